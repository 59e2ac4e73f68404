//! The shared excitation over one tile, tabulated once in f64 for all members: at the beginning,
//! the middle and the end of each substep, and the differences, which f32 would lose.
//!
//! A delay of the readings commutes with the mechanics, so it is one of the force that moves the
//! masses; by how much that force differs from the true one is tabulated for each sample.

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
    let delay_s = job.readout_delay_s();
    let before = before_the_run(job);
    let at = |half: u64| delayed(job, half as f64 * half_s, delay_s, before);
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

/// What the late force has more than the force itself at the end of each of `count` samples from
/// `first` on, m/s²; empty where no reading is late.
pub fn late<T: Real>(job: &Job, first: u64, count: u64) -> Vec<T> {
    let delay_s = job.readout_delay_s();
    if delay_s == 0.0 {
        return Vec::new();
    }
    let before = before_the_run(job);
    let one = |n: u64| {
        let Some(passed) = n.checked_sub(job.clock.still_samples) else { return T::of(0.0) };
        let time_s = (passed + 1) as f64 * job.clock.sample_s();
        T::of(delayed(job, time_s, delay_s, before) - delayed(job, time_s, 0.0, before))
    };
    (first..first + count).map(one).collect()
}

/// The force `delay_s` before a time of the run, m/s².
fn delayed(job: &Job, time_s: f64, delay_s: f64, before: f64) -> f64 {
    match time_s - delay_s {
        then_s if then_s < 0.0 => before,
        then_s => job.waveform.specific_force_m_s2(then_s),
    }
}

/// The force before the run, m/s²: that of the still start, or the run's first.
fn before_the_run(job: &Job) -> f64 {
    match job.clock.still_samples {
        0 => job.waveform.specific_force_m_s2(0.0),
        _ => job.waveform.standing_m_s2(),
    }
}
