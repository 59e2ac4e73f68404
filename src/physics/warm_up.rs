//! An offset that settles exponentially after switch-on: c·exp(−t/τ), counted from the first
//! sample.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Place, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};

/// Offset of the reading c·exp(−t/τ).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WarmUp;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "warm-up",
    kind: Kind::Driven,
    statement: "The offset of the reading settles exponentially after switch-on.",
    equation: "y = x + c·exp(−t/τ)",
    parameters: &[
        Parameter { name: "c", unit: "y", range: (-1.0, 1.0) },
        Parameter { name: "tau", unit: "s", range: (0.0, 10.0) },
    ],
    acts: "readout",
    signature: "a residual that is large at the beginning and dies away",
    confusable_with: &["bias-drift", "bias-random-walk", "readout-highpass"],
    reference: "IEEE 1293, turn-on transient",
};

impl Law for WarmUp {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Readout(Place::Bias)
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let shortest = (0.01 * s.duration_s).min(1.0 / s.omega_rad_s);
        vec![Coordinate::Linear(0.1 * s.output), Coordinate::Log(shortest, 2.0 * s.duration_s)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        [0.02, 0.05, 0.12, 0.3, 0.8].map(|t| vec![0.0, t * s.duration_s]).to_vec()
    }
    #[inline(always)]
    fn reading(&self, at: &Instant<'_, f64>, p: &[f64; MOST_VALUES], _: &[f64; MOST_STAGED], y: f64) -> f64 {
        y + p[0] * (-at.time / p[1]).exp()
    }
}
