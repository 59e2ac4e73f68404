//! A periodic disturbance in the reading that the input has nothing to do with.

use std::f64::consts::TAU;

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

use super::law::{Instant, LANES, Lanes, Physics};
use super::scales::{Coordinate, Scales};

/// One line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Periodic;

/// What the library says of it.
pub const PERIODIC: Candidate = Candidate {
    id: "periodic-disturbance",
    kind: Kind::Driven,
    statement: "A steady oscillation that the input does not cause is added to the reading, e.g. mains pickup.",
    equation: "y = x + a cos 2πft + b sin 2πft",
    parameters: &[
        Parameter { name: "a", unit: "y", range: (-1.0, 1.0) },
        Parameter { name: "b", unit: "y", range: (-1.0, 1.0) },
        Parameter { name: "frequency", unit: "Hz", range: (0.0, 1e6) },
    ],
    acts: "readout",
    signature: "a narrow line in the residual's spectrum that keeps its phase",
    confusable_with: &["force-noise"],
    reference: "Percival & Walden, Spectral Analysis for Physical Applications, 1993, ch. 10",
};

impl Physics for Periodic {
    fn words(&self) -> &'static Candidate {
        &PERIODIC
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let size = Coordinate::Linear(0.1 * s.output);
        vec![size, size, Coordinate::Bounded(0.1 / s.duration_s, 0.5 / s.duration_s, 0.5 / s.interval_s)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        s.lines_hz.iter().take(4).map(|f| vec![0.0, 0.0, *f]).collect()
    }
    #[inline(always)]
    fn reading(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], y: &mut Lanes) {
        for l in 0..LANES {
            let (sin, cos) = (TAU * p[2][l] * at.time_s).sin_cos();
            y[l] += p[0][l] * cos + p[1][l] * sin;
        }
    }
    fn reads(&self) -> Option<u8> {
        Some(4)
    }
}
