//! From errors of members to partial sums: moments of each block of 256 members, counts in fixed bins. Twin of
//! `shaders/reduce.wgsl`.
//!
//! The block is fixed, whatever the tile, thread or lane: so results are the same bits for any of them.

use super::lanes::LANES;
use super::members::Snapshot;
use crate::statistics::{Histogram, Moments};

/// Members per block.
pub const BLOCK: usize = 256;

/// Moments of the four quantities over a block that has `members` members, without those that failed.
pub fn moments(block: &[Snapshot], members: usize) -> [Moments; 4] {
    std::array::from_fn(|q| Moments::of(values(block, members, q)))
}

/// Counts the members of a block.
pub fn count(block: &[Snapshot], members: usize, histograms: &mut [Histogram; 4]) {
    for (q, histogram) in histograms.iter_mut().enumerate() {
        values(block, members, q).for_each(|v| histogram.add(v));
    }
}

fn values(block: &[Snapshot], members: usize, quantity: usize) -> impl Iterator<Item = f64> + Clone {
    let lanes = block.iter().flat_map(move |s| (0..LANES).map(move |l| (s.values[quantity][l], s.failed[l])));
    lanes.take(members).filter(|(_, failed)| !failed).map(|(value, _)| value)
}
