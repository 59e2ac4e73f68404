//! Computes the error of a navigator whose readings are perfect, free or corrected on the way.

use nalgebra::Vector3;

use super::{Difference, Increment, Integrator, Navigator, State, increments};
use crate::motion::earth::Earth;
use crate::motion::truth::Truth;

/// Correction by an aid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// From attitude, velocity and position.
    pub error: Difference,
    /// From specific force from now on, body axes, m/s².
    pub force_m_s2: Vector3<f64>,
    /// From the rate from now on, body axes, rad/s.
    pub rate_rad_s: Vector3<f64>,
}

/// A navigator along a motion.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// The Earth that it moves over.
    pub earth: Earth,
    /// Treatment of motion within a sample.
    pub integrator: Integrator,
    /// The motion.
    pub truth: &'a Truth,
    /// Says whether its height is held.
    pub held: bool,
}

impl Run<'_> {
    /// Its errors at each sample of the truth when it integrates these increments; `aid` is given
    /// the number of the sample and the error there, and says what is taken off.
    pub fn errors(
        &self,
        increments: &[Increment],
        aid: impl Fn(usize, &Difference) -> Option<Correction>,
    ) -> Vec<Difference> {
        let Some(first) = self.truth.samples.first() else { return Vec::new() };
        let interval_s = self.truth.interval_s;
        let mut navigator =
            Navigator::new(self.earth, self.integrator, interval_s, State::at_start(&self.earth, first));
        let start = Difference::of(&navigator.state, first);
        let [mut force_m_s2, mut rate_rad_s] = [Vector3::zeros(); 2];
        let steps = increments.iter().zip(&self.truth.samples[1..]).enumerate().map(|(k, (increment, sample))| {
            navigator.step(Increment {
                rotation_rad: increment.rotation_rad - rate_rad_s * interval_s,
                velocity_m_s: increment.velocity_m_s - force_m_s2 * interval_s,
            });
            if self.held {
                navigator.state.hold_vertical(&self.earth, sample);
            }
            if let Some(correction) = aid(k + 1, &Difference::of(&navigator.state, sample)) {
                navigator.state.correct(&self.earth, &correction.error);
                force_m_s2 += correction.force_m_s2;
                rate_rad_s += correction.rate_rad_s;
            }
            Difference::of(&navigator.state, sample)
        });
        std::iter::once(start).chain(steps).collect()
    }
}

/// Returns how far a navigator strays on perfect increments of a motion, at each sample of the
/// truth.
pub fn own_error(earth: &Earth, integrator: Integrator, truth: &Truth) -> Vec<Difference> {
    Run { earth: *earth, integrator, truth, held: false }.errors(&increments(truth), |_, _| None)
}
