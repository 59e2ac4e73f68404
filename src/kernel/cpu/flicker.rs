//! Bias instability of 64 members: the terms of `kernel::flicker`, carried from sample to sample.
//!
//! Numbers: terms 0 and 1 are renewed by small steps of the samples' counters (`cheap_noise`);
//! stream 1 renews the slower ones (one counter for 16 samples: its number 0 is for the first of
//! them, number 1 for the ninth); stream 2 + j starts term j.

use super::cheap_noise;
use super::lanes::{Kernel, LANES, Lane};
use super::stretch::Numbers;
use crate::flicker::{HELD, RENEWED, RETAINED, place, slow_term};
use crate::fragment::Fragment;
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
    block: "
        if HAS_$TERM {
            $term_slows = gaussian_first_pair(block, member, STREAM_$TERM | (1u << 8u), seed);
        }
",
    draw: "
        if HAS_$TERM && (counter & 1u) == 0u {
            let number = select($term_slows.x, $term_slows.y, (counter & 2u) == 2u);
            $term_terms.z = renew_slowest(i, $term_base, 4u * counter, number, $term_terms.z);
        }
",
    add: "
                if HAS_$TERM {
                    $term_terms = renew_fastest($sense_words, number, $term_terms);
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

/// Starts the terms where a run begins, renews those whose turn it is, and adds `scale` times their
/// weighted sum to the samples of a stretch. Numbers come from the stream of the samples and from
/// that of the slow terms.
pub(super) fn add<T: Real>(
    numbers: &mut Numbers<'_, T>,
    [samples, stream]: [Stream; 2],
    flicker: &mut Flicker<T>,
    amplitudes: &[T],
    scale: &Lane<T>,
    out: &mut [Lane<T>],
) {
    let (level, first) = (numbers.level, numbers.from);
    if first == 0 {
        for j in 0..flicker.terms.len() {
            flicker.terms[j] = numbers.start(stream, 2 + j);
        }
    }
    numbers.bits(samples);
    let is_dense = numbers.own.is_some();
    match is_dense {
        false => _ = numbers.pair(stream, 1, first >> 4),
        true if first.is_multiple_of(HELD) => dense(numbers, stream, flicker, amplitudes),
        true => {}
    }
    let (slow, bits) = numbers.drawn();
    let place = if is_dense { 0 } else { place(numbers.drawer.first_member) };
    level.run(AddFlicker { flicker, amplitudes, scale, first, place, is_dense, bits, slow, out });
}

/// Steps every slow term by 16 samples at once, with one random number per term.
fn dense<T: Real>(numbers: &mut Numbers<'_, T>, stream: Stream, flicker: &mut Flicker<T>, amplitudes: &[T]) {
    let counter = numbers.from / HELD;
    flicker.slowest = Lane::splat(T::of(0.0));
    for (j, (term, amplitude)) in flicker.terms.iter_mut().zip(amplitudes).enumerate().skip(2) {
        if counter > 0 {
            let number = numbers.pair(stream, 2 + j, counter)[0];
            let left = -(HELD as f64) / 4f64.powi(j as i32);
            let (keep, new) = (T::of(left.exp()), T::of((-(2.0 * left).exp_m1()).sqrt()));
            (0..LANES).for_each(|l| term[l] = keep * term[l] + new * number[l]);
        }
        (0..LANES).for_each(|l| flicker.slowest[l] = *amplitude * term[l] + flicker.slowest[l]);
    }
}

/// Renews the terms whose turn it is and adds `scale` times their weighted sum to consecutive
/// samples.
struct AddFlicker<'a, T> {
    pub flicker: &'a mut Flicker<T>,
    /// Weights of the terms.
    pub amplitudes: &'a [T],
    pub scale: &'a Lane<T>,
    /// Number of the first of the samples.
    pub first: u64,
    /// Place in the schedule of renewals at which these members began.
    pub place: u64,
    /// Says whether the slow terms have been taken along, see [`dense`].
    pub is_dense: bool,
    /// Small steps of each four samples that share a counter.
    pub bits: &'a [Lane<u32>],
    /// Numbers for the slow terms.
    pub slow: &'a [Lane<T>; 2],
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddFlicker<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Flicker { terms, slowest } = self.flicker;
        let (keep, new) = (T::of(RETAINED), T::of(RENEWED));
        for (i, out) in self.out.iter_mut().enumerate() {
            let sample = self.first + i as u64;
            let bits = &self.bits[((sample >> 2) - (self.first >> 2)) as usize];
            let renewed =
                slow_term(sample + self.place).filter(|&j| sample != 0 && j < terms.len() && !(self.is_dense && j > 1));
            match renewed {
                Some(1) => step_fourth::<T, FMA>(keep, new, &mut terms[1], bits),
                Some(j) => relax::<T, FMA>(keep, new, &mut terms[j], &self.slow[usize::from(j == 2)]),
                None => {}
            }
            if (sample == 0 && !self.is_dense) || renewed.is_some_and(|j| j > 1) {
                *slowest = Lane::splat(T::of(0.0));
                for (term, a) in terms.iter().zip(self.amplitudes).skip(2) {
                    for l in 0..LANES {
                        slowest[l] = fma::<T, FMA>(*a, term[l], slowest[l]);
                    }
                }
            }
            let [quick, slow, ..] = &mut terms[..] else { return };
            step_fast::<T, FMA>(keep, T::of(RENEWED * cheap_noise::EIGHTH), quick, bits, sample);
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

// In functions of their own: where a term may be one of several, the compiler does not see that its
// lanes are apart.

#[inline(always)]
fn step_fast<T: Real, const FMA: bool>(keep: T, new: T, term: &mut Lane<T>, bits: &Lane<u32>, sample: u64) {
    for l in 0..LANES {
        term[l] = fma::<T, FMA>(keep, term[l], new * cheap_noise::fast(bits[l], sample));
    }
}

#[inline(always)]
fn step_fourth<T: Real, const FMA: bool>(keep: T, new: T, term: &mut Lane<T>, bits: &Lane<u32>) {
    for l in 0..LANES {
        term[l] = fma::<T, FMA>(keep, term[l], new * cheap_noise::fourth(bits[l]));
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
