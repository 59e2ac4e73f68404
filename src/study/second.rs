//! A second sample of a study's random numbers: the same members with the draws of some keys, or with
//! the noise in the run, under another seed.

use std::sync::Arc;

use crate::kernel::flight::axis_seed;
use crate::units::key::{Key, SLOTS};

/// Keys by their slots, a bit each.
pub type Slots = u128;

const _: () = assert!(SLOTS <= Slots::BITS as usize, "there are more slots than bits");

/// Parts the seeds of the two samples: the fraction of √2 in 64 bits. No multiple of the constant
/// by which the seeds of axes differ (`kernel::flight::axis_seed`) comes near.
const APART: u64 = 0x6A09_E667_F3BC_C908;

/// Finds the keys that a member draws from the second sample, by slot.
pub type Taken = Arc<dyn Fn(u64) -> Slots + Send + Sync>;

/// The part of a study's random numbers that comes from the second sample.
#[derive(Clone)]
pub struct Second {
    /// Keys of each member whose draws do.
    pub taken: Taken,
    /// Says whether the noise in the run does, and what a start draws.
    pub in_run: bool,
}

/// The seeds under which a study draws.
#[derive(Clone)]
pub struct Seeds {
    samples: [u64; 2],
    second: Option<Second>,
}

/// The seeds under which one member draws.
#[derive(Debug, Clone, Copy)]
pub(super) struct MemberSeeds {
    samples: [u64; 2],
    taken: Slots,
}

impl Seeds {
    /// One sample.
    pub fn one(seed: u64) -> Self {
        Self { samples: [seed, seed ^ APART], second: None }
    }

    /// The same with what comes from the second one.
    pub(super) fn with(self, second: Option<Second>) -> Self {
        Self { second, ..self }
    }

    /// The seeds of an axis.
    pub(super) fn along(&self, axis: usize) -> Self {
        Self { samples: self.samples.map(|seed| axis_seed(seed, axis as u64)), second: self.second.clone() }
    }

    /// The seed of the noise in the run.
    pub(super) fn in_run(&self) -> u64 {
        self.samples[usize::from(self.second.as_ref().is_some_and(|second| second.in_run))]
    }

    /// The seeds of a member's draws.
    pub(super) fn member(&self, member: u64) -> MemberSeeds {
        MemberSeeds { samples: self.samples, taken: self.second.as_ref().map_or(0, |second| (second.taken)(member)) }
    }
}

impl MemberSeeds {
    /// The seed under which it draws a key.
    pub(super) fn of(&self, key: &Key) -> u64 {
        self.samples[((self.taken >> key.slot) & 1) as usize]
    }
}
