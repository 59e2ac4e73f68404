//! One tile for 64 members: samples of an ensemble, from state to state. Twin of `shaders/simulate.wgsl`.
//!
//! Per sample: force noise, the substeps of the proof mass, the reading and its errors, the gyro and the tilt, and two
//! integrations. Sums run in T over 64 samples and are then added to f64 totals (the shader: to compensated ones), so
//! that f32 does not lose the drift of a long run under a large bias. Units inside: one sample is the unit of time.

use super::lanes::{Kernel, LANES, Lane};
use super::noise::{Drawer, stream};
use super::oscillator::{
    ExactHold, ExponentialRk2, Ideal, Oscillator, RosenbrockEuler, RungeKutta4, RungeKutta4General,
};
use crate::kernel::flicker::{self, MOST_TERMS, RENEWED, RETAINED};
use crate::kernel::force::Force;
use crate::kernel::integrator::Integrator;
use crate::kernel::job::Job;
use crate::kernel::member::{COEFFICIENTS, COLUMNS, Column, column, flicker_amplitudes};
use crate::numerics::elementary::{Real, fma, sin_cos_turns};
use crate::rng::Stream;

/// Samples summed in T before they are added to the totals; a power of two, so that its multiples are exact.
pub const CHUNK: u64 = 64;
/// A reading error above this, m/s² (a million g), means that the member has left the range of its model.
pub const BOUND_M_S2: f32 = 1e7;

/// What all members share.
#[derive(Debug, Clone)]
pub struct Shared<T> {
    /// Key of the random numbers.
    pub seed: u64,
    /// Substeps per sample.
    pub substeps: u32,
    /// How the proof mass is stepped.
    pub integrator: Integrator,
    /// Tilt to horizontal acceleration, per unit of rate summed over samples: gravity × sample period.
    pub tilt_gain: T,
    /// Amplitudes of the flicker terms.
    pub flicker: Vec<T>,
}

impl<T: Real> Shared<T> {
    /// What the members of a job share.
    pub fn of(job: &Job) -> Self {
        let sample_s = job.clock.step_s * f64::from(job.clock.steps_per_sample);
        Self {
            seed: job.seed,
            substeps: job.clock.steps_per_sample * job.integrator.substeps(),
            integrator: job.integrator,
            tilt_gain: T::of(job.gravity_m_s2 * sample_s),
            flicker: flicker_amplitudes(&job.clock).into_iter().map(T::of).collect(),
        }
    }
}

/// Error terms that some of these members have.
#[derive(Debug, Clone, Copy, Default)]
struct Active {
    white: bool,
    flicker: bool,
    walk: bool,
    force: bool,
    gyro: bool,
    gyro_white: bool,
    gyro_flicker: bool,
    gyro_walk: bool,
    sine: bool,
    gain: bool,
    reading: bool,
    range: bool,
    quantisation: bool,
}

/// 64 members between tiles: parameters and state.
#[derive(Debug, Clone)]
pub struct Members<T> {
    draw: Drawer,
    active: Active,
    columns: [Lane<T>; COLUMNS],
    turns: [Lane<u32>; 2],
    e: Lane<T>,
    q: Lane<T>,
    walk: Lane<T>,
    gyro_walk: Lane<T>,
    flicker: Vec<Lane<T>>,
    gyro_flicker: Vec<Lane<T>>,
    /// Sums since the last multiple of [`CHUNK`] samples.
    velocity: Lane<T>,
    position: Lane<T>,
    rate: Lane<T>,
    /// Sums up to there.
    velocity_total: Lane<f64>,
    position_total: Lane<f64>,
    rate_total: Lane<f64>,
    acceleration: Lane<T>,
    failed: [bool; LANES],
}

/// Errors of 64 members at a sample, in the order of `QUANTITIES`, and who failed.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Position (m), velocity (m/s), acceleration (m/s²) and tilt (rad) error.
    pub values: [[f64; LANES]; 4],
    /// Members that left the range of their model.
    pub failed: [bool; LANES],
}

/// What is seen of every sample: reading errors of the accelerometer (m/s²) and of the gyro (rad/s).
pub trait Observer<T> {
    /// Called after each sample.
    fn sample(&mut self, accelerometer: &Lane<T>, gyro: &Lane<T>);
}

impl<T> Observer<T> for () {
    #[inline(always)]
    fn sample(&mut self, _: &Lane<T>, _: &Lane<T>) {}
}

impl<T: Real> Members<T> {
    /// 64 members at rest, from `first_member` on (a multiple of 64). Lanes beyond `columns` repeat the last one.
    pub fn new(seed: u64, first_member: u64, columns: &[Column], flicker_terms: usize) -> Self {
        let zero = Lane::splat(T::of(0.0));
        let mut lanes = [zero; COLUMNS];
        let mut turns = [Lane::splat(0); 2];
        for l in 0..LANES {
            let Some(member) = columns.get(l).or(columns.last()) else { break };
            (0..COLUMNS).for_each(|c| lanes[c][l] = T::of(member.values[c]));
            (0..2).for_each(|i| turns[i][l] = member.turns[i]);
        }
        let any = |c: usize| lanes[c].0.iter().any(|v| *v != T::of(0.0));
        let active = Active {
            white: any(column::WHITE),
            flicker: any(column::FLICKER),
            walk: any(column::WALK),
            force: any(column::FORCE),
            gyro: (column::GYRO_BIAS..=column::GYRO_WALK).any(any),
            gyro_white: any(column::GYRO_WHITE),
            gyro_flicker: any(column::GYRO_FLICKER),
            gyro_walk: any(column::GYRO_WALK),
            sine: any(column::SINE),
            gain: lanes[column::GAIN].0.iter().any(|v| *v != T::of(1.0)),
            reading: any(column::SCALE) || any(column::K2),
            range: lanes[column::RANGE].0.iter().any(|v| *v < T::of(1e30)),
            quantisation: any(column::QUANTISATION),
        };
        let terms = |on: bool| vec![zero; if on { flicker_terms } else { 0 }];
        Self {
            draw: Drawer { seed, first_member },
            active,
            columns: lanes,
            turns,
            e: zero,
            q: zero,
            walk: zero,
            gyro_walk: zero,
            flicker: terms(active.flicker),
            gyro_flicker: terms(active.gyro_flicker),
            velocity: zero,
            position: zero,
            rate: zero,
            velocity_total: Lane::splat(0.0),
            position_total: Lane::splat(0.0),
            rate_total: Lane::splat(0.0),
            acceleration: zero,
            failed: [false; LANES],
        }
    }

    /// Places every proof mass: error of the reading (m/s²) and rate of the reading times one substep.
    pub fn place(&mut self, error_m_s2: f64, rate_step_m_s2: f64) {
        self.e = Lane::splat(T::of(error_m_s2));
        self.q = Lane::splat(T::of(rate_step_m_s2));
    }

    /// Error of the reading and its rate times one substep, of one lane.
    pub fn placed(&self, lane: usize) -> (f64, f64) {
        (self.e[lane].f64(), self.q[lane].f64())
    }

    /// The errors after `samples` samples of `sample_s` seconds.
    pub fn snapshot(&self, samples: u64, sample_s: f64) -> Snapshot {
        let mut s = Snapshot { values: [[0.0; LANES]; 4], failed: self.failed };
        let since = (samples % CHUNK) as f64;
        for l in 0..LANES {
            let position = self.position_total[l] + (since * self.velocity_total[l] + self.position[l].f64());
            s.values[0][l] = sample_s * sample_s * position;
            s.values[1][l] = sample_s * (self.velocity_total[l] + self.velocity[l].f64());
            s.values[2][l] = self.acceleration[l].f64();
            s.values[3][l] = sample_s * (self.rate_total[l] + self.rate[l].f64());
            s.failed[l] |= self.acceleration[l].beyond(BOUND_M_S2) || s.values.iter().any(|v| !v[l].is_finite());
        }
        s
    }
}

/// Samples `first` to `first + count` of 64 members; `force` holds their substeps.
pub struct Simulate<'a, T: Real, S: Observer<T> = ()> {
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
    pub observer: &'a mut S,
}

impl<T: Real, S: Observer<T>> Kernel for Simulate<'_, T, S> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        match self.shared.integrator {
            Integrator::Ideal => tile::<T, Ideal, S, FMA>(self),
            Integrator::ExactHold => tile::<T, ExactHold, S, FMA>(self),
            Integrator::RungeKutta4 { .. } => tile::<T, RungeKutta4, S, FMA>(self),
            Integrator::RungeKutta4General { .. } => tile::<T, RungeKutta4General, S, FMA>(self),
            Integrator::ExponentialRk2 { .. } => tile::<T, ExponentialRk2, S, FMA>(self),
            Integrator::RosenbrockEuler { .. } => tile::<T, RosenbrockEuler, S, FMA>(self),
        }
    }
}

/// Four consecutive numbers of a purpose, renewed every four samples.
struct Fours<T>([Lane<T>; 4]);

impl<T: Real> Fours<T> {
    #[inline(always)]
    fn renew<const FMA: bool>(&mut self, on: bool, draw: &Drawer, sample: u64, purpose: Stream) {
        if on {
            draw.four::<T, FMA>((sample >> 2) as u32, stream(purpose, 0), &mut self.0);
        }
    }
}

/// The terms of one bias instability during a tile. Numbers: stream 0 renews the fast term, stream 1 the slow ones (number
/// 0 of a counter is term 1's, number 1 the other's), stream 2 + j starts term j.
struct Flicker<'a, T> {
    draw: Drawer,
    purpose: Stream,
    amplitudes: &'a [T],
    terms: &'a mut [Lane<T>],
    slow_numbers: [Lane<T>; 2],
    /// Sum of terms 2 and slower.
    slowest: Lane<T>,
}

impl<'a, T: Real> Flicker<'a, T> {
    #[inline(always)]
    fn new<const FMA: bool>(
        draw: Drawer,
        purpose: Stream,
        amplitudes: &'a [T],
        terms: &'a mut [Lane<T>],
        first: u64,
    ) -> Self {
        let zero = Lane::splat(T::of(0.0));
        let mut flicker = Self { draw, purpose, amplitudes, terms, slow_numbers: [zero; 2], slowest: zero };
        if first == 0 {
            for j in 1..flicker.terms.len() {
                flicker.draw.two::<T, FMA>(0, stream(purpose, 2 + j), &mut flicker.slow_numbers);
                flicker.terms[j] = flicker.slow_numbers[0];
            }
        }
        flicker.sum_slowest::<FMA>();
        flicker
    }

    #[inline(always)]
    fn sum_slowest<const FMA: bool>(&mut self) {
        self.slowest = Lane::splat(T::of(0.0));
        for (term, a) in self.terms.iter().zip(self.amplitudes).skip(2) {
            for l in 0..LANES {
                self.slowest[l] = fma::<T, FMA>(*a, term[l], self.slowest[l]);
            }
        }
    }

    /// Draws for the slow terms of this sample and the three after it.
    #[inline(always)]
    fn renew<const FMA: bool>(&mut self, sample: u64) {
        self.draw.two::<T, FMA>((sample >> 2) as u32, stream(self.purpose, 1), &mut self.slow_numbers);
    }

    /// Renews the terms whose turn it is and adds `scale` times their sum to `out`.
    #[inline(always)]
    fn add<const FMA: bool>(&mut self, sample: u64, fast: &Lane<T>, scale: &Lane<T>, out: &mut Lane<T>) {
        let (keep, new) = if sample == 0 { (0.0, 1.0) } else { (RETAINED, RENEWED) };
        let (keep, new) = (T::of(keep), T::of(new));
        if let Some(j) = flicker::slow_term(sample).filter(|&j| j < self.terms.len()) {
            let number = &self.slow_numbers[usize::from(j > 1)];
            for l in 0..LANES {
                self.terms[j][l] = fma::<T, FMA>(keep, self.terms[j][l], new * number[l]);
            }
            if j > 1 {
                self.sum_slowest::<FMA>();
            }
        }
        let [quick, slow, ..] = self.terms else { return };
        for l in 0..LANES {
            quick[l] = fma::<T, FMA>(keep, quick[l], new * fast[l]);
            let sum = fma::<T, FMA>(self.amplitudes[1], slow[l], self.slowest[l]);
            out[l] = fma::<T, FMA>(scale[l], fma::<T, FMA>(self.amplitudes[0], quick[l], sum), out[l]);
        }
    }
}

#[inline(always)]
fn tile<T: Real, O: Oscillator<T>, S: Observer<T>, const FMA: bool>(work: Simulate<'_, T, S>) {
    let Simulate { shared, members: m, force, first, count, observer } = work;
    let on = m.active;
    let draw = m.draw;
    let zero = Lane::splat(T::of(0.0));
    let fresh = || Fours([zero; 4]);
    let (mut white, mut walk, mut pushes) = (fresh(), fresh(), fresh());
    let (mut gyro_white, mut gyro_walk) = (fresh(), fresh());
    let (mut fast, mut gyro_fast) = (fresh(), fresh());
    let k = m.columns;
    let substeps = shared.substeps as usize;
    let mut amplitudes = [T::of(0.0); MOST_TERMS];
    amplitudes[..shared.flicker.len()].copy_from_slice(&shared.flicker);

    let mut flicker = Flicker::new::<FMA>(draw, Stream::AccelerometerFlicker, &amplitudes, &mut m.flicker, first);
    let mut gyro_flicker = Flicker::new::<FMA>(draw, Stream::GyroFlicker, &amplitudes, &mut m.gyro_flicker, first);

    for n in first..first + count {
        if n & 3 == 0 || n == first {
            pushes.renew::<FMA>(on.force, &draw, n, Stream::Force);
            white.renew::<FMA>(on.white, &draw, n, Stream::AccelerometerWhite);
            fast.renew::<FMA>(on.flicker, &draw, n, Stream::AccelerometerFlicker);
            walk.renew::<FMA>(on.walk, &draw, n, Stream::AccelerometerWalk);
            gyro_white.renew::<FMA>(on.gyro_white, &draw, n, Stream::GyroWhite);
            gyro_fast.renew::<FMA>(on.gyro_flicker, &draw, n, Stream::GyroFlicker);
            gyro_walk.renew::<FMA>(on.gyro_walk, &draw, n, Stream::GyroWalk);
            if on.flicker {
                flicker.renew::<FMA>(n);
            }
            if on.gyro_flicker {
                gyro_flicker.renew::<FMA>(n);
            }
        }
        let number = (n & 3) as usize;

        // Mechanics.
        let local = (n - first) as usize * substeps;
        let steps = &force[local..local + substeps];
        let push = if on.force { &pushes.0[number] } else { &zero };
        let mut felt = zero;
        for (i, f) in steps.iter().enumerate() {
            if on.sine {
                let half = (n * u64::from(shared.substeps) + i as u64) * 2;
                for l in 0..LANES {
                    let at = |half: u64| {
                        let turns = m.turns[0][l].wrapping_add((half as u32).wrapping_mul(m.turns[1][l]));
                        k[column::SINE][l] * sin_cos_turns::<T, FMA>(turns).0
                    };
                    let [begin, middle, end] = [at(half), at(half + 1), at(half + 2)];
                    let gain = k[column::GAIN][l];
                    let own = Force {
                        begin: fma::<T, FMA>(gain, f.begin, begin),
                        middle: fma::<T, FMA>(gain, f.middle, middle),
                        end: fma::<T, FMA>(gain, f.end, end),
                        to_middle: fma::<T, FMA>(gain, f.to_middle, middle - begin),
                        to_end: fma::<T, FMA>(gain, f.to_end, end - begin),
                    };
                    (m.e[l], m.q[l]) =
                        O::step::<FMA>(&coefficients(&k, l), m.e[l], m.q[l], &own, k[column::FORCE][l] * push[l]);
                    felt[l] = own.end;
                }
            } else if on.gain {
                for l in 0..LANES {
                    let gain = k[column::GAIN][l];
                    let own = Force {
                        begin: gain * f.begin,
                        middle: gain * f.middle,
                        end: gain * f.end,
                        to_middle: gain * f.to_middle,
                        to_end: gain * f.to_end,
                    };
                    (m.e[l], m.q[l]) =
                        O::step::<FMA>(&coefficients(&k, l), m.e[l], m.q[l], &own, k[column::FORCE][l] * push[l]);
                    felt[l] = own.end;
                }
            } else if O::MOVES {
                for l in 0..LANES {
                    (m.e[l], m.q[l]) =
                        O::step::<FMA>(&coefficients(&k, l), m.e[l], m.q[l], f, k[column::FORCE][l] * push[l]);
                }
            }
        }
        if !on.sine && !on.gain {
            felt = Lane::splat(steps[substeps - 1].end);
        }

        // The accelerometer's reading.
        let mut error = zero;
        for l in 0..LANES {
            error[l] = m.e[l] + k[column::BIAS][l];
        }
        if on.reading {
            for l in 0..LANES {
                let a = felt[l] + m.e[l];
                error[l] = fma::<T, FMA>(fma::<T, FMA>(k[column::K2][l], a, k[column::SCALE][l]), a, error[l]);
            }
        }
        if on.white {
            for l in 0..LANES {
                error[l] = fma::<T, FMA>(k[column::WHITE][l], white.0[number][l], error[l]);
            }
        }
        if on.flicker {
            flicker.add::<FMA>(n, &fast.0[number], &k[column::FLICKER], &mut error);
        }
        if on.walk {
            for l in 0..LANES {
                m.walk[l] = fma::<T, FMA>(k[column::WALK][l], walk.0[number][l], m.walk[l]);
                error[l] = error[l] + m.walk[l];
            }
        }
        if on.range {
            for l in 0..LANES {
                let range = k[column::RANGE][l];
                error[l] = error[l].min(range - felt[l]).max(-range - felt[l]);
            }
        }
        if on.quantisation {
            for l in 0..LANES {
                let lsb = k[column::QUANTISATION][l];
                let reading = (felt[l] + error[l]) / lsb.max(T::of(1e-30));
                error[l] = fma::<T, FMA>(lsb, reading.round() - reading, error[l]);
            }
        }

        // The gyro, the tilt and what gravity makes of it; the mean of the tilt over the sample.
        let mut turn = zero;
        if on.gyro {
            turn = k[column::GYRO_BIAS];
            if on.gyro_white {
                for l in 0..LANES {
                    turn[l] = fma::<T, FMA>(k[column::GYRO_WHITE][l], gyro_white.0[number][l], turn[l]);
                }
            }
            if on.gyro_flicker {
                gyro_flicker.add::<FMA>(n, &gyro_fast.0[number], &k[column::GYRO_FLICKER], &mut turn);
            }
            if on.gyro_walk {
                for l in 0..LANES {
                    m.gyro_walk[l] = fma::<T, FMA>(k[column::GYRO_WALK][l], gyro_walk.0[number][l], m.gyro_walk[l]);
                    turn[l] = turn[l] + m.gyro_walk[l];
                }
            }
        }
        observer.sample(&error, &turn);
        if on.gyro {
            for l in 0..LANES {
                let before = T::of(m.rate_total[l]) + m.rate[l];
                error[l] = fma::<T, FMA>(shared.tilt_gain, fma::<T, FMA>(T::of(0.5), turn[l], before), error[l]);
                m.rate[l] = m.rate[l] + turn[l];
            }
        }

        // Two integrations: the error is held over the sample, the velocity is a trapezium.
        for l in 0..LANES {
            m.position[l] = m.position[l] + fma::<T, FMA>(T::of(0.5), error[l], m.velocity[l]);
            m.velocity[l] = m.velocity[l] + error[l];
        }
        if n + 1 == first + count {
            m.acceleration = error;
        }

        if (n + 1) % CHUNK == 0 {
            for l in 0..LANES {
                m.position_total[l] += CHUNK as f64 * m.velocity_total[l] + m.position[l].f64();
                m.velocity_total[l] += m.velocity[l].f64();
                m.rate_total[l] += m.rate[l].f64();
                m.failed[l] |= error[l].beyond(BOUND_M_S2) || m.e[l].beyond(BOUND_M_S2);
            }
            (m.position, m.velocity, m.rate) = (zero, zero, zero);
        }
    }
}

#[inline(always)]
fn coefficients<T: Real>(k: &[Lane<T>; COLUMNS], l: usize) -> [T; COEFFICIENTS] {
    std::array::from_fn(|c| k[c][l])
}
