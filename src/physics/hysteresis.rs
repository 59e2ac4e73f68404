//! A spring with memory: a parallel spring that yields and slips back (Bouc–Wen).

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Cloud, Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};

/// Bouc–Wen.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Hysteresis;

/// What the library says of it.
pub const CANDIDATE: Candidate = Candidate {
    id: "hysteresis",
    kind: Kind::Driven,
    statement: "Part of the restoring force remembers the path: it yields and slips back (Bouc–Wen).",
    equation: "x″ + 2ζω₀x′ + ω₀²x + k_h z = g·u, z′ = x′ − (s|x′|z + (1 − s)x′|z|)/z_y",
    parameters: &[
        Parameter { name: "k_h", unit: "1/s^2", range: (0.0, 1.0) },
        Parameter { name: "z_y", unit: "y", range: (0.0, 10.0) },
        Parameter { name: "s", unit: "1", range: (0.0, 1.0) },
    ],
    acts: "equation of motion",
    signature: "loops in force against displacement whose area does not depend on speed",
    confusable_with: &["coulomb-friction", "cubic-stiffness", "quadratic-damping", "squeeze-film-damping"],
    reference: "Wen, J. Eng. Mech. ASCE 102 (1976); Ismail, Ikhouane & Rodellar, Arch. Comput. Methods Eng. 16 (2009)",
};

impl Law for Hysteresis {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![
            // A negative one would feed the motion instead of damping it.
            Coordinate::Bounded(0.1 * s.omega_rad_s.powi(2), 0.0, 1e3 * s.omega_rad_s.powi(2)),
            Coordinate::Log(0.01 * s.output, 4.0 * s.output),
            Coordinate::Bounded(0.3, 0.0, 1.0),
            Coordinate::Linear(0.1 * s.output),
        ]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        [0.05, 0.2, 0.7, 2.0].map(|y| vec![1e-4 * s.omega_rad_s.powi(2), y * s.output, 0.5, 0.0]).to_vec()
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
        (s.velocity / p[1]).min(4.0 * s.omega_rad_s)
    }
    fn cloud(&self, s: &Scales) -> Option<Cloud> {
        let shapes = (0..24).map(|i| vec![0.02 * s.output * 200f64.powf(f64::from(i) / 23.0), 0.5, 0.0]).collect();
        Some(Cloud::Shapes { strength: 0.01 * s.omega_rad_s.powi(2), shapes })
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
        let (z, v, share) = (own[0], at.v, p[2]);
        let mut rates = [T::of(0.0); MOST_STAGED];
        rates[0] = v - (share * v.abs() * z + (T::of(1.0) - share) * v * z.abs()) / p[1];
        rates
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Loaded in one direction from z = 0, z′ = x′(1 − z/z_y) whatever s: z = z_y(1 − e^(−x/z_y)).
    #[test]
    fn a_single_loading_yields_exponentially() {
        let (yields, steps) = (0.3, 1000);
        for s in [0.2, 0.9] {
            let p = [1.0, yields, s, 0.0, 0.0, 0.0];
            let mut z = 0.0;
            let h = 1.0 / f64::from(steps);
            for _ in 0..steps {
                let rate = |z: f64| {
                    let at = Instant { v: 1.0, ..Instant::default() };
                    let own = std::array::from_fn(|i| if i == 0 { z } else { 0.0 });
                    Hysteresis.rates::<f64, false>(&at, &p, &own)[0]
                };
                let half = rate(z + 0.5 * h * rate(z));
                z += h * half;
            }
            assert!((z - yields * (1.0 - (-1.0f64 / yields).exp())).abs() < 1e-6, "{s}: {z}");
        }
    }
}
