//! A readout that bends: y = x + k₂x² + k₃x³.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Place, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};

/// x + k₂x² + k₃x³ at the readout.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ReadoutNonlinearity;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "readout-nonlinearity",
    kind: Kind::Driven,
    statement: "The readout is nonlinear: reading and displacement are not proportional.",
    equation: "y = x + k₂x² + k₃x³",
    parameters: &[
        Parameter { name: "k2", unit: "1/y", range: (-1.0, 1.0) },
        Parameter { name: "k3", unit: "1/y^2", range: (-1.0, 1.0) },
    ],
    acts: "readout",
    signature: "harmonics that the resonance does not filter; the resonance does not move with amplitude",
    confusable_with: &["cubic-stiffness", "quadratic-stiffness", "readout-saturation"],
    reference: "IEEE 1293, nonlinearity coefficients K₂ and K₃",
};

impl Law for ReadoutNonlinearity {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Readout(Place::Nonlinearity)
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 / s.output), Coordinate::Linear(0.1 / s.output.powi(2))]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.0]]
    }
    #[inline(always)]
    fn reading(&self, _: &Instant<'_, f64>, p: &[f64; MOST_VALUES], _: &[f64; MOST_STAGED], y: f64) -> f64 {
        y + y * y * (p[0] + p[1] * y)
    }
}
