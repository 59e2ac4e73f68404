//! Offsets that change by law: a ramp, and a warm-up that dies away. Time counts from the recording's first sample.

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

use super::law::{Instant, LANES, Lanes, Physics};
use super::scales::{Coordinate, Scales};

/// c·t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp;

/// What the library says of it.
pub const RAMP: Candidate = Candidate {
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

impl Physics for Ramp {
    fn words(&self) -> &'static Candidate {
        &RAMP
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.output / s.duration_s)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    #[inline(always)]
    fn reading(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], y: &mut Lanes) {
        for l in 0..LANES {
            y[l] += p[0][l] * at.time_s;
        }
    }
    fn reads(&self) -> Option<u8> {
        Some(4)
    }
}

/// c·exp(−t/τ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WarmUp;

/// What the library says of it.
pub const WARM_UP: Candidate = Candidate {
    id: "warm-up",
    kind: Kind::Driven,
    statement: "The offset of the reading settles exponentially after switch-on.",
    equation: "y = x + c·exp(−t/τ)",
    parameters: &[
        Parameter { name: "c", unit: "y", range: (-1.0, 1.0) },
        Parameter { name: "tau", unit: "s", range: (0.0, 10.0) },
    ],
    acts: "readout",
    signature: "a residual that is large at the beginning and dies away",
    confusable_with: &["bias-drift", "bias-random-walk"],
    reference: "IEEE 1293, turn-on transient",
};

impl Physics for WarmUp {
    fn words(&self) -> &'static Candidate {
        &WARM_UP
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.output), Coordinate::Log(0.01 * s.duration_s, 2.0 * s.duration_s)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        [0.02, 0.05, 0.12, 0.3, 0.8].map(|t| vec![0.0, t * s.duration_s]).to_vec()
    }
    #[inline(always)]
    fn reading(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], y: &mut Lanes) {
        for l in 0..LANES {
            y[l] += p[0][l] * (-at.time_s / p[1][l]).exp();
        }
    }
    fn reads(&self) -> Option<u8> {
        Some(4)
    }
}
