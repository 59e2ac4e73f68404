//! The random numbers of a few consecutive samples of 64 members, drawn for one purpose after the
//! other.

use std::ops::Range;

use super::lanes::{Lane, Level};
use super::noise::{Draw, DrawSamples, Drawer, stream};
use super::own::Own;
use crate::chained::Once;
use crate::numerics::elementary::Real;
use crate::rng::Stream;

/// Samples that go through a phase together: few enough that their numbers stay in the first-level
/// cache, enough that calling a phase costs nothing. A multiple of the four samples that share a
/// counter, and a divisor of `sums::CHUNK`.
pub(crate) const STRETCH: usize = 16;

/// Room for the numbers of a stretch.
pub(crate) struct Room<T> {
    /// Numbers of the stretch, one for each sample.
    each: [Lane<T>; STRETCH],
    /// Two for the stretch.
    pair: [Lane<T>; 2],
    /// The bits left over, of each four samples.
    bits: [Lane<u32>; STRETCH / 4],
}

impl<T: Real> Room<T> {
    /// Nothing drawn yet.
    pub(crate) fn new() -> Self {
        let zero = Lane::splat(T::of(0.0));
        Self { each: [zero; STRETCH], pair: [zero; 2], bits: [Lane::splat(0); STRETCH / 4] }
    }
}

/// Samples `from` to `until`, all of one stretch, and the room for their numbers.
pub(crate) struct Numbers<'a, T> {
    pub level: Level,
    pub drawer: Drawer,
    /// Source of the numbers that a member draws once, if it is not the index under which it draws.
    pub(super) own: Option<&'a Own>,
    pub from: u64,
    /// The sample after the last.
    pub until: u64,
    pub room: &'a mut Room<T>,
    /// Stream whose left-over bits are in `room`; none before any are drawn.
    pub bits_of: Option<Stream>,
}

impl<T: Real> Numbers<'_, T> {
    /// First counter and how many.
    fn counters(&self) -> (u32, usize) {
        let (first, last) = (self.from >> 2, (self.until - 1) >> 2);
        (first as u32, (last - first + 1) as usize)
    }

    /// Returns the place of the samples among those of their counters.
    fn samples(&self) -> Range<usize> {
        let skipped = (self.from & 3) as usize;
        skipped..skipped + (self.until - self.from) as usize
    }

    /// Draws one number a sample.
    pub(crate) fn each(&mut self, purpose: Stream) -> &[Lane<T>] {
        let (counter, counters) = self.counters();
        let out = &mut self.room.each[..4 * counters];
        self.level.run(Draw { drawer: self.drawer, stream: stream(purpose, 0), counter, each: 4, out });
        &self.room.each[self.samples()]
    }

    /// Draws one number a sample, and the bits that these leave.
    pub(crate) fn each_and_bits(&mut self, purpose: Stream) -> &[Lane<T>] {
        self.draw(purpose, 4);
        &self.room.each[self.samples()]
    }

    /// The bits of each four samples that share a counter, from that of the first on, drawn unless
    /// they are there.
    pub(crate) fn bits(&mut self, purpose: Stream) -> &[Lane<u32>] {
        if self.bits_of != Some(purpose) {
            self.draw(purpose, 0);
        }
        &self.room.bits
    }

    fn draw(&mut self, purpose: Stream, each: usize) {
        let (counter, counters) = self.counters();
        let Room { each: numbers, bits, .. } = &mut *self.room;
        let (numbers, bits) = (&mut numbers[..each * counters], &mut bits[..counters]);
        let stream = stream(purpose, 0);
        self.level.run(DrawSamples { drawer: self.drawer, stream, counter, numbers, bits });
        self.bits_of = Some(purpose);
    }

    /// Draws the first two numbers of one counter.
    pub(crate) fn pair(&mut self, purpose: Stream, term: usize, counter: u64) -> &[Lane<T>; 2] {
        let out = &mut self.room.pair;
        let stream = stream(purpose, term);
        self.level.run(Draw { drawer: self.drawer, stream, counter: counter as u32, each: 2, out });
        &self.room.pair
    }

    /// Draws the number with which a process starts: the first of counter 0.
    pub(crate) fn start(&mut self, purpose: Stream, term: usize) -> Lane<T> {
        match self.own {
            None => self.pair(purpose, term, 0)[0],
            Some(own) => own.once(Once { seed: self.drawer.seed, counter: 0, stream: stream(purpose, term) }),
        }
    }

    /// Returns what was drawn last: two numbers of one counter, and bits.
    pub(crate) fn drawn(&self) -> (&[Lane<T>; 2], &[Lane<u32>]) {
        (&self.room.pair, &self.room.bits)
    }
}
