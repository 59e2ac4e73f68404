//! Random numbers of 64 members of a chain.

use std::sync::Arc;

use super::lanes::{LANES, Lane};
use super::noise::Drawer;
use crate::chained::{Chained, Once};
use crate::numerics::elementary::Real;

/// Source of the numbers of 64 members.
#[derive(Debug, Clone)]
pub(super) struct Own {
    pub chained: Arc<dyn Chained>,
    /// The first of them.
    pub first: u64,
    /// Block of samples whose indices they draw under.
    pub block: Option<u64>,
}

impl Own {
    /// Sets the indices under which they draw, if another block of samples begins at `from`.
    pub(super) fn renumber(&mut self, drawer: &mut Drawer, from: u64) {
        let block = from / self.chained.block_samples();
        if self.block != Some(block) {
            self.block = Some(block);
            (0..LANES).for_each(|l| drawer.low[l] = self.chained.index(self.first + l as u64, block));
        }
    }

    /// The number that each draws once.
    pub(super) fn once<T: Real>(&self, number: Once) -> Lane<T> {
        let mut lanes = Lane::splat(T::of(0.0));
        (0..LANES).for_each(|l| lanes[l] = T::of(self.chained.once(number, self.first + l as u64)));
        lanes
    }
}
