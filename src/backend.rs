//! What integrates a batch of members and sums it up: the CPU's lanes and threads, or a GPU.
//!
//! Not for loops over batches, pilots or resuming: that is `ensemble`.

use std::ops::Range;

use crate::error::Result;
use crate::kernel::job::Job;
use crate::statistics::{Bins, Histogram, Machine, Moments};

pub mod cpu;
pub mod gpu;
pub mod misfits;
pub mod orbits;
pub mod tile;

/// Members of a job to integrate in one go.
pub struct Batch<'a> {
    /// The ensemble.
    pub job: &'a Job,
    /// Which members; begins at a multiple of 256.
    pub members: Range<u64>,
    /// Bins per report time and quantity; empty when only moments are wanted.
    pub bins: &'a [[Bins; 4]],
    /// Told how many member-samples were done since the last call.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// A batch at one report time.
#[derive(Debug, Clone, Default)]
pub struct Partial {
    /// Moments of each block of 256 members, in order.
    pub blocks: Vec<[Moments; 4]>,
    /// Counts per quantity; empty where no bins were given.
    pub histograms: Vec<Histogram>,
    /// Members that have failed by then.
    pub failed: u64,
}

/// Something that integrates batches.
pub trait Backend {
    /// What it is, for provenance.
    fn machine(&self, job: &Job) -> Machine;

    /// Members per batch that suit its memory and this job.
    ///
    /// # Errors
    /// Not even one block fits.
    fn batch_members(&self, job: &Job) -> Result<u64>;

    /// Integrates a batch; one partial per report time. `None` when the user asked to stop.
    ///
    /// # Errors
    /// A member that the integrator cannot step; a device that was lost.
    fn run(&mut self, batch: &Batch<'_>) -> Result<Option<Vec<Partial>>>;
}
