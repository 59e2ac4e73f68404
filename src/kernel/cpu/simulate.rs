//! One tile for 64 members: samples of an ensemble, from state to state. Twin of
//! `shaders/simulate.wgsl`.
//!
//! Per sample: force noise, the substeps of the proof mass, the reading and its errors, the gyro
//! and the tilt, and two integrations. Sixteen samples go through each of these phases in turn: a
//! phase is compiled once for each instruction set, whatever stands before and after it, which a
//! kernel that had them all inside would be for every integrator and observer (300 to 680 kB each).
//! Units inside: one sample is the unit of time.

use super::general::General;
use super::lanes::{Lane, Level};
use super::members::{Members, Shared};
use super::oscillator::{ExactHold, ExponentialRk2, Ideal, ProofMasses, RosenbrockEuler, RungeKutta4, Step};
use super::reading::{self, Late, Limit, Samples, TakeOff};
use super::stretch::{Numbers, Room, STRETCH};
use super::sums::Integrate;
use crate::force::Force;
use crate::integrator::Integrator;
use crate::member::column;
use crate::numerics::elementary::Real;
use crate::rng::Stream;
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::{Sense, SensorTerm};

/// One sample of 64 members, before a still start's means are taken off.
#[derive(Debug, Clone, Copy)]
pub struct Seen<'a, T> {
    /// Specific force along the axis, m/s².
    pub felt: &'a Lane<T>,
    /// Error of the accelerometer's reading beyond that, m/s².
    pub accelerometer: &'a Lane<T>,
    /// Error of the gyro's reading, rad/s.
    pub gyro: &'a Lane<T>,
}

type Observer<'a, T> = dyn FnMut(&Seen<'_, T>) + 'a;

/// Samples `first` to `first + count` of 64 members, which lie all before or all after the end of a
/// still start; `force` holds their substeps.
pub struct Simulate<'a, T: Real> {
    /// Numbers that all members share.
    pub shared: &'a Shared<T>,
    /// Parameters and state of the members.
    pub members: &'a mut Members<T>,
    /// The excitation of these samples.
    pub force: &'a [Force<T>],
    /// Temperature of the sensor above its reference at each, K; empty where it is not.
    pub warmer: &'a [T],
    /// Difference of the late force from the force itself at each, m/s²; empty where no reading is
    /// late.
    pub late: &'a [T],
    /// First sample.
    pub first: u64,
    /// Number of samples.
    pub count: u64,
    /// Receives each sample as it is taken.
    pub observer: Option<&'a mut Observer<'a, T>>,
}

/// Samples of a stretch, phase by phase; those of sample n are at n modulo [`STRETCH`].
pub(super) struct Stretch<T> {
    room: Room<T>,
    felt: [Lane<T>; STRETCH],
}

impl<T: Real> Stretch<T> {
    /// Room for a stretch.
    pub(super) fn new() -> Self {
        Self { room: Room::new(), felt: [Lane::splat(T::of(0.0)); STRETCH] }
    }
}

/// Errors of the readings of consecutive samples.
pub(super) struct Errors<'a, T> {
    /// Of the accelerometer, m/s².
    pub error: &'a mut [Lane<T>],
    /// Of the gyro, rad/s; left alone where none of the members has any.
    pub turn: &'a mut [Lane<T>],
}

impl<T: Real> Simulate<'_, T> {
    /// Does the work with an instruction set.
    pub fn run(mut self, level: Level) {
        let zero = Lane::splat(T::of(0.0));
        let (mut stretch, mut error, mut turn) = (Stretch::new(), [zero; STRETCH], [zero; STRETCH]);
        if self.first == self.shared.still_samples && self.first > 0 {
            self.members.level(self.shared);
        }
        let end = self.first + self.count;
        let mut from = self.first;
        while from < end {
            let until = end.min((from / STRETCH as u64 + 1) * STRETCH as u64);
            let count = (until - from) as usize;
            let out = Errors { error: &mut error[..count], turn: &mut turn[..count] };
            self.samples(level, from, until, &mut stretch, out);
            from = until;
        }
    }

    /// Samples `from` to `until`, all of one stretch.
    fn samples(&mut self, level: Level, from: u64, until: u64, stretch: &mut Stretch<T>, out: Errors<'_, T>) {
        let Errors { error, turn } = out;
        let turns = self.read(level, from, until, stretch, Errors { error: &mut *error, turn: &mut *turn });
        let (shared, m) = (self.shared, &mut *self.members);
        let still = from < shared.still_samples;
        if shared.still_samples > 0 && !still {
            level.run(TakeOff { mean: &m.mean, out: error });
            if turns {
                level.run(TakeOff { mean: &m.gyro_mean, out: turn });
            }
        }
        let tilt_gain = if still { T::of(0.0) } else { shared.tilt_gain };
        let turn = turns.then_some(&*turn);
        level.run(Integrate { sums: &mut m.sums, end: until, error, turn, tilt_gain, e: &m.e });
        if let Some(last) = error.last() {
            m.acceleration = *last;
        }
    }

    /// Errors of the readings of samples `from` to `until`, all of one stretch, with what a still
    /// start will take off; returns whether some gyro has any.
    pub(super) fn read(
        &mut self,
        level: Level,
        from: u64,
        until: u64,
        stretch: &mut Stretch<T>,
        out: Errors<'_, T>,
    ) -> bool {
        let (shared, m) = (self.shared, &mut *self.members);
        // While a still start lasts, nothing moves and no tilt is integrated.
        let still = from < shared.still_samples;
        let on = m.active;
        let at = (from % STRETCH as u64) as usize;
        let here = at..at + (until - from) as usize;
        let Stretch { room, felt } = stretch;
        let felt = &mut felt[here.clone()];
        let Errors { error, turn } = out;
        if let Some(own) = &mut m.own {
            own.renumber(&mut m.draw, from);
        }
        let own = m.own.as_ref();
        let mut numbers = Numbers { level, drawer: m.draw, own, from, until, room, bits_of: None };

        let substeps = shared.substeps as usize;
        let place = (from - self.first) as usize;
        let (local, tile_samples) = (place * substeps, place..place + here.len());
        let motion = ProofMasses {
            k: &m.columns,
            e: &mut m.e,
            q: &mut m.q,
            force: &self.force[local..local + here.len() * substeps],
            substeps,
            push: on.force.then(|| numbers.each(Stream::Force)),
            gain: on.gain,
            sine: (on.sine && !still).then_some((&m.turns, from * u64::from(shared.substeps) * 2)),
            low_pass: m.low_pass.as_deref_mut(),
            scaled: on.any(Sense::Accelerometer, |law| matches!(law, ErrorLaw::Proportional(_))),
            error,
            felt,
        };
        let turns = on.any(Sense::Gyro, |_| true);
        if turns {
            turn.fill(m.columns[column::GYRO_BIAS]);
        }
        match shared.integrator {
            Integrator::Ideal => level.run(Step(Ideal, motion)),
            Integrator::ExactHold => level.run(Step(ExactHold, motion)),
            Integrator::RungeKutta4 { .. } => level.run(Step(RungeKutta4, motion)),
            Integrator::RungeKutta4General { .. } => {
                let first = from * u64::from(shared.substeps);
                let warmer = self.warmer.get(tile_samples.clone()).unwrap_or_default();
                level.run(General { laws: &mut m.laws, first, warmer, motion });
            }
            Integrator::ExponentialRk2 { .. } => level.run(Step(ExponentialRk2, motion)),
            Integrator::RosenbrockEuler { .. } => level.run(Step(RosenbrockEuler, motion)),
        }

        let k = &m.columns;
        if let Some(late) = self.late.get(tile_samples.clone()).filter(|_| on.has(SensorTerm::ReadoutDelay)) {
            level.run(Late { late, gain: &k[column::GAIN], felt: &mut *felt, error: &mut *error });
        }
        for term in on.terms() {
            let out = if term.sense() == Sense::Gyro { &mut *turn } else { &mut *error };
            let samples = Samples { felt, warmer: self.warmer.get(tile_samples.clone()).unwrap_or_default(), out };
            reading::add(term, &mut numbers, k, &m.waves, &mut m.reading, &shared.flicker, samples);
        }
        let (range, rounded) = (on.has(SensorTerm::Range), on.has(SensorTerm::Quantisation));
        if range || rounded {
            let range = range.then_some(&k[column::RANGE]);
            let steps = rounded.then_some([&k[column::QUANTISATION], &k[column::STEPS]]);
            level.run(Limit { range, steps, felt, error });
        }
        if let Some(observer) = &mut self.observer {
            let samples = felt.iter().zip(&*error).zip(&*turn);
            samples.for_each(|((felt, accelerometer), gyro)| observer(&Seen { felt, accelerometer, gyro }));
        }
        turns
    }
}
