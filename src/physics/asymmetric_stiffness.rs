//! A spring that is stiffer on one side of its place of rest than on the other: k x_r (|x|/x_r)ⁿ, with n fitted.
//!
//! With n = 1 the force has a corner at rest, as where two faces touch on one side, a crack opens and closes, or a
//! beam lies on a support: the two sides have the stiffness ω₀² ± k, whatever the amplitude. With n = 2 it is
//! the smooth spring of [`QuadraticStiffness`](super::quadratic_stiffness::QuadraticStiffness).
//!
//! The strength is stated at a displacement x_r, which is chosen and not fitted, as that of
//! [`PowerLawStiffness`](super::power_law_stiffness::PowerLawStiffness) is.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::power::{LEAST, bounded_power};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Restoring force k x_r (|x|/x_r)ⁿ per unit mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AsymmetricStiffness;

/// Exponents that a fit may take: below the first the stiffness has no bound at rest.
const EXPONENTS: [f64; 2] = [0.8, 8.0];

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "asymmetric-stiffness",
    kind: Kind::Driven,
    statement: "The spring is stiffer on one side of its place of rest than on the other, by a power of the displacement \
                that is not the second: the first where something touches on one side only.",
    equation: "x″ + 2ζω₀x′ + ω₀²x + k x_r(|x|/x_r)ⁿ = g·u",
    parameters: &[
        Parameter { name: "k", unit: "1/s^2", range: (-1.0, 1.0) },
        Parameter { name: "x_r", unit: "y", range: (0.0, 10.0) },
        Parameter { name: "n", unit: "1", range: (EXPONENTS[0], EXPONENTS[1]) },
    ],
    acts: "equation of motion",
    signature: "the mean displacement follows a power of the amplitude, and even harmonics grow with it",
    confusable_with: &["quadratic-stiffness", "end-stop", "readout-nonlinearity"],
    reference: "Shaw & Holmes, A periodically forced piecewise linear oscillator, J. Sound Vib. 90 (1983)",
};

/// Declares its keys in a study: its stiffer side changes with the axis.
pub(crate) const GIVEN: &[Given] = &[
    Given::turning(Key::new(
        105,
        "sensor.asymmetric_stiffness_per_s2",
        "stiffness k of the asymmetric spring",
        "1/s²",
        1.0,
        Sign::Any,
    )),
    Given::new(Key::new(
        106,
        "sensor.asymmetric_stiffness_at_m",
        "displacement x_r at which it is that",
        "m",
        1.0,
        Sign::Positive,
    )),
    Given::new(Key::new(
        107,
        "sensor.asymmetric_stiffness_exponent",
        "exponent n of that spring",
        "1",
        1.0,
        Sign::Positive,
    )),
];

impl Law for AsymmetricStiffness {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let exponent = Coordinate::Log(EXPONENTS[0], EXPONENTS[1]);
        vec![Coordinate::Linear(0.1 * s.omega_rad_s.powi(2)), Coordinate::Held, exponent]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        [1.2, 3.0].map(|n| vec![0.0, 2.0 * s.output, n]).to_vec()
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn asymmetric_stiffness(at: Instant, p0: f32, p1: f32, p2: f32, sum: f32) -> f32 {
    return fma(-(p0 * p1), pow(max(abs(at.x) / p1, 1e-6), p2), sum);
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
        let s = (at.x.abs() / p[1]).max(T::of(LEAST));
        fma::<T, FMA>(-(p[0] * p[1]), bounded_power(s, p[2]), sum)
    }
    /// None: a diagnosis tries it where the square does not fit.
    fn tried(_: usize) -> Vec<Self> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::quadratic_stiffness::QuadraticStiffness;
    use super::super::test_problem::Mass;
    use super::*;

    // k x_r (x/x_r)² = (k/x_r) x².
    #[test]
    fn the_second_power_is_the_quadratic_spring() {
        let mass = Mass { omega: 2.0, zeta: 0.05, gain: 1.0 };
        let push = |t: f64| (1.7 * t).sin();
        let quadratic = mass.moved(&QuadraticStiffness, &[0.8], [0.5, 0.1], 6.0, 4000, push);
        let power = |n: f64| mass.moved(&AsymmetricStiffness, &[0.8 * 0.7, 0.7, n], [0.5, 0.1], 6.0, 4000, push);
        for (a, b) in power(2.0).iter().zip(quadratic) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        assert!((power(1.9)[0] - quadratic[0]).abs() > 1e-4, "another power is another spring");
    }

    // With the first power half a cycle takes π/√(ω₀² + k) on one side and π/√(ω₀² − k) on the other, from any
    // amplitude (Shaw & Holmes 1983): thrown from rest with speed v, the mass comes back with −v.
    #[test]
    fn with_the_first_power_each_side_is_a_spring_of_its_own() {
        let mass = Mass { omega: 2.0, zeta: 0.0, gain: 1.0 };
        for (speed, k) in [(0.6, 1.5), (0.01, 1.5), (-0.6, 1.5), (0.6, -1.5)] {
            let own = 4.0 + k * f64::signum(speed);
            let back = mass.moved(&AsymmetricStiffness, &[k, 0.7, 1.0], [0.0, speed], PI / own.sqrt(), 20_000, |_| 0.0);
            assert!(
                back[0].abs() < 1e-6 * speed.abs() && (back[1] / speed + 1.0).abs() < 1e-6,
                "{k} {speed}: {back:?}"
            );
        }
    }
}
