//! A random-phase multisine: equal lines, evenly spaced over a band, with seeded phases.
//!
//! The excitation of frequency-response measurements (Pintelon & Schoukens, *System
//! Identification*, 2nd ed., ch. 5).

use std::f64::consts::TAU;

use super::plan::{Plan, Spectrum};
use super::reader::Kind;
use super::section::Form;
use super::waveform::Waveform;
use crate::rng::{Philox, Stream};
use rand::RngExt;

/// Most lines: they are summed afresh at every step.
const MOST_LINES: u32 = 4096;

pub(crate) const KIND: Kind = Kind {
    name: "multisine",
    keys: &[("rms_m_s2", Form::Number), ("from_hz", Form::Number), ("to_hz", Form::Number), ("lines", Form::Whole)],
    plan: |given| {
        let rms = given.need("rms_m_s2")?;
        let ((from_hz, to_hz), lines) = (given.band_hz()?, given.whole("lines")?);
        if lines == 0 || lines > MOST_LINES {
            return Err(given.refuse(
                format!("`excitation.lines` = {lines}: need 1 to {MOST_LINES}"),
                "for a dense spectrum use kind = \"random\"",
            ));
        }
        let words = format!("multisine of {rms} m/s² rms, {lines} lines from {from_hz} Hz to {to_hz} Hz");
        let shape = |rms_m_s2| Multisine::new(rms_m_s2, from_hz, to_hz, lines, given.run.seed);
        Ok(Plan::sized(rms, shape, words, Spectrum::Band(from_hz.max(to_hz))))
    },
};

/// Equal lines over a band.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Multisine {
    amplitude_m_s2: f64,
    lines: Vec<(f64, f64)>,
}

impl Multisine {
    /// `lines` sines from `from_hz` to `to_hz` inclusive whose sum has the root mean square
    /// `rms_m_s2`.
    pub(crate) fn new(rms_m_s2: f64, from_hz: f64, to_hz: f64, lines: u32, seed: u64) -> Self {
        let mut rng = Philox::new(seed, 0, Stream::Excitation);
        let spacing_hz = if lines > 1 { (to_hz - from_hz) / f64::from(lines - 1) } else { 0.0 };
        let line = |k| (TAU * (from_hz + spacing_hz * f64::from(k)), TAU * rng.random::<f64>());
        Self { amplitude_m_s2: rms_m_s2 * (2.0 / f64::from(lines)).sqrt(), lines: (0..lines).map(line).collect() }
    }
}

impl Waveform for Multisine {
    fn before_m_s2(&self) -> f64 {
        0.0
    }

    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        let sum: f64 = self.lines.iter().map(|(omega_rad_s, phase_rad)| (omega_rad_s * time_s + phase_rad).sin()).sum();
        self.amplitude_m_s2 * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_root_mean_square_is_the_one_asked_for() {
        // 11 lines from 1 to 2 Hz repeat after 10 s; over a whole period the mean square is exact.
        let multisine = Multisine::new(3.0, 1.0, 2.0, 11, 7);
        let n = 10_000;
        let square: f64 = (0..n).map(|k| multisine.specific_force_m_s2(10.0 * k as f64 / n as f64).powi(2)).sum();
        assert!(((square / n as f64).sqrt() - 3.0).abs() < 1e-9);
        assert_ne!(multisine, Multisine::new(3.0, 1.0, 2.0, 11, 8));
    }
}
