//! Which random numbers a study draws: under its seed those of each member's index, or, of some keys
//! or of the noise in the run, those of a second sample; or those of a chain of members.

use std::sync::Arc;

use crate::kernel::chained::{Chained, Once};
use crate::kernel::flight::axis_seed;
use crate::numerics::special::normal_cdf;
use crate::rng::{Stream, philox4x32_10};
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
    chained: Option<Arc<dyn Chained>>,
}

/// The seeds and the chain by which one member draws its numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct MemberSeeds<'a> {
    samples: [u64; 2],
    taken: Slots,
    chained: Option<&'a dyn Chained>,
    member: u64,
}

impl Seeds {
    /// One sample.
    pub fn one(seed: u64) -> Self {
        Self { samples: [seed, seed ^ APART], second: None, chained: None }
    }

    /// The same with what comes from the second one, and with the chain of which its members are.
    pub(super) fn with(self, second: Option<Second>, chained: Option<Arc<dyn Chained>>) -> Self {
        Self { second, chained, ..self }
    }

    /// The seeds of an axis.
    pub(super) fn along(&self, axis: usize) -> Self {
        Self { samples: self.samples.map(|seed| axis_seed(seed, axis as u64)), ..self.clone() }
    }

    /// The seed of the noise in the run.
    pub(super) fn in_run(&self) -> u64 {
        self.samples[usize::from(self.second.as_ref().is_some_and(|second| second.in_run))]
    }

    /// The chain of which its members are, if they are of one.
    pub(super) fn chained(&self) -> Option<Arc<dyn Chained>> {
        self.chained.clone()
    }

    /// Returns the seeds and the chain by which a member draws its numbers.
    pub(super) fn member(&self, member: u64) -> MemberSeeds<'_> {
        let taken = self.second.as_ref().map_or(0, |second| (second.taken)(member));
        MemberSeeds { samples: self.samples, taken, chained: self.chained.as_deref(), member }
    }
}

impl MemberSeeds<'_> {
    /// The probability of a lower value of a key than the member's, which makes its value; drawn
    /// apart for each of the axes and elements that share the key.
    pub(super) fn probability(&self, key: &Key, apart: u64) -> f64 {
        let seed = axis_seed(self.samples[((self.taken >> key.slot) & 1) as usize], apart);
        match self.chained {
            None => probability(key, seed, self.member),
            Some(chained) => {
                let number = Once { seed, counter: key.slot as u32, stream: Stream::Tolerance as u32 };
                normal_cdf(chained.once(number, self.member)).clamp(f64::MIN_POSITIVE, LARGEST)
            }
        }
    }
}

/// Largest number below 1.
const LARGEST: f64 = 1.0 - f64::EPSILON / 2.0;

/// Draws a number between 0 and 1, neither of which it is.
pub(super) fn probability(key: &Key, seed: u64, member: u64) -> f64 {
    let counter = [key.slot as u32, member as u32, (member >> 32) as u32, Stream::Tolerance as u32];
    uniform(philox4x32_10(counter, [seed as u32, (seed >> 32) as u32]))
}

/// The number between 0 and 1 that random words make: the middle of one of 2⁵³ cells.
pub fn uniform(words: [u32; 4]) -> f64 {
    let mantissa = (u64::from(words[1]) << 32 | u64::from(words[0])) >> 11;
    ((mantissa as f64 + 0.5) / (1u64 << 53) as f64).min(LARGEST)
}
