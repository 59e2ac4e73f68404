//! Adds what 64 members take from the temperature and from late stamps to consecutive samples, and
//! the end of their gyros' range. Twin of `followed` in `shaders/navigate.wgsl`.

use super::lanes::{Kernel, LANES, Lane};
use crate::environment::FOLLOWED;
use crate::numerics::elementary::{Real, fma};
use crate::truth_step::Passage;

/// The numbers, and the errors of the accelerometers' readings and of the gyros'.
pub(super) struct Followed<'a, T> {
    /// Numbers as `Follow::numbers` has them.
    pub numbers: &'a [Lane<T>; FOLLOWED],
    pub passages: &'a [Passage<T>],
    /// Of each sample a normal number; empty without jitter.
    pub jitter: &'a [Lane<T>],
    /// Samples from the end of the still start to the first of these.
    pub passed: u64,
    /// Time between samples, s.
    pub sample_s: f64,
    pub error: [&'a mut [Lane<T>]; 3],
    pub turn: [&'a mut [Lane<T>]; 3],
}

impl<T: Real> Kernel for Followed<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let k = self.numbers;
        let none = Lane::splat(T::of(0.0));
        for axis in 0..3 {
            for n in 0..self.passages.len() {
                let p = &self.passages[n];
                let time_s = T::of(((self.passed + n as u64) as f64 + 0.5) * self.sample_s);
                let jitter = if self.jitter.is_empty() { &none } else { &self.jitter[n] };
                let (error, turn) = (&mut self.error[axis][n], &mut self.turn[axis][n]);
                for l in 0..LANES {
                    let offset = fma::<T, FMA>(k[14][l], time_s, k[12][l]);
                    let late = -fma::<T, FMA>(k[13][l], jitter[l], offset);
                    let force = fma::<T, FMA>(k[3 + axis][l], p.body_force[axis], k[axis][l]);
                    let rate = fma::<T, FMA>(k[9 + axis][l], p.body_rate[axis], k[6 + axis][l]);
                    let warm_force = fma::<T, FMA>(force, p.warmer, error[l]);
                    let warm_rate = fma::<T, FMA>(rate, p.warmer, turn[l]);
                    error[l] = fma::<T, FMA>(late, p.force_change[axis], warm_force);
                    let (range, rate) = (k[15 + axis][l], p.body_rate[axis]);
                    let turned = fma::<T, FMA>(late, p.rate_change[axis], warm_rate);
                    turn[l] = turned.min(range - rate).max(-range - rate);
                }
            }
        }
    }
}
