//! An offset that drifts in proportion to time, counted from the first sample: c·t.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Place, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};

/// Offset of the reading c·t.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BiasDrift;

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

impl Law for BiasDrift {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Readout(Place::Bias)
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.output / s.duration_s)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    #[inline(always)]
    fn reading(&self, at: &Instant<'_, f64>, p: &[f64; MOST_VALUES], _: &[f64; MOST_STAGED], y: f64) -> f64 {
        y + p[0] * at.time
    }
}
