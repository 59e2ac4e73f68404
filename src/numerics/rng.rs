//! Counter-based random numbers: Philox4x32-10, identical bit for bit here and in
//! `shaders/shared/philox.wgsl`.
//!
//! A number is a pure function of (seed; member, step, stream): nothing is carried along, so
//! results do not depend on tiles, threads or lanes. Source: Salmon, Moraes, Dror, Shaw, *Parallel
//! random numbers: as easy as 1, 2, 3*, SC 2011.

use rand::rand_core::{Infallible, TryRng};
use rand_distr::{Distribution, StandardNormal};

/// First multiplier of a round.
pub const MULTIPLIER_0: u32 = 0xD251_1F53;
/// Second multiplier of a round.
pub const MULTIPLIER_1: u32 = 0xCD9E_8D57;
/// Increment of the first key word in each round.
pub const WEYL_0: u32 = 0x9E37_79B9;
/// Increment of the second key word in each round.
pub const WEYL_1: u32 = 0xBB67_AE85;

/// Philox4x32 with ten rounds: 128 random bits for one counter and key.
#[inline(always)]
pub fn philox4x32_10(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    let mut round = 0;
    while round < 10 {
        let product_0 = MULTIPLIER_0 as u64 * counter[0] as u64;
        let product_1 = MULTIPLIER_1 as u64 * counter[2] as u64;
        counter = [
            (product_1 >> 32) as u32 ^ counter[1] ^ key[0],
            product_1 as u32,
            (product_0 >> 32) as u32 ^ counter[3] ^ key[1],
            product_0 as u32,
        ];
        key = [key[0].wrapping_add(WEYL_0), key[1].wrapping_add(WEYL_1)];
        round += 1;
    }
    counter
}

/// Purpose of a random number. Each purpose has its own stream, or bits of its own in one
/// (`kernel::cpu::cheap_noise`), so that switching one error on does not change another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Stream {
    /// Tolerances: one draw per member and parameter.
    Tolerance = 0,
    /// Each sample of the accelerometer: its white noise and, of the bits that this leaves, the
    /// steps of its walk and of its fastest Gauss–Markov terms.
    AccelerometerWhite = 1,
    /// Slow Gauss–Markov terms of the accelerometer's bias instability.
    AccelerometerFlicker = 2,
    /// Walk of the accelerometer in the paper's figures; not used by kernels.
    AccelerometerWalk = 3,
    /// Each sample of the gyro, as of the accelerometer.
    GyroWhite = 4,
    /// Slow Gauss–Markov terms of the gyro's bias instability.
    GyroFlicker = 5,
    /// Walk of the gyro in the paper's figures; not used by kernels.
    GyroWalk = 6,
    /// Brownian force on the proof mass.
    Force = 7,
    /// Phases of a random or multisine excitation.
    Excitation = 8,
    /// Resampling and synthetic data on the host.
    Host = 9,
    /// Attitude at the start of a run in six axes.
    Start = 10,
    /// Noise of the fixes that aid a navigation.
    Fix = 11,
    /// Time-stamp jitter of each reading.
    Jitter = 12,
    /// Gauss–Markov process of the accelerometer's bias.
    AccelerometerMarkov = 13,
    /// Gauss–Markov process of the gyro's bias.
    GyroMarkov = 14,
}

/// A stream of random numbers for one member, usable wherever `rand` asks for a generator.
#[derive(Debug, Clone)]
pub struct Philox {
    key: [u32; 2],
    counter: [u32; 4],
    buffer: [u32; 4],
    used: usize,
}

impl Philox {
    /// The stream of `member` for one purpose. Counter words: step (running), member low, member
    /// high, stream.
    pub fn new(seed: u64, member: u64, stream: Stream) -> Self {
        Self {
            key: [seed as u32, (seed >> 32) as u32],
            counter: [0, member as u32, (member >> 32) as u32, stream as u32],
            buffer: [0; 4],
            used: 4,
        }
    }
}

impl Philox {
    /// The next standard normal number.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(self)
    }
}

impl TryRng for Philox {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        if self.used == 4 {
            self.buffer = philox4x32_10(self.counter, self.key);
            self.counter[0] = self.counter[0].wrapping_add(1);
            self.used = 0;
        }
        self.used += 1;
        Ok(self.buffer[self.used - 1])
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let low = self.try_next_u32()? as u64;
        Ok(low | (self.try_next_u32()? as u64) << 32)
    }

    fn try_fill_bytes(&mut self, destination: &mut [u8]) -> Result<(), Infallible> {
        for chunk in destination.chunks_mut(4) {
            let word = self.try_next_u32()?.to_le_bytes();
            chunk.copy_from_slice(&word[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    // Random123 1.14, file kat_vectors, rows "philox4x32 10".
    #[test]
    fn known_answers() {
        assert_eq!(philox4x32_10([0; 4], [0; 2]), [0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8]);
        assert_eq!(philox4x32_10([u32::MAX; 4], [u32::MAX; 2]), [0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd]);
        assert_eq!(
            philox4x32_10([0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344], [0xa4093822, 0x299f31d0]),
            [0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1]
        );
    }

    #[test]
    fn streams_members_and_seeds_differ() {
        let first = |seed, member, stream| Philox::new(seed, member, stream).next_u64();
        let base = first(1, 0, Stream::Host);
        assert_ne!(base, first(2, 0, Stream::Host));
        assert_ne!(base, first(1, 1 << 32, Stream::Host));
        assert_ne!(base, first(1, 0, Stream::Force));
        assert_eq!(base, first(1, 0, Stream::Host));
    }
}
