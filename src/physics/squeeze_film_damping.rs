//! Damping that grows with the square of the displacement, as a gas film is squeezed: c x²x′.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Damping force c x²x′ per unit mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SqueezeFilmDamping;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "squeeze-film-damping",
    kind: Kind::Driven,
    statement: "Damping grows with displacement, as the gas film is squeezed.",
    equation: "x″ + (2ζω₀ + c x²)x′ + ω₀²x = g·u",
    parameters: &[Parameter { name: "c", unit: "1/(y^2 s)", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "the peak of the resonance is lower at high amplitude; loss grows with displacement, not with speed",
    confusable_with: &["quadratic-damping", "coulomb-friction", "hysteresis"],
    reference: "Bao & Yang, Squeeze film air damping in MEMS, Sensors and Actuators A 136 (2007)",
};

/// Declares its keys in a study.
pub const GIVEN: &[Given] = &[Given::new(Key::new(
    5,
    "sensor.squeeze_film_per_m2_s",
    "squeeze-film damping",
    "1/(m² s)",
    1.0,
    Sign::NotNegative,
))];

impl Law for SqueezeFilmDamping {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        // Below zero it would feed the motion: no film does.
        vec![Coordinate::Bounded(s.zeta * s.omega_rad_s / s.output.powi(2), 0.0, f64::MAX)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn squeeze_film_damping(at: Instant, p0: f32, sum: f32) -> f32 {
    return fma(-(p0 * at.x * at.x), at.v, sum);
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
        fma::<T, FMA>(-(p[0] * at.x * at.x), at.v, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // Without a spring dv/dx = −c x²: from x = 0 on, v = v₀ − c x³/3.
    #[test]
    fn a_free_mass_loses_speed_with_the_cube_of_its_way() {
        let [x, v] = Mass::default().moved(&SqueezeFilmDamping, &[6.0], [0.0, 1.0], 0.7, 4000, |_| 0.0);
        assert!(x > 0.4 && (v - (1.0 - 2.0 * x.powi(3))).abs() < 1e-10, "{x} {v}");
    }
}
