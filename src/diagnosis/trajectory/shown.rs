//! States what of a slope is the motion's, and what the noise of the reading that a parameter multiplies.
//!
//! Noise has no information of a parameter, however much of it there is, and where the same noise stands in the residual
//! it moves the parameter (Fuller, *Measurement error models*, 1987, §1.1).

use super::blocks::Linear;
use super::parameters::{GYRO_MISALIGNMENT, GYRO_SCALE, MOUNTING, PARAMETERS, Point};
use super::rows::Row;
use crate::model::Half;

/// Part of what the square of a slope tells from which on it is not the motion's but the sensor's noise (Fuller,
/// *Measurement error models*, 1987, §1.1).
pub(super) const MOST_NOISE: f64 = 1.0 / 9.0;

/// Rows, the half of a pose that they are of, and from one to the next, s.
pub(super) type Rows<'a> = (&'a [Row], Half, f64);

/// Part of the square of a parameter's slope that is the sensor's noise.
pub(super) fn noise_in((rows, half, width_s): Rows<'_>, own: [f64; 2], p: usize) -> f64 {
    let noise = match half {
        Half::Attitude => own[0] / width_s,
        // Specific force over two bins, weighted by a triangle.
        Half::Position => own[1] * 2.0 / (3.0 * width_s),
    };
    let slopes = rows.iter().filter(|row| row.holds).map(|row| row.slope[p].norm_squared());
    let (sum, count) = slopes.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    if sum > 0.0 { noise * count / sum } else { f64::INFINITY }
}

/// Part of the square of each parameter's slope that is the sensor's noise, by the rows of the attitude; zero of
/// parameters that multiply no reading of the gyro.
pub(super) fn noise<'a>(all: impl Iterator<Item = Rows<'a>>, own: [f64; 2]) -> Point {
    let mut noise = [0.0; PARAMETERS];
    for rows in all.filter(|(_, half, _)| *half == Half::Attitude) {
        let of_gyro = MOUNTING.chain(GYRO_SCALE).chain(GYRO_MISALIGNMENT);
        of_gyro.for_each(|p| noise[p] = noise_in(rows, own, p).min(1.0));
    }
    noise
}

/// Returns whether what a model learns of a parameter next to all others, with this variance, is the motion's.
pub(super) fn shows(linear: &Linear, p: usize, variance: f64) -> bool {
    linear.noise_part(p, variance) < MOST_NOISE
}

/// By how much a parameter that is known with this variance may be wrong because the reading that it multiplies and the
/// one that it is held against share their noise: a scale factor by the part of the noise (Fuller, §1.1), and an axis
/// that is off, whose readings are two, by nothing.
pub(super) fn shared(linear: &Linear, p: usize, variance: f64) -> f64 {
    if GYRO_SCALE.contains(&p) { linear.noise_part(p, variance) } else { 0.0 }
}
