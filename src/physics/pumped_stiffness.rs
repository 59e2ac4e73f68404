//! A spring whose stiffness goes up and down with time: a form of a stiffness drift that is fitted and never named.
//!
//! It puts a line on either side of the motion's own, so that in a free decay it looks like further modes: those are named
//! where it does not do as well. No study runs it.

use std::f64::consts::TAU;
use std::ops::Range;

use crate::numerics::elementary::{Real, fma, sin_cos};

use super::candidate::{Candidate, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::side_by_side::each;
use super::state::{Instant, Instants, MOST_STAGED, MOST_VALUES, Staged, Values};
use super::stiffness_drift;

/// ω₀²(1 + ε_c cos Ωt + ε_s sin Ωt).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PumpedStiffness;

/// States the candidate where it is periodic.
pub(super) const CANDIDATE: Candidate = Candidate {
    statement: "The spring is pumped: its stiffness goes up and down with time.",
    equation: "x″ + 2ζω₀x′ + ω₀²(1 + ε_c cos Ωt + ε_s sin Ωt)x = g·u",
    parameters: &[
        Parameter { name: "Omega", unit: "rad/s", range: (0.01, 10.0) },
        Parameter { name: "epsilon_c", unit: "1", range: (-0.5, 0.5) },
        Parameter { name: "epsilon_s", unit: "1", range: (-0.5, 0.5) },
    ],
    reference: "Nayfeh & Mook, Nonlinear Oscillations, 1979, ch. 5",
    ..stiffness_drift::CANDIDATE
};

impl PumpedStiffness {
    /// Places of its sizes among its parameters.
    pub const SIZES: Range<usize> = 1..3;

    /// Adds its force to the accelerations of N masses.
    #[inline(always)]
    pub(super) fn forces<T: Real, const N: usize, const FMA: bool>(
        &self,
        at: &Instants<'_, T, N>,
        p: &Values<T, N>,
        own: &Staged<T, N>,
        rates: &mut Staged<T, N>,
        acceleration: &mut [T; N],
    ) {
        each::<_, T, N, FMA>(self, at, p, own, rates, acceleration);
    }
}

impl Law for PumpedStiffness {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let turn = TAU / s.duration_s;
        let omega = Coordinate::Bounded(0.1 * turn, turn, (TAU * s.highest_hz).max(2.0 * turn));
        vec![omega, Coordinate::Bounded(0.1, -0.5, 0.5), Coordinate::Bounded(0.1, -0.5, 0.5)]
    }
    /// A line stands at |Ω ± ω₀|.
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let pumps = |f: &f64| [(TAU * f - s.omega_rad_s).abs(), TAU * f + s.omega_rad_s];
        let all = s.lines_hz.iter().flat_map(pumps).filter(|omega| omega * s.duration_s > TAU);
        all.map(|omega| vec![omega, 0.0, 0.0]).collect()
    }
    fn fastest_rad_s(&self, p: &[f64], _: &Scales) -> f64 {
        p[0]
    }
    #[inline(always)]
    fn force<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        _: &[T; MOST_STAGED],
        sum: T,
    ) -> T {
        let (sin, cos) = sin_cos::<T, FMA>(p[0] * at.time);
        fma::<T, FMA>(-(at.stiffness * (p[1] * cos + p[2] * sin)), at.x, sum)
    }
    /// None: a diagnosis looks for it where no input is recorded.
    fn tried(_: usize) -> Vec<Self> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // To first order in ε the side lines of cos ω₀t at ω₀ ± Ω have the sizes −ε/2 · ω₀²/(ω₀² − (ω₀ ± Ω)²), and the
    // motion that begins at 1 at rest adds what makes them vanish there (Nayfeh & Mook, § 5.2).
    #[test]
    fn its_side_lines_are_those_of_the_perturbation_series() {
        let (omega, pump, epsilon) = (2.0f64, 0.7f64, 1e-3);
        let side = |w: f64| -0.5 * epsilon * omega * omega / (omega * omega - w * w);
        let (low, high) = (side(omega - pump), side(omega + pump));
        for t in [3.0f64, 11.0] {
            let mass = Mass { omega, ..Mass::default() };
            let [x, _] = mass.moved(&PumpedStiffness, &[pump, epsilon, 0.0], [1.0, 0.0], t, 20_000, |_| 0.0);
            let free = 1.0 - low - high;
            let series =
                free * (omega * t).cos() + low * ((omega - pump) * t).cos() + high * ((omega + pump) * t).cos();
            // The next term is of order ε²ω₀t.
            assert!((x - series).abs() < 3e-5, "{t}: {x} {series}");
            assert!((x - (omega * t).cos()).abs() > 2e-4, "the pump moves it: {t}");
        }
    }
}
