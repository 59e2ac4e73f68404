//! Job × backend → statistics: the pilot that sets the bins, batches that fit the memory, progress, Ctrl-C and resuming.
//!
//! Results depend neither on the batches nor on where a run was interrupted: members are summed in blocks of 256, in
//! order, and counts are integers.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::backend::cpu::{Cpu, Precision};
use crate::backend::{Backend, Batch, Partial};
use crate::error::{Error, Result};
use crate::kernel::job::Job;
use crate::progress;
use crate::statistics::{Bins, Statistics, Summary};

mod backends;
mod state;

pub use backends::{Backends, Choice};
use state::State;

/// Members that set the bins of the histograms: always the same first ones.
const PILOT: u64 = 1024;

/// What a long run has summed up is written this often.
const KEEP_EVERY: Duration = Duration::from_secs(30);

/// How to run.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Where.
    pub backend: Choice,
    /// Precision; f64 means the CPU.
    pub precision: Precision,
    /// File for the state of an interrupted run; none is kept without.
    pub state: Option<PathBuf>,
    /// Continue from that file.
    pub resume: bool,
    /// Members per batch, where the backend's own choice is not wanted (a multiple of 256).
    pub batch_members: Option<u64>,
    /// No progress bar.
    pub quiet: bool,
}

/// Integrates an ensemble and sums it up.
///
/// # Errors
/// Impossible jobs, adapters that are not there, Ctrl-C (the hint says how to go on), state files that do not fit.
pub fn run(job: &Job, options: &Options) -> Result<Statistics> {
    Backends::default().run(job, options)
}

/// Integrates an ensemble on a given backend.
///
/// # Errors
/// As [`run`].
pub fn run_on(job: &Job, backend: &mut dyn Backend, options: &Options) -> Result<Statistics> {
    check(job)?;
    let begun = Instant::now();
    let machine = backend.machine(job);
    let mut state = match (&options.state, options.resume) {
        (Some(path), true) => State::read(path, job, &machine)?,
        _ => State::new(job, &machine),
    };
    let bar = if options.quiet {
        indicatif::ProgressBar::hidden()
    } else {
        progress::bar("simulating", job.members.saturating_mul(job.clock.samples))
    };
    bar.set_position(state.next_member.saturating_mul(job.clock.samples));
    if state.bins.is_empty() {
        let Some(bins) = pilot(job, options)? else { return Err(interrupted(options)) };
        state.set_bins(bins);
    }
    let size = options.batch_members.map_or_else(|| backend.batch_members(job), |m| Ok(m.next_multiple_of(256)))?;
    let mut kept = Instant::now();
    while state.next_member < job.members {
        let end = job.members.min(state.next_member.saturating_add(size));
        let batch = Batch { job, members: state.next_member..end, bins: &state.bins, progress: &|done| bar.inc(done) };
        let Some(partials) = backend.run(&batch)? else {
            bar.abandon();
            if let Some(path) = &options.state {
                state.write(path)?;
            }
            return Err(interrupted(options));
        };
        state.add(&partials, end);
        // For those who are not asked to stop but killed.
        if let Some(path) = options.state.as_ref().filter(|_| kept.elapsed() > KEEP_EVERY) {
            state.write(path)?;
            kept = Instant::now();
        }
    }
    bar.finish_and_clear();
    if let Some(path) = options.state.as_ref().filter(|p| p.exists()) {
        std::fs::remove_file(path).map_err(|e| Error::io("remove", path, &e))?;
    }
    Ok(Statistics {
        members: job.members,
        failed: state.reports.last().map_or(0, |r| r.failed),
        time_s: times_s(job),
        at: state
            .reports
            .iter()
            .map(|r| std::array::from_fn(|q| Summary::of(&r.moments[q], r.histograms[q].clone())))
            .collect(),
        member_steps: job.member_steps(),
        seconds: begun.elapsed().as_secs_f64(),
        machine,
    })
}

/// Report times of a job, s.
pub fn times_s(job: &Job) -> Vec<f64> {
    let sample_s = job.clock.sample_s();
    job.clock.report_samples.iter().map(|&n| n as f64 * sample_s).collect()
}

/// Bins from the first members, always on the CPU: the same for every backend of the same precision.
fn pilot(job: &Job, options: &Options) -> Result<Option<Vec<[Bins; 4]>>> {
    let mut cpu = Cpu { precision: options.precision, ..Cpu::default() };
    let batch = Batch { job, members: 0..job.members.min(PILOT), bins: &[], progress: &|_| () };
    let Some(partials) = cpu.run(&batch)? else { return Ok(None) };
    let bins = |partial: &Partial| {
        std::array::from_fn(|q| {
            let mut all = crate::statistics::Moments::default();
            partial.blocks.iter().for_each(|b| all.merge(&b[q]));
            Bins::around(&all)
        })
    };
    Ok(Some(partials.iter().map(bins).collect()))
}

fn interrupted(options: &Options) -> Error {
    let hint = match &options.state {
        Some(path) => format!("what was done is kept in {}: the same command with --resume goes on", path.display()),
        None => "run it again".to_owned(),
    };
    Error::interrupted("could not finish the simulation", hint)
}

/// Refuses jobs that cannot be.
fn check(job: &Job) -> Result<()> {
    let refuse = |cause: &str, hint: &str| Err(Error::new("could not simulate", cause, hint));
    let clock = &job.clock;
    if job.members == 0 {
        return refuse("there are no members", "ask for at least one");
    }
    if clock.samples == 0 || clock.steps_per_sample == 0 || clock.step_s.is_nan() || clock.step_s <= 0.0 {
        return refuse("the run has no samples, no steps or no step size", "lengthen duration_s or shorten step_s");
    }
    let ordered = clock.report_samples.windows(2).all(|w| w[0] < w[1]);
    let inside = clock.report_samples.iter().all(|&r| r >= 1 && r <= clock.samples);
    if clock.report_samples.is_empty() || !ordered || !inside {
        return refuse(
            "the report times do not increase, or lie outside the run",
            "give times between 0 and duration_s",
        );
    }
    let steps = job.steps_per_sample();
    if steps > u64::from(u32::MAX) {
        return refuse(
            &format!("a sample takes {steps} steps, and at most {} are counted", u32::MAX),
            "raise the sample rate, or leave a resonance so high out: it follows the force at once",
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
