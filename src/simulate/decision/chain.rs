//! Members of an ensemble whose random numbers are a mixture of several members': states of a chain,
//! each of which keeps most of the last one's.
//!
//! A number that a member draws once (a tolerance, the start of a process) is the sum of the normal
//! numbers of several indices with weights whose squares add up to one. The noise in the run is cut
//! into blocks of samples, each of which is that of one index. So every state has the law of an
//! ordinary member, and what it drew is known by a few numbers.

use std::sync::{Arc, PoisonError, RwLock};

use crate::kernel::chained::{Chained, Once};
use crate::numerics::special::normal_quantile;
use crate::rng::{Stream, philox4x32_10};
use crate::study::second::uniform;

/// Blocks that a run's noise is cut into, where it has samples enough: of a walk, whose variance
/// grows as t³, the largest then makes 3/128 of the variance of a position at its end.
const BLOCKS: u64 = 128;
/// Samples that the kernels take at a time.
const STRETCH: u64 = 16;

/// Random numbers of one state.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Weights and indices of the numbers that it draws once.
    mix: Vec<(f64, u32)>,
    /// The index of each block of samples.
    blocks: Vec<u32>,
}

impl Link {
    /// An ordinary member whose run has this many blocks.
    pub fn independent(index: u32, blocks: u64) -> Self {
        Self { mix: vec![(1.0, index)], blocks: vec![index; blocks as usize] }
    }

    /// Keeps most of another's numbers: `kept` of each that is drawn once, and each block with that
    /// probability.
    pub fn moved(&self, kept: f64, index: u32, seed: u64) -> Self {
        let mut mix: Vec<(f64, u32)> = self.mix.iter().map(|(weight, of)| (kept * weight, *of)).collect();
        mix.push(((1.0 - kept * kept).sqrt(), index));
        let key = [seed as u32, (seed >> 32) as u32];
        let is_kept = |block: usize| uniform(philox4x32_10([block as u32, index, 0, Stream::Host as u32], key)) < kept;
        let blocks = self.blocks.iter().enumerate().map(|(i, of)| if is_kept(i) { *of } else { index }).collect();
        Self { mix, blocks }
    }
}

/// The states that the members of an ensemble are, in their order; while there are none, ordinary
/// members.
#[derive(Debug)]
pub struct Chain {
    links: RwLock<Arc<Vec<Link>>>,
    block_samples: u64,
}

impl Chain {
    /// An empty chain for runs of this many samples.
    pub fn new(samples: u64) -> Self {
        let block_samples = samples.div_ceil(BLOCKS).next_multiple_of(STRETCH);
        Self { links: RwLock::default(), block_samples }
    }

    /// Number of blocks in a run of this many samples.
    pub fn blocks(&self, samples: u64) -> u64 {
        samples.div_ceil(self.block_samples)
    }

    /// Replaces them all.
    pub fn set(&self, links: Vec<Link>) {
        *self.links.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(links);
    }

    /// Reads something of a member's state; `None` of ordinary members. A lane beyond the last
    /// state repeats it.
    fn read<R>(&self, member: u64, read: impl FnOnce(&Link) -> R) -> Option<R> {
        let links = self.links.read().unwrap_or_else(PoisonError::into_inner).clone();
        links.get(member as usize).or(links.last()).map(read)
    }
}

impl Chained for Chain {
    fn once(&self, number: Once, member: u64) -> f64 {
        let mixed = |link: &Link| link.mix.iter().map(|(weight, of)| weight * normal(number, u64::from(*of))).sum();
        self.read(member, mixed).unwrap_or_else(|| normal(number, member))
    }

    fn index(&self, member: u64, block: u64) -> u32 {
        let at = |link: &Link| link.blocks.get(block as usize).or(link.blocks.last()).copied();
        self.read(member, at).flatten().unwrap_or(member as u32)
    }

    fn block_samples(&self) -> u64 {
        self.block_samples
    }
}

/// The standard normal number of this name that a member draws.
fn normal(number: Once, member: u64) -> f64 {
    let Once { seed, counter, stream } = number;
    let counter = [counter, member as u32, (member >> 32) as u32, stream];
    normal_quantile(uniform(philox4x32_10(counter, [seed as u32, (seed >> 32) as u32])))
}
