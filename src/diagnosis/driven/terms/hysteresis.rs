//! A spring with memory: Bouc–Wen hysteresis.

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

use super::law::{Cloud, Instant, LANES, Lanes, Physics};
use super::scales::{Coordinate, Scales};

/// A parallel spring that yields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoucWen;

/// What the library says of it.
pub const BOUC_WEN: Candidate = Candidate {
    id: "hysteresis",
    kind: Kind::Driven,
    statement: "Part of the restoring force remembers the path: it yields and slips back (Bouc–Wen).",
    equation: "x″ + 2ζω₀x′ + ω₀²x + k_h z = g·u, z′ = x′ − (s|x′|z + (1 − s)x′|z|)/z_y",
    parameters: &[
        Parameter { name: "k_h", unit: "1/s^2", range: (0.0, 1.0) },
        Parameter { name: "z_y", unit: "y", range: (0.0, 10.0) },
        Parameter { name: "s", unit: "1", range: (0.0, 1.0) },
    ],
    acts: "equation of motion",
    signature: "loops in force against displacement whose area does not depend on speed",
    confusable_with: &["coulomb-friction", "cubic-stiffness", "quadratic-damping", "squeeze-film-damping"],
    reference: "Wen, J. Eng. Mech. ASCE 102 (1976); Ismail, Ikhouane & Rodellar, Arch. Comput. Methods Eng. 16 (2009)",
};

impl Physics for BoucWen {
    fn words(&self) -> &'static Candidate {
        &BOUC_WEN
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![
            // A negative one would feed the motion instead of damping it.
            Coordinate::Bounded(0.1 * s.omega_rad_s.powi(2), 0.0, 1e3 * s.omega_rad_s.powi(2)),
            Coordinate::Log(0.01 * s.output, 4.0 * s.output),
            Coordinate::Bounded(0.3, 0.0, 1.0),
            Coordinate::Linear(0.1 * s.output),
        ]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        [0.05, 0.2, 0.7, 2.0].map(|y| vec![1e-4 * s.omega_rad_s.powi(2), y * s.output, 0.5, 0.0]).to_vec()
    }
    fn states(&self) -> usize {
        1
    }
    fn has_corner(&self) -> bool {
        true
    }
    fn unknown_beginnings(&self) -> usize {
        1
    }
    fn begin(&self, _: &Lanes, _: &Lanes, p: &[Lanes], own: &mut [Lanes]) {
        own[0] = p[3];
    }
    fn fastest_rad_s(&self, p: &[f64], s: &Scales) -> f64 {
        (s.velocity / p[1]).min(4.0 * s.omega_rad_s)
    }
    #[inline(always)]
    fn force(&self, at: &Instant<'_>, p: &[Lanes], own: &[Lanes], rates: &mut [Lanes], acceleration: &mut Lanes) {
        // Slices are opened before the loop: a bounds check inside keeps it from becoming vector code.
        let (stiffness, yields, share, own, rate) = (&p[0], &p[1], &p[2], &own[0], &mut rates[0]);
        for l in 0..LANES {
            let (z, v) = (own[l], at.v[l]);
            acceleration[l] -= stiffness[l] * z;
            rate[l] = v - (share[l] * v.abs() * z + (1.0 - share[l]) * v * z.abs()) / yields[l];
        }
    }
    fn moves(&self) -> bool {
        true
    }
    fn cloud(&self, s: &Scales) -> Option<Cloud> {
        let shapes = (0..24).map(|i| vec![0.02 * s.output * 200f64.powf(f64::from(i) / 23.0), 0.5, 0.0]).collect();
        Some(Cloud::Shapes { strength: 0.01 * s.omega_rad_s.powi(2), shapes })
    }
}
