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
    let late = Late::of(job);
    let first = first_sample * per_sample;
    let at = |half: u64| late.force(half);
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

/// Returns what the late force has more than the force itself at the end of each of `count` samples
/// from `first` on, m/s²; empty where no reading is late.
pub fn late<T: Real>(job: &Job, first: u64, count: u64) -> Vec<T> {
    let late = Late::of(job);
    if late.halves == 0.0 {
        return Vec::new();
    }
    let halves = 2 * job.steps_per_sample();
    let one = |n: u64| match n.checked_sub(job.clock.still_samples) {
        Some(passed) => {
            let half = (passed + 1) * halves;
            T::of(late.force(half) - job.waveform.specific_force_m_s2(half as f64 * late.half_s))
        }
        None => T::of(0.0),
    };
    (first..first + count).map(one).collect()
}

/// The force as the readings are late of it.
struct Late<'a> {
    job: &'a Job,
    /// Half a substep, s.
    half_s: f64,
    /// The delay, in half substeps.
    halves: f64,
    /// The force before the run: that of the still start, or the run's first without vibration, m/s².
    before: f64,
}

impl<'a> Late<'a> {
    /// Nearer than this to a whole number of half substeps, a delay is one: an edge of the force then
    /// stays on the step that it falls on.
    const WHOLE: f64 = 1e-6;

    fn of(job: &'a Job) -> Self {
        let half_s = 0.5 * job.clock.step_s / f64::from(job.integrator.substeps());
        let halves = job.readout_delay_s() / half_s;
        let before = match job.clock.still_samples {
            0 => job.waveform.before_m_s2(),
            _ => job.waveform.standing_m_s2(),
        };
        let halves = if (halves - halves.round()).abs() < Self::WHOLE { halves.round() } else { halves };
        Self { job, half_s, halves, before }
    }

    /// Delayed force after `half` half substeps of the run, m/s².
    fn force(&self, half: u64) -> f64 {
        match half as f64 - self.halves {
            // A sum over samples ends with each, and so begins after the run's first force.
            then if then <= 0.0 => self.before,
            then => self.job.waveform.specific_force_m_s2(then * self.half_s),
        }
    }
}
