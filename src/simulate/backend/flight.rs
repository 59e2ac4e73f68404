//! Six-axis ensembles on the CPU: lanes × threads, as `cpu` has them for one axis.
//!
//! What every member is summed to stands here as well. Not for batches, pilots or progress over
//! them: that is `strapdown`.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use super::cpu::{Precision, column, machine};
use super::tile;
use crate::control::Control;
use crate::error::Result;
use crate::kernel::cpu::imu::{Imu, Row, Tile};
use crate::kernel::cpu::lanes::{LANES, Level};
use crate::kernel::cpu::members::{Members, Shared};
use crate::kernel::cpu::reduce::BLOCK;
use crate::kernel::flight::Flight;
use crate::kernel::force;
use crate::kernel::job::Job;
use crate::numerics::elementary::Real;
use crate::parallel;
use crate::statistics::{Bins, Histogram, Machine, Moments};

/// Quantities that are summed of every member at every report time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Position error along an axis of north-east-down, m.
    Position(usize),
    /// Velocity error along one, m/s.
    Velocity(usize),
    /// Attitude error: roll, pitch, heading, rad.
    Attitude(usize),
    /// Horizontal distance from the truth, m.
    Horizontal,
    /// Distance from the truth, m.
    Spherical,
    /// North plus east position error, m: its variance holds their covariance.
    NorthPlusEast,
}

/// Number of quantities that are summed.
pub const QUANTITIES: usize = 12;

impl Quantity {
    /// Its place in a row of sums.
    pub const fn place(self) -> usize {
        match self {
            Self::Position(axis) => axis,
            Self::Velocity(axis) => 3 + axis,
            Self::Attitude(axis) => 6 + axis,
            Self::Horizontal => 9,
            Self::Spherical => 10,
            Self::NorthPlusEast => 11,
        }
    }
}

/// Quantities of one member that are summed.
pub type Outcome = [f64; QUANTITIES];

/// The errors of these members themselves at each report time of the flight, in f32, in their order; NaN of those that
/// have failed. The range begins at a multiple of 256; `progress` gets the number of member-samples done
/// since the last call.
///
/// # Errors
/// A member that the integrator cannot step; stopped.
pub fn outcomes(
    flight: &Flight,
    members: Range<u64>,
    control: &Control,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Vec<Vec<Outcome>>> {
    let reports = flight.clock().report_samples.len();
    let last = AtomicBool::new(false);
    let mut outcomes = vec![Vec::new(); reports];
    let stop = || control.cancelled() || last.load(Ordering::Relaxed);
    let batch = FlightBatch { flight, members, bins: &[], stop: &stop, progress };
    FlightCpu::default().integrate::<f32>(&batch, |at, rows| {
        let outcome = |row: &Option<Row>| row.as_ref().map_or([f64::NAN; QUANTITIES], quantities);
        outcomes[at].extend(rows.iter().map(outcome));
        // What comes after the last report is not needed.
        last.store(at + 1 == reports, Ordering::Relaxed);
    })?;
    if !last.into_inner() {
        control.go_on().map_err(|s| s.during("could not finish the simulation", "run it again"))?;
    }
    Ok(outcomes)
}

fn quantities(row: &Row) -> Outcome {
    let [north, east, down, ..] = *row;
    let square = north * north + east * east;
    let mut all = [0.0; QUANTITIES];
    all[..9].copy_from_slice(row);
    all[Quantity::Horizontal.place()] = square.sqrt();
    all[Quantity::Spherical.place()] = (square + down * down).sqrt();
    all[Quantity::NorthPlusEast.place()] = north + east;
    all
}

/// A batch at one report time.
#[derive(Debug, Clone, Default)]
pub struct Sums {
    /// Moments of each block of 256 members, in order.
    pub blocks: Vec<[Moments; QUANTITIES]>,
    /// Counts per quantity; empty where no bins were given.
    pub histograms: Vec<Histogram>,
    /// Members that have failed by then.
    pub failed: u64,
}

impl Sums {
    /// Sums up members in their order; a row is missing where one failed.
    pub fn of(rows: &[Option<Row>], bins: Option<&[Bins; QUANTITIES]>) -> Self {
        // Counts are integers, and blocks keep their order: the same for any number of threads.
        let share = rows.len().div_ceil(BLOCK).div_ceil(parallel::threads()).max(1) * BLOCK;
        let parts = parallel::map_chunks(rows, share, |_, rows| Self::of_share(rows, bins));
        let mut sums = Self::default();
        for part in parts {
            sums.failed += part.failed;
            sums.blocks.extend(part.blocks);
            if sums.histograms.is_empty() {
                sums.histograms = part.histograms;
            } else {
                sums.histograms.iter_mut().zip(&part.histograms).for_each(|(mine, theirs)| mine.merge(&theirs.counts));
            }
        }
        sums
    }

    fn of_share(rows: &[Option<Row>], bins: Option<&[Bins; QUANTITIES]>) -> Self {
        let mut sums =
            Self { histograms: bins.map_or_else(Vec::new, |b| b.map(Histogram::new).into()), ..Self::default() };
        for block in rows.chunks(BLOCK) {
            let there: Vec<Outcome> = block.iter().flatten().map(quantities).collect();
            sums.blocks.push(Moments::of_each(there.iter().copied()));
            sums.failed += (block.len() - there.len()) as u64;
            for (q, histogram) in sums.histograms.iter_mut().enumerate() {
                there.iter().for_each(|row| histogram.add(row[q]));
            }
        }
        sums
    }
}

/// Members of a flight to integrate in one go.
pub struct FlightBatch<'a> {
    /// The ensemble that the members belong to.
    pub flight: &'a Flight,
    /// Range of members; begins at a multiple of 256.
    pub members: Range<u64>,
    /// Bins per report time; empty when only moments are wanted.
    pub bins: &'a [[Bins; QUANTITIES]],
    /// Asked after each tile whether to stop there.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Told how many member-samples were done since the last call.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// The CPU backend of six-axis ensembles.
#[derive(Debug, Clone, Copy)]
pub struct FlightCpu {
    /// Precision of the state.
    pub precision: Precision,
    /// Instruction set of the lanes.
    pub level: Level,
    /// Most samples per tile.
    pub tile_samples: u64,
}

impl Default for FlightCpu {
    fn default() -> Self {
        Self { precision: Precision::F32, level: Level::best(), tile_samples: 512 }
    }
}

/// Substeps of an axis tabulated at a time.
const MOST_SUBSTEPS: u64 = 8192;

/// A device that integrates batches of a six-axis ensemble.
pub trait FlightBackend {
    /// The machine it integrates on, for provenance.
    fn machine(&self, flight: &Flight) -> Machine;

    /// Members per batch that suit it.
    fn batch_members(&self) -> u64;

    /// Integrates a batch; nothing where it was stopped.
    ///
    /// # Errors
    /// A member that the integrator cannot step; a device that was lost.
    fn run(&mut self, batch: &FlightBatch<'_>) -> Result<Option<Vec<Sums>>>;

    /// Returns whether the device itself has failed.
    fn has_failed(&self) -> bool {
        false
    }
}

impl FlightBackend for FlightCpu {
    fn machine(&self, flight: &Flight) -> Machine {
        machine(self.precision, self.level, flight.axes[0].integrator)
    }

    fn batch_members(&self) -> u64 {
        8192
    }

    fn run(&mut self, batch: &FlightBatch<'_>) -> Result<Option<Vec<Sums>>> {
        let mut reports = Vec::new();
        let sum = |at: usize, rows: &[Option<Row>]| reports.push(Sums::of(rows, batch.bins.get(at)));
        let done = match self.precision {
            Precision::F32 => self.integrate::<f32>(batch, sum)?,
            Precision::F64 => self.integrate::<f64>(batch, sum)?,
        };
        Ok(done.then_some(reports))
    }
}

impl FlightCpu {
    /// Integrates a batch and hands over the members' errors at every report time; `false` where it
    /// was stopped.
    ///
    /// # Errors
    /// A member that the integrator cannot step.
    pub fn integrate<T: Real>(
        &self,
        batch: &FlightBatch<'_>,
        mut report: impl FnMut(usize, &[Option<Row>]),
    ) -> Result<bool> {
        let flight = batch.flight;
        let clock = flight.clock();
        let shared = flight.axes.each_ref().map(Shared::<T>::of);
        let size = batch.members.end - batch.members.start;
        let starts: Vec<u64> = batch.members.clone().step_by(LANES).collect();
        let mut groups =
            parallel::map(&starts, |first| draw::<T>(flight, *first, batch.members.end, shared[0].flicker.len()))
                .into_iter()
                .collect::<Result<Vec<Imu<T>>>>()?;
        let substeps = shared.iter().map(|s| u64::from(s.substeps)).max().unwrap_or(1);
        let most = self.tile_samples.min(MOST_SUBSTEPS / substeps).max(4);
        let mut from = 0;
        while let Some(next) = tile::next(clock, from, most) {
            let (first, count) = (next.samples.start, next.samples.end - next.samples.start);
            let force = flight.axes.each_ref().map(|job| force::table::<T>(job, first, count));
            let late = flight.axes.each_ref().map(|job| force::late::<T>(job, first, count));
            let passages = match first.checked_sub(clock.still_samples) {
                Some(passed) => flight.course.table::<T>(passed, count),
                None => Vec::new(),
            };
            let warmer = flight.axes[0].warmer_k::<T>(first, count);
            let (force, late, warmer, passages) = (&force, &late, &warmer[..], &passages[..]);
            let tile = Tile { flight, shared: &shared, force, late, warmer, passages, first, count };
            parallel::for_each_mut(&mut groups, |_, group| group.run(&tile, self.level));
            from = next.samples.end;
            (batch.progress)(count * size);
            if let Some(at) = next.report {
                let snapshots = parallel::map(&groups, |group| group.snapshot(flight, from));
                let mut rows: Vec<Option<Row>> = snapshots.into_iter().flatten().collect();
                rows.truncate(size as usize);
                report(at, &rows);
            }
            if from < clock.samples && (batch.stop)() {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The 64 members from `first` on, below `end`.
fn draw<T: Real>(flight: &Flight, first: u64, end: u64, flicker_terms: usize) -> Result<Imu<T>> {
    let axis = |job: &Job| -> Result<Box<Members<T>>> {
        let mut members = Members::new(job.seed, first..end, flicker_terms, |i| column(job, i))?;
        members.chain(job.chained.as_ref());
        Ok(members)
    };
    let [x, y, z] = &flight.axes;
    Ok(Imu::new(flight, first, [axis(x)?, axis(y)?, axis(z)?]))
}
