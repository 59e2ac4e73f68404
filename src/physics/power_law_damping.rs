//! Damping by one power of the velocity, c (|v|/v_r)ⁿ⁻¹ v, with n fitted: between the drag of a
//! slow stream (n = 1) and of a fast one (n = 2), beyond it, or below it, towards dry friction.
//!
//! The strength is stated as the damping at a velocity v_r, which is chosen and not fitted (see
//! `power_law_stiffness`): c v_r^(1−n) is the coefficient of |v|ⁿ⁻¹v. It is not searched for
//! ([`Law::tried`]): a diagnosis looks for it in the place of a drag, or of a friction, that departs
//! from its form.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::power::{Exponent, LEAST, bounded_power};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Damping force c (|v|/v_r)ⁿ⁻¹ v per unit mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PowerLawDamping(pub Exponent);

/// Exponents that a fit may take: below lies dry friction.
const EXPONENTS: [f64; 2] = [0.2, 6.0];

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "power-law-damping",
    kind: Kind::Driven,
    statement: "The damping force follows a power of the speed that is neither the first nor the second.",
    equation: "x″ + 2ζω₀x′ + c(|x′|/v_r)ⁿ⁻¹x′ + ω₀²x = g·u",
    parameters: &[
        Parameter { name: "c", unit: "1/s", range: (0.0, 1.0) },
        Parameter { name: "v_r", unit: "y/s", range: (0.0, 10.0) },
        Parameter { name: "n", unit: "1", range: (EXPONENTS[0], EXPONENTS[1]) },
    ],
    acts: "equation of motion",
    signature: "the height of the resonance's peak goes with a power of the amplitude",
    confusable_with: &["quadratic-damping", "coulomb-friction", "squeeze-film-damping", "hysteresis"],
    reference: "Elliott, Ghandchi Tehrani & Langley, Phil. Trans. R. Soc. A 373 (2015)",
};

/// Declares its keys in a study.
pub(crate) const GIVEN: &[Given] = &[
    Given::new(Key::new(
        101,
        "sensor.power_law_damping_per_s",
        "damping by a power of the velocity c",
        "1/s",
        1.0,
        Sign::NotNegative,
    )),
    Given::new(Key::new(
        102,
        "sensor.power_law_damping_at_m_s",
        "velocity v_r at which it is that",
        "m/s",
        1.0,
        Sign::Positive,
    )),
    Given::new(Key::new(
        103,
        "sensor.power_law_damping_exponent",
        "exponent n of that power",
        "1",
        1.0,
        Sign::Positive,
    )),
];

impl Law for PowerLawDamping {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let size = s.zeta * s.omega_rad_s;
        match self.0 {
            // Below zero it would feed the motion.
            Exponent::Free => vec![
                Coordinate::Bounded(size, 0.0, f64::MAX),
                Coordinate::Held,
                Coordinate::Log(EXPONENTS[0], EXPONENTS[1]),
            ],
            Exponent::Held => vec![Coordinate::Linear(size), Coordinate::Held, Coordinate::Held],
        }
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        [0.5, 1.5, 3.0].map(|n| vec![0.1 * s.zeta * s.omega_rad_s, 2.0 * s.velocity, n]).to_vec()
    }
    /// Below the first power the force has a cusp at standstill: it takes steps as short as those of dry
    /// friction.
    fn fastest_rad_s(&self, p: &[f64], s: &Scales) -> f64 {
        if p[2] < 1.0 { 7.0 * s.omega_rad_s } else { 0.0 }
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn power_law_damping(at: Instant, p0: f32, p1: f32, p2: f32, sum: f32) -> f32 {
    return fma(-(p0 * pow(max(abs(at.v) / p1, 1e-6), p2 - 1.0)), at.v, sum);
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
        let s = (at.v.abs() / p[1]).max(T::of(LEAST));
        fma::<T, FMA>(-(p[0] * bounded_power(s, p[2] - T::of(1.0))), at.v, sum)
    }
    /// None: see the module.
    fn tried(_: usize) -> Vec<Self> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::super::quadratic_damping::QuadraticDamping;
    use super::super::test_problem::Mass;
    use super::*;

    const FREE: PowerLawDamping = PowerLawDamping(Exponent::Free);

    #[test]
    fn the_second_power_is_the_quadratic_damping() {
        let mass = Mass { omega: 2.0, zeta: 0.05, gain: 1.0 };
        let push = |t: f64| (1.7 * t).sin();
        let square = mass.moved(&QuadraticDamping, &[0.8], [0.5, 0.1], 6.0, 4000, push);
        let power = |n: f64| mass.moved(&FREE, &[0.8 * 0.7, 0.7, n], [0.5, 0.1], 6.0, 4000, push);
        for (a, b) in power(2.0).iter().zip(square) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        assert!((power(1.9)[0] - square[0]).abs() > 1e-4, "another power is another damping");
    }

    // Without a spring v′ = −c|v|ⁿ⁻¹v is solved by |v|^(1−n) = |v₀|^(1−n) + (n − 1)ct.
    #[test]
    fn a_free_mass_slows_down_as_the_power_says() {
        for (n, v0) in [(1.5, 3.0), (2.5, -3.0), (0.5, 3.0)] {
            let (c, reference, time_s): (f64, f64, f64) = (0.7, 2.0, 1.5);
            let [_, v] = Mass::default().moved(&FREE, &[c, reference, n], [0.0, v0], time_s, 4000, |_| 0.0);
            let rate = c * reference.powf(1.0 - n);
            let exact = (v0.abs().powf(1.0 - n) + (n - 1.0) * rate * time_s).powf(1.0 / (1.0 - n));
            assert!((v.abs() - exact).abs() < 1e-8 && v * v0 > 0.0, "{n}: {v} {exact}");
        }
    }
}
