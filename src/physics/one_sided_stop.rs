//! A stop on one side of the mass, where its position says: what a study runs for an [`EndStop`]
//! that a diagnosis found on one side.
//!
//! Two of different gaps are not one law; a stop on both sides next to this one is.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::end_stop::{EndStop, Side};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Elastic contact beyond a position: above it where it is positive, below it where it is negative.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OneSidedStop;

/// States the candidate for the library; a diagnosis names it as an end stop.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "one-sided-stop",
    kind: Kind::Driven,
    statement: "The mass runs into a stop on one side.",
    equation: "x″ + 2ζω₀x′ + ω₀²x + k_c (x − x_c)₊ = g·u for x_c > 0, mirrored for x_c < 0",
    parameters: &[
        Parameter { name: "k_c", unit: "1/s^2", range: (0.003, 1000.0) },
        Parameter { name: "x_c", unit: "y", range: (-5.0, 5.0) },
    ],
    acts: "equation of motion",
    signature: "the tops of the reading are flattened on one side",
    confusable_with: &["end-stop"],
    reference: "Shaw & Holmes, A periodically forced piecewise linear oscillator, J. Sound Vib. 90 (1983)",
};

/// Declares its keys in a study: its position changes sides with the axis.
pub(crate) const GIVEN: &[Given] = &[
    Given::new(Key::new(
        86,
        "sensor.one_sided_stop_per_s2",
        "stiffness of the one-sided stop k_c",
        "1/s²",
        1.0,
        Sign::NotNegative,
    )),
    Given::turning(Key::new(
        87,
        "sensor.one_sided_stop_at_m",
        "position of the one-sided stop, negative below",
        "m",
        1.0,
        Sign::Any,
    )),
];

impl OneSidedStop {
    /// The values of an end stop on one side; `None` for one on both.
    pub fn values_of(stop: EndStop, p: &[f64]) -> Option<[f64; 2]> {
        match stop.0 {
            Side::Both => None,
            Side::Upper => Some([p[0], p[1]]),
            Side::Lower => Some([p[0], -p[1]]),
        }
    }
}

impl Law for OneSidedStop {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![EndStop(Side::Upper).coordinates(s)[0], Coordinate::Linear(s.output)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        EndStop(Side::Upper).starts(s)
    }
    fn stiffens(&self, p: &[f64]) -> f64 {
        p[0].max(0.0)
    }
    fn has_corner(&self) -> bool {
        true
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn one_sided_stop(at: Instant, p0: f32, p1: f32, sum: f32) -> f32 {
    let side = select(1.0, -1.0, p1 < 0.0);
    return fma(-p0 * side, max(side * (at.x - p1), 0.0), sum);
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
        let side = T::of(if p[1] < T::of(0.0) { -1.0 } else { 1.0 });
        fma::<T, FMA>(-p[0] * side, (side * (at.x - p[1])).max(T::of(0.0)), sum)
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // Pushed steadily against its stop, a critically damped mass rests where both springs balance:
    // (g·u + k_c·x_c)/(ω₀² + k_c); pushed away from it, at g·u/ω₀².
    #[test]
    fn a_steady_push_is_stopped_on_the_side_of_the_position_alone() {
        let mass = Mass { omega: 3.0, zeta: 1.0, gain: 1.0 };
        for (at, push, expected) in [
            (1.2, 27.0, (27.0 + 40.0 * 1.2) / 49.0),
            (1.2, -27.0, -3.0),
            (-1.2, -27.0, -(27.0 + 40.0 * 1.2) / 49.0),
            (-1.2, 27.0, 3.0),
        ] {
            let [x, _] = mass.moved(&OneSidedStop, &[40.0, at], [0.0, 0.0], 20.0, 20_000, |_| push);
            assert!((x - expected).abs() < 1e-9, "{at} {push}: {x}");
        }
    }

    #[test]
    fn an_end_stop_on_one_side_moves_the_mass_as_its_values_here_do() {
        let mass = Mass { omega: 3.0, zeta: 0.2, gain: 1.0 };
        let push = |t: f64| 20.0 * (2.0 * t).sin();
        let moved_by = |stop: EndStop| mass.moved(&stop, &[40.0, 1.2], [0.0, 0.0], 7.3, 20_000, push);
        let mut ends = Vec::new();
        for side in [Side::Upper, Side::Lower] {
            let values = OneSidedStop::values_of(EndStop(side), &[40.0, 1.2]).expect("it is on one side");
            let here = mass.moved(&OneSidedStop, &values, [0.0, 0.0], 7.3, 20_000, push);
            assert_eq!(here, moved_by(EndStop(side)), "{side:?}");
            ends.push(here);
        }
        // Control: the sides differ, and a stop on both is neither.
        assert!((ends[0][0] - ends[1][0]).abs() > 1e-3, "{ends:?}");
        assert_eq!(OneSidedStop::values_of(EndStop(Side::Both), &[40.0, 1.2]), None);
    }
}
