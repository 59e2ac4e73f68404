//! A spring that stiffens or softens with the square of the displacement: βx³.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Restoring force βx³ per unit mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CubicStiffness;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
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

/// `sum` and the acceleration −βx³. Every simulation with a cubic spring takes it from here.
#[inline(always)]
pub fn acceleration<T: Real, const FMA: bool>(beta: T, x: T, sum: T) -> T {
    fma::<T, FMA>(-(beta * x * x), x, sum)
}

/// Returns the force per mass with which a spring of linear stiffness and β pulls back: x(k + βx²).
/// Orbits that are followed for long take this form, which rounds once less.
#[inline(always)]
pub fn pull<T: Real>(stiffness: T, beta: T, x: T) -> T {
    x * (stiffness + beta * (x * x))
}

/// By how much the spring is stiffer at `x`: 3βx², the derivative of βx³.
#[inline(always)]
pub fn tangent_stiffness<T: Real>(beta: T, x: T) -> T {
    T::of(3.0) * (beta * (x * x))
}

/// The same three for shaders.
pub const WGSL: &str = "fn cubic_acceleration(beta: f32, x: f32, sum: f32) -> f32 {
    return fma(-(beta * x * x), x, sum);
}
fn cubic_pull(stiffness: f32, beta: f32, x: f32) -> f32 {
    return x * (stiffness + beta * (x * x));
}
fn cubic_tangent_stiffness(beta: f32, x: f32) -> f32 {
    return 3.0 * (beta * (x * x));
}
";

/// Declares its keys in a study.
pub const GIVEN: &[Given] =
    &[Given::new(Key::new(2, "sensor.cubic_stiffness_per_m2_s2", "cubic stiffness β", "1/(m² s²)", 1.0, Sign::Any))];

impl Law for CubicStiffness {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.omega_rad_s.powi(2) / s.output.powi(2))]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn cubic_stiffness(at: Instant, p0: f32, sum: f32) -> f32 {
    return cubic_acceleration(p0, at.x, sum);
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
        acceleration::<T, FMA>(p[0], at.x, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // Released at A, the mass is back after T = 4K(m)/√(ω₀² + βA²) with m = βA²/2/(ω₀² + βA²)
    // (Nayfeh & Mook, § 2.1); K by the arithmetic-geometric mean of 1 and √(1 − m).
    #[test]
    fn the_period_grows_shorter_as_the_elliptic_integral_says() {
        let (omega, beta, a) = (2.0f64, 30.0, 0.4);
        let stiff = omega * omega + beta * a * a;
        let (mut mean, mut root) = (1.0f64, (1.0 - 0.5 * beta * a * a / stiff).sqrt());
        for _ in 0..6 {
            (mean, root) = (0.5 * (mean + root), (mean * root).sqrt());
        }
        let period = 2.0 * std::f64::consts::PI / (mean * stiff.sqrt());
        let mass = Mass { omega, ..Mass::default() };
        let end = |p: f64| mass.moved(&CubicStiffness, &[p], [a, 0.0], period, 2000, |_| 0.0);
        assert!((end(beta)[0] - a).abs() < 1e-9 && end(beta)[1].abs() < 1e-8, "{:?}", end(beta));
        assert!((end(1.01 * beta)[0] - a).abs() > 1e-5, "another spring has another period");
    }
}
