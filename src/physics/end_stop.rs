//! A stop that the mass runs into beyond a gap, on one side or both.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role, StartGrid};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Side of the mass that has a stop.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Side {
    /// Both, at the same distance.
    #[default]
    Both,
    /// Stop at positive displacement.
    Upper,
    /// Stop at negative displacement.
    Lower,
}

impl Side {
    /// Returns how far the reading gets on this side.
    fn reach(self, s: &Scales) -> f64 {
        let (below, above) = (s.centre - s.output_range.0, s.output_range.1 - s.centre);
        match self {
            Side::Both => above.max(below),
            Side::Upper => above,
            Side::Lower => below,
        }
    }
}

/// Elastic contact beyond a gap.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EndStop(pub Side);

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "end-stop",
    kind: Kind::Driven,
    statement: "Beyond a gap the mass runs into a stop, on one side or both.",
    equation: "x″ + 2ζω₀x′ + ω₀²x + k_c (x − gap)₊ = g·u (mirrored for the other side)",
    parameters: &[
        Parameter { name: "k_c", unit: "1/s^2", range: (0.003, 1000.0) },
        Parameter { name: "gap", unit: "y", range: (0.0, 5.0) },
    ],
    acts: "equation of motion",
    signature: "residual only near and just after the largest displacements; the tops of the reading are flattened",
    confusable_with: &["readout-saturation", "cubic-stiffness", "quadratic-stiffness"],
    reference: "Shaw & Holmes, A periodically forced piecewise linear oscillator, J. Sound Vib. 90 (1983)",
};

/// Stiffness of the softest stop, over that of the spring.
const SOFTEST: f64 = 0.003;
/// The same next to a spring that bends smoothly: a softer stop and such a bend differ by a corner
/// alone, and together they imitate a bend of another order.
const SOFTEST_BESIDE_A_BEND: f64 = 0.3;

impl EndStop {
    /// Returns whether it is too soft to be told from the bend of another spring in the same model.
    pub fn may_be_a_bend(parameters: &[f64], s: &Scales) -> bool {
        parameters[0] < SOFTEST_BESIDE_A_BEND * s.omega_rad_s.powi(2)
    }
}

/// Declares its keys in a study: stops on both sides.
pub(crate) const GIVEN: &[Given] = &[
    Given::new(Key::new(
        75,
        "sensor.end_stop_per_s2",
        "stiffness of the end stops k_c",
        "1/s²",
        1.0,
        Sign::NotNegative,
    )),
    Given::new(Key::new(76, "sensor.end_stop_gap_m", "gap to the end stops", "m", 1.0, Sign::NotNegative)),
];

impl Law for EndStop {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let spring = s.omega_rad_s.powi(2);
        // Softer ones are not searched for.
        vec![Coordinate::Log(SOFTEST * spring, 1e3 * spring), Coordinate::Log(0.3 * s.output, 10.0 * s.output)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let reach = self.0.reach(s);
        let spring = s.omega_rad_s.powi(2);
        [0.35, 0.55, 0.7, 0.8, 0.88, 0.95]
            .into_iter()
            .flat_map(|r| [0.02, 0.15, 1.0, 10.0].map(|k| vec![k * spring, r * reach.max(0.5 * s.output)]))
            .collect()
    }
    /// Harder and further away, softer and nearer: the same energy goes into it where the mass gets
    /// furthest.
    fn elsewhere(&self, p: &[f64], s: &Scales) -> Vec<Vec<f64>> {
        let reach = self.0.reach(s);
        let depth = (reach - p[1]).max(0.0);
        [0.25, 4.0, 16.0].map(|harder| vec![harder * p[0], reach - depth / f64::sqrt(harder)]).to_vec()
    }
    fn fastest_rad_s(&self, p: &[f64], s: &Scales) -> f64 {
        (p[0].max(0.0) + s.omega_rad_s.powi(2)).sqrt().min(7.0 * s.omega_rad_s)
    }
    fn stiffens(&self, p: &[f64]) -> f64 {
        p[0].max(0.0)
    }
    fn has_corner(&self) -> bool {
        true
    }
    /// Gaps from where the mass often is to where it hardly ever gets; stops from a bend to a wall.
    fn start_grid(&self, s: &Scales) -> Option<StartGrid> {
        let (spring, reach) = (s.omega_rad_s.powi(2), self.0.reach(s).max(0.5 * s.output));
        let gaps = [0.3, 0.4, 0.5, 0.58, 0.66, 0.73, 0.79, 0.84, 0.88, 0.92, 0.95, 0.975, 0.99];
        let stops = [0.02, 0.15, 0.6, 2.0, 6.0, 18.0];
        Some(StartGrid::Points(gaps.iter().flat_map(|g| stops.map(|k| vec![k * spring, g * reach])).collect()))
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn end_stop(at: Instant, p0: f32, p1: f32, sum: f32) -> f32 {
    return fma(-p0, max(at.x - p1, 0.0) - max(-at.x - p1, 0.0), sum);
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
        // Sides as factors: a branch in the loop over lanes keeps it from becoming vector code.
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let upper = if self.0 == Side::Lower { zero } else { one };
        let lower = if self.0 == Side::Upper { zero } else { one };
        let (above, below) = ((at.x - p[1]).max(zero), (-at.x - p[1]).max(zero));
        fma::<T, FMA>(-p[0], upper * above - lower * below, sum)
    }
    fn tried(_: usize) -> Vec<Self> {
        [Side::Both, Side::Upper, Side::Lower].map(Self).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // ½ k (reach − gap)² is the same in every valley.
    #[test]
    fn other_local_minima_take_up_the_same_energy() {
        let scales = Scales { output_range: (-1.5, 2.0), velocity: 1.0, omega_rad_s: 3.0, ..Scales::of_a_mass() };
        let energy = |p: &[f64], reach: f64| p[0] * (reach - p[1]).powi(2);
        for (side, reach) in [(Side::Both, 2.0), (Side::Upper, 2.0), (Side::Lower, 1.5)] {
            let here = [40.0, 1.2];
            for p in EndStop(side).elsewhere(&here, &scales) {
                assert!((energy(&p, reach) / energy(&here, reach) - 1.0).abs() < 1e-12, "{side:?} {p:?}");
            }
        }
    }

    // Pushed steadily beyond the gap, a critically damped mass rests where both springs balance:
    // (g·u + k_c·gap)/(ω₀² + k_c).
    #[test]
    fn a_steady_push_ends_where_both_springs_balance() {
        let mass = Mass { omega: 3.0, zeta: 1.0, gain: 1.0 };
        for (side, push, expected) in [
            (Side::Both, 27.0, (27.0 + 40.0 * 1.2) / 49.0),
            (Side::Both, -27.0, -(27.0 + 40.0 * 1.2) / 49.0),
            (Side::Upper, -27.0, -3.0),
            (Side::Lower, 27.0, 3.0),
        ] {
            let [x, _] = mass.moved(&EndStop(side), &[40.0, 1.2], [0.0, 0.0], 20.0, 20_000, |_| push);
            assert!((x - expected).abs() < 1e-9, "{side:?} {push}: {x}");
        }
    }
}
