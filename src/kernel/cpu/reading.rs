//! What an instrument adds to a reading: white noise, a random walk, the end of its range and the size of its steps.
//!
//! Each is added to consecutive samples of 64 members; bias instability has a file of its own.

use super::lanes::{Kernel, LANES, Lane};
use crate::numerics::elementary::{Real, fma};

/// White noise.
pub(super) struct AddWhite<'a, T> {
    /// Deviation.
    pub scale: &'a Lane<T>,
    pub numbers: &'a [Lane<T>],
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddWhite<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (out, number) in self.out.iter_mut().zip(self.numbers) {
            for l in 0..LANES {
                out[l] = fma::<T, FMA>(self.scale[l], number[l], out[l]);
            }
        }
    }
}

/// A random walk.
pub(super) struct AddWalk<'a, T> {
    /// Deviation of one increment.
    pub scale: &'a Lane<T>,
    pub numbers: &'a [Lane<T>],
    /// Where it has got to.
    pub walk: &'a mut Lane<T>,
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddWalk<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (out, number) in self.out.iter_mut().zip(self.numbers) {
            for l in 0..LANES {
                self.walk[l] = fma::<T, FMA>(self.scale[l], number[l], self.walk[l]);
                out[l] = out[l] + self.walk[l];
            }
        }
    }
}

/// Full scale and quantisation, which act on the reading itself: on the specific force felt plus the error so far.
pub(super) struct Limit<'a, T> {
    /// Largest magnitude of a reading.
    pub range: Option<&'a Lane<T>>,
    /// Size of a step, and steps per m/s²; 0 for none.
    pub steps: Option<[&'a Lane<T>; 2]>,
    pub felt: &'a [Lane<T>],
    pub error: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for Limit<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (error, felt) in self.error.iter_mut().zip(self.felt) {
            if let Some(range) = self.range {
                for l in 0..LANES {
                    error[l] = error[l].min(range[l] - felt[l]).max(-range[l] - felt[l]);
                }
            }
            if let Some([size, steps]) = self.steps {
                for l in 0..LANES {
                    let reading = (felt[l] + error[l]) * steps[l];
                    error[l] = fma::<T, FMA>(size[l], reading.round() - reading, error[l]);
                }
            }
        }
    }
}
