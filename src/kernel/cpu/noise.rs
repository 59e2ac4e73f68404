//! Gaussian numbers for 64 members at once. Twin of `shaders/shared/philox.wgsl`.
//!
//! The numbers of one purpose are numbered; number n of a member is element n mod 4 of counter n
//! / 4. Counter words: n / 4, member low, member high, stream; key: seed. So a number depends on
//! nothing but its name.

use super::lanes::{Kernel, LANES, Lane};
use crate::numerics::elementary::{Real, gaussian_pair};
use crate::rng::{MULTIPLIER_0, MULTIPLIER_1, Stream, WEYL_0, WEYL_1};

/// Who draws: 64 members.
#[derive(Debug, Clone, Copy)]
pub struct Drawer {
    /// Seed of the study.
    pub seed: u64,
    /// First member; a multiple of 64.
    pub first_member: u64,
    /// Lower words of the indices under which they draw: their own, or those of other members, all
    /// with the upper word of the first.
    pub(super) low: Lane<u32>,
}

/// Stream word of a purpose; bias instability has one per group of terms.
#[inline(always)]
pub fn stream(purpose: Stream, term: usize) -> u32 {
    purpose as u32 | (term as u32) << 8
}

impl Drawer {
    /// The members from `first_member` on, each under its own index.
    pub fn new(seed: u64, first_member: u64) -> Self {
        let mut low = Lane::splat(0);
        // The first member is a multiple of 64, so the lane never carries into the high word.
        (0..LANES).for_each(|l| low[l] = first_member as u32 | l as u32);
        Self { seed, first_member, low }
    }

    /// Philox4x32-10 for 64 members, word for word that of `rng`, in 64-bit lanes: a 32-bit
    /// multiplication that keeps both halves is one instruction there, and what piles up in the
    /// upper half is never looked at.
    ///
    /// Each round waits for the one before: two members at a time, half the lanes apart, give the
    /// processor twice as much to do meanwhile (Zen 5: a sixth fewer cycles with SSE2 and AVX-512,
    /// a twentieth with AVX2; four at a time are ten times slower, for the compiler then keeps them
    /// in memory).
    #[inline(always)]
    fn words(&self, counter: u32, stream: u32, out: &mut [Lane<u32>; 4]) {
        const LOW: u64 = 0xFFFF_FFFF;
        const HALF: usize = LANES / 2;
        let high = self.first_member >> 32;
        for l in 0..HALF {
            let mut pair = [l, l + HALF].map(|l| [u64::from(counter), u64::from(self.low[l]), high, u64::from(stream)]);
            let mut key = [self.seed as u32, (self.seed >> 32) as u32];
            for _ in 0..10 {
                for c in &mut pair {
                    let product_0 = u64::from(MULTIPLIER_0) * (c[0] & LOW);
                    let product_1 = u64::from(MULTIPLIER_1) * (c[2] & LOW);
                    *c = [
                        product_1 >> 32 ^ c[1] ^ u64::from(key[0]),
                        product_1,
                        product_0 >> 32 ^ c[3] ^ u64::from(key[1]),
                        product_0,
                    ];
                }
                key = [key[0].wrapping_add(WEYL_0), key[1].wrapping_add(WEYL_1)];
            }
            for i in 0..4 {
                (out[i][l], out[i][l + HALF]) = (pair[0][i] as u32, pair[1][i] as u32);
            }
        }
    }

    /// Gaussian numbers of consecutive counters from `counter` on: the first `each` (2 or 4) of
    /// every counter's four.
    #[inline(always)]
    pub fn fill<T: Real, const FMA: bool>(&self, stream: u32, counter: u32, each: usize, out: &mut [Lane<T>]) {
        let mut words = [Lane::splat(0_u32); 4];
        for (i, numbers) in out.chunks_exact_mut(each).enumerate() {
            self.words(counter.wrapping_add(i as u32), stream, &mut words);
            normals::<T, FMA>(&words, numbers);
        }
    }
}

/// The gaussian numbers that four words make, as many as there is room for.
#[inline(always)]
fn normals<T: Real, const FMA: bool>(words: &[Lane<u32>; 4], numbers: &mut [Lane<T>]) {
    for (pair, words) in numbers.chunks_exact_mut(2).zip(words.chunks_exact(2)) {
        let [first, second] = pair else { continue };
        gaussian_pairs::<T, FMA>(&words[0], &words[1], first, second);
    }
}

/// The bits of four words that no gaussian number looks at, side by side: seven for each of four
/// samples, see [`super::cheap_noise`].
#[inline(always)]
fn left_over(words: &[Lane<u32>; 4], out: &mut Lane<u32>) {
    for l in 0..LANES {
        out[l] =
            words[0][l] & 0x7F | (words[1][l] & 0x7F) << 8 | (words[2][l] & 0x7F) << 16 | (words[3][l] & 0x7F) << 24;
    }
}

#[inline(always)]
fn gaussian_pairs<T: Real, const FMA: bool>(
    radius: &Lane<u32>,
    angle: &Lane<u32>,
    first: &mut Lane<T>,
    second: &mut Lane<T>,
) {
    for l in 0..LANES {
        (first[l], second[l]) = gaussian_pair::<T, FMA>(radius[l], angle[l]);
    }
}

/// Draws what consecutive counters have for four samples each: gaussian numbers, unless there is no
/// room for them, and the bits that are left over.
pub(crate) struct DrawSamples<'a, T> {
    /// Source of random numbers.
    pub drawer: Drawer,
    /// Stream of the process.
    pub stream: u32,
    /// Counter of the first step.
    pub counter: u32,
    pub numbers: &'a mut [Lane<T>],
    pub bits: &'a mut [Lane<u32>],
}

impl<T: Real> Kernel for DrawSamples<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let mut words = [Lane::splat(0_u32); 4];
        let mut numbers = self.numbers.chunks_exact_mut(4);
        for (i, bits) in self.bits.iter_mut().enumerate() {
            self.drawer.words(self.counter.wrapping_add(i as u32), self.stream, &mut words);
            if let Some(numbers) = numbers.next() {
                normals::<T, FMA>(&words, numbers);
            }
            left_over(&words, bits);
        }
    }
}

/// Fills lanes with the numbers of one stream: compiled once for all purposes.
pub struct Draw<'a, T> {
    /// Source of random numbers.
    pub drawer: Drawer,
    /// Stream of the process.
    pub stream: u32,
    /// Counter of the first step.
    pub counter: u32,
    /// Numbers taken of each counter, 2 or 4.
    pub each: usize,
    /// Values of a lane for each step.
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for Draw<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        self.drawer.fill::<T, FMA>(self.stream, self.counter, self.each, self.out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::philox4x32_10;

    #[test]
    fn lanes_draw_what_a_single_philox_draws() {
        let drawer = Drawer::new(0x1234_5678_9ABC_DEF0, (7 << 32) + 64);
        let word = stream(Stream::GyroFlicker, 3);
        let mut four = [Lane::splat(0.0); 4];
        drawer.fill::<f64, false>(word, 1_000_000_000, 4, &mut four);
        for (l, got) in four[2].0.iter().enumerate() {
            let w = philox4x32_10([1_000_000_000, 64 + l as u32, 7, word], [0x9ABC_DEF0, 0x1234_5678]);
            assert_eq!(*got, gaussian_pair::<f64, false>(w[2], w[3]).0);
        }
    }
}
