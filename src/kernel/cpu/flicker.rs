//! Bias instability of 64 members: the terms of `kernel::flicker`, carried from sample to sample.
//!
//! Numbers: stream 0 renews the fast term, stream 1 the slow ones (number 0 of a counter is term 1's, number 1 the other's),
//! stream 2 + j starts term j.

use super::lanes::{Kernel, LANES, Lane};
use super::stretch::Numbers;
use crate::kernel::flicker::{RENEWED, RETAINED, place, slow_term};
use crate::kernel::fragment::Fragment;
use crate::numerics::elementary::{Real, fma};
use crate::rng::Stream;

/// State of one instrument's terms.
#[derive(Debug, Clone)]
pub(crate) struct Flicker<T> {
    terms: Vec<Lane<T>>,
    /// Weighted sum of terms 2 and slower.
    slowest: Lane<T>,
}

impl<T: Real> Flicker<T> {
    /// All terms zero, as they are before they are started.
    pub(crate) fn new(terms: usize) -> Self {
        let zero = Lane::splat(T::of(0.0));
        Self { terms: vec![zero; terms], slowest: zero }
    }

    /// All that changes from sample to sample.
    pub(super) fn lanes(&mut self) -> impl Iterator<Item = &mut Lane<T>> {
        let Self { terms, slowest } = self;
        terms.iter_mut().chain([slowest])
    }
}

/// Bias instability in the shader.
pub(super) const FLICKER: Fragment = Fragment {
    begin: "
    let $term_scale = column(i, $TERM);
    let $term_base = $base;
    var $term_terms = vec3<f32>();
    var $term_fasts = vec4<f32>();
    var $term_slows = vec2<f32>();
    if HAS_$TERM {
        if tile.first_sample == 0u {
            start_terms(i, $term_base, member, STREAM_$TERM);
        }
        $term_terms = vec3<f32>(
            state[$term_base * stride + i],
            state[($term_base + 1u) * stride + i],
            sum_slowest(i, $term_base),
        );
    }
",
    draw: "
        if HAS_$TERM {
            $term_fasts = gaussians(counter, member, STREAM_$TERM, seed);
            $term_slows = gaussians(counter, member, STREAM_$TERM | (1u << 8u), seed).xy;
            $term_terms.z = renew_slowest(i, $term_base, 4u * counter, $term_slows.y, $term_terms.z);
        }
",
    add: "
                if HAS_$TERM {
                    $term_terms = renew_fastest(n, pick($term_fasts, number), $term_slows.x, $term_terms);
                    let sum = fma(amplitude(0u), $term_terms.x, fma(amplitude(1u), $term_terms.y, $term_terms.z));
                    $out = fma($term_scale, sum, $out);
                }
",
    end: "
    if HAS_$TERM {
        state[$term_base * stride + i] = $term_terms.x;
        state[($term_base + 1u) * stride + i] = $term_terms.y;
    }
",
};

/// Starts the terms where a run begins, renews those whose turn it is, and adds `scale` times their weighted sum to the
/// samples of a stretch.
pub(super) fn add<T: Real>(
    numbers: &mut Numbers<'_, T>,
    stream: Stream,
    flicker: &mut Flicker<T>,
    amplitudes: &[T],
    scale: &Lane<T>,
    out: &mut [Lane<T>],
) {
    let (level, first) = (numbers.level, numbers.from);
    if first == 0 {
        for j in 1..flicker.terms.len() {
            numbers.pairs(stream, 2 + j, 0, 1);
            flicker.terms[j] = numbers.pairs[0];
        }
    }
    numbers.pairs(stream, 1, first >> 2, (((numbers.until - 1) >> 2) - (first >> 2) + 1) as usize);
    let range = numbers.renew(stream);
    let (fast, slow) = (&numbers.each[range], &*numbers.pairs);
    let place = place(numbers.drawer.first_member);
    level.run(AddFlicker { flicker, amplitudes, scale, first, place, fast, slow, out });
}

/// Renews the terms whose turn it is and adds `scale` times their weighted sum to consecutive samples.
struct AddFlicker<'a, T> {
    pub flicker: &'a mut Flicker<T>,
    /// Weights of the terms.
    pub amplitudes: &'a [T],
    pub scale: &'a Lane<T>,
    /// Number of the first of the samples.
    pub first: u64,
    /// Where in the schedule of renewals these members began.
    pub place: u64,
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
            let renewed = slow_term(sample + self.place).filter(|&j| sample != 0 && j < terms.len());
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
            add_sum::<T, FMA>([self.amplitudes[0], self.amplitudes[1]], [quick, slow, slowest], self.scale, out);
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
fn add_sum<T: Real, const FMA: bool>(a: [T; 2], terms: [&Lane<T>; 3], scale: &Lane<T>, out: &mut Lane<T>) {
    let [quick, slow, slowest] = terms;
    for l in 0..LANES {
        let sum = fma::<T, FMA>(a[1], slow[l], slowest[l]);
        out[l] = fma::<T, FMA>(scale[l], fma::<T, FMA>(a[0], quick[l], sum), out[l]);
    }
}
