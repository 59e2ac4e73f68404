//! A rectangular pulse: the paper's test of what double integration makes of a lagging proof mass.

use super::plan::{Plan, Spectrum};
use super::reader::Kind;
use super::section::Form;
use super::waveform::Waveform;

pub(crate) const KIND: Kind = Kind {
    name: "rectangle",
    keys: &[("amplitude_m_s2", Form::Number), ("start_s", Form::Number), ("length_s", Form::Number)],
    plan: |given| {
        let (amplitude, start_s) = (given.need("amplitude_m_s2")?, given.start_s()?);
        let length_s = given.positive("length_s")?;
        let words = format!("rectangle of {amplitude} m/s² from {start_s} s for {length_s} s");
        let shape = |amplitude_m_s2| Rectangle { amplitude_m_s2, start_s, length_s };
        Ok(Plan::sized(amplitude, shape, words, Spectrum::Shape))
    },
};

/// `amplitude` from `start_s` (inclusive) for `length_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rectangle {
    pub amplitude_m_s2: f64,
    pub start_s: f64,
    pub length_s: f64,
}

impl Waveform for Rectangle {
    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        let since = time_s - self.start_s;
        if since >= 0.0 && since < self.length_s { self.amplitude_m_s2 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_edges_are_half_open() {
        let pulse = Rectangle { amplitude_m_s2: 2.0, start_s: 1.0, length_s: 0.5 };
        let at = |t| pulse.specific_force_m_s2(t);
        assert_eq!([at(0.999), at(1.0), at(1.499), at(1.5)], [0.0, 2.0, 2.0, 0.0]);
    }
}
