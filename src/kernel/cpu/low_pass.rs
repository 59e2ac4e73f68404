//! The low-pass behind the proof masses of 64 members, substep by substep; its weights are those of
//! `kernel::low_pass`. Twin of what `shaders/simulate.wgsl` does with them.

use super::lanes::{LANES, Lane};
use crate::low_pass::{self, WEIGHTS};
use crate::numerics::elementary::{Real, fma};

/// Weights of the members, and the error of what their low-pass shows.
#[derive(Debug, Clone)]
pub(super) struct LowPass<T> {
    /// Of each member, in the order of `kernel::low_pass`.
    pub weights: [Lane<T>; WEIGHTS],
    /// Output of the low-pass less the force, m/s².
    pub p: Lane<T>,
}

/// Motion of a mass in a substep, besides its state at the end.
pub(super) struct Moved<'a, T> {
    /// Its error and the rate of its reading at the beginning.
    pub from: [&'a Lane<T>; 2],
    /// Both at the end.
    pub to: [&'a Lane<T>; 2],
    /// By how much the force has grown.
    pub growth: &'a Lane<T>,
    /// Noise of the force.
    pub push: &'a Lane<T>,
}

impl<T: Real> LowPass<T> {
    /// Of members with these weights, at the beginning; none where each of them is read as it is.
    pub(super) fn of(weights: [Lane<T>; WEIGHTS]) -> Option<Box<Self>> {
        let none = T::of(0.0);
        let unread = |(lane, of): (&Lane<T>, f64)| lane.0.iter().any(|v| *v != none && *v != T::of(of));
        weights.iter().zip(low_pass::NONE).any(unread).then(|| Box::new(Self { weights, p: Lane::splat(none) }))
    }

    /// Takes it over one substep.
    #[inline(always)]
    pub(super) fn step<const FMA: bool>(&mut self, m: &Moved<'_, T>) {
        let [kept, e0, v0, e1, v1, growth, push] = &self.weights;
        for l in 0..LANES {
            let g = m.growth[l];
            let mut p = fma::<T, FMA>(growth[l], g, push[l] * m.push[l]);
            p = fma::<T, FMA>(v1[l], m.to[1][l] - g, p);
            p = fma::<T, FMA>(e1[l], m.to[0][l], p);
            p = fma::<T, FMA>(v0[l], m.from[1][l] - g, p);
            p = fma::<T, FMA>(e0[l], m.from[0][l], p);
            self.p[l] = fma::<T, FMA>(kept[l], self.p[l], p);
        }
    }
}
