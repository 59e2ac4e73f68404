//! The integrals of 64 members' reading errors: velocity and position of the accelerometer's, tilt
//! of the gyro's.
//!
//! Sums run in T over 64 samples and are then added to f64 totals (the shader: to compensated
//! ones), so that f32 does not lose the drift of a long run under a large bias. One sample is the
//! unit of time.

use super::lanes::{Kernel, LANES, Lane};
use crate::numerics::elementary::{Real, fma};

/// Samples summed in T before they are added to the totals; a power of two, so that its multiples
/// are exact.
pub(crate) const CHUNK: u64 = 64;
/// A reading error above this, m/s² (a million g), means that the member has left the range of its
/// model.
pub(crate) const BOUND_M_S2: f32 = 1e7;

/// Values of the integrals.
#[derive(Debug, Clone)]
pub(super) struct Sums<T> {
    /// Since the last multiple of [`CHUNK`] samples.
    pub velocity: Lane<T>,
    pub position: Lane<T>,
    pub rate: Lane<T>,
    pub velocity_total: Lane<f64>,
    pub position_total: Lane<f64>,
    pub rate_total: Lane<f64>,
    /// Members that left the range of their model.
    pub failed: [bool; LANES],
}

impl<T: Real> Sums<T> {
    /// Nothing summed yet.
    pub(super) fn new() -> Self {
        let (zero, none) = (Lane::splat(T::of(0.0)), Lane::splat(0.0));
        Self {
            velocity: zero,
            position: zero,
            rate: zero,
            velocity_total: none,
            position_total: none,
            rate_total: none,
            failed: [false; LANES],
        }
    }
}

/// Takes the sums through consecutive samples, of which at most the last is a multiple of
/// [`CHUNK`].
pub(super) struct Integrate<'a, T> {
    pub sums: &'a mut Sums<T>,
    /// Number of samples done when these are.
    pub end: u64,
    /// Errors of the accelerometer; what gravity makes of the tilt is added.
    pub error: &'a mut [Lane<T>],
    /// Errors of the gyro, if it has any.
    pub turn: Option<&'a [Lane<T>]>,
    /// Tilt to horizontal acceleration.
    pub tilt_gain: T,
    /// Error of the proof mass at the end.
    pub e: &'a Lane<T>,
}

impl<T: Real> Kernel for Integrate<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { sums, error, .. } = self;
        if let Some(turn) = self.turn {
            for (error, turn) in error.iter_mut().zip(turn) {
                tilt::<T, FMA>(self.tilt_gain, turn, &sums.rate_total, &mut sums.rate, error);
            }
        }
        let (mut velocity, mut position) = (sums.velocity, sums.position);
        for error in error.iter() {
            // The error is held over the sample, the velocity is a trapezium.
            for l in 0..LANES {
                position[l] = position[l] + fma::<T, FMA>(T::of(0.5), error[l], velocity[l]);
                velocity[l] = velocity[l] + error[l];
            }
        }
        (sums.velocity, sums.position) = (velocity, position);
        if let Some(last) = error.last().filter(|_| self.end.is_multiple_of(CHUNK)) {
            for l in 0..LANES {
                sums.position_total[l] += CHUNK as f64 * sums.velocity_total[l] + sums.position[l].f64();
                sums.velocity_total[l] += sums.velocity[l].f64();
                sums.rate_total[l] += sums.rate[l].f64();
                sums.failed[l] |= last[l].beyond(BOUND_M_S2) || self.e[l].beyond(BOUND_M_S2);
            }
            let zero = Lane::splat(T::of(0.0));
            (sums.position, sums.velocity, sums.rate) = (zero, zero, zero);
        }
    }
}

/// Adds what gravity makes of the mean tilt over the sample, and turns on.
#[inline(always)]
fn tilt<T: Real, const FMA: bool>(gain: T, turn: &Lane<T>, total: &Lane<f64>, rate: &mut Lane<T>, error: &mut Lane<T>) {
    for l in 0..LANES {
        let before = T::of(total[l]) + rate[l];
        error[l] = fma::<T, FMA>(gain, fma::<T, FMA>(T::of(0.5), turn[l], before), error[l]);
        rate[l] = rate[l] + turn[l];
    }
}
