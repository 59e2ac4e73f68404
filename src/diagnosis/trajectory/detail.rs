//! Plain numbers behind the figures and the words of a diagnosis of an IMU in motion.

use super::account::Account;
use super::repaired::Repaired;
use crate::verdict::Triads;

/// Plain numbers behind the figures.
#[derive(Debug, Clone)]
pub struct Detail {
    /// Attitude: changes of the error per second.
    pub attitude: Series,
    /// Position: errors of acceleration.
    pub position: Series,
    /// Angle between reference and dead reckoning, rad, over time.
    pub drift: Vec<(f64, f64)>,
    /// Spectra of gyro and accelerometer in motion: Hz, unit/√Hz, mean of the axes.
    pub spectra: [Vec<(f64, f64)>; 2],
    /// One-sided densities that the model states, unit/√Hz: gyro, accelerometer.
    pub stated: [Option<f64>; 2],
    /// Biases and matrices with their intervals.
    pub published: Option<Triads>,
    /// The sensor as diagnosed, for a study along the reference; none without a reference.
    pub repaired: Option<Repaired>,
    /// Facts that the sentences of the verdict are made from.
    pub account: Account,
}

/// Lengths of a residual over time, thinned for plotting: s, SI.
#[derive(Debug, Clone, Default)]
pub struct Series {
    /// Time, s, and size with the base model.
    pub before: Vec<(f64, f64)>,
    /// Time, s, and size with the named effects.
    pub after: Vec<(f64, f64)>,
}
