//! Noise that is more than white at the readout: force noise, shaped by the resonance, and a bias that walks.
//!
//! Neither changes a simulation; both change what the next sample is expected to be, given the ones before (`gain`).

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

use super::law::{Noise, Physics};
use super::scales::{Coordinate, Scales};

/// White force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force;

/// What the library says of it.
pub const FORCE: Candidate = Candidate {
    id: "force-noise",
    kind: Kind::Driven,
    statement: "Noise enters as a force before the proof mass, which colours it like the resonator itself.",
    equation: "x″ + 2ζω₀x′ + ω₀²x = g·u + w, w white",
    parameters: &[Parameter { name: "rms_displacement", unit: "y", range: (0.0, 1.0) }],
    acts: "noise in the equation of motion",
    signature: "the residual rings at the resonance; its next sample follows from the ones before",
    confusable_with: &["bias-random-walk"],
    reference: "Gabrielson, Mechanical-thermal noise in micromachined sensors, IEEE T-ED 40 (1993); Ljung, System Identification, 1999, ch. 4",
};

impl Physics for Force {
    fn words(&self) -> &'static Candidate {
        &FORCE
    }
    fn coordinates(&self, _: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Log(1e-3, 1e3)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        [0.1, 0.3, 1.0, 3.0, 10.0, 100.0].map(|r| vec![r]).to_vec()
    }
    fn noise(&self) -> Option<Noise> {
        Some(Noise::Force)
    }
}

/// Random walk of the reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walk;

/// What the library says of it.
pub const WALK: Candidate = Candidate {
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

impl Physics for Walk {
    fn words(&self) -> &'static Candidate {
        &WALK
    }
    fn coordinates(&self, _: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Log(1e-5, 1e2)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        [0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 10.0].map(|r| vec![r]).to_vec()
    }
    fn noise(&self) -> Option<Noise> {
        Some(Noise::Walk)
    }
}
