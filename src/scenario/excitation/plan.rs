//! An excitation as a study runs it: a waveform that all members share, and what each member has of
//! its own.

use std::sync::Arc;

use super::keys::SIZE;
use super::waveform::Waveform;
use crate::error::{Error, Result};
use crate::units::key::Key;
use crate::units::number::Number;

/// Excitation of the sensor.
#[derive(Clone)]
pub struct Plan {
    /// Shared by all members, up to their gain.
    pub waveform: Arc<dyn Waveform>,
    /// Variation of the excitation between members.
    pub variation: Variation,
    /// Numbers that are drawn per member.
    pub drawn: Vec<(&'static Key, Number)>,
    /// Description with numbers and units.
    pub words: String,
    /// The frequencies it is made of.
    pub spectrum: Spectrum,
    /// SHA-256 of the file that is replayed, hexadecimal.
    pub replayed_sha256: Option<String>,
}

/// Variation of the excitation between members.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variation {
    /// Every member gets the shared waveform unchanged.
    None,
    /// By a factor: [`SIZE`] is the member's gain.
    Gain,
    /// A sine of its own: size, frequency and phase are drawn.
    Sine,
}

/// The frequencies an excitation is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spectrum {
    /// Any other shape, without a highest frequency.
    Shape,
    /// One line, Hz: without it nothing is left.
    Line(f64),
    /// A band up to here, Hz.
    Band(f64),
}

impl Plan {
    /// The same for all members.
    pub fn shared(waveform: impl Waveform + 'static, words: String, spectrum: Spectrum) -> Self {
        Self {
            waveform: Arc::new(waveform),
            variation: Variation::None,
            drawn: Vec::new(),
            words,
            spectrum,
            replayed_sha256: None,
        }
    }

    /// A shape of fixed size, or of unit size with the members' gain.
    pub fn sized<W: Waveform + 'static>(
        size: Number,
        shape: impl Fn(f64) -> W,
        words: String,
        spectrum: Spectrum,
    ) -> Self {
        match size.fixed() {
            Some(value) => Self::shared(shape(value), words, spectrum),
            None => Self {
                variation: Variation::Gain,
                drawn: vec![(&SIZE, size)],
                ..Self::shared(shape(1.0), words + ", drawn per member", spectrum)
            },
        }
    }
}

impl Plan {
    /// Refuses a line that steps of this length cannot see, and says of a band that part of it
    /// folds back.
    ///
    /// # Errors
    /// A line at or above half the rate of the steps; `source` is where the study was read from.
    pub fn resolved(mut self, source: &str, step_s: f64) -> Result<Self> {
        let half_hz = 0.5 / step_s;
        let folds = |highest_hz: f64| highest_hz >= half_hz * (1.0 - 1e-9);
        let step = |fraction: f64, highest_hz: f64| (fraction / highest_hz * 1e9).floor() / 1e9;
        match self.spectrum {
            Spectrum::Line(highest_hz) if folds(highest_hz) => Err(Error::new(
                format!("could not use {source}"),
                format!(
                    "a sine of {highest_hz:?} Hz cannot be represented in steps of {step_s:?} s: half their rate is \
                    {half_hz:?} Hz"
                ),
                match step(0.25, highest_hz) {
                    0.0 => "check its exponent".to_owned(),
                    step => format!("`step_s` at or below {step:?} resolves it"),
                },
            )),
            Spectrum::Band(highest_hz) if folds(highest_hz) => {
                self.words += &format!(
                    ". It is sampled every {step_s:?} s, so that content above {half_hz:?} Hz is aliased; `step_s` \
                     at or below {:?} would resolve it",
                    step(0.4, highest_hz)
                );
                Ok(self)
            }
            _ => Ok(self),
        }
    }
}

/// A number's 99 % quantile, as the highest frequency that counts.
pub(crate) fn highest_hz(number: Number) -> f64 {
    number.quantile(0.99, true)
}
