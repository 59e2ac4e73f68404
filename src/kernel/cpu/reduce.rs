//! From errors of members to partial sums: moments of each block of 256 members, counts in fixed
//! bins. Twin of `shaders/reduce.wgsl`.
//!
//! The block is fixed, whatever the tile, thread or lane: so results are the same bits for any of
//! them.

use super::lanes::LANES;
use super::members::Snapshot;
use crate::statistics::{Histogram, Moments};

/// Members per block.
pub const BLOCK: usize = 256;

/// Moments of the four quantities over a block that has `members` members, without those that
/// failed.
pub fn moments(block: &[Snapshot], members: usize) -> [Moments; 4] {
    Moments::of_each(rows(block, members))
}

/// Counts the members of a block.
pub fn count(block: &[Snapshot], members: usize, histograms: &mut [Histogram; 4]) {
    rows(block, members).for_each(|row| histograms.iter_mut().zip(row).for_each(|(h, v)| h.add(v)));
}

fn rows(block: &[Snapshot], members: usize) -> impl Iterator<Item = [f64; 4]> + Clone {
    let lanes = block.iter().flat_map(|s| (0..LANES).map(move |l| (s, l))).take(members);
    lanes.filter(|(s, l)| !s.failed[*l]).map(|(s, l)| std::array::from_fn(|q| s.values[q][l]))
}
