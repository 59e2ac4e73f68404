//! An offset that wanders like a random walk.
//!
//! It changes no simulation but what the next sample is expected to be, given the ones before.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Noise, Role};
use super::scales::{Coordinate, Scales};

/// Random walk of the reading.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BiasRandomWalk;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "bias-random-walk",
    kind: Kind::Driven,
    statement: "The offset of the reading wanders like a random walk.",
    equation: "y = x + b, b′ white",
    parameters: &[Parameter { name: "K", unit: "y/sqrt(s)", range: (0.0, 1.0) }],
    acts: "noise at the readout",
    signature: "slow wandering of the residual whose variance grows with time",
    confusable_with: &["bias-drift", "warm-up", "force-noise"],
    reference: "IEEE 952, annex C (rate random walk)",
};

impl Law for BiasRandomWalk {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Noise(Noise::Walk)
    }
    fn coordinates(&self, _: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Log(1e-5, 1e2)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        [0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 10.0].map(|r| vec![r]).to_vec()
    }
}
