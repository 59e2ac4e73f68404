//! An offset that drifts in proportion to time, counted from the first sample: c·t.
//!
//! With an exponent n it is c·t·(t/T)ⁿ⁻¹, where T is the length of the recording, which is chosen and
//! not fitted: c is the mean rate over it. That form is not searched for ([`Law::tried`]): a diagnosis
//! looks for it in the place of two laws of time that may imitate it. No study runs it.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Place, Role};
use super::power::{LEAST, bounded_power};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};

/// Course of a drift in time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Course {
    /// A straight line.
    #[default]
    Line,
    /// One power of time, whose exponent is fitted.
    Power,
}

/// Offset of the reading that grows with time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BiasDrift(pub Course);

/// Exponents that a fit may take: below lies a step at the first sample.
const EXPONENTS: [f64; 2] = [0.1, 6.0];

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "bias-drift",
    kind: Kind::Driven,
    statement: "The offset of the reading drifts in proportion to time.",
    equation: "y = x + c·t",
    parameters: &[Parameter { name: "c", unit: "y/s", range: (-1.0, 1.0) }],
    acts: "readout",
    signature: "a straight line in the residual",
    confusable_with: &["warm-up", "bias-random-walk"],
    reference: "IEEE 952, annex C (rate ramp)",
};

/// States the candidate with an exponent: the same one, with two parameters more.
pub(crate) const BENT: Candidate = Candidate {
    statement: "The offset of the reading drifts along a power of time.",
    equation: "y = x + c·t·(t/T)ⁿ⁻¹",
    parameters: &[
        Parameter { name: "c", unit: "y/s", range: (-1.0, 1.0) },
        Parameter { name: "T", unit: "s", range: (0.0, 10.0) },
        Parameter { name: "n", unit: "1", range: (EXPONENTS[0], EXPONENTS[1]) },
    ],
    ..CANDIDATE
};

impl Law for BiasDrift {
    fn candidate(&self) -> &'static Candidate {
        match self.0 {
            Course::Line => &CANDIDATE,
            Course::Power => &BENT,
        }
    }
    fn role(&self) -> Role {
        Role::Readout(Place::Bias)
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let rate = Coordinate::Linear(0.1 * s.output / s.duration_s);
        match self.0 {
            Course::Line => vec![rate],
            Course::Power => vec![rate, Coordinate::Held, Coordinate::Log(EXPONENTS[0], EXPONENTS[1])],
        }
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        match self.0 {
            Course::Line => vec![vec![0.0]],
            Course::Power => [0.3, 0.6, 1.5, 2.5].map(|n| vec![0.0, s.duration_s, n]).to_vec(),
        }
    }
    #[inline(always)]
    fn reading(&self, at: &Instant<'_, f64>, p: &[f64; MOST_VALUES], _: &[f64; MOST_STAGED], y: f64) -> f64 {
        match self.0 {
            Course::Line => y + p[0] * at.time,
            Course::Power => y + p[0] * at.time * bounded_power((at.time / p[1]).max(LEAST), p[2] - 1.0),
        }
    }
    /// The straight line alone: see the module.
    fn tried(_: usize) -> Vec<Self> {
        vec![Self(Course::Line)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_power_is_the_line_and_any_power_ends_at_the_mean_rate() {
        let read = |course: Course, time: f64, n: f64| {
            let at = Instant { time, ..Instant::default() };
            let p = [0.3, 8.0, n, 0.0, 0.0, 0.0];
            BiasDrift(course).reading(&at, &p, &[0.0; MOST_STAGED], 1.0)
        };
        for time in [0.0, 0.5, 3.0, 8.0] {
            let line = read(Course::Line, time, 1.0);
            assert!((read(Course::Power, time, 1.0) - line).abs() < 1e-15);
            // 0.3·8·(t/8)^0.6.
            assert!((read(Course::Power, time, 0.6) - 1.0 - 2.4 * (time / 8.0).powf(0.6)).abs() < 1e-5, "{time}");
        }
        assert!((read(Course::Power, 8.0, 2.7) - read(Course::Line, 8.0, 1.0)).abs() < 1e-12);
        assert!((read(Course::Power, 3.0, 0.6) - read(Course::Line, 3.0, 1.0)).abs() > 0.1, "another power is another");
    }
}
