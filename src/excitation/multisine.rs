//! A random-phase multisine: equal lines, evenly spaced over a band, with seeded phases.
//!
//! The excitation of frequency-response measurements (Pintelon & Schoukens, *System Identification*, 2nd ed., ch. 5).

use std::f64::consts::TAU;

use super::Waveform;
use crate::rng::{Philox, Stream};
use rand::RngExt;

/// Equal lines over a band.
#[derive(Debug, Clone, PartialEq)]
pub struct Multisine {
    amplitude_m_s2: f64,
    lines: Vec<(f64, f64)>,
}

impl Multisine {
    /// `lines` sines from `from_hz` to `to_hz` inclusive whose sum has the root mean square `rms_m_s2`.
    pub fn new(rms_m_s2: f64, from_hz: f64, to_hz: f64, lines: u32, seed: u64) -> Self {
        let mut rng = Philox::new(seed, 0, Stream::Excitation);
        let spacing_hz = if lines > 1 { (to_hz - from_hz) / f64::from(lines - 1) } else { 0.0 };
        let line = |k| (TAU * (from_hz + spacing_hz * f64::from(k)), TAU * rng.random::<f64>());
        Self { amplitude_m_s2: rms_m_s2 * (2.0 / f64::from(lines)).sqrt(), lines: (0..lines).map(line).collect() }
    }
}

impl Waveform for Multisine {
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
