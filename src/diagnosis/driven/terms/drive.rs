//! What the input does besides pushing in proportion: its square in the force, and a share that goes straight to the reading.

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

use super::law::{Instant, LANES, Lanes, Physics};
use super::scales::{Coordinate, Scales};

/// g(u + κu²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Square;

/// What the library says of it.
pub const SQUARE: Candidate = Candidate {
    id: "drive-nonlinearity",
    kind: Kind::Driven,
    statement: "The force is not proportional to the input: its square acts too, as with electrostatic drive.",
    equation: "x″ + 2ζω₀x′ + ω₀²x = g(u + κu²)",
    parameters: &[Parameter { name: "kappa", unit: "1/u", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "sums, differences and harmonics of the input's frequencies, filtered by the resonance",
    confusable_with: &["quadratic-stiffness", "readout-nonlinearity"],
    reference: "Senturia, Microsystem Design, 2001, ch. 6 (electrostatic actuation)",
};

impl Physics for Square {
    fn words(&self) -> &'static Candidate {
        &SQUARE
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 / s.input)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    #[inline(always)]
    fn force(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], _: &mut [Lanes], acceleration: &mut Lanes) {
        for l in 0..LANES {
            acceleration[l] += at.base.gain[l] * p[0][l] * at.input[l] * at.input[l];
        }
    }
    fn moves(&self) -> bool {
        true
    }
    fn needs_input(&self) -> bool {
        true
    }
}

/// y = x + d·u.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feedthrough;

/// What the library says of it.
pub const FEEDTHROUGH: Candidate = Candidate {
    id: "feedthrough",
    kind: Kind::Driven,
    statement: "A share of the input reaches the reading without passing the proof mass.",
    equation: "y = x + d·u",
    parameters: &[Parameter { name: "d", unit: "y/u", range: (-1.0, 1.0) }],
    acts: "readout",
    signature: "the frequency response levels off above the resonance instead of falling",
    confusable_with: &["parasitic-mode", "readout-delay", "readout-lowpass"],
    reference: "Lee & Seshia, Parasitic feedthrough cancellation, Sensors and Actuators A 156 (2009)",
};

impl Physics for Feedthrough {
    fn words(&self) -> &'static Candidate {
        &FEEDTHROUGH
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.output / s.input)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    #[inline(always)]
    fn reading(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], y: &mut Lanes) {
        for l in 0..LANES {
            y[l] += p[0][l] * at.input[l];
        }
    }
    fn reads(&self) -> Option<u8> {
        Some(3)
    }
    fn needs_input(&self) -> bool {
        true
    }
}
