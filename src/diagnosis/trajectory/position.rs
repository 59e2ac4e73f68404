//! The reference's position against the one that specific force leads to, along the reference's own
//! attitude: p + R l − ∬ (R C f + g), in north-east-down.

use nalgebra::{UnitQuaternion, Vector3};

use super::course::{Case, Course, vector};
use super::integral::{between, cumulative, place};
use super::parameters::{
    COSINES, DRIFT, FORCE_BIAS, FORCE_MATRIX, FORCE_PLACES, FORCE_WANDER, LENGTH, LEVER_ARM, LOWPASS, MOUNTING, OFFSET,
    PARAMETERS, Point, TILT,
};
use super::rows::{Bins, Orders, Row, Spacing, rows};
use crate::parallel;

/// Nor how fast: bins that are cut short next to a gap stand uneven, and must leave nothing of a velocity.
pub(super) const POSITION: Orders = Orders { of: [2; 3], spacing: Spacing::Middles };

/// Rows of the position: changes of velocity from bin to bin, m/s².
pub(super) fn position_rows(case: &Case<'_>, course: &Course, point: &Point, bins: &Bins, error: &Steady) -> Vec<Row> {
    let log = case.log;
    let attitude: Vec<UnitQuaternion<f64>> =
        (0..log.time_s.len()).map(|k| error.at(log.time_s[k]) * course.attitude[k]).collect();
    let places = places(case, point);
    let twice = |changes: &[Vector3<f64>]| twice(case, &places, changes);
    let tilt = [point[TILT.start], point[TILT.start + 1]];
    // However a frame is tilted, gravity is as large as it is.
    let down = (case.gravity_m_s2.powi(2) - tilt[0].powi(2) - tilt[1].powi(2)).max(0.0).sqrt();
    let gravity = Vector3::new(tilt[0], tilt[1], down);
    let felt: Vec<Vector3<f64>> = attitude
        .iter()
        .zip(&course.force)
        .map(|(attitude, force)| (attitude * force + gravity) * course.pace.powi(2))
        .collect();
    let (way, velocity) = twice(&felt);
    let arm = vector(point, LEVER_ARM.start);
    let residual: Vec<Vector3<f64>> = (0..places.len())
        .map(|pose| case.motion.position[pose] + case.motion.attitude[pose] * arm - way[pose])
        .collect();
    let middle = case.motion.middle_s();
    let of = |p: usize| -> Option<Vec<Vector3<f64>>> {
        if LEVER_ARM.contains(&p) {
            let axis = Vector3::ith(p - LEVER_ARM.start, 1.0);
            return Some(case.motion.attitude.iter().map(|attitude| attitude * axis).collect());
        }
        if p == LENGTH {
            // Of the way that was felt: the noise of the positions themselves would pass for a size.
            return Some(way.iter().map(|way| -way).collect());
        }
        if TILT.contains(&p) {
            let n = p - TILT.start;
            let axis = Vector3::z() * (tilt[n] / down.max(f64::MIN_POSITIVE)) - Vector3::ith(n, 1.0);
            return Some(twice(&vec![axis; log.time_s.len()]).0);
        }
        integrand(case, course, 0, p, middle)?;
        let changes: Vec<Vector3<f64>> = (0..log.time_s.len())
            .map(|k| attitude[k] * integrand(case, course, k, p, middle).unwrap_or_default())
            .collect();
        let mut all = twice(&changes).0;
        if p == OFFSET || p == DRIFT {
            for (pose, way) in all.iter_mut().enumerate() {
                let times = if p == OFFSET { 1.0 } else { case.motion.time_s[pose] - middle };
                *way -= velocity[pose] * times;
            }
        }
        if p == DRIFT {
            // Seconds that are shorter carry less far, by their square.
            all.iter_mut().zip(&way).for_each(|(slope, way)| *slope += way * 2.0);
        }
        Some(all)
    };
    let slopes = parallel::map_indices(PARAMETERS, of);
    rows(&case.left_out_s(point), bins, POSITION, &residual, &slopes)
}

/// Returns where the IMU's stamp of each pose lies among its samples.
pub(super) fn places(case: &Case<'_>, point: &Point) -> Vec<(usize, f64)> {
    (0..case.motion.time_s.len()).map(|pose| place(&case.log.time_s, case.stamp_s(point, pose))).collect()
}

/// The double integral at the poses of what is given at the samples, and the single one.
pub(super) fn twice(
    case: &Case<'_>,
    places: &[(usize, f64)],
    changes: &[Vector3<f64>],
) -> (Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
    let time_s = &case.log.time_s;
    let velocity = cumulative(time_s, changes, case.rule);
    let way = cumulative(time_s, &velocity, case.rule);
    let at_poses = |of: &[Vector3<f64>], slope: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
        places.iter().map(|at| between(time_s, of, slope, *at)).collect()
    };
    (at_poses(&way, &velocity), at_poses(&velocity, changes))
}

/// Returns what a parameter of the accelerometer takes from the specific force, in the IMU's axes.
pub(super) fn taken(case: &Case<'_>, course: &Course, k: usize, p: usize) -> Option<Vector3<f64>> {
    if FORCE_BIAS.contains(&p) {
        return Some(Vector3::ith(p - FORCE_BIAS.start, 1.0));
    }
    if FORCE_MATRIX.contains(&p) {
        let (row, column) = FORCE_PLACES[p - FORCE_MATRIX.start];
        return Some(Vector3::ith(row, course.force[k][column]));
    }
    FORCE_WANDER.contains(&p).then(|| {
        let n = p - FORCE_WANDER.start;
        Vector3::ith(n / COSINES, case.cosines(case.log.time_s[k])[n % COSINES])
    })
}

/// Returns what a parameter takes from the specific force, in the IMU's axes: the residual grows by
/// its double integral.
fn integrand(case: &Case<'_>, course: &Course, k: usize, p: usize, middle_s: f64) -> Option<Vector3<f64>> {
    let (w, f, time_s) = (course.rate[k], course.force[k], case.log.time_s[k]);
    if let Some(taken) = taken(case, course, k, p) {
        return Some(taken);
    }
    if MOUNTING.contains(&p) {
        return Some(-Vector3::ith(p - MOUNTING.start, 1.0).cross(&f));
    }
    match p {
        LOWPASS => Some(case.derivatives?.second.force[k] * 0.5),
        // The reference's attitude at a sample is that of another instant.
        OFFSET => Some(w.cross(&f)),
        DRIFT => Some(w.cross(&f) * (time_s - middle_s)),
        _ => None,
    }
}

/// The error of the reckoned attitude without the reference's noise: means over half a second,
/// joined by straight lines.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Steady {
    start_s: f64,
    step_s: f64,
    values: Vec<Vector3<f64>>,
}

/// Over which E is averaged, s.
const STEADY_S: f64 = 0.25;

impl Steady {
    /// From E at the poses, whose times are the IMU's stamps of them.
    pub(super) fn of(stamps_s: &[f64], error: &[Vector3<f64>]) -> Self {
        let bins = Bins::over(stamps_s, STEADY_S);
        let mut values = bins.means(error);
        for k in 1..values.len() {
            if bins.count[k] == 0 {
                values[k] = values[k - 1];
            }
        }
        Self { start_s: bins.start_s + 0.5 * STEADY_S, step_s: STEADY_S, values }
    }

    /// At an IMU's stamp.
    fn at(&self, stamp_s: f64) -> UnitQuaternion<f64> {
        let Some(last) = self.values.len().checked_sub(1) else { return UnitQuaternion::identity() };
        let at = ((stamp_s - self.start_s) / self.step_s).clamp(0.0, last as f64);
        let (k, u) = (at as usize, at.fract());
        let next = self.values[(k + 1).min(last)];
        UnitQuaternion::from_scaled_axis(self.values[k] * (1.0 - u) + next * u)
    }
}
