//! Checks a job before it is integrated: counts that fit their counters, report times in order,
//! histograms that fit the memory.

use crate::error::{Error, Result};
use crate::kernel::job::Job;

/// Refuses jobs that cannot be.
pub(super) fn check(job: &Job) -> Result<()> {
    let refuse = |cause: &str, hint: &str| Err(Error::new("could not simulate", cause, hint));
    let clock = &job.clock;
    if job.members == 0 {
        return refuse("there are no members", "ask for at least one");
    }
    if clock.samples == 0 || clock.steps_per_sample == 0 || clock.step_s.is_nan() || clock.step_s <= 0.0 {
        return refuse("the run has no samples, no steps or no step size", "lengthen duration_s or shorten step_s");
    }
    let ordered = clock.report_samples.windows(2).all(|w| w[0] < w[1]);
    let inside = clock.report_samples.iter().all(|&r| r > clock.still_samples && r <= clock.samples);
    if clock.report_samples.is_empty() || !ordered || !inside {
        return refuse(
            "the report times do not increase, or lie outside the run or in its still start",
            "give times between 0 and duration_s",
        );
    }
    let steps = job.steps_per_sample();
    if steps > u64::from(u32::MAX) {
        return refuse(
            &format!("a sample takes {steps} steps, and at most {} are counted", u32::MAX),
            "raise the sample rate, or leave out so high a resonance: it follows the force instantly",
        );
    }
    // Samples are counted in 32 bits on the device.
    if clock.samples > u64::from(u32::MAX) {
        return refuse("the run has more than 4.2e9 samples", "lower the sample rate or shorten the run");
    }
    let bytes = clock.report_samples.len() as u64 * 4 * 8 * (crate::statistics::histogram::BINS as u64 + 2);
    if bytes > 2 << 30 {
        let cause = format!("{} report times need {} MB of histograms", clock.report_samples.len(), bytes >> 20);
        return refuse(&cause, "give fewer report times");
    }
    Ok(())
}
