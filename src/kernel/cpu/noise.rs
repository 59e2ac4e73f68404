//! Gaussian numbers for 64 members at once. Twin of `shaders/shared/philox.wgsl`.
//!
//! The numbers of one purpose are numbered; number n of a member is element n mod 4 of counter n / 4. Counter words:
//! n / 4, member low, member high, stream; key: seed. So a number depends on nothing but its name.

use super::lanes::LANES;
use crate::numerics::elementary::{Real, gaussian_pair};
use crate::rng::{Stream, philox4x32_10};

/// One number per member.
pub type Lane<T> = [T; LANES];

/// Who draws: 64 members from `first` on.
#[derive(Debug, Clone, Copy)]
pub struct Drawer {
    /// Key.
    pub seed: u64,
    /// First member; a multiple of 64.
    pub first_member: u64,
}

/// Stream word of a purpose; bias instability has one stream per term.
#[inline(always)]
pub fn stream(purpose: Stream, term: usize) -> u32 {
    purpose as u32 | (term as u32) << 8
}

impl Drawer {
    /// Gaussian numbers 4·`counter` to 4·`counter` + 3 of every member.
    #[inline(always)]
    pub fn four<T: Real, const FMA: bool>(&self, counter: u32, stream: u32, out: &mut [Lane<T>; 4]) {
        let key = [self.seed as u32, (self.seed >> 32) as u32];
        // The first member is a multiple of 64, so the lane never carries into the high word.
        let (low, high) = (self.first_member as u32, (self.first_member >> 32) as u32);
        let mut words = [[0_u32; LANES]; 4];
        for l in 0..LANES {
            let w = philox4x32_10([counter, low | l as u32, high, stream], key);
            words[0][l] = w[0];
            words[1][l] = w[1];
            words[2][l] = w[2];
            words[3][l] = w[3];
        }
        for l in 0..LANES {
            (out[0][l], out[1][l]) = gaussian_pair::<T, FMA>(words[0][l], words[1][l]);
        }
        for l in 0..LANES {
            (out[2][l], out[3][l]) = gaussian_pair::<T, FMA>(words[2][l], words[3][l]);
        }
    }

    /// Gaussian number `n` of every member.
    #[inline(always)]
    pub fn one<T: Real, const FMA: bool>(&self, n: u32, stream: u32) -> Lane<T> {
        let mut four = [[T::of(0.0); LANES]; 4];
        self.four::<T, FMA>(n >> 2, stream, &mut four);
        four[(n & 3) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_draw_what_a_single_philox_draws() {
        let drawer = Drawer { seed: 0x1234_5678_9ABC_DEF0, first_member: (7 << 32) + 64 };
        let word = stream(Stream::GyroFlicker, 3);
        let n = 4_000_000_002;
        let got = drawer.one::<f64, false>(n, word);
        for (l, got) in got.iter().enumerate() {
            let w = philox4x32_10([n >> 2, 64 + l as u32, 7, word], [0x9ABC_DEF0, 0x1234_5678]);
            assert_eq!(*got, gaussian_pair::<f64, false>(w[2], w[3]).0);
        }
    }
}
