//! Random numbers of members that are not those of their index: members of a chain, each of which
//! differs a little from the one before, see `decision::risk` of the crate that simulates.

use std::fmt::Debug;

/// Name of a number that a member draws once: of a tolerance, of the start of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Once {
    /// Seed of the study, or of one of its axes.
    pub seed: u64,
    /// First word of its counter.
    pub counter: u32,
    /// Stream, the last word of its counter.
    pub stream: u32,
}

/// Source of the random numbers of members of a chain.
pub trait Chained: Debug + Send + Sync {
    /// A standard normal number that a member draws once.
    fn once(&self, number: Once, member: u64) -> f64;

    /// Index under which a member draws its noise during a block of samples.
    fn index(&self, member: u64, block: u64) -> u32;

    /// Samples of a block: a multiple of 16, the samples that the kernels take at a time.
    fn block_samples(&self) -> u64;
}
