//! 64 six-axis members: three axes of readings, what couples them, and the navigation that they
//! feed.

use super::aiding::Correct;
use super::environment::Followed;
use super::lanes::{LANES, Lane, Level};
use super::members::{Members, Shared};
use super::navigate::{Couple, Navigate, State, roll_pitch_heading};
use super::noise::Drawer;
use super::reading::TakeOff;
use super::simulate::{Errors, Simulate, Stretch};
use super::stretch::{Numbers, Room, STRETCH};
use super::sums::CHUNK;
use crate::aiding::{self, Fix};
use crate::environment::FOLLOWED;
use crate::flight::{COUPLINGS, Flight, Vertical};
use crate::force::Force;
use crate::numerics::elementary::Real;
use crate::rng::Stream;
use crate::truth_step::Passage;

/// Three axes, the couplings if there are any, and the errors of navigation.
pub struct Imu<T: Real> {
    axes: [Box<Members<T>>; 3],
    coupling: Option<Box<[Lane<T>; COUPLINGS]>>,
    follow: Option<Box<[Lane<T>; FOLLOWED]>>,
    state: Box<State<T>>,
    /// Corrections that a still start has found for accelerometers and gyros, and fixes since; none
    /// without either.
    found: Option<Box<[[Lane<T>; 3]; 2]>>,
    first_member: u64,
}

/// Numbers that all members share over some samples, which lie all before or all after the end of a
/// still start.
pub struct Tile<'a, T: Real> {
    /// Ensemble whose readings are simulated.
    pub flight: &'a Flight,
    /// Numbers that the members of each axis share.
    pub shared: &'a [Shared<T>; 3],
    /// The specific force along each axis.
    pub force: &'a [Vec<Force<T>>; 3],
    /// Difference of the late force from the force itself along each axis; empty where no reading
    /// is late.
    pub late: &'a [Vec<T>; 3],
    /// Temperature of the sensor above its reference at each sample, K; empty where it is not.
    pub warmer: &'a [T],
    /// The truth; empty during a still start.
    pub passages: &'a [Passage<T>],
    /// First sample of the block, counted from the beginning of the flight.
    pub first: u64,
    /// Number of samples in the block.
    pub count: u64,
}

/// Quantities of one member: position and velocity errors in north-east-down (m, m/s), attitude
/// errors in roll, pitch and heading (rad).
pub type Row = [f64; 9];

impl<T: Real> Imu<T> {
    /// The members from `first_member` on at the beginning of a run.
    pub fn new(flight: &Flight, first_member: u64, axes: [Box<Members<T>>; 3]) -> Self {
        let coupling = flight.coupling.as_ref().map(|draw| {
            let mut lanes = Box::new([Lane::splat(T::of(0.0)); COUPLINGS]);
            for l in 0..LANES {
                let numbers = draw(first_member + l as u64).numbers();
                lanes.iter_mut().zip(numbers).for_each(|(lane, number)| lane[l] = T::of(number));
            }
            lanes
        });
        let follow = flight.follow.as_ref().map(|draw| {
            let mut lanes = Box::new([Lane::splat(T::of(0.0)); FOLLOWED]);
            for l in 0..LANES {
                let numbers = draw(first_member + l as u64).numbers();
                lanes.iter_mut().zip(numbers).for_each(|(lane, number)| lane[l] = T::of(number));
            }
            lanes
        });
        let found = (!flight.fixes.is_empty()).then(|| Box::new([[Lane::splat(T::of(0.0)); 3]; 2]));
        let mut imu = Self { axes, coupling, follow, state: Box::new(State::default()), found, first_member };
        if flight.clock().still_samples == 0 {
            (0..LANES).for_each(|l| imu.state.begin(l, &flight.begin(first_member + l as u64, None)));
        }
        imu
    }

    /// Takes the members through a tile.
    pub fn run(&mut self, tile: &Tile<'_, T>, level: Level) {
        let still_samples = tile.flight.clock().still_samples;
        if tile.first < still_samples {
            // One-axis runs: what they sum during a still start are the mean errors.
            for axis in 0..3 {
                self.simulate(tile, axis).run(level);
            }
            return;
        }
        if tile.first == still_samples && still_samples > 0 {
            self.align(tile);
        }
        let zero = Lane::splat(T::of(0.0));
        let mut stretch = Stretch::new();
        let (mut error, mut turn) = ([[zero; STRETCH]; 3], [[zero; STRETCH]; 3]);
        let mut room = Room::new();
        let end = tile.first + tile.count;
        let mut from = tile.first;
        let fixes = &tile.flight.fixes;
        let mut due = aiding::next(fixes, from - still_samples);
        while from < end {
            // Stretches of the readings and chunks of the navigation, which count from the end of
            // the still start.
            let chunk = still_samples + ((from - still_samples) / CHUNK + 1) * CHUNK;
            let mut until = end.min((from / STRETCH as u64 + 1) * STRETCH as u64).min(chunk);
            let next = fixes.get(due).map(|fix| (fix, still_samples + fix.sample));
            until = next.map_or(until, |(_, at)| until.min(at));
            let count = (until - from) as usize;
            for axis in 0..3 {
                let out = Errors { error: &mut error[axis][..count], turn: &mut turn[axis][..count] };
                if !self.simulate(tile, axis).read(level, from, until, &mut stretch, out) {
                    turn[axis][..count].fill(zero);
                }
            }
            let at = (from - tile.first) as usize;
            let passages = &tile.passages[at..at + count];
            if let Some(numbers) = &self.coupling {
                let [e0, e1, e2] = &mut error;
                let [t0, t1, t2] = &mut turn;
                let error = [&mut e0[..count], &mut e1[..count], &mut e2[..count]];
                let turn = [&mut t0[..count], &mut t1[..count], &mut t2[..count]];
                level.run(Couple { numbers, passages, error, turn });
            }
            if let Some(numbers) = &self.follow {
                let [e0, e1, e2] = &mut error;
                let [t0, t1, t2] = &mut turn;
                let error = [&mut e0[..count], &mut e1[..count], &mut e2[..count]];
                let turn = [&mut t0[..count], &mut t1[..count], &mut t2[..count]];
                let drawer = self.drawer(tile.flight.seed());
                let mut instants = Numbers { level, drawer, own: None, from, until, room: &mut room, bits_of: None };
                let jitter = if tile.flight.jitters { instants.each(Stream::Jitter) } else { &[] };
                let (passed, sample_s) = (from - still_samples, tile.flight.clock().sample_s());
                level.run(Followed { numbers, passages, jitter, passed, sample_s, error, turn });
            }
            if let Some([accelerometers, gyros]) = self.found.as_deref() {
                for axis in 0..3 {
                    level.run(TakeOff { mean: &accelerometers[axis], out: &mut error[axis][..count] });
                    level.run(TakeOff { mean: &gyros[axis], out: &mut turn[axis][..count] });
                }
            }
            self.navigate(tile, level, passages, from - still_samples, [&error, &turn]);
            from = until;
            if let Some((fix, at)) = next
                && at == until
            {
                self.correct(tile.flight, fix, due as u32, level);
                due += 1;
            }
        }
    }

    fn simulate<'a>(&'a mut self, tile: &Tile<'a, T>, axis: usize) -> Simulate<'a, T> {
        Simulate {
            shared: &tile.shared[axis],
            members: &mut self.axes[axis],
            force: &tile.force[axis],
            warmer: tile.warmer,
            late: &tile.late[axis],
            first: tile.first,
            count: tile.count,
            observer: None,
        }
    }

    fn navigate(
        &mut self,
        tile: &Tile<'_, T>,
        level: Level,
        passages: &[Passage<T>],
        passed: u64,
        [error, turn]: [&[[Lane<T>; STRETCH]; 3]; 2],
    ) {
        let count = passages.len();
        let free = T::of(if tile.flight.vertical == Vertical::Free { 1.0 } else { 0.0 });
        let [error, turn] = [error, turn].map(|all| all.each_ref().map(|lanes| &lanes[..count]));
        let (since, sample_s) = (passed % CHUNK, tile.flight.clock().sample_s());
        let state = &mut *self.state;
        if tile.flight.course.earth.latitude_rad.is_some() {
            level.run(Navigate::<T, true> { state, passages, error, turn, since, sample_s, free });
        } else {
            level.run(Navigate::<T, false> { state, passages, error, turn, since, sample_s, free });
        }
    }

    /// Draws jitter and fixes, which belong to no axis, under the indices of the first axis.
    fn drawer(&self, seed: u64) -> Drawer {
        Drawer { seed, ..self.axes[0].draw }
    }

    /// Corrects the members' errors by a fix.
    fn correct(&mut self, flight: &Flight, fix: &Fix, number: u32, level: Level) {
        let drawer = self.drawer(flight.seed());
        let Some(taken) = self.found.as_deref_mut() else { return };
        let since_s = (fix.sample % CHUNK) as f64 * flight.clock().sample_s();
        level.run(Correct { state: &mut self.state, taken, fix, number, drawer, since_s });
    }

    /// Ends the still start.
    fn align(&mut self, tile: &Tile<'_, T>) {
        let mut found = Box::new([[Lane::splat(T::of(0.0)); 3]; 2]);
        for l in 0..LANES {
            let means = std::array::from_fn(|axis| self.axes[axis].standing_mean(&tile.shared[axis], l));
            let begin = tile.flight.aligned(self.first_member + l as u64, means);
            self.state.begin(l, &begin);
            for axis in 0..3 {
                found[0][axis][l] = T::of(begin.accelerometer[axis]);
                found[1][axis][l] = T::of(begin.gyro[axis]);
            }
        }
        self.found = Some(found);
    }

    /// The errors of 64 members after `samples` samples, and who failed.
    pub fn snapshot(&self, flight: &Flight, samples: u64) -> [Option<Row>; LANES] {
        let clock = flight.clock();
        let passed = samples - clock.still_samples;
        let heading_rad = flight.heading_rad(passed);
        let own = flight.own_at(samples);
        std::array::from_fn(|l| {
            let failed = self.state.failed(l) || self.axes.iter().any(|axis| axis.has_failed(l));
            (!failed).then(|| {
                let [turn, velocity, position] = self.state.errors(l, passed, clock.sample_s());
                let turn = roll_pitch_heading(turn, heading_rad);
                std::array::from_fn(|i| own[i] + [position, velocity, turn][i / 3][i % 3])
            })
        })
    }
}
