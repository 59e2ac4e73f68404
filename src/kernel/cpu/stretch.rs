//! The random numbers of a few consecutive samples of 64 members, drawn for one purpose after the other.

use std::ops::Range;

use super::lanes::{Lane, Level};
use super::noise::{Draw, Drawer, stream};
use crate::numerics::elementary::Real;
use crate::rng::Stream;

/// Samples that go through a phase together: few enough that their numbers stay in the first-level cache, enough that
/// calling a phase costs nothing. A multiple of the four samples that share a counter, and a divisor of `sums::CHUNK`.
pub(crate) const STRETCH: usize = 16;

/// Samples `from` to `until`, all of one stretch, and the room for their numbers.
pub(crate) struct Numbers<'a, T> {
    pub level: Level,
    pub drawer: Drawer,
    pub from: u64,
    /// The sample after the last.
    pub until: u64,
    /// Room for one number a sample.
    pub each: &'a mut [Lane<T>; STRETCH],
    /// Room for two numbers for each four samples.
    pub pairs: &'a mut [Lane<T>; STRETCH / 2],
}

impl<T: Real> Numbers<'_, T> {
    /// Draws one number a sample and says where in `each` they are.
    pub(crate) fn renew(&mut self, purpose: Stream) -> Range<usize> {
        let (first, last) = (self.from >> 2, (self.until - 1) >> 2);
        let counters = (last - first + 1) as usize;
        let out = &mut self.each[..4 * counters];
        self.level.run(Draw { drawer: self.drawer, stream: stream(purpose, 0), counter: first as u32, each: 4, out });
        let skipped = (self.from & 3) as usize;
        skipped..skipped + (self.until - self.from) as usize
    }

    /// Draws one number a sample.
    pub(crate) fn each(&mut self, purpose: Stream) -> &[Lane<T>] {
        let range = self.renew(purpose);
        &self.each[range]
    }

    /// Draws two numbers for each of `counters` counters from `counter` on, into `pairs`.
    pub(crate) fn pairs(&mut self, purpose: Stream, term: usize, counter: u64, counters: usize) {
        let out = &mut self.pairs[..2 * counters];
        let stream = stream(purpose, term);
        self.level.run(Draw { drawer: self.drawer, stream, counter: counter as u32, each: 2, out });
    }
}
