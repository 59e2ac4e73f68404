//! A spring that is stiffer on one side than on the other: αx².

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Restoring force αx² per unit mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct QuadraticStiffness;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "quadratic-stiffness",
    kind: Kind::Driven,
    statement: "The spring is stiffer on one side than on the other.",
    equation: "x″ + 2ζω₀x′ + ω₀²x + αx² = g·u",
    parameters: &[Parameter { name: "alpha", unit: "1/(y s^2)", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "the mean displacement follows the vibration's power; second harmonics",
    confusable_with: &["drive-nonlinearity", "readout-nonlinearity", "end-stop"],
    reference: "Nayfeh & Mook, Nonlinear Oscillations, 1979, ch. 4; IEEE 1293 (vibration rectification)",
};

/// Declares its keys in a study.
pub const GIVEN: &[Given] = &[Given::turning(Key::new(
    3,
    "sensor.quadratic_stiffness_per_m_s2",
    "quadratic stiffness α",
    "1/(m s²)",
    1.0,
    Sign::Any,
))];

impl Law for QuadraticStiffness {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 * s.omega_rad_s.powi(2) / s.output)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn quadratic_stiffness(at: Instant, p0: f32, sum: f32) -> f32 {
    return fma(-(p0 * at.x), at.x, sum);
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
        fma::<T, FMA>(-(p[0] * at.x), at.x, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // Energy ½v² + ½ω₀²x² + αx³/3 is kept, so that the speed at rest position is known from where
    // the mass was released.
    #[test]
    fn the_mass_is_faster_through_rest_on_its_way_from_the_stiff_side() {
        let (omega, alpha, a) = (2.0f64, 3.0, 0.3);
        let mass = Mass { omega, ..Mass::default() };
        let energy = |[x, v]: [f64; 2]| 0.5 * v * v + 0.5 * omega * omega * x * x + alpha * x.powi(3) / 3.0;
        for t in [0.3, 1.1, 2.5] {
            let there = mass.moved(&QuadraticStiffness, &[alpha], [a, 0.0], t, 4000, |_| 0.0);
            assert!((energy(there) / energy([a, 0.0]) - 1.0).abs() < 1e-10, "{there:?}");
            let other = mass.moved(&QuadraticStiffness, &[-alpha], [a, 0.0], t, 4000, |_| 0.0);
            assert!((energy(other) / energy([a, 0.0]) - 1.0).abs() > 1e-2, "{other:?}");
        }
    }
}
