//! A reading that is late by a fixed time: y(t) = x(t − τ).
//!
//! A delay commutes with everything that does not depend on time, so it is applied to the input
//! that moves the mass; what reaches the reading past the mass is not late.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};

/// y(t) = x(t − τ).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ReadoutDelay;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "readout-delay",
    kind: Kind::Driven,
    statement: "The reading lags the input by a fixed time.",
    equation: "y(t) = x(t − τ)",
    parameters: &[Parameter { name: "tau", unit: "s", range: (0.0, 1.0) }],
    acts: "readout",
    signature: "phase that falls in proportion to frequency",
    confusable_with: &["readout-lowpass", "feedthrough", "parasitic-mode", "input-lag"],
    reference: "Ljung, System Identification, 1999, ch. 4 (time delay)",
};

impl Law for ReadoutDelay {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::InputDelay
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Bounded(0.1 * s.interval_s, 0.0, f64::MAX)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let mut starts = vec![vec![0.0]];
        if s.lag_samples > 0.0 {
            starts.push(vec![s.lag_samples * s.interval_s]);
        }
        starts
    }
    fn needs_input(&self) -> bool {
        true
    }
}
