//! One part of a run on one backend, batch by batch: summed as it comes, kept when it is time,
//! stopped between two tiles.

use std::ops::Range;
use std::time::Instant;

use super::check::check;
use super::checkpoint::Keeper;
use super::options::Options;
use super::state::{Report, State};
use crate::backend::cpu::Cpu;
use crate::backend::{Backend, Batch, Partial, Ran};
use crate::control::{Control, Progress};
use crate::error::Result;
use crate::kernel::job::{Clock, Job};
use crate::statistics::{Bins, Moments, Statistics, Summary};

/// Members that set the bins of the histograms: always the same first ones.
const PILOT: u64 = 1024;

/// Integrates an ensemble on a given backend.
///
/// # Errors
/// As `run`.
pub fn run_on(job: &Job, backend: &mut dyn Backend, options: &Options) -> Result<Statistics> {
    run_kept(job, backend, options, &mut Keeper::none())
}

/// Integrates an ensemble on a given backend as the next part of a run whose sums are kept.
///
/// # Errors
/// As `run`, where the hint says how to go on; states that are damaged or belong to another run.
pub fn run_kept(job: &Job, backend: &mut dyn Backend, options: &Options, keeper: &mut Keeper) -> Result<Statistics> {
    run_part(job, backend, None, options, keeper)
}

/// Runs as [`run_kept`] does; `reason` says why on this backend, where another was tried first.
pub(super) fn run_part(
    job: &Job,
    backend: &mut dyn Backend,
    reason: Option<&str>,
    options: &Options,
    keeper: &mut Keeper,
) -> Result<Statistics> {
    let begun = Instant::now();
    check(job)?;
    keeper.begin(job, options.precision)?;
    integrate(job, backend, reason, options, keeper).map_err(|error| match backend.has_failed() {
        true => keeper.kept(error),
        false => error,
    })?;
    Ok(summed(job, keeper.part(), begun.elapsed().as_secs_f64()))
}

/// Runs as [`run_kept`] does; what `device` leaves undone because it fails, the CPU does from there
/// on. The report then says who did what, and why.
///
/// # Errors
/// As [`run_kept`], but for failures of the device.
pub fn run_or_fall_back(
    job: &Job,
    device: &mut dyn Backend,
    options: &Options,
    keeper: &mut Keeper,
) -> Result<Statistics> {
    let begun = Instant::now();
    check(job)?;
    keeper.begin(job, options.precision)?;
    if let Err(error) = integrate(job, device, None, options, keeper) {
        if !device.has_failed() {
            return Err(error);
        }
        let reason = format!("{} failed: {}", device.machine(job).name, error.cause);
        let done = keeper.part().next_member;
        options.control.remark(&format!("note: {reason}. The CPU continues from member {done} of {}.", job.members));
        let mut cpu = Cpu { precision: options.precision, ..Cpu::default() };
        integrate(job, &mut cpu, Some(&reason), options, keeper)?;
    }
    Ok(summed(job, keeper.part(), begun.elapsed().as_secs_f64()))
}

/// Takes the part of the run that was begun to its end.
fn integrate(
    job: &Job,
    backend: &mut dyn Backend,
    reason: Option<&str>,
    options: &Options,
    keeper: &mut Keeper,
) -> Result<()> {
    let samples = job.clock.samples;
    let (members, pilot) = (keeper.part().members.clone(), PILOT.min(job.members));
    if keeper.part().is_done() {
        return Ok(());
    }
    let length = (members.end - members.start + pilot).saturating_mul(samples);
    let watched = Watched { control: &options.control, progress: options.control.stage("simulating", length) };
    if keeper.part().bins.is_empty() {
        // Always on the CPU: the same for every backend of the same precision. And always of the
        // first members: the same for every shard.
        let mut cpu = Cpu { precision: options.precision, ..Cpu::default() };
        let partials = batch(job, &mut cpu, 0..pilot, keeper, &watched)?;
        keeper.part_mut().set_bins(partials.iter().map(bins).collect());
    }
    let machine = backend.machine(job);
    let size = options.batch_members.map_or_else(|| backend.batch_members(job), |m| Ok(m.next_multiple_of(256)))?;
    loop {
        let from = keeper.part().next_member;
        watched.progress.set((from - members.start + pilot).saturating_mul(samples));
        if from >= members.end {
            break;
        }
        let next = from..members.end.min(from.saturating_add(size));
        let partials = batch(job, backend, next, keeper, &watched)?;
        keeper.part_mut().add(&partials, &machine, reason);
        keeper.keep_if_due(&options.control);
    }
    Ok(())
}

/// Who watches a run, and how far it has come.
struct Watched<'a> {
    control: &'a Control,
    progress: Progress,
}

/// The next members, or those of a batch that was under way; kept when it is time, half-way through
/// a tile or not.
fn batch(
    job: &Job,
    backend: &mut dyn Backend,
    mut members: Range<u64>,
    keeper: &mut Keeper,
    watched: &Watched<'_>,
) -> Result<Vec<Partial>> {
    let Watched { control, progress } = watched;
    let machine = backend.machine(job);
    let bins = keeper.part().bins.clone();
    if let Some(unfinished) = keeper.part().under_way(&machine) {
        members = unfinished.members.clone();
        progress.add(unfinished.samples * (members.end - members.start));
    }
    loop {
        control.go_on().map_err(|s| keeper.stopped(s))?;
        let begun = Instant::now();
        let stop = || control.cancelled() || keeper.is_due_within(begun);
        let resume = keeper.part().under_way(&machine);
        let done = |samples| progress.add(samples);
        let ran =
            backend.run(&Batch { job, members: members.clone(), bins: &bins, resume, stop: &stop, progress: &done });
        keeper.part_mut().seconds += begun.elapsed().as_secs_f64();
        match ran? {
            Ran::Whole(partials) => {
                keeper.part_mut().set_under_way(None);
                return Ok(partials);
            }
            Ran::Part(unfinished) => {
                keeper.part_mut().set_under_way(Some((machine.clone(), unfinished)));
                keeper.keep_if_due(control);
            }
        }
    }
}

/// Bins around the moments of the pilot.
fn bins(partial: &Partial) -> [Bins; 4] {
    std::array::from_fn(|q| {
        let mut all = Moments::default();
        partial.blocks.iter().for_each(|b| all.merge(&b[q]));
        Bins::around(&all)
    })
}

/// Sums up all members of a job.
pub(super) fn summed(job: &Job, state: &State, seconds: f64) -> Statistics {
    let summaries = |report: &Report| {
        let moments = report.moments.total();
        std::array::from_fn(|q| Summary::of(&moments[q], report.histograms[q].clone()))
    };
    Statistics {
        members: job.members,
        failed: state.reports.last().map_or(0, |r| r.failed),
        time_s: times_s(job),
        at: state.reports.iter().map(summaries).collect(),
        member_steps: job.member_steps(),
        seconds,
        machine: state.machine(),
        origins: state.origins.clone(),
    }
}

/// Report times of a job, s, from the end of its still start.
pub fn times_s(job: &Job) -> Vec<f64> {
    let Clock { report_samples, still_samples, .. } = &job.clock;
    let sample_s = job.clock.sample_s();
    report_samples.iter().map(|&n| n.saturating_sub(*still_samples) as f64 * sample_s).collect()
}
