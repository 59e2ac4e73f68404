//! The reference's attitude against the one that the gyro leads to: E with R C = exp(E) Q, in
//! north-east-down.
//!
//! E changes by −∫ Q δω of an error δω of the rate, so that what is fitted is linear in every
//! parameter, wherever in the recording it began (Savage, *Strapdown inertial navigation
//! integration algorithm design*, part 1, 1998).

use nalgebra::Vector3;

use super::course::{Case, Course};
use super::integral::{between, cumulative, place};
use super::parameters::{
    COSINES, DRIFT, EARTH_RATE, G_SENSITIVITY, GYRO_BIAS, GYRO_MISALIGNMENT, GYRO_OFF_DIAGONAL, GYRO_SCALE,
    GYRO_WANDER, LOWPASS, MOUNTING, OFFSET, PARAMETERS, Point, RATE_SQUARE,
};
use super::rows::{Bins, Orders, Row, Spacing, rows};
use crate::parallel;

/// Rotation vector E at each pose, rad.
pub(super) fn error(case: &Case<'_>, course: &Course, point: &Point) -> Vec<Vector3<f64>> {
    let mounting = case.mounting(point);
    let at = |pose: usize| {
        let reckoned = course.attitude_at(case.log, case.stamp_s(point, pose));
        (case.motion.attitude[pose] * mounting * reckoned.inverse()).scaled_axis()
    };
    (0..case.motion.time_s.len()).map(at).collect()
}

/// Dead reckoning does not know where it began.
pub(super) const ATTITUDE: Orders = Orders { of: [1; 3], spacing: Spacing::Width };

/// Rows of the attitude: changes of E from bin to bin, rad/s.
pub(super) fn attitude_rows(case: &Case<'_>, course: &Course, point: &Point, bins: &Bins) -> Vec<Row> {
    let residual = error(case, course, point);
    let poses = case.motion.time_s.len();
    let places: Vec<(usize, f64)> = (0..poses).map(|pose| place(&case.log.time_s, case.stamp_s(point, pose))).collect();
    let of = |p: usize| -> Option<Vec<Vector3<f64>>> {
        let direct = direct(case, course, &places, p);
        if integrand(case, course, 0, p).is_none() {
            return direct;
        }
        let changes: Vec<Vector3<f64>> = (0..case.log.time_s.len())
            .map(|k| course.attitude[k] * integrand(case, course, k, p).unwrap_or_default())
            .collect();
        let all = cumulative(&case.log.time_s, &changes, case.rule);
        let integral = places.iter().map(|at| between(&case.log.time_s, &all, &changes, *at));
        Some(match direct {
            Some(direct) => integral.zip(direct).map(|(integral, direct)| integral + direct).collect(),
            None => integral.collect(),
        })
    };
    let slopes = parallel::map_indices(PARAMETERS, of);
    rows(&case.left_out_s(point), bins, ATTITUDE, &residual, &slopes)
}

/// Returns what a parameter takes from the rate felt, in the IMU's axes: E grows by its integral.
pub(super) fn integrand(case: &Case<'_>, course: &Course, k: usize, p: usize) -> Option<Vector3<f64>> {
    let (w, f) = (course.rate[k], course.force[k]);
    let unit = |axis: usize, value: f64| course.gyro.column(axis) * value;
    if GYRO_BIAS.contains(&p) {
        return Some(unit(p - GYRO_BIAS.start, 1.0));
    }
    if GYRO_SCALE.contains(&p) {
        let axis = p - GYRO_SCALE.start;
        return Some(unit(axis, w[axis]));
    }
    if GYRO_MISALIGNMENT.contains(&p) {
        let (row, column) = GYRO_OFF_DIAGONAL[p - GYRO_MISALIGNMENT.start];
        return Some(unit(row, w[column]));
    }
    if G_SENSITIVITY.contains(&p) {
        let n = p - G_SENSITIVITY.start;
        return Some(unit(n / 3, f[n % 3]));
    }
    if RATE_SQUARE.contains(&p) {
        let axis = p - RATE_SQUARE.start;
        return Some(unit(axis, w[axis] * w[axis]));
    }
    if p == DRIFT {
        // Seconds that are shorter turn less.
        return Some(w);
    }
    if p == LOWPASS {
        // At a given total lag, which is another parameter: v(t − τ) = y − ½ τ² d²y/dt².
        return Some(course.gyro * case.derivatives?.second.rate[k] * 0.5);
    }
    GYRO_WANDER.contains(&p).then(|| {
        let n = p - GYRO_WANDER.start;
        unit(n / COSINES, case.cosines(case.log.time_s[k])[n % COSINES])
    })
}

/// Returns what a parameter does to E at the poses at once.
fn direct(case: &Case<'_>, course: &Course, places: &[(usize, f64)], p: usize) -> Option<Vec<Vector3<f64>>> {
    if p != OFFSET && p != DRIFT && !MOUNTING.contains(&p) && !EARTH_RATE.contains(&p) {
        return None;
    }
    let middle = case.motion.middle_s();
    let at = |(pose, (k, u)): (usize, &(usize, f64))| {
        let attitude = course.attitude[*k];
        let turning = || attitude * (course.rate[*k] * (1.0 - u) + course.rate[k + 1] * *u);
        match p {
            OFFSET => -turning(),
            DRIFT => -turning() * (case.motion.time_s[pose] - middle),
            _ if EARTH_RATE.contains(&p) => Vector3::ith(p - EARTH_RATE.start, case.motion.time_s[pose] - middle),
            _ => attitude * Vector3::ith(p - MOUNTING.start, 1.0),
        }
    };
    Some(places.iter().enumerate().map(at).collect())
}
