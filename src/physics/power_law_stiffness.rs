//! A spring of one power of the displacement: k (|x|/x_r)ⁿ⁻¹ x, with n fitted.
//!
//! The strength of a power has a unit that depends on it, and no two powers have strengths that
//! can be compared. It is therefore stated as a stiffness at a displacement x_r, which is chosen
//! (about the largest that the recording reaches) and not fitted: k is the slope of the line from
//! the origin to the force there, and k x_r^(1−n) is the coefficient of |x|ⁿ⁻¹x.
//!
//! The search does not try it next to the cube (`cubic_stiffness`, [`Law::tried`]); a diagnosis tries
//! it instead of a cube where the cube does not fit.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::power::{Exponent, LEAST, bounded_power};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Restoring force k (|x|/x_r)ⁿ⁻¹ x per unit mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PowerLawStiffness(pub Exponent);

/// Exponents that a fit may take: nearer to one it is the linear spring of the base model.
const EXPONENTS: [f64; 2] = [1.1, 8.0];

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "power-law-stiffness",
    kind: Kind::Driven,
    statement: "The force of the spring follows a power of the displacement that is neither the first nor the third.",
    equation: "x″ + 2ζω₀x′ + ω₀²x + k(|x|/x_r)ⁿ⁻¹x = g·u",
    parameters: &[
        Parameter { name: "k", unit: "1/s^2", range: (-1.0, 1.0) },
        Parameter { name: "x_r", unit: "y", range: (0.0, 10.0) },
        Parameter { name: "n", unit: "1", range: (EXPONENTS[0], EXPONENTS[1]) },
    ],
    acts: "equation of motion",
    signature: "the resonance moves with a power of the amplitude; odd harmonics of the displacement",
    confusable_with: &["cubic-stiffness", "end-stop", "readout-nonlinearity", "hysteresis"],
    reference: "Nayfeh & Mook, Nonlinear Oscillations, 1979, ch. 2; Kovacic & Brennan, The Duffing Equation, 2011, ch. 2",
};

/// Declares its keys in a study.
pub(crate) const GIVEN: &[Given] = &[
    Given::new(Key::new(
        98,
        "sensor.power_law_stiffness_per_s2",
        "stiffness of the power-law spring k",
        "1/s²",
        1.0,
        Sign::Any,
    )),
    Given::new(Key::new(
        99,
        "sensor.power_law_stiffness_at_m",
        "displacement x_r at which it is that",
        "m",
        1.0,
        Sign::Positive,
    )),
    Given::new(Key::new(
        100,
        "sensor.power_law_stiffness_exponent",
        "exponent n of that power",
        "1",
        1.0,
        Sign::Positive,
    )),
];

impl Law for PowerLawStiffness {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let exponent = match self.0 {
            Exponent::Free => Coordinate::Log(EXPONENTS[0], EXPONENTS[1]),
            Exponent::Held => Coordinate::Held,
        };
        vec![Coordinate::Linear(0.1 * s.omega_rad_s.powi(2)), Coordinate::Held, exponent]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        [2.0, 5.0].map(|n| vec![0.01 * s.omega_rad_s.powi(2), 2.0 * s.output, n]).to_vec()
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn power_law_stiffness(at: Instant, p0: f32, p1: f32, p2: f32, sum: f32) -> f32 {
    return fma(-(p0 * pow(max(abs(at.x) / p1, 1e-6), p2 - 1.0)), at.x, sum);
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
        fma::<T, FMA>(-(p[0] * bounded_power(s, p[2] - T::of(1.0))), at.x, sum)
    }
    /// None: see the module.
    fn tried(_: usize) -> Vec<Self> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::super::cubic_stiffness::CubicStiffness;
    use super::super::test_problem::Mass;
    use super::*;

    const FREE: PowerLawStiffness = PowerLawStiffness(Exponent::Free);

    // k (x/x_r)² x = (k/x_r²) x³.
    #[test]
    fn the_third_power_is_the_cubic_spring() {
        let mass = Mass { omega: 2.0, zeta: 0.05, gain: 1.0 };
        let push = |t: f64| (1.7 * t).sin();
        let cubic = mass.moved(&CubicStiffness, &[0.8], [0.5, 0.1], 6.0, 4000, push);
        let power = |n: f64| mass.moved(&FREE, &[0.8 * 0.49, 0.7, n], [0.5, 0.1], 6.0, 4000, push);
        for (a, b) in power(3.0).iter().zip(cubic) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        assert!((power(2.9)[0] - cubic[0]).abs() > 1e-4, "another power is another spring");
    }

    // Without a linear spring v²/2 + c|x|^(n+1)/(n+1) is constant: let go at A, the mass passes the
    // centre at √(2c A^(n+1)/(n+1)), after A^((1−n)/2) √((n+1)/2c) ∫₀¹ ds/√(1 − s^(n+1)).
    #[test]
    fn energy_is_that_of_the_power() {
        for n in [1.7, 5.0] {
            let (k, reference, a): (f64, f64, f64) = (3.0, 0.7, 0.5);
            let c = k * reference.powf(1.0 - n);
            for time_s in [0.3, 0.9, 1.4] {
                let [x, v] = Mass::default().moved(&FREE, &[k, reference, n], [a, 0.0], time_s, 8000, |_| 0.0);
                let energy = 0.5 * v * v + c * x.abs().powf(n + 1.0) / (n + 1.0);
                let before = c * a.powf(n + 1.0) / (n + 1.0);
                assert!((energy / before - 1.0).abs() < 1e-7 && v.abs() > 0.01, "{n} {time_s}: {energy} {before}");
            }
        }
    }
}
