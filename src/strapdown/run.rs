//! Flight × backend → statistics: the pilot that sets the bins, then batch after batch.
//!
//! Results depend neither on the batches nor on the threads: members are summed in blocks of 256, in order, and counts are
//! integers.

use std::time::Instant;

use crate::backend::flight::{FlightBackend, FlightBatch, FlightCpu, QUANTITIES, Quantity, Sums};
use crate::control::Control;
use crate::error::Result;
use crate::kernel::flight::Flight;
use crate::statistics::{Bins, Histogram, Machine, Moments, Summary};

/// Members that set the bins of the histograms: always the same first ones.
const PILOT: u64 = 1024;

/// An ensemble, summed up.
#[derive(Debug, Clone)]
pub struct Ensemble {
    /// Members asked for.
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
    /// Where.
    pub machine: Machine,
}

impl Ensemble {
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

/// Integrates a flight and sums it up.
///
/// # Errors
/// A member that the integrator cannot step; a device that was lost; stopped.
pub fn run(flight: &Flight, backend: &mut dyn FlightBackend, control: &Control) -> Result<Ensemble> {
    let begun = Instant::now();
    let members = flight.members();
    let pilot = members.min(PILOT);
    let progress = control.stage("simulating", (members + pilot).saturating_mul(flight.clock().samples));
    let batch = |on: &mut dyn FlightBackend, members, bins: &[[Bins; QUANTITIES]]| -> Result<Vec<Sums>> {
        let work = FlightBatch {
            flight,
            members,
            bins,
            stop: &|| control.cancelled(),
            progress: &|samples| progress.add(samples),
        };
        let sums = on.run(&work)?;
        let stopped = || control.go_on().map_err(|s| s.during("could not finish the simulation", "run it again"));
        match sums {
            Some(sums) => Ok(sums),
            None => stopped().map(|()| Vec::new()),
        }
    };
    // Always on the CPU: the same for every backend.
    let bins: Vec<[Bins; QUANTITIES]> = batch(&mut FlightCpu::default(), 0..pilot, &[])?.iter().map(bins).collect();
    let mut totals: Vec<Sums> = Vec::new();
    let mut from = 0;
    while from < members {
        let until = members.min(from + backend.batch_members());
        let sums = batch(backend, from..until, &bins)?;
        if totals.is_empty() {
            totals = sums;
        } else {
            totals.iter_mut().zip(sums).for_each(|(total, part)| add(total, part));
        }
        from = until;
    }
    let clock = flight.clock();
    let sample_s = clock.sample_s();
    Ok(Ensemble {
        members,
        failed: totals.last().map_or(0, |t| t.failed),
        time_s: clock.report_samples.iter().map(|n| (n - clock.still_samples) as f64 * sample_s).collect(),
        at: totals.iter().map(summed).collect(),
        member_steps: flight.member_steps(),
        seconds: begun.elapsed().as_secs_f64(),
        machine: backend.machine(flight),
    })
}

/// The moments of all blocks, merged in order.
fn moments(sums: &Sums) -> [Moments; QUANTITIES] {
    let mut all = [Moments::default(); QUANTITIES];
    sums.blocks.iter().for_each(|block| all.iter_mut().zip(block).for_each(|(mine, theirs)| mine.merge(theirs)));
    all
}

/// Bins around the moments of the pilot.
fn bins(sums: &Sums) -> [Bins; QUANTITIES] {
    moments(sums).map(|m| Bins::around(&m))
}

fn add(total: &mut Sums, part: Sums) {
    total.blocks.extend(part.blocks);
    total.failed += part.failed;
    total.histograms.iter_mut().zip(&part.histograms).for_each(|(mine, theirs)| mine.merge(&theirs.counts));
}

fn summed(sums: &Sums) -> [Summary; QUANTITIES] {
    let all = moments(sums);
    let none = || Histogram::new(Bins::around(&Moments::default()));
    std::array::from_fn(|q| Summary::of(&all[q], sums.histograms.get(q).cloned().unwrap_or_else(none)))
}
