//! Damping that grows with speed: c₂|x′|x′.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Damping force c₂|x′|x′ per unit mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct QuadraticDamping;

/// States the candidate for the library.
pub const CANDIDATE: Candidate = Candidate {
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

/// Declares its keys in a study.
pub const GIVEN: &[Given] =
    &[Given::new(Key::new(4, "sensor.quadratic_damping_per_m", "quadratic damping c₂", "1/m", 1.0, Sign::NotNegative))];

impl Law for QuadraticDamping {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        // Below zero it would feed the motion: no gas does.
        vec![Coordinate::Bounded(s.zeta * s.omega_rad_s / s.velocity, 0.0, f64::MAX)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn quadratic_damping(at: Instant, p0: f32, sum: f32) -> f32 {
    return fma(-(p0 * abs(at.v)), at.v, sum);
}"
    }
    #[inline(always)]
    fn force<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        _: &[T; MOST_STAGED],
        sum: T,
    ) -> T {
        fma::<T, FMA>(-(p[0] * at.v.abs()), at.v, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // Without a spring v′ = −c₂|v|v is solved by v = v₀/(1 + c₂|v₀|t).
    #[test]
    fn a_free_mass_slows_down_hyperbolically() {
        for v0 in [3.0, -3.0] {
            let [_, v] = Mass::default().moved(&QuadraticDamping, &[0.7], [0.0, v0], 2.0, 2000, |_| 0.0);
            assert!((v - v0 / (1.0 + 0.7 * 3.0 * 2.0)).abs() < 1e-10, "{v}");
        }
    }
}
