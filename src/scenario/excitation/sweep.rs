//! A sine whose frequency moves evenly from one end of a band to the other over the run.

use std::f64::consts::TAU;

use super::plan::{Plan, Spectrum};
use super::reader::Kind;
use super::section::Form;
use super::waveform::Waveform;

pub(crate) const KIND: Kind = Kind {
    name: "sweep",
    keys: &[("amplitude_m_s2", Form::Number), ("from_hz", Form::Number), ("to_hz", Form::Number)],
    plan: |given| {
        let amplitude = given.need("amplitude_m_s2")?;
        let ((from_hz, to_hz), length_s) = (given.band_hz()?, given.run.duration_s);
        let words = format!("sweep of {amplitude} m/s² from {from_hz} Hz to {to_hz} Hz over the run");
        let shape = |amplitude_m_s2| Sweep { amplitude_m_s2, from_hz, to_hz, length_s };
        Ok(Plan::sized(amplitude, shape, words, Spectrum::Band(from_hz.max(to_hz))))
    },
};

/// Linear sweep; the phase is the integral of the frequency, so that no instant jumps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sweep {
    pub amplitude_m_s2: f64,
    /// Frequency at t = 0, Hz.
    pub from_hz: f64,
    /// Frequency at t = `length_s`, Hz.
    pub to_hz: f64,
    /// Length of the run, s.
    pub length_s: f64,
}

impl Waveform for Sweep {
    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        let slope_hz_s = (self.to_hz - self.from_hz) / self.length_s;
        self.amplitude_m_s2 * (TAU * time_s * (self.from_hz + 0.5 * slope_hz_s * time_s)).sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_zero_crossings_follow_the_instantaneous_frequency() {
        let sweep = Sweep { amplitude_m_s2: 1.0, from_hz: 1.0, to_hz: 11.0, length_s: 10.0 };
        let signs: Vec<bool> = (0..1_000_000).map(|k| sweep.specific_force_m_s2(k as f64 * 1e-5) >= 0.0).collect();
        let crossings = |from: usize, to: usize| signs[from..to].windows(2).filter(|w| w[0] != w[1]).count();
        // Cycles are the integral of the frequency: 4 of the 60 in the first 2 s, 20 in the last 2
        // s, two crossings each.
        assert_eq!(crossings(1, 200_000), 7);
        assert!((39..=41).contains(&crossings(800_000, 1_000_000)));
    }
}
