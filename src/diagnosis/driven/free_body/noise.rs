//! Noise of the reading as it shows in the force that a motion takes. White noise that is differentiated twice is
//! blue: its past predicts it although nothing is missing from the model.

use nalgebra::{DMatrix, DVector};

use super::low_pass::{Impulse, power};
use super::motion::{MotionAndForce, Part};
use super::regression::Regression;
use crate::driven::intake::data::Data;
use crate::numerics::moments::mean_sd;

/// A residual whose variance is at most this many times that of the reading's noise is taken for that noise alone. The
/// noise is measured above the low-pass of the position, and noise from rounding is not quite white: a slow axis read
/// to 1 µm has 1.12 times the variance that was expected.
const SLACK: f64 = 1.25;

/// Standard deviation of white noise of the reading, from what lies above the low-pass of the position.
pub fn of_reading(data: &Data, motion: &MotionAndForce) -> f64 {
    let counted = motion.counting.iter().cloned().flatten();
    let above: Vec<f64> = counted.map(|k| data.reading[k] - motion.x[k]).collect();
    mean_sd(&above).1 / power(&Impulse::of(data.rate_hz).above).sqrt()
}

/// Predictable fraction (R²) of a force residual that consists of the reading's noise and white noise of the force:
/// from `lags` of its own past values, `every` samples apart.
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
