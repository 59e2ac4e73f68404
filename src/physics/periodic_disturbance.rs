//! A steady oscillation in the reading that the input does not cause, e.g. mains pickup.

use std::f64::consts::TAU;

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Place, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};

/// One sinusoid added to the reading, a cos 2πft + b sin 2πft, by its place among them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PeriodicDisturbance(pub usize);

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "periodic-disturbance",
    kind: Kind::Driven,
    statement: "A steady oscillation that the input does not cause is added to the reading, e.g. mains pickup.",
    equation: "y = x + a cos 2πft + b sin 2πft",
    parameters: &[
        Parameter { name: "a", unit: "y", range: (-1.0, 1.0) },
        Parameter { name: "b", unit: "y", range: (-1.0, 1.0) },
        Parameter { name: "frequency", unit: "Hz", range: (0.0, 1e6) },
    ],
    acts: "readout",
    signature: "a narrow line in the residual's spectrum that keeps its phase",
    confusable_with: &["force-noise"],
    reference: "Percival & Walden, Spectral Analysis for Physical Applications, 1993, ch. 10",
};

impl Law for PeriodicDisturbance {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Readout(Place::Bias)
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let size = Coordinate::Linear(0.1 * s.output);
        vec![size, size, Coordinate::Bounded(0.1 / s.duration_s, 0.5 / s.duration_s, s.highest_hz)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        // In some of the samples alone a sine may be a constant.
        let turns = |f: f64| (f * s.interval_s - (f * s.interval_s).round()).abs() * s.duration_s / s.interval_s;
        let seen = s.lines_hz.iter().take(4).filter(|f| turns(**f) >= 0.5);
        seen.map(|f| vec![0.0, 0.0, *f]).collect()
    }
    #[inline(always)]
    fn reading(&self, at: &Instant<'_, f64>, p: &[f64; MOST_VALUES], _: &[f64; MOST_STAGED], y: f64) -> f64 {
        let (sin, cos) = (TAU * p[2] * at.time).sin_cos();
        y + (p[0] * cos + p[1] * sin)
    }
}
