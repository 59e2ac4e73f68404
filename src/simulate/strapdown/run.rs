//! Flight × backend → statistics: the pilot that sets the bins, then batch after batch.
//!
//! Results depend neither on the batches nor on the threads nor on where a run was stopped: see
//! `totals` and `kept`.

use std::time::Instant;

use super::kept::{Kept, Progress};
use super::totals::Totals;
use crate::backend::flight::{FlightBackend, FlightBatch, FlightCpu, QUANTITIES, Quantity};
use crate::control::Control;
use crate::error::Result;
use crate::kernel::cpu::lanes::LANES;
use crate::kernel::cpu::reduce::BLOCK;
use crate::kernel::flight::Flight;
use crate::parallel;
use crate::statistics::{Bins, Machine, Summary};

/// Members that set the bins of the histograms: always the same first ones.
const PILOT: u64 = 1024;

/// An ensemble, summed up.
#[derive(Debug, Clone)]
pub struct Ensemble {
    /// Number of members asked for.
    pub members: u64,
    /// Members that left the range of numbers by the end.
    pub failed: u64,
    /// Report times, s, from the end of the still start.
    pub time_s: Vec<f64>,
    /// Summaries of every quantity per report time.
    at: Vec<[Summary; QUANTITIES]>,
    /// Samples integrated, over all members.
    pub member_steps: u64,
    /// Wall time, s.
    pub seconds: f64,
    /// Backend that computed them.
    pub machine: Machine,
}

impl Ensemble {
    /// All members of a flight, from their sums.
    pub(super) fn of(flight: &Flight, totals: &Totals, machine: Machine, seconds: f64) -> Self {
        let clock = flight.clock();
        let time_s = |n: &u64| (n - clock.still_samples) as f64 * clock.sample_s();
        Self {
            members: flight.members(),
            failed: totals.failed(),
            time_s: clock.report_samples.iter().map(time_s).collect(),
            at: totals.summed(),
            member_steps: flight.member_steps(),
            seconds,
            machine,
        }
    }

    /// Summary of a quantity at a report time.
    pub fn summary(&self, report: usize, quantity: Quantity) -> &Summary {
        &self.at[report][quantity.place()]
    }

    /// Covariance of the north and east position errors at a report time, m².
    pub fn north_east_m2(&self, report: usize) -> f64 {
        let variance = |quantity| self.summary(report, quantity).sd.powi(2);
        0.5 * (variance(Quantity::NorthPlusEast) - variance(Quantity::Position(0)) - variance(Quantity::Position(1)))
    }
}

/// Fewest members of a batch on which the threads of a small machine are busy.
const LEAST_MEMBERS: u64 = 1024;
/// Member-samples of a batch, so that what a stop loses is some ten seconds of two cores.
const BATCH_STEPS: u64 = 1 << 30;

/// Integrates a flight and sums it up, going on with what was kept of it.
///
/// # Errors
/// A member that the integrator cannot step; a device that was lost; a state that cannot be gone on
/// with; stopped.
pub fn run(flight: &Flight, backend: &mut dyn FlightBackend, kept: &mut Kept, control: &Control) -> Result<Ensemble> {
    let (so_far, machine) = integrate(flight, backend, kept, control)?;
    Ok(Ensemble::of(flight, &so_far.totals, machine, so_far.seconds))
}

/// Integrates the members that the keeper says, all or a shard's, going on with what was kept of
/// them.
///
/// # Errors
/// As [`run`].
pub(super) fn integrate(
    flight: &Flight,
    backend: &mut dyn FlightBackend,
    kept: &mut Kept,
    control: &Control,
) -> Result<(Progress, Machine)> {
    let begun = Instant::now();
    let (members, machine) = (kept.members(flight), backend.machine(flight));
    let pilot = if members.is_empty() { 0 } else { flight.members().min(PILOT) };
    let mut so_far = kept.begin(flight, &machine)?;
    let before_s = so_far.seconds;
    let work = members.end - members.start + pilot;
    let progress = control.stage("simulating", work.saturating_mul(flight.clock().samples));
    let batch = |on: &mut dyn FlightBackend, members, bins: &[[Bins; QUANTITIES]]| {
        let work = FlightBatch {
            flight,
            members,
            bins,
            stop: &|| control.cancelled(),
            progress: &|samples| progress.add(samples),
        };
        on.run(&work)
    };
    if so_far.totals.is_empty() && pilot > 0 {
        // Always on the CPU, and the same members: the same bins for every backend and every shard.
        let sums = batch(&mut FlightCpu::default(), 0..pilot, &[])?;
        control.go_on().map_err(|by| kept.stopped(flight, &machine, &so_far, by))?;
        so_far.totals = Totals::new(&sums.unwrap_or_default());
    } else {
        progress.add((pilot + so_far.next_member - members.start).saturating_mul(flight.clock().samples));
    }
    let bins = so_far.totals.bins();
    let least = LEAST_MEMBERS.max(2 * LANES as u64 * parallel::threads() as u64);
    let most = (BATCH_STEPS / flight.clock().samples.max(1)).max(least).next_multiple_of(BLOCK as u64);
    while so_far.next_member < members.end {
        let from = so_far.next_member;
        let until = members.end.min(from + backend.batch_members().min(most));
        let sums = batch(backend, from..until, &bins)?;
        so_far.seconds = before_s + begun.elapsed().as_secs_f64();
        let Some(sums) = sums else {
            control.go_on().map_err(|by| kept.stopped(flight, &machine, &so_far, by))?;
            continue;
        };
        so_far.totals.add(from, &sums);
        so_far.next_member = until;
        kept.keep_if_due(flight, &machine, &so_far, control);
    }
    so_far.seconds = before_s + begun.elapsed().as_secs_f64();
    kept.finish(flight, &machine, &so_far)?;
    Ok((so_far, machine))
}
