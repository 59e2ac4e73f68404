//! A half-sine shock, the pulse of drop and shock tests (IEC 60068-2-27).

use std::f64::consts::PI;

use super::plan::{Plan, Spectrum};
use super::reader::Kind;
use super::section::Form;
use super::waveform::Waveform;
use crate::units::STANDARD_GRAVITY_M_S2;

pub(crate) const KIND: Kind = Kind {
    name: "shock",
    keys: &[("peak_g", Form::Number), ("start_s", Form::Number), ("length_s", Form::Number)],
    plan: |given| {
        let (peak, start_s) = (given.need("peak_g")?, given.start_s()?);
        let length_s = given.positive("length_s")?;
        let words = format!("half-sine shock of {peak} g for {length_s} s at {start_s} s");
        let shape = |peak_m_s2| Shock { peak_m_s2, start_s, length_s };
        Ok(Plan::sized(peak.scaled(STANDARD_GRAVITY_M_S2), shape, words, Spectrum::Shape))
    },
};

/// One half period of a sine.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Shock {
    pub peak_m_s2: f64,
    pub start_s: f64,
    /// Length of the half period, s.
    pub length_s: f64,
}

impl Waveform for Shock {
    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        let since = time_s - self.start_s;
        if since > 0.0 && since < self.length_s { self.peak_m_s2 * (PI * since / self.length_s).sin() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_velocity_change_is_two_over_pi_of_peak_times_length() {
        let shock = Shock { peak_m_s2: 1000.0, start_s: 0.1, length_s: 0.011 };
        let step = 1e-6;
        let velocity: f64 = (0..200_000).map(|k| shock.specific_force_m_s2(k as f64 * step) * step).sum();
        assert!((velocity - 2.0 / PI * 11.0).abs() < 1e-3, "{velocity}");
    }
}
