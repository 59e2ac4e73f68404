//! A spring with memory: a parallel spring that yields and slips back (Bouc–Wen).
//!
//! β and γ come without the usual bound of γ by β: z grows from zero as (1 − e^(−(β + γ)x))/(β +
//! γ), which stiffens where β + γ is below zero. Where β is zero, z follows from x alone and no
//! loop opens; a positive β makes the way up run above the way down, so that k_h β > 0 is what
//! takes energy from the motion: neither may be negative, and γ may have either sign. The scale of
//! z is fixed by z′ = x′ at z = 0 (A = 1): another A only rescales k_h.
//!
//! Bouc's law has n = 1; Wen's has an exponent, by which the yield is sharper or smoother
//! ([`Sharpness::Own`]). Both bends then come over the scale of z, 1/β, so that their units stay
//! what they are: in Wen's own letters β_W = βⁿ and γ_W = γβⁿ⁻¹. This form is not searched for
//! ([`Law::tried`]): a diagnosis looks for it in the place of one with n = 1 that leaves something.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role, StartGrid};
use super::power::{LEAST, bounded_power};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Sharpness with which the spring with memory yields.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Sharpness {
    /// Yields as an exponential: n = 1.
    #[default]
    One,
    /// By an exponent n that is fitted.
    Own,
}

/// Restoring force with memory by Bouc and Wen.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Hysteresis(pub Sharpness);

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "hysteresis",
    kind: Kind::Driven,
    statement: "Part of the restoring force depends on the path taken: it yields and recovers (Bouc–Wen).",
    equation: "x″ + 2ζω₀x′ + ω₀²x + k_h z = g·u, z′ = x′ − β|x′|z − γx′|z|",
    parameters: &[
        Parameter { name: "k_h", unit: "1/s^2", range: (0.0, 1.0) },
        Parameter { name: "beta", unit: "1/y", range: (0.0, 10.0) },
        Parameter { name: "gamma", unit: "1/y", range: (-10.0, 10.0) },
    ],
    acts: "equation of motion",
    signature: "loops in force against displacement whose area does not depend on speed",
    confusable_with: &["coulomb-friction", "cubic-stiffness", "quadratic-damping", "squeeze-film-damping"],
    reference: "Wen, J. Eng. Mech. ASCE 102 (1976); Ismail, Ikhouane & Rodellar, Arch. Comput. Methods Eng. 16 (2009)",
};

/// Exponents that a fit may take.
const EXPONENTS: [f64; 2] = [0.4, 6.0];

/// States the candidate with an exponent: the same one, with one parameter more.
pub(crate) const SHARP: Candidate = Candidate {
    equation: "x″ + 2ζω₀x′ + ω₀²x + k_h z = g·u, z′ = x′ − β|x′|(β|z|)ⁿ⁻¹z − γx′(β|z|)ⁿ⁻¹|z|",
    parameters: &[
        Parameter { name: "k_h", unit: "1/s^2", range: (0.0, 1.0) },
        Parameter { name: "beta", unit: "1/y", range: (0.0, 10.0) },
        Parameter { name: "gamma", unit: "1/y", range: (-10.0, 10.0) },
        Parameter { name: "n", unit: "1", range: (EXPONENTS[0], EXPONENTS[1]) },
    ],
    ..CANDIDATE
};

/// Declares its keys in a study, which runs the form with an exponent. A run begins without a memory:
/// z = 0.
pub const GIVEN: &[Given] = &[
    Given::new(Key::new(
        83,
        "sensor.hysteresis_per_s2",
        "stiffness of the spring with memory k_h",
        "1/s²",
        1.0,
        Sign::NotNegative,
    )),
    Given::new(Key::new(84, "sensor.hysteresis_beta_per_m", "memory of the spring β", "1/m", 1.0, Sign::NotNegative)),
    Given::new(Key::new(
        85,
        "sensor.hysteresis_gamma_per_m",
        "bend of the spring with memory γ",
        "1/m",
        1.0,
        Sign::Any,
    )),
    Given::new(
        Key::new(
            104,
            "sensor.hysteresis_exponent",
            "exponent n by which the spring with memory yields",
            "1",
            1.0,
            Sign::Positive,
        )
        .or(1.0),
    ),
];

impl Law for Hysteresis {
    fn candidate(&self) -> &'static Candidate {
        match self.0 {
            Sharpness::One => &CANDIDATE,
            Sharpness::Own => &SHARP,
        }
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let mut all = vec![
            // A negative one would feed the motion instead of damping it.
            Coordinate::Bounded(0.1 * s.omega_rad_s.powi(2), 0.0, 1e3 * s.omega_rad_s.powi(2)),
            // With less the loop is a line: what bends without one is a spring.
            Coordinate::Log(0.05 / s.output, 1e2 / s.output),
            Coordinate::Linear(0.3 / s.output),
            Coordinate::Linear(0.1 * s.output),
        ];
        if self.0 == Sharpness::Own {
            all.insert(3, Coordinate::Log(EXPONENTS[0], EXPONENTS[1]));
        }
        all
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let bends = [0.25, 0.7, 2.5, 10.0].map(|b| b / s.output);
        let mut all = bends.map(|b| vec![1e-4 * s.omega_rad_s.powi(2), b, b, 0.0]).to_vec();
        if self.0 == Sharpness::Own {
            all.iter_mut().for_each(|start| start.insert(3, 1.0));
        }
        all
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
    fn fastest_rad_s(&self, p: &[f64], s: &Scales) -> f64 {
        let sharp = if self.0 == Sharpness::Own { p[3].max(1.0) } else { 1.0 };
        (s.velocity * sharp * (p[1] + p[2].abs())).min(4.0 * s.omega_rad_s)
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn in_studies(&self) -> Self {
        Self(Sharpness::Own)
    }
    fn wgsl(&self) -> &'static str {
        "fn hysteresis_rates(at: Instant, p0: f32, p1: f32, p2: f32, p3: f32, own: f32) -> f32 {
    let bent = p1 * abs(at.v) * own + p2 * at.v * abs(own);
    return at.v - bent * pow(max(p1 * abs(own), 1e-6), p3 - 1.0);
}
fn hysteresis(at: Instant, p0: f32, p1: f32, p2: f32, p3: f32, own: f32, sum: f32) -> f32 {
    return fma(-p0, own, sum);
}"
    }
    /// Returns the stiffening. Where z is largest, 1/(β + γ), and the mass turns back, z′/x′ = 1 +
    /// (β − γ)z; from z = 0 on it is 1. No more than ten: a z that may grow far takes a way that no
    /// mass has.
    fn stiffens(&self, p: &[f64]) -> f64 {
        let back = if p[1] + p[2] > 0.0 { 2.0 * p[1] / (p[1] + p[2]) } else { 1.0 };
        p[0].max(0.0) * back.clamp(1.0, 10.0)
    }
    fn start_grid(&self, s: &Scales) -> Option<StartGrid> {
        if self.0 == Sharpness::Own {
            return None;
        }
        let bends = (0..12).map(|i| 0.1 / s.output * 250f64.powf(f64::from(i) / 11.0));
        let directions = bends.flat_map(|b| [-1.3, 0.0, 1.0].map(|ratio| vec![b, ratio * b, 0.0])).collect();
        // It detunes by 5e-7: next to nothing even where Q is 10⁵ and the half width 5e-6.
        Some(StartGrid::Directions { strength: 1e-6 * s.omega_rad_s.powi(2), directions })
    }
    #[inline(always)]
    fn force<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        own: &[T; MOST_STAGED],
        sum: T,
    ) -> T {
        let _ = at;
        fma::<T, FMA>(-p[0], own[0], sum)
    }
    #[inline(always)]
    fn rates<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        own: &[T; MOST_STAGED],
    ) -> [T; MOST_STAGED] {
        let (z, v) = (own[0], at.v);
        let mut rates = [T::of(0.0); MOST_STAGED];
        let bent = p[1] * v.abs() * z + p[2] * v * z.abs();
        rates[0] = match self.0 {
            Sharpness::One => v - bent,
            Sharpness::Own => v - bent * bounded_power((p[1] * z.abs()).max(T::of(LEAST)), p[3] - T::of(1.0)),
        };
        rates
    }
    /// With n = 1 alone: see the module.
    fn tried(_: usize) -> Vec<Self> {
        vec![Self(Sharpness::One)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// z after a path of these velocities, each for a unit of time.
    fn after(beta: f64, gamma: f64, path: &[f64]) -> f64 {
        along(Hysteresis(Sharpness::One), [beta, gamma, 0.0], path)
    }

    fn along(law: Hysteresis, [beta, gamma, n]: [f64; 3], path: &[f64]) -> f64 {
        let p = [1.0, beta, gamma, n, 0.0, 0.0];
        let (mut z, steps) = (0.0, 1000);
        let h = 1.0 / f64::from(steps);
        for v in path {
            for _ in 0..steps {
                let rate = |z: f64| {
                    let at = Instant { v: *v, ..Instant::default() };
                    let own = std::array::from_fn(|i| if i == 0 { z } else { 0.0 });
                    law.rates::<f64, false>(&at, &p, &own)[0]
                };
                z += h * rate(z + 0.5 * h * rate(z));
            }
        }
        z
    }

    // Loaded in one direction from z = 0, dz/dx = 1 − (β + γ)z: z = (1 − e^(−(β + γ)x))/(β + γ), of
    // either sign.
    #[test]
    fn a_single_loading_follows_the_sum_of_both_bends_alone() {
        for (beta, gamma) in [(2.0, 1.0), (0.5, 2.5), (0.8, -1.1)] {
            let sum: f64 = beta + gamma;
            let exact = (1.0 - (-sum).exp()) / sum;
            assert!((after(beta, gamma, &[1.0]) - exact).abs() < 1e-6, "{beta} {gamma}");
        }
    }

    // With n = 1 the power is e⁰: not a bit is another. For n = 2, dz/dx = 1 − (β² + γβ)z² from z = 0
    // on is solved by z = tanh(qx)/q with q² = β² + γβ.
    #[test]
    fn an_exponent_of_one_is_the_stated_law_and_of_two_a_hyperbolic_tangent() {
        let own = Hysteresis(Sharpness::Own);
        let path = [1.0, -0.7, 0.4];
        assert_eq!(along(own, [2.0, -0.8, 1.0], &path), after(2.0, -0.8, &path));
        for (beta, gamma) in [(2.0f64, 1.0f64), (0.8, -0.3)] {
            let q = (beta * beta + gamma * beta).sqrt();
            let z = along(own, [beta, gamma, 2.0], &[1.0]);
            assert!((z - q.tanh() / q).abs() < 1e-6, "{beta} {gamma}: {z}");
            assert!((z - along(own, [beta, gamma, 1.7], &[1.0])).abs() > 1e-3, "another exponent yields otherwise");
        }
    }

    // Loaded far, z ends at 1/(β + γ); on the way back it falls the steeper the more it remembers.
    #[test]
    fn the_bound_of_the_steps_is_the_steepest_way_back() {
        let (beta, gamma) = (2.0, 1.0);
        let [far, back] = [vec![10.0], vec![10.0, -1e-4]].map(|path| after(beta, gamma, &path));
        let bound = Hysteresis::default().stiffens(&[3.0, beta, gamma]);
        assert!((3.0 * (far - back) / 1e-4 / bound - 1.0).abs() < 1e-3, "{far} {back} {bound}");
        assert_eq!(Hysteresis::default().stiffens(&[3.0, 0.0, -1.0]), 3.0);
    }

    // Back again from z > 0 under x′ < 0, dz/dx = 1 + (β − γ)z: what is left where the path closes
    // is the memory, and γ alone has none (β = 0: dz/dx = 1 − γ|z| both ways).
    #[test]
    fn without_beta_nothing_is_remembered() {
        assert!(after(0.0, -1.1, &[1.0, -1.0]).abs() < 1e-6);
        let (beta, gamma): (f64, f64) = (0.8, -1.1);
        let top = after(beta, gamma, &[1.0]);
        let difference = beta - gamma;
        let exact = ((1.0 + difference * top) * (-difference).exp() - 1.0) / difference;
        let back = after(beta, gamma, &[1.0, -1.0]);
        // Past zero the sum of both acts again; stay on the near side of it.
        assert!(exact < 0.0 && back < 0.0, "{exact} {back}");
        let half = after(beta, gamma, &[1.0, -0.3]);
        let exact = ((1.0 + difference * top) * (-0.3 * difference).exp() - 1.0) / difference;
        assert!((half - exact).abs() < 1e-6, "{half} {exact}");
    }
}
