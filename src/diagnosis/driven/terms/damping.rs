//! Damping that is not proportional to velocity: quadratic, squeeze-film, and dry friction.

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

use super::law::{Instant, LANES, Lanes, Physics};
use super::scales::{Coordinate, Scales};

/// c₂|x′|x′.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quadratic;

/// What the library says of it.
pub const QUADRATIC: Candidate = Candidate {
    id: "quadratic-damping",
    kind: Kind::Driven,
    statement: "Damping grows with speed, as in a gas stream or a turbulent fluid.",
    equation: "x″ + 2ζω₀x′ + c₂|x′|x′ + ω₀²x = g·u",
    parameters: &[Parameter { name: "c2", unit: "1/y", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "the peak of the resonance is lower at high amplitude; odd harmonics of velocity",
    confusable_with: &["squeeze-film-damping", "coulomb-friction", "hysteresis"],
    reference: "Bao, Analysis and Design Principles of MEMS Devices, 2005, ch. 3",
};

impl Physics for Quadratic {
    fn words(&self) -> &'static Candidate {
        &QUADRATIC
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(s.zeta * s.omega_rad_s / s.velocity)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    #[inline(always)]
    fn force(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], _: &mut [Lanes], acceleration: &mut Lanes) {
        let strength = &p[0];
        for l in 0..LANES {
            acceleration[l] -= strength[l] * at.v[l].abs() * at.v[l];
        }
    }
    fn moves(&self) -> bool {
        true
    }
}

/// c x²x′.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SqueezeFilm;

/// What the library says of it.
pub const SQUEEZE_FILM: Candidate = Candidate {
    id: "squeeze-film-damping",
    kind: Kind::Driven,
    statement: "Damping grows with displacement, as the gas film is squeezed.",
    equation: "x″ + (2ζω₀ + c x²)x′ + ω₀²x = g·u",
    parameters: &[Parameter { name: "c", unit: "1/(y^2 s)", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "the peak of the resonance is lower at high amplitude; loss grows with displacement, not with speed",
    confusable_with: &["quadratic-damping", "coulomb-friction", "hysteresis"],
    reference: "Bao & Yang, Squeeze film air damping in MEMS, Sensors and Actuators A 136 (2007)",
};

impl Physics for SqueezeFilm {
    fn words(&self) -> &'static Candidate {
        &SQUEEZE_FILM
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(s.zeta * s.omega_rad_s / s.output.powi(2))]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    #[inline(always)]
    fn force(&self, at: &Instant<'_>, p: &[Lanes], _: &[Lanes], _: &mut [Lanes], acceleration: &mut Lanes) {
        let strength = &p[0];
        for l in 0..LANES {
            acceleration[l] -= strength[l] * at.x[l] * at.x[l] * at.v[l];
        }
    }
    fn moves(&self) -> bool {
        true
    }
}

/// f_c sgn x′.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb;

/// What the library says of it.
pub const COULOMB: Candidate = Candidate {
    id: "coulomb-friction",
    kind: Kind::Driven,
    statement: "Dry friction opposes motion with a constant force and can hold the mass still.",
    equation: "x″ + 2ζω₀x′ + f_c sgn x′ + ω₀²x = g·u",
    parameters: &[Parameter { name: "f_c", unit: "y/s^2", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "more damping at low amplitude than at high; flat tops where motion stops",
    confusable_with: &["hysteresis", "quadratic-damping", "squeeze-film-damping"],
    reference: "Armstrong-Hélouvry, Dupont & Canudas de Wit, Automatica 30 (1994)",
};

impl Physics for Coulomb {
    fn words(&self) -> &'static Candidate {
        &COULOMB
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.zeta * s.omega_rad_s * s.velocity)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    fn has_corner(&self) -> bool {
        true
    }
    fn moves(&self) -> bool {
        true
    }
    /// Its force is the pass's own, so that no step is taken across a turn with the wrong sign.
    fn rubs(&self) -> bool {
        true
    }
}
