//! Intervals from the fits with one pose left out in turn: they need no model of the noise, only
//! that poses err apart. Source: Efron & Tibshirani, An Introduction to the Bootstrap, 1993,
//! chapter 11.

use super::calibration::Point;
use super::fit::Fit;
use crate::numerics::special::t_quantile;

/// Half the width of a 95 % interval from delete-one-pose replicates.
pub(crate) fn half_width(of: &dyn Fn(&Point) -> f64, fit: &Fit, replicates: &[Point]) -> f64 {
    let each: Vec<f64> = replicates.iter().map(of).collect();
    // Each pose brings about six equations; a parameter costs its part of a pose.
    let degrees_of_freedom = (each.len() as f64 - fit.active.len() as f64 / 6.0).max(2.0);
    t_quantile(0.975, degrees_of_freedom) * deviation(&each)
}

/// Standard deviation of an estimate from its delete-one replicates.
pub(super) fn deviation(each: &[f64]) -> f64 {
    let n = each.len().max(1) as f64;
    let mean = each.iter().sum::<f64>() / n;
    ((n - 1.0) / n * each.iter().map(|v| (v - mean).powi(2)).sum::<f64>()).sqrt()
}
