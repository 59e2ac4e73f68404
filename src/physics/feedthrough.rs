//! A fraction of the input that reaches the reading past the mass: y = x + d·u.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Place, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};

/// y = x + d·u.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Feedthrough;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "feedthrough",
    kind: Kind::Driven,
    statement: "Part of the input reaches the reading without passing the proof mass.",
    equation: "y = x + d·u",
    parameters: &[Parameter { name: "d", unit: "y/u", range: (-1.0, 1.0) }],
    acts: "readout",
    signature: "the frequency response levels off above the resonance instead of falling",
    confusable_with: &["parasitic-mode", "readout-delay", "readout-lowpass"],
    reference: "Lee & Seshia, Parasitic feedthrough cancellation, Sensors and Actuators A 156 (2009)",
};

impl Law for Feedthrough {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Readout(Place::Input)
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.output / s.input)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    fn needs_input(&self) -> bool {
        true
    }
    #[inline(always)]
    fn reading(&self, at: &Instant<'_, f64>, p: &[f64; MOST_VALUES], _: &[f64; MOST_STAGED], y: f64) -> f64 {
        y + p[0] * at.input
    }
}
