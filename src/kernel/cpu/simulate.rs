//! One tile for 64 members: samples of an ensemble, from state to state. Twin of `shaders/simulate.wgsl`.
//!
//! Per sample: force noise, the substeps of the proof mass, the reading and its errors, the gyro and the tilt, and two
//! integrations. Sixteen samples go through each of these phases in turn: a phase is compiled once for each
//! instruction set, whatever stands before and after it, which a kernel that had them all inside would be for every
//! integrator and observer (300 to 680 kB each). Units inside: one sample is the unit of time.

use std::ops::Range;

use super::flicker::{AddFlicker, Flicker};
use super::lanes::{Lane, Level};
use super::members::{Members, Shared};
use super::noise::{Draw, Drawer, stream};
use super::oscillator::{
    ExactHold, ExponentialRk2, Ideal, Motion, RosenbrockEuler, RungeKutta4, RungeKutta4General, Step,
};
use super::reading::{AddWalk, AddWhite, Limit};
use super::sums::Integrate;
use crate::kernel::force::Force;
use crate::kernel::integrator::Integrator;
use crate::kernel::member::column;
use crate::numerics::elementary::Real;
use crate::rng::Stream;

/// Samples that go through a phase together: few enough that their numbers stay in the first-level cache, enough that
/// calling a phase costs nothing. A multiple of the four samples that share a counter, and a divisor of `sums::CHUNK`.
const STRETCH: usize = 16;

/// Sees every sample: reading errors of the accelerometer (m/s²) and of the gyro (rad/s).
pub type Observer<'a, T> = dyn FnMut(&Lane<T>, &Lane<T>) + 'a;

/// Samples `first` to `first + count` of 64 members; `force` holds their substeps.
pub struct Simulate<'a, T: Real> {
    /// What all members share.
    pub shared: &'a Shared<T>,
    /// The members.
    pub members: &'a mut Members<T>,
    /// The excitation of these samples.
    pub force: &'a [Force<T>],
    /// First sample.
    pub first: u64,
    /// How many.
    pub count: u64,
    /// Sees every sample.
    pub observer: Option<&'a mut Observer<'a, T>>,
}

/// What the samples of a stretch are, phase by phase; those of sample n are at n modulo [`STRETCH`].
struct Stretch<T> {
    numbers: [Lane<T>; STRETCH],
    slow: [Lane<T>; STRETCH / 2],
    felt: [Lane<T>; STRETCH],
    error: [Lane<T>; STRETCH],
    turn: [Lane<T>; STRETCH],
}

impl<T: Real> Simulate<'_, T> {
    /// Does the work with an instruction set.
    pub fn run(mut self, level: Level) {
        let zero = Lane::splat(T::of(0.0));
        let mut stretch = Stretch {
            numbers: [zero; STRETCH],
            slow: [zero; STRETCH / 2],
            felt: [zero; STRETCH],
            error: [zero; STRETCH],
            turn: [zero; STRETCH],
        };
        let end = self.first + self.count;
        let mut from = self.first;
        while from < end {
            let until = end.min((from / STRETCH as u64 + 1) * STRETCH as u64);
            self.samples(level, from, until, &mut stretch);
            from = until;
        }
    }

    /// Samples `from` to `until`, all of one stretch.
    fn samples(&mut self, level: Level, from: u64, until: u64, stretch: &mut Stretch<T>) {
        let (shared, m) = (self.shared, &mut *self.members);
        let on = m.active;
        let at = (from % STRETCH as u64) as usize;
        let here = at..at + (until - from) as usize;
        let Stretch { numbers, slow, felt, error, turn } = stretch;
        let (felt, error, turn) = (&mut felt[here.clone()], &mut error[here.clone()], &mut turn[here.clone()]);
        let mut source = Source { level, drawer: m.draw, from, until, numbers, slow };

        let substeps = shared.substeps as usize;
        let local = (from - self.first) as usize * substeps;
        let motion = Motion {
            k: &m.columns,
            e: &mut m.e,
            q: &mut m.q,
            force: &self.force[local..local + here.len() * substeps],
            substeps,
            push: on.force.then(|| source.each(Stream::Force)),
            gain: on.gain,
            sine: on.sine.then_some((&m.turns, from * u64::from(shared.substeps) * 2)),
            scaled: on.reading,
            error,
            felt,
        };
        match shared.integrator {
            Integrator::Ideal => level.run(Step(Ideal, motion)),
            Integrator::ExactHold => level.run(Step(ExactHold, motion)),
            Integrator::RungeKutta4 { .. } => level.run(Step(RungeKutta4, motion)),
            Integrator::RungeKutta4General { .. } => level.run(Step(RungeKutta4General, motion)),
            Integrator::ExponentialRk2 { .. } => level.run(Step(ExponentialRk2, motion)),
            Integrator::RosenbrockEuler { .. } => level.run(Step(RosenbrockEuler, motion)),
        }

        let k = &m.columns;
        if on.white {
            source.white(Stream::AccelerometerWhite, &k[column::WHITE], error);
        }
        if on.flicker {
            let flicker = &mut m.flicker;
            source.flicker(Stream::AccelerometerFlicker, flicker, &shared.flicker, &k[column::FLICKER], error);
        }
        if on.walk {
            source.walk(Stream::AccelerometerWalk, &k[column::WALK], &mut m.walk, error);
        }
        if on.range || on.quantisation {
            let range = on.range.then_some(&k[column::RANGE]);
            let steps = on.quantisation.then_some([&k[column::QUANTISATION], &k[column::STEPS]]);
            level.run(Limit { range, steps, felt, error });
        }
        if on.gyro {
            turn.fill(k[column::GYRO_BIAS]);
        }
        if on.gyro_white {
            source.white(Stream::GyroWhite, &k[column::GYRO_WHITE], turn);
        }
        if on.gyro_flicker {
            let flicker = &mut m.gyro_flicker;
            source.flicker(Stream::GyroFlicker, flicker, &shared.flicker, &k[column::GYRO_FLICKER], turn);
        }
        if on.gyro_walk {
            source.walk(Stream::GyroWalk, &k[column::GYRO_WALK], &mut m.gyro_walk, turn);
        }
        if let Some(observer) = &mut self.observer {
            error.iter().zip(&*turn).for_each(|(error, turn)| observer(error, turn));
        }
        let tilt_gain = shared.tilt_gain;
        let turn = on.gyro.then_some(&*turn);
        level.run(Integrate { sums: &mut m.sums, end: until, error, turn, tilt_gain, e: &m.e });
        if let Some(last) = error.last() {
            m.acceleration = *last;
        }
    }
}

/// Draws the numbers of a stretch, one purpose after the other, and adds noises made of them.
struct Source<'a, T> {
    level: Level,
    drawer: Drawer,
    from: u64,
    until: u64,
    numbers: &'a mut [Lane<T>; STRETCH],
    slow: &'a mut [Lane<T>; STRETCH / 2],
}

impl<T: Real> Source<'_, T> {
    /// Draws one number a sample; says where they are.
    fn renew(&mut self, purpose: Stream) -> Range<usize> {
        let (first, last) = (self.from >> 2, (self.until - 1) >> 2);
        let counters = (last - first + 1) as usize;
        let out = &mut self.numbers[..4 * counters];
        self.level.run(Draw { drawer: self.drawer, stream: stream(purpose, 0), counter: first as u32, each: 4, out });
        let skipped = (self.from & 3) as usize;
        skipped..skipped + (self.until - self.from) as usize
    }

    fn each(&mut self, purpose: Stream) -> &[Lane<T>] {
        let range = self.renew(purpose);
        &self.numbers[range]
    }

    fn white(&mut self, purpose: Stream, scale: &Lane<T>, out: &mut [Lane<T>]) {
        let level = self.level;
        level.run(AddWhite { scale, numbers: self.each(purpose), out });
    }

    fn walk(&mut self, purpose: Stream, scale: &Lane<T>, walk: &mut Lane<T>, out: &mut [Lane<T>]) {
        let level = self.level;
        level.run(AddWalk { scale, numbers: self.each(purpose), walk, out });
    }

    fn flicker(
        &mut self,
        purpose: Stream,
        flicker: &mut Flicker<T>,
        amplitudes: &[T],
        scale: &Lane<T>,
        out: &mut [Lane<T>],
    ) {
        let (level, drawer, first) = (self.level, self.drawer, self.from);
        let draw = |term: usize, counter: u32, out: &mut [Lane<T>]| {
            level.run(Draw { drawer, stream: stream(purpose, term), counter, each: 2, out });
        };
        if first == 0 {
            for j in 1..flicker.terms.len() {
                draw(2 + j, 0, &mut self.slow[..2]);
                flicker.terms[j] = self.slow[0];
            }
        }
        let counters = (((self.until - 1) >> 2) - (first >> 2) + 1) as usize;
        draw(1, (first >> 2) as u32, &mut self.slow[..2 * counters]);
        let range = self.renew(purpose);
        let (fast, slow) = (&self.numbers[range], &*self.slow);
        level.run(AddFlicker { flicker, amplitudes, scale, first, fast, slow, out });
    }
}
