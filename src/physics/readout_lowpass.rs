//! A reading that is smoothed by a first-order low-pass behind the mass: τy′ + y = x.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Constants, Instant, LANES, Lanes, MOST_STAGED, MOST_VALUES, Stride};

/// τy′ + y = x.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ReadoutLowpass;

/// What the library says of it.
pub(crate) const CANDIDATE: Candidate = Candidate {
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

impl Law for ReadoutLowpass {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::LowPass
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
    /// The displacement over a step is Hermite's cubic through both ends; a cubic's answer is known
    /// in closed form.
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
    #[inline(always)]
    fn reading(&self, _: &Instant<'_, f64>, _: &[f64; MOST_VALUES], own: &[f64; MOST_STAGED], _: f64) -> f64 {
        own[0]
    }
}
