//! A reading that is rounded to steps. No simulation is changed; it is judged by the likelihood of
//! the values themselves.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};

/// Rounding to a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ReadoutQuantisation;

/// States the candidate for the library.
pub const CANDIDATE: Candidate = Candidate {
    id: "readout-quantisation",
    kind: Kind::Driven,
    statement: "The reading is rounded to steps that are coarse next to the noise.",
    equation: "y = step · round(x / step)",
    parameters: &[Parameter { name: "step", unit: "y", range: (0.0, 1.0) }],
    acts: "readout",
    signature: "readings fall on few, evenly spaced values; the residual is spread evenly over one step",
    confusable_with: &[],
    reference: "Widrow & Kollár, Quantization Noise, 2008; IEEE 952, annex C",
};

impl Law for ReadoutQuantisation {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Lattice
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(s.residual)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        Vec::new()
    }
}
