//! Readings that come late: a pure delay, or a first-order low-pass.

use crate::diagnosis::candidate::{Candidate, Kind, Parameter};

use super::law::{Constants, Instant, LANES, Lanes, Physics, Stride};
use super::scales::{Coordinate, Scales};

/// y(t) = x(t − τ). A delay commutes with everything that does not depend on time, so it is applied to the input that moves
/// the mass; what reaches the reading past the mass is not late.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay;

/// What the library says of it.
pub const DELAY: Candidate = Candidate {
    id: "readout-delay",
    kind: Kind::Driven,
    statement: "The reading lags the input by a fixed time.",
    equation: "y(t) = x(t − τ)",
    parameters: &[Parameter { name: "tau", unit: "s", range: (-1.0, 1.0) }],
    acts: "readout",
    signature: "phase that falls in proportion to frequency",
    confusable_with: &["readout-lowpass", "feedthrough", "parasitic-mode"],
    reference: "Ljung, System Identification, 1999, ch. 4 (time delay)",
};

impl Physics for Delay {
    fn words(&self) -> &'static Candidate {
        &DELAY
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.interval_s)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let mut starts = vec![vec![0.0]];
        if s.lag_samples != 0.0 {
            starts.push(vec![s.lag_samples * s.interval_s]);
        }
        starts
    }
    fn delays(&self) -> bool {
        true
    }
    fn needs_input(&self) -> bool {
        true
    }
}

/// τy′ + y = x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lowpass;

/// What the library says of it.
pub const LOWPASS: Candidate = Candidate {
    id: "readout-lowpass",
    kind: Kind::Driven,
    statement: "The readout smooths: a first-order low-pass stands behind the proof mass.",
    equation: "τy′ + y = x",
    parameters: &[Parameter { name: "tau", unit: "s", range: (0.0, 10.0) }],
    acts: "readout",
    signature: "phase and amplitude fall beyond a corner frequency",
    confusable_with: &["readout-delay", "parasitic-mode", "feedthrough"],
    reference: "IEEE 1293, frequency response",
};

impl Physics for Lowpass {
    fn words(&self) -> &'static Candidate {
        &LOWPASS
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Log(1e-4 / s.omega_rad_s, 100.0 / s.omega_rad_s)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        [0.005, 0.04, 0.2, 1.0].map(|t| vec![t / s.omega_rad_s]).to_vec()
    }
    fn states(&self) -> usize {
        1
    }
    fn begin(&self, x: &Lanes, v: &Lanes, p: &[Lanes], own: &mut [Lanes]) {
        for l in 0..LANES {
            own[0][l] = x[l] - p[0][l] * v[l];
        }
    }
    /// Time constant in steps, and what a step leaves of a difference.
    fn constants(&self, p: &[Lanes], step_s: f64) -> Constants {
        let mut constants = [[0.0; LANES]; 6];
        for l in 0..LANES {
            constants[0][l] = p[0][l] / step_s;
            constants[1][l] = (-step_s / p[0][l]).exp();
        }
        constants
    }
    /// The displacement over a step is Hermite's cubic through both ends; a cubic's answer is known in closed form.
    #[inline(always)]
    fn follow(&self, s: &Stride, constants: &Constants, _: &[Lanes], own: &mut [Lanes]) {
        let [ratios, decays, ..] = constants;
        let own = &mut own[0];
        for l in 0..LANES {
            let ratio = ratios[l];
            let (rise, a, b) = (s.x1[l] - s.x0[l], s.step_s * s.v0[l], s.step_s * s.v1[l]);
            let c3 = a + b - 2.0 * rise;
            let c2 = 3.0 * rise - 2.0 * a - b - 3.0 * ratio * c3;
            let c1 = a - 2.0 * ratio * c2;
            let c0 = s.x0[l] - ratio * c1;
            own[l] = c0 + c1 + c2 + c3 + (own[l] - c0) * decays[l];
        }
    }
    fn follows(&self) -> bool {
        true
    }
    #[inline(always)]
    fn reading(&self, _: &Instant<'_>, _: &[Lanes], own: &[Lanes], y: &mut Lanes) {
        *y = own[0];
    }
    fn reads(&self) -> Option<u8> {
        Some(1)
    }
    fn lags(&self) -> bool {
        true
    }
}
