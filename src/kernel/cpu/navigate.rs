//! From reading errors in three axes to errors of attitude, velocity and position, for 64 members.
//! Twin of `shaders/navigate.wgsl`.
//!
//! The errors are integrated about the truth, never the readings. With R the true attitude (body to
//! north-east-down), a computed attitude δC R obeys
//!
//! - δC′ = δC [R δω + ω_in]× − [ω_in + δω_in]× δC, exactly;
//! - δv′ = (δC − 1)(R f + R δf) + R δf − δω_c × (v + δv) − ω_c × δv + δg, ω_c = 2ω_ie + ω_en;
//! - δp′ = δv and what the curvature of the Earth adds, linear in δp (an error of 10 km is 0.2 % of
//!   its radius).
//!
//! δC is kept as σ, four times its modified Rodrigues vector (Marandi & Modi, *A preferred
//! coordinate system and the associated orientation representation in attitude dynamics*, 1987):
//! tan(φ/4) along the axis, near zero the rotation vector itself. Three numbers, no norm to keep,
//! no singularity below a full turn; beyond half a turn it is exchanged for its shadow. So heading
//! errors of any size are right. Sums run in T over 64 samples and are then added to f64 totals, as
//! in `sums`.

use nalgebra::{Rotation3, Vector3};

use super::lanes::{Kernel, LANES, Lane};
use super::sums::CHUNK;
use crate::flight::{Begin, COUPLINGS};
use crate::numerics::elementary::{Real, fma};
use crate::truth_step::Passage;

/// Axes, of the body or of north-east-down.
type Axes<T> = [Lane<T>; 3];

/// Errors of 64 members in north-east-down.
#[derive(Debug, Clone)]
pub struct State<T> {
    /// Since the last multiple of [`CHUNK`] samples: attitude σ (rad), velocity (m/s), position (m)
    /// without what the total of the velocity adds to it.
    parts: [Axes<T>; 3],
    /// Sums up to that sample.
    totals: [Axes<f64>; 3],
}

/// Places in the state.
const ATTITUDE: usize = 0;
const VELOCITY: usize = 1;
const POSITION: usize = 2;

/// A velocity error above this, m/s, means that the member has left the range of its model.
pub(crate) const BOUND_M_S: f32 = 1e7;

impl<T: Real> Default for State<T> {
    fn default() -> Self {
        Self { parts: [[Lane::splat(T::of(0.0)); 3]; 3], totals: [[Lane::splat(0.0); 3]; 3] }
    }
}

impl<T: Real> State<T> {
    /// Sets a lane to the initial state of one member.
    pub fn begin(&mut self, lane: usize, begin: &Begin) {
        (0..3).for_each(|i| self.totals[ATTITUDE][i][lane] = begin.attitude[i]);
    }

    /// Rotation vector of the attitude error (rad), velocity and position error of one member in
    /// north-east-down, after `samples` samples of `sample_s`.
    pub fn errors(&self, lane: usize, samples: u64, sample_s: f64) -> [Vector3<f64>; 3] {
        let at = |q: usize| Vector3::from_fn(|i, _| self.totals[q][i][lane] + self.parts[q][i][lane].f64());
        let sigma = at(ATTITUDE);
        let size = sigma.norm();
        let turn = if size > 0.0 { sigma * (4.0 * (size / 4.0).atan() / size) } else { sigma };
        let passed = (samples % CHUNK) as f64 * sample_s;
        let moved = Vector3::from_fn(|i, _| passed * self.totals[VELOCITY][i][lane]);
        [turn, at(VELOCITY), at(POSITION) + moved]
    }

    /// Attitude σ, velocity and position error of one member, `since_s` after the totals were last
    /// added to.
    #[inline(always)]
    pub(super) fn current(&self, lane: usize, since_s: f64) -> [[f64; 3]; 3] {
        let mut all = [[0.0; 3]; 3];
        for q in 0..3 {
            for i in 0..3 {
                all[q][i] = self.totals[q][i][lane] + self.parts[q][i][lane].f64();
            }
        }
        for i in 0..3 {
            all[POSITION][i] += since_s * self.totals[VELOCITY][i][lane];
        }
        all
    }

    /// Adds to attitude σ, velocity and position error of one member along one axis.
    #[inline(always)]
    pub(super) fn add(&mut self, lane: usize, axis: usize, change: [T; 3]) {
        for q in 0..3 {
            self.parts[q][axis][lane] = self.parts[q][axis][lane] + change[q];
        }
    }

    /// Returns whether a member has left the range of numbers.
    pub fn failed(&self, lane: usize) -> bool {
        let all = |q: usize, i: usize| self.totals[q][i][lane] + self.parts[q][i][lane].f64();
        let out = |q: usize, i: usize| !all(q, i).is_finite();
        (0..9).any(|n| out(n / 3, n % 3)) || (0..3).any(|i| all(VELOCITY, i).abs() > f64::from(BOUND_M_S))
    }

    /// Adds the parts to the totals, `chunk_s` after the last time.
    fn fold(&mut self, chunk_s: f64) {
        for i in 0..3 {
            for l in 0..LANES {
                self.totals[POSITION][i][l] += chunk_s * self.totals[VELOCITY][i][l] + self.parts[POSITION][i][l].f64();
                self.totals[VELOCITY][i][l] += self.parts[VELOCITY][i][l].f64();
                self.totals[ATTITUDE][i][l] += self.parts[ATTITUDE][i][l].f64();
            }
        }
        for l in 0..LANES {
            let square: f64 = (0..3).map(|i| self.totals[ATTITUDE][i][l].powi(2)).sum();
            // Beyond half a turn the other way round is shorter.
            if square > 16.0 {
                (0..3).for_each(|i| self.totals[ATTITUDE][i][l] *= -16.0 / square);
            }
        }
        self.parts = [[Lane::splat(T::of(0.0)); 3]; 3];
    }
}

/// Adds what one instrument takes from other axes to consecutive samples.
pub(super) struct Couple<'a, T> {
    /// Numbers of a coupling, as `Coupling::numbers` has them.
    pub numbers: &'a [Lane<T>; COUPLINGS],
    pub passages: &'a [Passage<T>],
    /// Errors of the accelerometers' readings, and of the gyros'.
    pub error: [&'a mut [Lane<T>]; 3],
    pub turn: [&'a mut [Lane<T>]; 3],
}

impl<T: Real> Kernel for Couple<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let k = self.numbers;
        for axis in 0..3 {
            let row = 3 * axis;
            for n in 0..self.passages.len() {
                let p = &self.passages[n];
                let (error, turn) = (&mut self.error[axis][n], &mut self.turn[axis][n]);
                for l in 0..LANES {
                    let mut f = error[l];
                    let mut w = turn[l];
                    for from in 0..3 {
                        f = fma::<T, FMA>(k[row + from][l], p.body_force[from], f);
                        w = fma::<T, FMA>(k[9 + row + from][l], p.body_rate[from], w);
                        w = fma::<T, FMA>(k[18 + row + from][l], p.body_force[from], w);
                    }
                    error[l] = f;
                    turn[l] = w;
                }
            }
        }
    }
}

/// Takes the errors through consecutive samples, of which at most the last is a multiple of
/// [`CHUNK`] after the start of navigation.
pub(super) struct Navigate<'a, T, const ROUND: bool> {
    pub state: &'a mut State<T>,
    pub passages: &'a [Passage<T>],
    /// Errors of the readings in body axes, m/s² and rad/s.
    pub error: [&'a [Lane<T>]; 3],
    pub turn: [&'a [Lane<T>]; 3],
    /// Samples since the last multiple of [`CHUNK`].
    pub since: u64,
    /// Time between samples, s.
    pub sample_s: f64,
    /// 1 where height is free, 0 where it is held.
    pub free: T,
}

impl<T: Real, const ROUND: bool> Kernel for Navigate<'_, T, ROUND> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let h = T::of(self.sample_s);
        let zero = Lane::splat(T::of(0.0));
        let mut base: [Axes<T>; 3] = [[zero; 3]; 3];
        for i in 0..9 {
            for l in 0..LANES {
                base[i / 3][i % 3][l] = T::of(self.state.totals[i / 3][i % 3][l]);
            }
        }
        let mut parts = self.state.parts;
        let [ex, ey, ez] = self.error;
        let [tx, ty, tz] = self.turn;
        for (n, p) in self.passages.iter().enumerate() {
            let passed_s = T::of((self.since + n as u64) as f64 * self.sample_s);
            let (ex, ey, ez, tx, ty, tz) = (&ex[n], &ey[n], &ez[n], &tx[n], &ty[n], &tz[n]);
            for l in 0..LANES {
                let (mut from, mut part) = ([T::of(0.0); 9], [T::of(0.0); 9]);
                for i in 0..9 {
                    from[i] = base[i / 3][i % 3][l];
                    part[i] = parts[i / 3][i % 3][l];
                }
                let member = Member { base: from, part, error: [ex[l], ey[l], ez[l]], turn: [tx[l], ty[l], tz[l]] };
                let after = step::<T, FMA, ROUND>(p, &member, h, passed_s, self.free);
                for i in 0..9 {
                    parts[i / 3][i % 3][l] = after[i];
                }
            }
        }
        self.state.parts = parts;
        if self.since + self.passages.len() as u64 == CHUNK {
            self.state.fold(CHUNK as f64 * self.sample_s);
        }
    }
}

/// One member before a step.
struct Member<T> {
    base: [T; 9],
    part: [T; 9],
    error: [T; 3],
    turn: [T; 3],
}

// No closures from here on: they are functions of their own, compiled without the instruction set
// of their caller.

#[inline(always)]
pub(super) fn cross<T: Real, const FMA: bool>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [
        fma::<T, FMA>(a[1], b[2], -(a[2] * b[1])),
        fma::<T, FMA>(a[2], b[0], -(a[0] * b[2])),
        fma::<T, FMA>(a[0], b[1], -(a[1] * b[0])),
    ]
}

#[inline(always)]
pub(super) fn dot<T: Real, const FMA: bool>(a: [T; 3], b: [T; 3]) -> T {
    fma::<T, FMA>(a[0], b[0], fma::<T, FMA>(a[1], b[1], a[2] * b[2]))
}

#[inline(always)]
fn add<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn less<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// k a + b.
#[inline(always)]
pub(super) fn plus<T: Real, const FMA: bool>(k: T, a: [T; 3], b: [T; 3]) -> [T; 3] {
    [fma::<T, FMA>(k, a[0], b[0]), fma::<T, FMA>(k, a[1], b[1]), fma::<T, FMA>(k, a[2], b[2])]
}

/// A vector in body axes, in north-east-down.
#[inline(always)]
fn turned<T: Real, const FMA: bool>(r: &[T; 9], v: [T; 3]) -> [T; 3] {
    [dot::<T, FMA>([r[0], r[1], r[2]], v), dot::<T, FMA>([r[3], r[4], r[5]], v), dot::<T, FMA>([r[6], r[7], r[8]], v)]
}

/// Errors of the rates that a navigator with a wrong place and velocity computes: of the level
/// against inertial space, and Coriolis'.
#[inline(always)]
fn computed_rates<T: Real, const FMA: bool>(p: &Passage<T>, v: [T; 3], at: [T; 3], latitude: T) -> [[T; 3]; 2] {
    let curved = [p.velocity[0] * p.curvature[0], p.velocity[1] * p.curvature[1]];
    let north = fma::<T, FMA>(curved[0], at[2], v[0]) * p.curvature[0];
    let east = fma::<T, FMA>(curved[1], at[2], v[1]) * p.curvature[1];
    let earth = [-(p.earth_rate[0] * latitude), T::of(0.0), -(p.earth_rate[1] * latitude)];
    let transport = [east, -north, -fma::<T, FMA>(p.tangent, east, p.convergence * latitude)];
    let level = add(transport, earth);
    [level, add(level, earth)]
}

/// (δC − 1) of a vector, for σ.
#[inline(always)]
fn tilted<T: Real, const FMA: bool>(sigma: [T; 3], v: [T; 3]) -> [T; 3] {
    let one = T::of(1.0);
    let once = cross::<T, FMA>(sigma, v);
    let twice = cross::<T, FMA>(sigma, once);
    let square = T::of(1.0 / 16.0) * dot::<T, FMA>(sigma, sigma);
    let share = one / ((one + square) * (one + square));
    let (odd, even) = (share * (one - square), share * T::of(0.5));
    plus::<T, FMA>(even, twice, [odd * once[0], odd * once[1], odd * once[2]])
}

/// Returns the growth of σ over a time h, for the rates u = R δω − δω_in and ω_in + δω_in.
#[inline(always)]
fn turning<T: Real, const FMA: bool>(sigma: [T; 3], u: [T; 3], level: [T; 3], h: T) -> [T; 3] {
    let square = T::of(1.0 / 16.0) * dot::<T, FMA>(sigma, sigma);
    let along = T::of(0.125) * dot::<T, FMA>(sigma, u);
    let around = cross::<T, FMA>(sigma, plus::<T, FMA>(T::of(0.5), u, level));
    let grown = plus::<T, FMA>(T::of(1.0) - square, u, plus::<T, FMA>(along, sigma, around));
    [h * grown[0], h * grown[1], h * grown[2]]
}

/// The parts after one sample, `passed_s` after the base.
#[inline(always)]
fn step<T: Real, const FMA: bool, const ROUND: bool>(
    p: &Passage<T>,
    m: &Member<T>,
    h: T,
    passed_s: T,
    free: T,
) -> [T; 9] {
    let half = T::of(0.5);
    let (b, q) = (&m.base, &m.part);
    let (f, w) = (turned::<T, FMA>(&p.attitude, m.error), turned::<T, FMA>(&p.attitude, m.turn));
    let sigma = add([b[0], b[1], b[2]], [q[0], q[1], q[2]]);
    let part = [q[3], q[4], q[5]];
    let v = add([b[3], b[4], b[5]], part);
    let at = add([b[6], b[7], b[8]], plus::<T, FMA>(passed_s, [b[3], b[4], b[5]], [q[6], q[7], q[8]]));
    let latitude = at[0] * p.curvature[0];
    let none = [T::of(0.0); 3];
    let [level, coriolis] = if ROUND { computed_rates::<T, FMA>(p, v, at, latitude) } else { [none; 2] };
    let (u, rate) = if ROUND { (less(w, level), add(p.level_rate, level)) } else { (w, none) };
    let grown = turning::<T, FMA>(sigma, u, rate, h);
    // By the attitude half-way.
    let mid = plus::<T, FMA>(half, grown, sigma);
    let mut a = add(tilted::<T, FMA>(mid, add(p.force, f)), f);
    if ROUND {
        a = less(a, cross::<T, FMA>(coriolis, add(p.velocity, v)));
        a = less(a, cross::<T, FMA>(p.coriolis_rate, v));
        a[2] = a[2] + fma::<T, FMA>(p.gravity[0], at[2], p.gravity[1] * latitude);
    }
    a[2] = free * a[2];
    // By the velocity's part; that of its total is added where the parts are.
    let mut moved = plus::<T, FMA>(half * h, a, part);
    if ROUND {
        let (north, east) = (p.velocity[0] * p.curvature[0], p.velocity[1] * p.curvature[1]);
        let (falling_n, falling_e) = (p.velocity[2] * p.curvature[0], p.velocity[2] * p.curvature[1]);
        moved[0] = moved[0] + fma::<T, FMA>(north, at[2], -(falling_n * at[0]));
        let narrowing = fma::<T, FMA>(p.tangent, north, falling_e);
        let converging = fma::<T, FMA>(p.velocity[1] * p.tangent, latitude, -(narrowing * at[1]));
        moved[1] = moved[1] + fma::<T, FMA>(east, at[2], converging);
    }
    let (turn, speed) = (add([q[0], q[1], q[2]], grown), plus::<T, FMA>(h, a, part));
    let place = plus::<T, FMA>(h, moved, [q[6], q[7], q[8]]);
    [turn[0], turn[1], turn[2], speed[0], speed[1], speed[2], place[0], place[1], place[2]]
}

/// An attitude error's rotation vector about the vehicle's own level axes: roll about forward,
/// pitch about right, heading about down. `heading_rad` is the vehicle's.
pub fn roll_pitch_heading(turn: Vector3<f64>, heading_rad: f64) -> Vector3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), -heading_rad) * turn
}
