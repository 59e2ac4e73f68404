//! One sine, the same for all members or one of each member's own.

use std::f64::consts::TAU;

use super::keys::{FREQUENCY, PHASE, SIZE};
use super::plan::{Plan, Spectrum, Variation, highest_hz};
use super::reader::Kind;
use super::rest::Rest;
use super::section::Form;
use super::waveform::Waveform;
use crate::units::number::Number;

pub(crate) const KIND: Kind = Kind {
    name: "sine",
    keys: &[("amplitude_m_s2", Form::Number), ("frequency_hz", Form::Number), ("phase_rad", Form::Number)],
    plan: |given| {
        let (amplitude, frequency) = (given.need("amplitude_m_s2")?, given.need("frequency_hz")?);
        let phase = given.number("phase_rad").unwrap_or(Number::Fixed(0.0));
        let words = format!("sine of {amplitude} m/s² at {frequency} Hz");
        let spectrum = Spectrum::Line(highest_hz(frequency));
        Ok(match (amplitude.fixed(), frequency.fixed(), phase.fixed()) {
            (Some(amplitude_m_s2), Some(frequency_hz), Some(phase_rad)) if frequency_hz > 0.0 => {
                Plan::shared(MemberSine { amplitude_m_s2, frequency_hz, phase_rad }, words, spectrum)
            }
            _ => Plan {
                variation: Variation::Sine,
                drawn: vec![(&SIZE, amplitude), (&FREQUENCY, frequency), (&PHASE, phase)],
                ..Plan::shared(Rest, words + ", drawn per member", spectrum)
            },
        })
    },
};

/// A·sin(2πft + φ). Where its numbers are drawn per member, it is added to the shared waveform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MemberSine {
    /// Amplitude, m/s².
    pub amplitude_m_s2: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Phase at t = 0, rad.
    pub phase_rad: f64,
}

impl Waveform for MemberSine {
    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        self.amplitude_m_s2 * (TAU * self.frequency_hz * time_s + self.phase_rad).sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_period_after_zero_it_peaks() {
        let sine = MemberSine { amplitude_m_s2: 5.0, frequency_hz: 3.0, phase_rad: 0.0 };
        assert!((sine.specific_force_m_s2(1.0 / 12.0) - 5.0).abs() < 1e-12);
        assert!(sine.specific_force_m_s2(0.0).abs() < 1e-12);
    }
}
