//! States what an IMU in motion, and its place next to the reference, may have other than the
//! ideal: where each number stands.
//!
//! Gyro: y = (I + S) ω + K f + b; accelerometer: y = (I + S) f + b. ω and f stand in the IMU's
//! axes, which are the accelerometer's and which C = C₀ exp(c) turns to the body axes of the
//! reference. The accelerometer's own scale and axes are judged where the reference has attitudes.
//! Next to positions alone they are free within what a sensor has, for what they do to gravity
//! as the body turns would else be taken for errors of the gyro. An IMU's stamp is late by τ + d (t
//! − t_middle). Zero is "absent", everywhere.

use std::ops::Range;

use super::log::Halves;

/// Number of parameters, fitted or not.
pub(super) const PARAMETERS: usize = 63;
/// A point in the space of all parameters, SI units.
pub(super) type Point = [f64; PARAMETERS];

/// b of the gyro, rad/s.
pub(super) const GYRO_BIAS: Range<usize> = 0..3;
/// b of the accelerometer, m/s².
pub(super) const FORCE_BIAS: Range<usize> = 3..6;
/// Gravity's components along the reference's north and east, m/s².
pub(super) const TILT: Range<usize> = 6..8;
/// By how much the readings are late in all, s: what the clock of the IMU stamps late, τ, and the
/// lag of a low-pass that they went through.
pub(super) const OFFSET: usize = 8;
/// Rate d of the IMU's clock against the reference's, s/s.
pub(super) const DRIFT: usize = 9;
/// Rotation c from IMU to body beyond the one taken, rad.
pub(super) const MOUNTING: Range<usize> = 10..13;
/// Diagonal of the gyro's S.
pub(super) const GYRO_SCALE: Range<usize> = 13..16;
/// The gyro's S off its diagonal: xy, xz, yx, yz, zx, zy.
pub(super) const GYRO_MISALIGNMENT: Range<usize> = 16..22;
/// K by rows, rad/s per m/s².
pub(super) const G_SENSITIVITY: Range<usize> = 22..31;
/// From the reference's origin to the accelerometer, body axes, m.
pub(super) const LEVER_ARM: Range<usize> = 31..34;
/// Slow wander of b of the gyro: two cosines over the recording, of x, then of y and z, rad/s.
pub(super) const GYRO_WANDER: Range<usize> = 34..40;
/// The same of the accelerometer, m/s².
pub(super) const FORCE_WANDER: Range<usize> = 40..46;
/// Rate of the reference's north-east-down against inertial space, rad/s.
pub(super) const EARTH_RATE: Range<usize> = 46..49;
/// By how much the attitude that dead reckoning goes through is off, about north, east and down,
/// rad: free where the reference has no attitudes.
pub(super) const ANCHOR: Range<usize> = 49..52;
/// The accelerometer's S on and below its diagonal: xx, yy, zz, yx, zx, zy.
pub(super) const FORCE_MATRIX: Range<usize> = 52..58;
/// The diagonal of it.
pub(super) const FORCE_SCALE: Range<usize> = 52..55;
/// The rest of it.
pub(super) const FORCE_MISALIGNMENT: Range<usize> = 55..58;
/// Square of the time constant of a low-pass that the readings went through, s². It enters by its
/// square next to the lag of both together, for to the first order a low-pass is a clock that is
/// late.
pub(super) const LOWPASS: usize = 58;

/// By how much each axis of the gyro reads too much in the square of its rate, s/rad. In no model: what is
/// left is held against it.
pub(super) const RATE_SQUARE: Range<usize> = 59..62;
/// By how much the reference's positions are too large, as a part. In no model either.
pub(super) const LENGTH: usize = 62;

/// Places of the gyro's off-diagonal numbers.
pub(super) const GYRO_OFF_DIAGONAL: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];
/// Places of the accelerometer's numbers: its axes are the body's.
pub(super) const FORCE_PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1)];
/// Cosines that a slow wander is made of.
pub(super) const COSINES: usize = 2;

/// The accelerometer's scale and axes as it is delivered: half a per cent to one.
pub(super) const DELIVERED: f64 = 1e-2;
/// By how much an attitude that dead reckoning goes through may be off, rad.
pub(super) const ANCHOR_RAD: f64 = 0.3;

/// Returns how large each number may be at the very most next to a reference with these halves of a pose: the
/// standard deviation of a prior that holds fast what nothing shows.
pub(super) fn widths(halves: Halves) -> Point {
    let mut widths = [0.0; PARAMETERS];
    let rows: [(Range<usize>, f64); 18] = [
        (GYRO_BIAS, 1.0),
        (FORCE_BIAS, 5.0),
        (TILT, 3.0),
        (OFFSET..OFFSET + 1, 10.0),
        (DRIFT..DRIFT + 1, 1e-2),
        (MOUNTING, 1.0),
        (GYRO_SCALE, 0.5),
        (GYRO_MISALIGNMENT, 0.5),
        (G_SENSITIVITY, 2e-2),
        (LEVER_ARM, 10.0),
        (GYRO_WANDER, 0.2),
        (FORCE_WANDER, 2.0),
        (EARTH_RATE, 1e-3),
        (ANCHOR, ANCHOR_RAD),
        (FORCE_MATRIX, if halves.attitude { 0.5 } else { DELIVERED }),
        (LOWPASS..LOWPASS + 1, 1e-2),
        (RATE_SQUARE, 0.5),
        (LENGTH..LENGTH + 1, 0.5),
    ];
    for (range, width) in rows {
        widths[range].fill(width);
    }
    widths
}

/// Time constant of the low-pass, s; zero where there is none.
pub(super) fn lowpass_s(point: &Point) -> f64 {
    point[LOWPASS].max(0.0).sqrt()
}

/// By how much the clock alone is late, s.
pub(super) fn clock_s(point: &Point) -> f64 {
    point[OFFSET] - lowpass_s(point)
}

/// A parameter as it is stated, SI.
pub(super) fn stated(point: &Point, p: usize) -> f64 {
    match p {
        OFFSET => clock_s(point),
        LOWPASS => lowpass_s(point),
        _ => point[p],
    }
}
