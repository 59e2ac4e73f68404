//! Bias instability of 64 members: the terms of `kernel::flicker`, carried from sample to sample.
//!
//! Numbers: stream 0 renews the fast term, stream 1 the slow ones (number 0 of a counter is term 1's, number 1 the other's),
//! stream 2 + j starts term j.

use super::lanes::{Kernel, LANES, Lane};
use crate::kernel::flicker::{RENEWED, RETAINED, slow_term};
use crate::numerics::elementary::{Real, fma};

/// State of one instrument's terms.
#[derive(Debug, Clone)]
pub struct Flicker<T> {
    pub(super) terms: Vec<Lane<T>>,
    /// Weighted sum of terms 2 and slower.
    slowest: Lane<T>,
}

impl<T: Real> Flicker<T> {
    /// All terms zero, as they are before they are started.
    pub fn new(terms: usize) -> Self {
        let zero = Lane::splat(T::of(0.0));
        Self { terms: vec![zero; terms], slowest: zero }
    }

    /// All that changes from sample to sample.
    pub(super) fn lanes(&mut self) -> impl Iterator<Item = &mut Lane<T>> {
        let Self { terms, slowest } = self;
        terms.iter_mut().chain([slowest])
    }
}

/// Renews the terms whose turn it is and adds `scale` times their weighted sum to consecutive samples.
pub(super) struct AddFlicker<'a, T> {
    pub flicker: &'a mut Flicker<T>,
    /// Weights of the terms.
    pub amplitudes: &'a [T],
    pub scale: &'a Lane<T>,
    /// Number of the first of the samples.
    pub first: u64,
    /// Numbers for the fast term, one a sample.
    pub fast: &'a [Lane<T>],
    /// Numbers for the slow terms, two for each four samples that share a counter.
    pub slow: &'a [Lane<T>],
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddFlicker<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Flicker { terms, slowest } = self.flicker;
        for (i, (out, fast)) in self.out.iter_mut().zip(self.fast).enumerate() {
            let sample = self.first + i as u64;
            let (keep, new) = if sample == 0 { (0.0, 1.0) } else { (RETAINED, RENEWED) };
            let (keep, new) = (T::of(keep), T::of(new));
            let renewed = slow_term(sample).filter(|&j| j < terms.len());
            if let Some(j) = renewed {
                let pair = ((sample >> 2) - (self.first >> 2)) as usize * 2;
                relax::<T, FMA>(keep, new, &mut terms[j], &self.slow[pair + usize::from(j > 1)]);
            }
            if sample == 0 || renewed.is_some_and(|j| j > 1) {
                *slowest = Lane::splat(T::of(0.0));
                for (term, a) in terms.iter().zip(self.amplitudes).skip(2) {
                    for l in 0..LANES {
                        slowest[l] = fma::<T, FMA>(*a, term[l], slowest[l]);
                    }
                }
            }
            let [quick, slow, ..] = &mut terms[..] else { return };
            relax::<T, FMA>(keep, new, quick, fast);
            add::<T, FMA>([self.amplitudes[0], self.amplitudes[1]], [quick, slow, slowest], self.scale, out);
        }
    }
}

#[inline(always)]
fn relax<T: Real, const FMA: bool>(keep: T, new: T, term: &mut Lane<T>, number: &Lane<T>) {
    for l in 0..LANES {
        term[l] = fma::<T, FMA>(keep, term[l], new * number[l]);
    }
}

#[inline(always)]
fn add<T: Real, const FMA: bool>(a: [T; 2], terms: [&Lane<T>; 3], scale: &Lane<T>, out: &mut Lane<T>) {
    let [quick, slow, slowest] = terms;
    for l in 0..LANES {
        let sum = fma::<T, FMA>(a[1], slow[l], slowest[l]);
        out[l] = fma::<T, FMA>(scale[l], fma::<T, FMA>(a[0], quick[l], sum), out[l]);
    }
}
