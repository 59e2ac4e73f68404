//! Integrates a batch of members and sums it up: the CPU's lanes and threads, or a GPU.
//!
//! Not for loops over batches, pilots or resuming: that is `ensemble`.

use std::ops::Range;

use crate::error::Result;
use crate::kernel::job::Job;
use crate::statistics::{Bins, Machine};

pub mod adapter;
pub mod cpu;
pub mod flight;
#[cfg(feature = "gpu")]
pub mod gpu;
#[cfg(not(feature = "gpu"))]
#[path = "backend/gpu/absent.rs"]
pub mod gpu;
pub mod orbits;
pub mod partial;
pub mod tile;

pub(crate) use partial::{Partial, Unfinished};

/// Members of a job to integrate in one go.
pub struct Batch<'a> {
    /// The ensemble that the members belong to.
    pub job: &'a Job,
    /// Range of members; begins at a multiple of 256.
    pub members: Range<u64>,
    /// Bins per report time and quantity; empty when only moments are wanted.
    pub bins: &'a [[Bins; 4]],
    /// A state between two tiles of this batch to go on from; ignored where it is not one of this
    /// backend.
    pub resume: Option<&'a Unfinished>,
    /// Asked after each tile whether to stop there.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Told how many member-samples were done since the last call.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

impl<'a> Batch<'a> {
    /// Members of a job from their beginning to the end, without bins.
    pub fn whole(job: &'a Job, members: Range<u64>) -> Self {
        Self { job, members, bins: &[], resume: None, stop: &|| false, progress: &|_| () }
    }
}

/// Progress of a batch.
#[derive(Debug, Clone)]
pub enum Ran {
    /// To its end: one partial per report time.
    Whole(Vec<Partial>),
    /// To a tile after which it was asked to stop.
    Part(Unfinished),
}

/// A device that integrates batches of an ensemble.
pub trait Backend {
    /// The machine it integrates on, for provenance.
    fn machine(&self, job: &Job) -> Machine;

    /// Members per batch that suit its memory and this job: as few as keep it busy where each is
    /// much work, so that what is done is summed up every few seconds.
    ///
    /// # Errors
    /// Not even one block fits.
    fn batch_members(&self, job: &Job) -> Result<u64>;

    /// Integrates a batch, or at least its next tile.
    ///
    /// # Errors
    /// A member that the integrator cannot step; a device that was lost.
    fn run(&mut self, batch: &Batch<'_>) -> Result<Ran>;

    /// Returns whether the device itself has failed, so that another backend may do what this one
    /// could not.
    fn has_failed(&self) -> bool {
        false
    }
}
