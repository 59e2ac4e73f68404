//! One sine, the same for all members. Where its numbers are drawn per member, `MemberSine` takes its place.

use std::f64::consts::TAU;

use super::{MemberSine, Waveform};

/// A·sin(2πft + φ).
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
