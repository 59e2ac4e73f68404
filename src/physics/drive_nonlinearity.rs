//! A force that is not proportional to the input: g(u + κu²), as with electrostatic drive.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Driving force g(u + κu²) per unit mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DriveNonlinearity;

/// States the candidate for the library.
pub const CANDIDATE: Candidate = Candidate {
    id: "drive-nonlinearity",
    kind: Kind::Driven,
    statement: "The force is not proportional to the input: its square acts too, as with electrostatic drive.",
    equation: "x″ + 2ζω₀x′ + ω₀²x = g(u + κu²)",
    parameters: &[Parameter { name: "kappa", unit: "1/u", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "sums, differences and harmonics of the input's frequencies, filtered by the resonance",
    confusable_with: &["quadratic-stiffness", "readout-nonlinearity"],
    reference: "Senturia, Microsystem Design, 2001, ch. 6 (electrostatic actuation)",
};

/// Declares its keys in a study.
pub(crate) const GIVEN: &[Given] =
    &[Given::new(Key::new(73, "sensor.drive_nonlinearity_s2_per_m", "drive nonlinearity κ", "s²/m", 1.0, Sign::Any))];

impl Law for DriveNonlinearity {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 / s.input)]
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    fn needs_input(&self) -> bool {
        true
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn drive_nonlinearity(at: Instant, p0: f32, sum: f32) -> f32 {
    return fma(at.gain * p0 * at.input, at.input, sum);
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
        fma::<T, FMA>(at.gain * p[0] * at.input, at.input, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // Critically damped, the mass comes to rest at g(u + κu²)/ω₀².
    #[test]
    fn a_steady_input_displaces_by_its_square_too() {
        let mass = Mass { omega: 4.0, zeta: 1.0, gain: 3.0 };
        for u in [0.5, -0.5] {
            let [x, _] = mass.moved(&DriveNonlinearity, &[0.2], [0.0, 0.0], 10.0, 4000, |_| u);
            assert!((x - 3.0 * (u + 0.2 * u * u) / 16.0).abs() < 1e-10, "{u}: {x}");
        }
    }
}
