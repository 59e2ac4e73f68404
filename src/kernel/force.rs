//! The shared excitation over one tile, tabulated once in f64 for all members: at the beginning,
//! the middle and the end of each substep, and the differences, which f32 would lose.

use super::job::Job;
use crate::numerics::elementary::Real;
use crate::parallel;

/// The specific force over one substep, m/s². Twin of `Force` in `shaders/shared/layout.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Force<T> {
    /// Value at the beginning of the substep, m/s².
    pub begin: T,
    /// Value in the middle of the substep, m/s².
    pub middle: T,
    /// Value at the end of the substep, m/s².
    pub end: T,
    /// Change from the beginning to the middle, m/s².
    pub to_middle: T,
    /// Change from the beginning to the end, m/s².
    pub to_end: T,
}

/// Substeps that a thread tabulates at a time.
const STRETCH: u64 = 1024;

/// The force over the substeps of `count` samples from `first_sample` on.
pub fn table<T: Real>(job: &Job, first_sample: u64, count: u64) -> Vec<Force<T>> {
    let per_step = u64::from(job.integrator.substeps());
    let per_sample = per_step * u64::from(job.clock.steps_per_sample);
    let half_s = 0.5 * job.clock.step_s / per_step as f64;
    let first = first_sample * per_sample;
    let at = |half: u64| job.waveform.specific_force_m_s2(half as f64 * half_s);
    let still = job.clock.still_samples * per_sample;
    let standing = T::of(job.waveform.standing_m_s2());
    let one = |substep: u64| {
        // Nothing moves during a still start; the waveform begins at its end.
        let Some(substep) = substep.checked_sub(still) else {
            return Force { begin: standing, middle: standing, end: standing, ..Force::default() };
        };
        let [begin, middle, end] = [at(2 * substep), at(2 * substep + 1), at(2 * substep + 2)];
        Force {
            begin: T::of(begin),
            middle: T::of(middle),
            end: T::of(end),
            to_middle: T::of(middle - begin),
            to_end: T::of(end - begin),
        }
    };
    let substeps = count * per_sample;
    let stretch = |n: usize| -> Vec<Force<T>> {
        let begin = n as u64 * STRETCH;
        (begin..substeps.min(begin + STRETCH)).map(|i| one(first + i)).collect()
    };
    parallel::map_indices(substeps.div_ceil(STRETCH) as usize, stretch).concat()
}
