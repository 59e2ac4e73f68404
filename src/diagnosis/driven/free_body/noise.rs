//! Noise of the reading in the force that a motion takes: differentiated twice it is blue, so that it foretells
//! itself although nothing is missing.

use nalgebra::{DMatrix, DVector};

use super::low_pass::{Impulse, power};
use super::motion::{MotionAndForce, Part};
use super::regression::Regression;
use crate::driven::intake::data::Data;
use crate::numerics::moments::mean_sd;

/// Variance of a residual over that of the reading's noise in it up to which it is taken for nothing else: noise is
/// measured above the low-pass of the position, and is not white where it comes of rounding.
const SLACK: f64 = 1.25;

/// Standard deviation of white noise of the reading, from what lies above the low-pass of the position.
pub fn of_reading(data: &Data, motion: &MotionAndForce) -> f64 {
    let counted = motion.counting.iter().cloned().flatten();
    let above: Vec<f64> = counted.map(|k| data.reading[k] - motion.x[k]).collect();
    mean_sd(&above).1 / power(&Impulse::of(data.rate_hz).above).sqrt()
}

/// Fraction of the variance of a residual of the force that its own past, every so many samples, predicts where it
/// is noise of the reading, and beyond that white.
pub(super) fn predictable(
    data: &Data,
    motion: &MotionAndForce,
    model: &Regression,
    (every, lags): (usize, usize),
) -> f64 {
    let impulse = Impulse::of(data.rate_hz);
    let (mass, drag) = (model.of(Part::Acceleration), model.of(Part::Velocity));
    let response: Vec<f64> =
        impulse.acceleration.iter().zip(&impulse.velocity).map(|(a, v)| mass * a + drag * v).collect();
    let noise = of_reading(data, motion).powi(2);
    let product = |lag: usize| response.iter().zip(&response[lag..]).map(|(a, b)| a * b).sum::<f64>();
    let mut covariance: Vec<f64> = (0..=lags).map(|lag| noise * product(lag * every)).collect();
    let over = model.variance / covariance[0].max(f64::MIN_POSITIVE);
    let share = if over < SLACK { over } else { 1.0 };
    covariance.iter_mut().for_each(|c| *c *= share);
    covariance[0] = covariance[0].max(model.variance) * (1.0 + 1e-9);
    let past = DVector::from_column_slice(&covariance[1..]);
    let matrix = DMatrix::from_fn(lags, lags, |i, j| covariance[i.abs_diff(j)]);
    matrix.cholesky().map_or(0.0, |c| c.solve(&past).dot(&past) / covariance[0])
}
