//! Springs that are not straight lines, or not constant: cubic and quadratic stiffness, and stiffness that drifts.

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

use super::law::{Instant, LANES, Lanes, Physics};
use super::scales::{Coordinate, Scales};

/// βx³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cubic;

/// What the library says of it.
pub const CUBIC: Candidate = Candidate {
    id: "cubic-stiffness",
    kind: Kind::Driven,
    statement: "The spring stiffens (or softens) with the square of the displacement.",
    equation: "x″ + 2ζω₀x′ + ω₀²x + βx³ = g·u",
    parameters: &[Parameter { name: "beta", unit: "1/(y^2 s^2)", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "the resonance moves with amplitude; third harmonics of the displacement",
    confusable_with: &["readout-nonlinearity", "hysteresis", "end-stop", "readout-saturation"],
    reference: "Nayfeh & Mook, Nonlinear Oscillations, 1979, ch. 4; Wigren & Schoukens, ECC 2013",
};

impl Physics for Cubic {
    fn words(&self) -> &'static Candidate {
        &CUBIC
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.omega_rad_s.powi(2) / s.output.powi(2))]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    #[inline(always)]
    fn force(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], _: &mut [Lanes], acceleration: &mut Lanes) {
        for l in 0..LANES {
            acceleration[l] -= p[0][l] * at.x[l] * at.x[l] * at.x[l];
        }
    }
    fn moves(&self) -> bool {
        true
    }
}

/// αx².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quadratic;

/// What the library says of it.
pub const QUADRATIC: Candidate = Candidate {
    id: "quadratic-stiffness",
    kind: Kind::Driven,
    statement: "The spring is stiffer on one side than on the other.",
    equation: "x″ + 2ζω₀x′ + ω₀²x + αx² = g·u",
    parameters: &[Parameter { name: "alpha", unit: "1/(y s^2)", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "the mean displacement follows the vibration's power; second harmonics",
    confusable_with: &["drive-nonlinearity", "readout-nonlinearity", "end-stop"],
    reference: "Nayfeh & Mook, Nonlinear Oscillations, 1979, ch. 4; IEEE 1293 (vibration rectification)",
};

impl Physics for Quadratic {
    fn words(&self) -> &'static Candidate {
        &QUADRATIC
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.omega_rad_s.powi(2) / s.output)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    #[inline(always)]
    fn force(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], _: &mut [Lanes], acceleration: &mut Lanes) {
        for l in 0..LANES {
            acceleration[l] -= p[0][l] * at.x[l] * at.x[l];
        }
    }
    fn moves(&self) -> bool {
        true
    }
}

/// ω₀²(1 + κt), or ω₀²(1 + κ·environment).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// The environment column it follows; time where absent.
    pub environment: Option<usize>,
}

/// What the library says of it.
pub const DRIFT: Candidate = Candidate {
    id: "stiffness-drift",
    kind: Kind::Driven,
    statement: "The spring changes during the recording, with time or with its environment.",
    equation: "x″ + 2ζω₀x′ + ω₀²(1 + κt)x = g·u, or κ times an environment column",
    parameters: &[Parameter { name: "kappa", unit: "1/s", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "the resonance moves with time whatever the amplitude",
    confusable_with: &["warm-up", "bias-drift"],
    reference: "IEEE 1293, temperature and time sensitivity of the scale factor",
};

impl Physics for Drift {
    fn words(&self) -> &'static Candidate {
        &DRIFT
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 / self.environment.map_or(s.duration_s, |e| s.environment[e].max(1e-300)))]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    #[inline(always)]
    fn force(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], _: &mut [Lanes], acceleration: &mut Lanes) {
        let by = self.environment.map_or(at.time_s, |e| at.environment[e]);
        for l in 0..LANES {
            acceleration[l] -= at.base.stiffness[l] * p[0][l] * by * at.x[l];
        }
    }
    fn moves(&self) -> bool {
        true
    }
}
