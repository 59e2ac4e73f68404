//! A spring that follows the temperature: what a study runs for a [`StiffnessDrift`] that a
//! diagnosis found to follow a recorded temperature.
//!
//! [`StiffnessDrift`]: super::stiffness_drift::StiffnessDrift

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// ω₀²(1 + κϑ), with ϑ in K above the temperature at which ω₀ is stated.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WarmStiffness;

/// States the candidate for the library; a diagnosis names it as a stiffness drift.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "warm-stiffness",
    kind: Kind::Driven,
    statement: "The spring follows the temperature.",
    equation: "x″ + 2ζω₀x′ + ω₀²(1 + κϑ)x = g·u, ϑ the temperature above its reference",
    parameters: &[Parameter { name: "kappa", unit: "1/K", range: (-0.1, 0.1) }],
    acts: "equation of motion",
    signature: "the resonance moves with the temperature whatever the amplitude",
    confusable_with: &["stiffness-drift"],
    reference: "IEEE 1293, temperature sensitivity of the scale factor",
};

/// Declares its keys in a study.
pub const GIVEN: &[Given] =
    &[Given::new(Key::new(92, "sensor.stiffness_per_k", "stiffness over temperature κ", "1/K", 1.0, Sign::Any))];

impl Law for WarmStiffness {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    /// A study's own: never fitted.
    fn coordinates(&self, _: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(1e-3)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    fn follows_temperature(&self) -> bool {
        true
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn warm_stiffness(at: Instant, p0: f32, sum: f32) -> f32 {
    return fma(-(at.stiffness * p0 * at.warmer), at.x, sum);
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
        let warmer = T::of(at.environment.first().copied().unwrap_or(0.0));
        fma::<T, FMA>(-(at.stiffness * p[0] * warmer), at.x, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // A spring that is 20 K · 0.005/K = a tenth stiffer pulls 0.1 ω₀²x more: 0.1 · 9 · 2.
    #[test]
    fn it_pulls_by_as_much_more_as_it_is_warmer() {
        let at = |environment| Instant { x: 2.0, stiffness: 9.0, environment, ..Instant::<f64>::default() };
        let force = |at: &Instant<'_, f64>| WarmStiffness.force::<f64, false>(at, &[0.005; 6], &[0.0; 3], 1.0);
        assert!((force(&at(&[20.0])) - (1.0 - 1.8)).abs() < 1e-15);
        // Controls: at the reference, and without a temperature, nothing is added.
        assert_eq!([force(&at(&[0.0])), force(&at(&[]))], [1.0, 1.0]);
    }
}
