//! The position of a reference that has no attitudes against the one that gyro and specific force
//! lead to: p + R l − ∬ (R f + g), in north-east-down, with R reckoned from the rates.
//!
//! What turns R by a rotation vector −s(t) turns the specific force with it, so that the residual
//! grows by ∬ s × R f − s × R l: errors of the gyro are seen in the specific force that they tilt
//! (Titterton & Weston, *Strapdown inertial navigation technology*, §12.3). Not for references with
//! attitudes, whose specific force is taken along those: `position`.

use nalgebra::Vector3;

use super::attitude;
use super::course::{Anchor, Case, Course, vector};
use super::integral::cumulative;
use super::parameters::{ANCHOR, DRIFT, EARTH_RATE, LEVER_ARM, OFFSET, PARAMETERS, Point};
use super::position::{places, taken, twice};
use super::rows::{Bins, Orders, Row, Spacing, rows};
use crate::parallel;

/// Orders where one attitude holds for the whole recording.
pub(super) const AS_A_WHOLE: Orders = Orders { of: [2; 3], spacing: Spacing::Middles };
/// Orders where it turns by block, to the sides once more than up and down: noise of the gyro makes
/// the attitude wander, and gravity with it, without end.
pub(super) const BY_BLOCK: Orders = Orders { of: [3, 3, 2], spacing: Spacing::Middles };

/// Rows of the position, m/s²: changes of velocity from bin to bin, and changes of those where they
/// are differenced once more.
pub(super) fn along_gyro_rows(
    case: &Case<'_>,
    course: &Course,
    point: &Point,
    (bins, orders): (&Bins, Orders),
) -> Vec<Row> {
    let (log, motion) = (case.log, case.motion);
    let places = places(case, point);
    let poses = motion.time_s.len();
    let twice = |changes: &[Vector3<f64>]| twice(case, &places, changes);
    let turned: Vec<Vector3<f64>> = course.attitude.iter().zip(&course.force).map(|(q, f)| q * f).collect();
    let gravity = Vector3::new(0.0, 0.0, case.gravity_m_s2);
    let felt: Vec<Vector3<f64>> = turned.iter().map(|f| (f + gravity) * course.pace.powi(2)).collect();
    let (way, velocity) = twice(&felt);
    let attitude: Vec<_> = (0..poses).map(|pose| course.attitude_at(log, case.stamp_s(point, pose))).collect();
    let arm = vector(point, LEVER_ARM.start);
    let residual: Vec<Vector3<f64>> =
        (0..poses).map(|pose| motion.position[pose] + attitude[pose] * arm - way[pose]).collect();
    let middle = motion.middle_s();
    let of = |p: usize| -> Option<Vec<Vector3<f64>>> {
        if LEVER_ARM.contains(&p) {
            let axis = Vector3::ith(p - LEVER_ARM.start, 1.0);
            return Some(attitude.iter().map(|attitude| attitude * axis).collect());
        }
        // The pose is that of another sample: the arm has turned until then, the body moved.
        let of_another = |pose: usize, times: f64| {
            let (k, u) = places[pose];
            let rate = course.rate[k] * (1.0 - u) + course.rate[k + 1] * u;
            (attitude[pose] * rate.cross(&arm) - velocity[pose]) * times
        };
        if p == OFFSET {
            return Some((0..poses).map(|pose| of_another(pose, 1.0)).collect());
        }
        if taken(case, course, 0, p).is_some() {
            let changes: Vec<Vector3<f64>> = (0..log.time_s.len())
                .map(|k| course.attitude[k] * taken(case, course, k, p).unwrap_or_default())
                .collect();
            return Some(twice(&changes).0);
        }
        let turns = turns(case, course, p)?;
        let tilted: Vec<Vector3<f64>> = turns.iter().zip(&turned).map(|(s, f)| s.cross(f)).collect();
        let mut all = twice(&tilted).0;
        for (slope, (attitude, (k, u))) in all.iter_mut().zip(attitude.iter().zip(&places)) {
            let s = turns[*k] * (1.0 - u) + turns[k + 1] * *u;
            *slope -= s.cross(&(attitude * arm));
        }
        if p == DRIFT {
            // Seconds that are shorter carry less far, by their square.
            let carried = |pose: usize| of_another(pose, motion.time_s[pose] - middle) + way[pose] * 2.0;
            all.iter_mut().enumerate().for_each(|(pose, slope)| *slope += carried(pose));
        }
        Some(all)
    };
    let slopes = parallel::map_indices(PARAMETERS, of);
    rows(&case.left_out_s(point), bins, orders, &residual, &slopes)
}

/// The rotation vector by which one unit of a parameter turns the reckoned attitude back, at each
/// sample; none where it turns nothing.
fn turns(case: &Case<'_>, course: &Course, p: usize) -> Option<Vec<Vector3<f64>>> {
    let Anchor::Found { sample, .. } = case.anchor else { return None };
    let time_s = &case.log.time_s;
    if ANCHOR.contains(&p) {
        let back: Vector3<f64> = Vector3::ith(p - ANCHOR.start, -1.0);
        return Some(vec![back; time_s.len()]);
    }
    if EARTH_RATE.contains(&p) {
        return Some(time_s.iter().map(|t| Vector3::ith(p - EARTH_RATE.start, t - time_s[sample])).collect());
    }
    attitude::integrand(case, course, 0, p)?;
    let changes: Vec<Vector3<f64>> = (0..time_s.len())
        .map(|k| course.attitude[k] * attitude::integrand(case, course, k, p).unwrap_or_default())
        .collect();
    let mut all = cumulative(time_s, &changes, case.rule);
    let none = all[sample];
    all.iter_mut().for_each(|s| *s -= none);
    Some(all)
}
