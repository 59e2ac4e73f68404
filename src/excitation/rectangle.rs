//! A rectangular pulse: the paper's test of what double integration makes of a lagging proof mass.

use super::Waveform;

/// `amplitude` from `start_s` (inclusive) for `length_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// Height, m/s².
    pub amplitude_m_s2: f64,
    /// First instant, s.
    pub start_s: f64,
    /// Duration, s.
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
