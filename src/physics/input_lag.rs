//! A measured input that comes late: what moved the mass was recorded after it did, u(t) = f(t −
//! τ).
//!
//! The reading then leads the input, as no sensor can: a delay of negative sign, in the chain that
//! measures the input.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};

/// u(t) = f(t − τ).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct InputLag;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "input-lag",
    kind: Kind::Driven,
    statement: "The measured input comes late by a fixed time: the reading leads it.",
    equation: "u(t) = f(t − τ), x″ + 2ζω₀x′ + ω₀²x = g·f",
    parameters: &[Parameter { name: "tau", unit: "s", range: (0.0, 1.0) }],
    acts: "measured input",
    signature: "phase that rises in proportion to frequency: the effect comes before its recorded cause",
    confusable_with: &["readout-delay", "feedthrough", "parasitic-mode"],
    reference: "Ljung, System Identification, 1999, ch. 4 (time delay)",
};

impl Law for InputLag {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::InputLead
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Bounded(0.1 * s.interval_s, 0.0, f64::MAX)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let mut starts = vec![vec![0.0]];
        if s.lag_samples < 0.0 {
            starts.push(vec![-s.lag_samples * s.interval_s]);
        }
        starts
    }
    fn needs_input(&self) -> bool {
        true
    }
}
