//! The work unit that other tools are measured on: 8192 Duffing oscillators, 4096 classic
//! Runge–Kutta steps of 1 ms from rest, a shared force, with or without one normal number per step
//! held as a force. Final displacement of the first.
//!
//! In displacement coordinates, as the others have it; the ensemble's own kernel works on the error
//! and does more.

use proofmass_base::parallel;
use proofmass_base::units::MICRO_G;
use proofmass_kernel::cpu::lanes::{Kernel, LANES, Lane, Level};
use proofmass_kernel::cpu::noise::{Draw, Drawer};
use proofmass_numerics::numerics::elementary::{Real, fma};
use proofmass_numerics::rng::Stream;

pub(crate) const MEMBERS: usize = 8192;
pub(crate) const STEPS: usize = 4096;
pub(crate) const STEP_S: f64 = 1e-3;

/// Parameters and force of the work unit.
pub(super) struct Problem<T> {
    blocks: Vec<Block<T>>,
    force: Vec<T>,
}

#[derive(Clone)]
struct Block<T> {
    first_member: u64,
    damping: Lane<T>,
    stiffness: Lane<T>,
    cubic: Lane<T>,
    sigma: Lane<T>,
}

impl<T: Real> Problem<T> {
    /// The parameters are functions of the oscillator's number alone.
    pub(super) fn new() -> Self {
        let tau = std::f64::consts::TAU;
        let block = |b: usize| {
            let zero = Lane::splat(T::of(0.0));
            let mut block =
                Block { first_member: (b * LANES) as u64, damping: zero, stiffness: zero, cubic: zero, sigma: zero };
            for l in 0..LANES {
                let s = (b * LANES + l) as f64 / MEMBERS as f64;
                let w = tau * (30.0 + 5.0 * s);
                block.damping[l] = T::of(w / (0.7 + s));
                block.stiffness[l] = T::of(w * w);
                block.cubic[l] = T::of(0.05 * 10.0 / (10.0 / (w * w)).powi(3));
                block.sigma[l] = T::of(60.0 * MICRO_G * (0.5 / STEP_S).sqrt() * (0.9 + 0.2 * s));
            }
            block
        };
        let at = |t: f64| 7.0 * (tau * 1.3 * t).sin() + 3.0 * (tau * 7.1 * t).cos();
        Self {
            blocks: (0..MEMBERS / LANES).map(block).collect(),
            force: (0..=2 * STEPS).map(|k| T::of(at(k as f64 * 0.5 * STEP_S))).collect(),
        }
    }

    /// One run of the work unit; displacement of oscillator 0 at its end, m.
    pub(super) fn run(&self, noise: bool, level: Level) -> f64 {
        let one = |block: &Block<T>| {
            let force = &self.force;
            if noise { Noisy { block, force }.run(level) } else { level.run(Quiet { block, force }) }
        };
        let ends: Vec<f64> = parallel::map(&self.blocks, one);
        ends[0]
    }
}

impl<T: Real> Default for Problem<T> {
    fn default() -> Self {
        Self::new()
    }
}

struct Quiet<'a, T> {
    block: &'a Block<T>,
    force: &'a [T],
}

struct Noisy<'a, T> {
    block: &'a Block<T>,
    force: &'a [T],
}

impl<T: Real> Kernel for Quiet<'_, T> {
    type Output = f64;
    #[inline(always)]
    fn run<const FMA: bool>(self) -> f64 {
        let zero = Lane::splat(T::of(0.0));
        let (mut x, mut v) = (zero, zero);
        let block = self.block.clone();
        for f in self.force.windows(3).step_by(2) {
            step::<T, FMA>(&block, &mut x, &mut v, [f[0], f[1], f[2]], &zero);
        }
        x[0].f64()
    }
}

/// Steps for which numbers are drawn at a time, in phases like the ensemble's own: a stretch of
/// them, then the steps.
const STRETCH: usize = 16;

impl<T: Real> Noisy<'_, T> {
    fn run(self, level: Level) -> f64 {
        let zero = Lane::splat(T::of(0.0));
        let (mut x, mut v, mut numbers) = (zero, zero, [zero; STRETCH]);
        let drawer = Drawer::new(1, self.block.first_member);
        for (i, force) in self.force.windows(2 * STRETCH + 1).step_by(2 * STRETCH).enumerate() {
            let counter = (i * STRETCH / 4) as u32;
            level.run(Draw { drawer, stream: Stream::Force as u32, counter, each: 4, out: &mut numbers });
            level.run(Pushed { block: self.block, force, numbers: &numbers, x: &mut x, v: &mut v });
        }
        x[0].f64()
    }
}

/// Consecutive steps, each with its normal number.
struct Pushed<'a, T> {
    block: &'a Block<T>,
    force: &'a [T],
    numbers: &'a [Lane<T>],
    x: &'a mut Lane<T>,
    v: &'a mut Lane<T>,
}

impl<T: Real> Kernel for Pushed<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let (mut x, mut v) = (*self.x, *self.v);
        for (f, number) in self.force.windows(3).step_by(2).zip(self.numbers) {
            let mut push = *number;
            for l in 0..LANES {
                push[l] = self.block.sigma[l] * number[l];
            }
            step::<T, FMA>(self.block, &mut x, &mut v, [f[0], f[1], f[2]], &push);
        }
        (*self.x, *self.v) = (x, v);
    }
}

#[inline(always)]
fn step<T: Real, const FMA: bool>(b: &Block<T>, x: &mut Lane<T>, v: &mut Lane<T>, f: [T; 3], push: &Lane<T>) {
    let (h, half, sixth, two) = (T::of(STEP_S), T::of(0.5 * STEP_S), T::of(STEP_S / 6.0), T::of(2.0));
    for l in 0..LANES {
        let (c, k, cubic) = (b.damping[l], b.stiffness[l], b.cubic[l]);
        let (x0, v0) = (x[l], v[l]);
        let a1 = acceleration::<T, FMA>(c, k, cubic, x0, v0, f[0] + push[l]);
        let (x2, v2) = (fma::<T, FMA>(half, v0, x0), fma::<T, FMA>(half, a1, v0));
        let a2 = acceleration::<T, FMA>(c, k, cubic, x2, v2, f[1] + push[l]);
        let (x3, v3) = (fma::<T, FMA>(half, v2, x0), fma::<T, FMA>(half, a2, v0));
        let a3 = acceleration::<T, FMA>(c, k, cubic, x3, v3, f[1] + push[l]);
        let (x4, v4) = (fma::<T, FMA>(h, v3, x0), fma::<T, FMA>(h, a3, v0));
        let a4 = acceleration::<T, FMA>(c, k, cubic, x4, v4, f[2] + push[l]);
        x[l] = fma::<T, FMA>(sixth, fma::<T, FMA>(two, v2 + v3, v0 + v4), x0);
        v[l] = fma::<T, FMA>(sixth, fma::<T, FMA>(two, a2 + a3, a1 + a4), v0);
    }
}

#[inline(always)]
fn acceleration<T: Real, const FMA: bool>(c: T, k: T, cubic: T, x: T, v: T, f: T) -> T {
    fma::<T, FMA>(-x, fma::<T, FMA>(cubic, x * x, k), fma::<T, FMA>(-c, v, f))
}
