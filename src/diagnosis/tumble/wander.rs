//! States how far offsets wander from pose to pose by 1/f noise, from the poses themselves.
//!
//! Inside a pose 1/f noise hides under the white noise; over the recording it is what moves the
//! poses. Unlike a law of the sensor, which follows attitude, it is alike in neighbouring poses:
//! two means have the covariance (B²/π) times the mean of ln(T/|t − s|) over their samples, in a
//! recording of length T (the spectrum B²/(πf) of `noise`). Restricted likelihood weighs it against
//! a misfit without memory (Patterson & Thompson, Biometrika 58 (1971) 545); where wander accounts
//! for what is left, the noise of every pose is raised.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, Vector3};

use super::calibration::Calibration;
use super::fit::Fit;
use super::group::Group;
use super::imu::Observed;
use super::residual::Residual;
use crate::sensor::Sense;

/// Loss in twice the log-likelihood, against a misfit without memory, from which wander is ruled
/// out: 5 % for one parameter at its bound (Self & Liang, J. Am. Stat. Assoc. 82 (1987) 605). Poses
/// are too few to prove wander that small; a mismatch is claimed only where wander cannot be all of
/// it.
const RULED_OUT: f64 = 2.7;
/// Misfit over the noise variance up to which it may be wander. Noise inside the poses that is a
/// few times too small is within what a second of stillness tells of minutes; more has a cause, and
/// a cause with a memory (hysteresis) wanders too.
pub(super) const MOST: f64 = 4.0;
/// Factors on the noise variance without memory that are tried.
const WITHOUT_MEMORY: [f64; 9] = [1.0, 1.5, 2.2, 3.3, 5.0, 10.0, 30.0, 100.0, 1000.0];
/// Factors on the wander's variance, which begins at a quarter of the mean noise variance of a
/// pose.
const WANDER: [f64; 10] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0];
/// Part of what is known of a parameter that is left out of account.
const NEXT_TO_NOTHING: f64 = 0.01;
/// More rows than this take too long for what they add.
const MOST_ROWS: usize = 360;

/// Raises the 1/f noise of sensors whose residual at rest is above its noise and wanders; whether
/// any was raised.
pub(crate) fn raise(observed: &mut Observed<'_>, fit: &Fit) -> bool {
    let above: Vec<Group> = Residual::of(fit).above.iter().filter(|a| a.1 < MOST).map(|a| a.0).collect();
    let mut raised = false;
    for (group, sensor) in [(Group::Gravity, Sense::Accelerometer), (Group::Still, Sense::Gyro)] {
        let Some(level) = above.contains(&group).then(|| wander(observed, fit, group)).flatten() else { continue };
        let (noise, scale) = match sensor {
            Sense::Accelerometer => (&mut observed.accelerometer_noise, observed.accelerometer_scale),
            Sense::Gyro => (&mut observed.gyro_noise, observed.gyro_scale),
        };
        for axis in noise.iter_mut() {
            let own = level.sqrt() * scale;
            if own > axis.bias_instability {
                axis.bias_instability = own;
                raised = true;
            }
        }
    }
    if raised {
        observed.weigh();
    }
    raised
}

/// B² of the wander in SI, where it accounts for the misfit.
fn wander(observed: &Observed<'_>, fit: &Fit, group: Group) -> Option<f64> {
    let rows: Vec<usize> = (0..fit.rows.group.len()).filter(|r| fit.rows.group[*r] == group).collect();
    if rows.len() > MOST_ROWS || rows.len() < fit.active.len() / 2 {
        return None;
    }
    let calibration = Calibration::from_point(&fit.point);
    let up: Vec<Vector3<f64>> =
        observed.forces_m_s2(&calibration).iter().map(|f| f / f.norm().max(f64::MIN_POSITIVE)).collect();
    // Along which axes a row reads: gravity along its direction, the gyro at rest along one axis
    // after the other.
    let along = |n: usize| match group {
        Group::Gravity => up[fit.rows.pose[rows[n]]],
        _ => Vector3::ith(n % 3, 1.0),
    };
    let record_s = observed.imu.accelerometer[0].len() as f64 / observed.imu.rate_hz;
    let length_s = |k: usize| observed.poses[k].samples.len() as f64 / observed.imu.rate_hz;
    let kernel = DMatrix::from_fn(rows.len(), rows.len(), |a, b| {
        let (i, j) = (fit.rows.pose[rows[a]], fit.rows.pose[rows[b]]);
        let apart_s = (observed.middle_s(i) - observed.middle_s(j)).abs();
        let covariance = mean_logarithm(record_s, apart_s, 0.5 * (length_s(i) + length_s(j))) / PI;
        let deviations = fit.rows.deviation[rows[a]] * fit.rows.deviation[rows[b]];
        along(a).dot(&along(b)) * covariance / deviations
    });
    // Columns of what these rows help to settle, scaled. What others settle they do not take up:
    // the slope of a gyro at rest with its scale factor is its residual itself.
    let settled = |c: &usize| {
        let slope = fit.rows.slope.column(*c);
        rows.iter().map(|r| slope[*r].powi(2)).sum::<f64>() > NEXT_TO_NOTHING * slope.norm_squared()
    };
    let columns: Vec<DVector<f64>> = (0..fit.active.len())
        .filter(settled)
        .map(|c| DVector::from_iterator(rows.len(), rows.iter().map(|r| fit.rows.slope[(*r, c)])).normalize())
        .collect();
    if columns.is_empty() {
        return None;
    }
    let design = DMatrix::from_columns(&columns);
    let residual = DVector::from_iterator(rows.len(), rows.iter().map(|r| fit.rows.residual[*r]));
    let unit = kernel.diagonal().mean();
    let likelihood = |white: f64, wander: f64| {
        let covariance = DMatrix::identity(rows.len(), rows.len()) * white + &kernel * (wander / unit);
        restricted(&covariance, &design, &residual)
    };
    let best = |of: &mut dyn Iterator<Item = (f64, f64)>| {
        of.filter_map(|(w, b)| Some((likelihood(w, b)?, b))).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let without = best(&mut WITHOUT_MEMORY.iter().map(|w| (*w, 0.0)))?;
    let with = best(&mut WANDER.iter().map(|b| (1.0, 0.25 * b)))?;
    (2.0 * (without.0 - with.0) < RULED_OUT).then(|| with.1 / unit)
}

/// The mean of ln(T/|t − s|) with t and s in two windows of one length whose middles lie `apart_s`
/// apart.
fn mean_logarithm(record_s: f64, apart_s: f64, length_s: f64) -> f64 {
    // The second antiderivative of ln x, even in x.
    let second = |x: f64| if x == 0.0 { 0.0 } else { 0.5 * x * x * x.abs().ln() - 0.75 * x * x };
    let difference = second(apart_s + length_s) + second(apart_s - length_s) - 2.0 * second(apart_s);
    record_s.ln() - difference / (length_s * length_s)
}

/// Restricted log-likelihood but for a constant; `None` where the covariance is none.
fn restricted(covariance: &DMatrix<f64>, design: &DMatrix<f64>, residual: &DVector<f64>) -> Option<f64> {
    let factored = covariance.clone().cholesky()?;
    let lower = factored.l();
    let logarithm = |l: &DMatrix<f64>| 2.0 * l.diagonal().iter().map(|v| v.ln()).sum::<f64>();
    let (mut columns, mut rest) = (design.clone(), residual.clone());
    if !lower.solve_lower_triangular_mut(&mut columns) || !lower.solve_lower_triangular_mut(&mut rest) {
        return None;
    }
    let mut normal = columns.tr_mul(&columns);
    (0..normal.nrows()).for_each(|i| normal[(i, i)] *= 1.0 + 1e-9);
    let normal = normal.cholesky()?;
    let projected = columns.tr_mul(&rest);
    let fitted = projected.dot(&normal.solve(&projected));
    Some(-0.5 * (logarithm(&lower) + logarithm(&normal.l()) + rest.norm_squared() - fitted))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half the mean square difference of neighbouring means of 1/f noise is its Allan variance, (2
    /// ln 2/π) B² whatever the length (IEEE 952, annex C); far apart the mean of the logarithm is
    /// the logarithm.
    #[test]
    fn means_of_flicker_vary_as_its_allan_variance_says() {
        for length_s in [0.5, 4.0] {
            let allan = mean_logarithm(200.0, 0.0, length_s) - mean_logarithm(200.0, length_s, length_s);
            assert!((allan - 2.0 * 2f64.ln()).abs() < 1e-9, "{allan}");
        }
        assert!((mean_logarithm(200.0, 100.0, 1.0) - 2f64.ln()).abs() < 1e-4);
    }

    /// A restricted likelihood does not see what the design absorbs.
    #[test]
    fn the_restricted_likelihood_does_not_change_with_what_the_design_takes_up() {
        let design = DMatrix::from_fn(12, 2, |r, c| if c == 0 { 1.0 } else { r as f64 });
        let covariance =
            DMatrix::from_fn(12, 12, |a, b| if a == b { 2.0 } else { 0.5f64.powi((a as i32 - b as i32).abs()) });
        let residual = DVector::from_fn(12, |r, _| (r as f64 * 2.1).sin());
        let moved = &residual + &design * DVector::from_vec(vec![3.0, -0.7]);
        let [a, b] = [&residual, &moved].map(|r| restricted(&covariance, &design, r).expect("a likelihood"));
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
}
