//! A spring that changes during the recording: ω₀²(1 + κt), or κ times an environment column.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// ω₀²(1 + κt), or ω₀²(1 + κ·environment).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StiffnessDrift {
    /// The environment column it follows; time where absent.
    pub environment: Option<usize>,
}

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "stiffness-drift",
    kind: Kind::Driven,
    statement: "The spring changes during the recording, with time or with its environment.",
    equation: "x″ + 2ζω₀x′ + ω₀²(1 + κt)x = g·u, or κ times an environment column",
    parameters: &[Parameter { name: "kappa", unit: "1/s", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "the resonance moves with time whatever the amplitude",
    confusable_with: &["warm-up", "bias-drift"],
    reference: "IEEE 1293, temperature and time sensitivity of the scale factor",
};

/// Declares its keys in a study: with time, from the beginning of the run on, its still start
/// included.
pub const GIVEN: &[Given] =
    &[Given::new(Key::new(74, "sensor.stiffness_drift_per_s", "stiffness drift κ", "1/s", 1.0, Sign::Any))];

impl Law for StiffnessDrift {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![Coordinate::Linear(0.1 / self.environment.map_or(s.duration_s, |e| s.environment[e].max(1e-300)))]
    }
    fn environment(&self) -> Option<usize> {
        self.environment
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn stiffness_drift(at: Instant, p0: f32, sum: f32) -> f32 {
    return fma(-(at.stiffness * p0 * at.time), at.x, sum);
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
        let by = match self.environment {
            Some(column) => T::of(at.environment.get(column).copied().unwrap_or(0.0)),
            None => at.time,
        };
        fma::<T, FMA>(-(at.stiffness * p[0] * by), at.x, sum)
    }
    /// With time, then with each environment column.
    fn tried(environments: usize) -> Vec<Self> {
        std::iter::once(None).chain((0..environments).map(Some)).map(|environment| Self { environment }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // A slow change leaves the action E/ω as it is: the amplitude falls as (1 + κt)^(−1/4) (Landau
    // & Lifshitz, Mechanics, § 49); corrections are of order κ/ω₀, here 1e-4.
    #[test]
    fn the_amplitude_falls_with_the_fourth_root_of_a_stiffness_that_grows_slowly() {
        let (omega, kappa) = (10.0f64, 1e-3);
        let mass = Mass { omega, ..Mass::default() };
        for t in [100.0, 400.0] {
            let law = StiffnessDrift { environment: None };
            let [x, v] = mass.moved(&law, &[kappa], [1.0, 0.0], t, 200_000, |_| 0.0);
            let amplitude = x.hypot(v / (omega * (1.0 + kappa * t).sqrt()));
            assert!((amplitude - (1.0 + kappa * t).powf(-0.25)).abs() < 3e-4, "{t}: {amplitude}");
        }
    }
}
