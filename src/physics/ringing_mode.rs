//! A further mode of a structure that rings freely: what a diagnosis names as a parasitic mode where
//! no input is recorded.
//!
//! Once released, each linear mode decays independently of the others: a decaying cosine and sine, with time
//! counted from the first sample. Its gain to an input stays unknown, so that no study runs it. A structure
//! may ring in several ([`RingingMode::ALL`]).

use std::f64::consts::TAU;
use std::ops::Range;

use crate::numerics::elementary::Real;

use super::candidate::{Candidate, Parameter};
use super::law::{Law, Place, Role};
use super::parasitic_mode;
use super::scales::{Coordinate, Scales};
use super::state::{Instant, Instants, MOST_STAGED, MOST_VALUES, Staged, Values};

/// A further mode of a free motion, by its place among them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RingingMode(pub usize);

/// Damping ratios that a fit may take.
const ZETAS: [f64; 2] = [1e-6, 0.3];
/// Damping ratios at which a fit begins.
const BEGINS: [f64; 2] = [0.002, 0.02];

/// States the candidate without an input.
pub(super) const CANDIDATE: Candidate = Candidate {
    statement: "A second resonance rings with the first and is read together with it.",
    equation: "y = x + exp(−ζ₂ω₂t)(a cos ω_d t + b sin ω_d t), ω_d = ω₂√(1 − ζ₂²)",
    parameters: &[
        Parameter { name: "omega2", unit: "rad/s", range: (0.1, 10.0) },
        Parameter { name: "zeta2", unit: "1", range: (ZETAS[0], ZETAS[1]) },
        Parameter { name: "a", unit: "y", range: (-1.0, 1.0) },
        Parameter { name: "b", unit: "y", range: (-1.0, 1.0) },
    ],
    signature: "a second line in the spectrum of the decay, which decays at its own rate",
    confusable_with: &["periodic-disturbance"],
    ..parasitic_mode::CANDIDATE
};

impl RingingMode {
    /// All that a diagnosis looks for.
    pub const ALL: [Self; 3] = [Self(0), Self(1), Self(2)];

    /// One that may as well belong to the first motion: a free form, which is not named.
    pub const ANY: Self = Self(usize::MAX);

    /// Places of its sizes a and b among its parameters.
    pub const SIZES: Range<usize> = 2..4;

    /// It moves no mass.
    #[inline(always)]
    pub(super) fn forces<T: Real, const N: usize, const FMA: bool>(
        &self,
        _: &Instants<'_, T, N>,
        _: &Values<T, N>,
        _: &Staged<T, N>,
        _: &mut Staged<T, N>,
        _: &mut [T; N],
    ) {
    }
}

impl Law for RingingMode {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Readout(Place::Bias)
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let size = Coordinate::Linear(0.1 * s.output);
        let turn = TAU / s.duration_s;
        let omega = Coordinate::Bounded(0.1 * turn, turn, (TAU * s.highest_hz).max(2.0 * turn));
        vec![omega, Coordinate::Log(ZETAS[0], ZETAS[1]), size, size]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        s.lines_hz.iter().flat_map(|f| BEGINS.map(|zeta| vec![TAU * f, zeta, 0.0, 0.0])).collect()
    }
    #[inline(always)]
    fn reading(&self, at: &Instant<'_, f64>, p: &[f64; MOST_VALUES], _: &[f64; MOST_STAGED], y: f64) -> f64 {
        let [omega, zeta, a, b, ..] = *p;
        let (sin, cos) = (omega * (1.0 - zeta * zeta).sqrt() * at.time).sin_cos();
        y + (-zeta * omega * at.time).exp() * (a * cos + b * sin)
    }
    /// None: a diagnosis looks for it where no input is recorded.
    fn tried(_: usize) -> Vec<Self> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Free motion of an oscillator (`transition`), which is a = x, b = (v + ζωx)/ω_d at the start.
    #[test]
    fn it_rings_as_a_free_oscillator_does() {
        let (omega, zeta, x, v) = (3.0f64, 0.05f64, 0.4, -1.1);
        let b = (v + zeta * omega * x) / (omega * (1.0 - zeta * zeta).sqrt());
        for time in [0.0, 0.3, 2.0, 9.0] {
            let at = Instant { time, ..Instant::default() };
            let read =
                |zeta: f64| RingingMode(0).reading(&at, &[omega, zeta, x, b, 0.0, 0.0], &[0.0; MOST_STAGED], 1.0);
            let [xx, xv, ..] = super::super::free_oscillator::transition(omega, zeta, time);
            assert!((read(zeta) - 1.0 - xx * x - xv * v).abs() < 1e-12, "{time}");
            assert!(time == 0.0 || (read(1.5 * zeta) - read(zeta)).abs() > 1e-4, "another damping is another: {time}");
        }
    }
}
