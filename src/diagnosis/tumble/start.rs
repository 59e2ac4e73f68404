//! States where the fit begins: offsets and scales from the poses alone, whatever the unit of the
//! counts.

use nalgebra::Vector3;

use super::calibration::{Calibration, PARAMETERS, Point, accelerometer, gyro};
use super::imu::Observed;
use crate::numerics::moments::mean;
use crate::numerics::order::median;

/// Mean angle by which the gyro's turns may miss gravity, rad: more is another scale, or other axes.
pub(super) const MISSED_RAD: f64 = 0.25;

/// Parameters of the base model: per axis an offset, per sensor one common scale, and how the
/// gyro's filter shapes a turn.
pub(super) fn base(with_gyro: bool) -> Vec<usize> {
    let gyro = gyro::OFFSET.chain(gyro::SCALE).chain(gyro::CONING);
    accelerometer::OFFSET.chain(accelerometer::SCALE).chain(gyro.filter(|_| with_gyro)).collect()
}

/// A first guess of the base model; sets the scales by which noise is weighed.
pub(crate) fn guess(observed: &mut Observed<'_>) -> Point {
    guess_with(observed, 0.0)
}

/// The same of poses that may lie in a plane: offsets that they do not show stay in the middle of
/// the readings, and what axes read unlike does not pass for an offset.
pub(super) fn bounded_guess(observed: &mut Observed<'_>) -> Point {
    guess_with(observed, IN_THE_MIDDLE)
}

/// States what offsets (5 % of gravity) and scales of the axes (3 %: twice that in a square) may be
/// makes the weight of the middle in the equations of the sphere, over its radius.
const IN_THE_MIDDLE: f64 = 0.06 / 0.05;

fn guess_with(observed: &mut Observed<'_>, middle: f64) -> Point {
    let mut point = [0.0; PARAMETERS];
    let poses = &observed.poses;
    let (offset, scale) = sphere(&poses.iter().map(|p| p.accelerometer).collect::<Vec<_>>(), middle);
    for i in 0..3 {
        point[accelerometer::OFFSET.start + i] = offset[i];
        point[gyro::OFFSET.start + i] = poses.iter().map(|p| p.gyro[i]).sum::<f64>() / poses.len().max(1) as f64;
    }
    point[accelerometer::SCALE.start] = scale / observed.imu.gravity_m_s2;
    observed.accelerometer_scale = point[accelerometer::SCALE.start];
    point[gyro::SCALE.start] = 1.0;
    if observed.imu.gyro.is_none() {
        return point;
    }
    point[gyro::SCALE.start] = gyro_scale(observed, &point);
    observed.gyro_scale = point[gyro::SCALE.start];
    point
}

/// Centre and radius of the sphere through the pose means, by linear least squares on |y|² = 2
/// y·o + (r² − o²), and with the centre held at the middle of the means by this weight, over their
/// spread.
fn sphere(means: &[Vector3<f64>], middle: f64) -> (Vector3<f64>, f64) {
    let count = means.len().max(1) as f64;
    let centre = means.iter().sum::<Vector3<f64>>() / count;
    let rows = means.len();
    let centred: Vec<Vector3<f64>> = means.iter().map(|m| m - centre).collect();
    let mut design = nalgebra::DMatrix::from_fn(rows, 4, |r, c| if c < 3 { 2.0 * centred[r][c] } else { 1.0 });
    let mut target = nalgebra::DVector::from_fn(rows, |r, _| centred[r].norm_squared());
    let spread = (target.sum() / count).sqrt();
    if middle > 0.0 {
        design = design.insert_rows(rows, 3, 0.0);
        target = target.insert_rows(rows, 3, 0.0);
        (0..3).for_each(|axis| design[(rows + axis, axis)] = middle * spread);
    }
    let Ok(solution) = design.svd(true, true).solve(&target, 1e-9 * spread) else { return (centre, spread) };
    let offset = Vector3::new(solution[0], solution[1], solution[2]);
    let radius = (solution[3] + offset.norm_squared()).max(0.0).sqrt();
    if radius.is_finite() && radius > 0.0 { (centre + offset, radius) } else { (centre, spread) }
}

/// Counts per rad/s: the best about that of the stated unit; where there is none, or turns miss by it, the best of
/// those that turns between poses allow.
fn gyro_scale(observed: &Observed<'_>, point: &Point) -> f64 {
    let misfit = |scale: f64| (mean(&misses_rad(observed, point, scale)), scale);
    let best = |scan: &mut dyn Iterator<Item = f64>| scan.map(misfit).min_by(|a, b| a.0.total_cmp(&b.0));
    let about = |si: f64| best(&mut (-4..=4).map(|n| 1.06f64.powi(n) / si)).filter(|b| b.0 < MISSED_RAD);
    if let Some((_, scale)) = observed.told[1].and_then(about) {
        return scale;
    }
    let most = turned_over_angle(observed, point);
    best(&mut scales(most, 1.06)).map_or(most, |b| b.1)
}

/// Angles between gravity as the gyro carries it through each move, with this many counts per rad/s, and as it is
/// read, rad: whole angles, for of those that are half a turn off the sine is small.
pub(super) fn misses_rad(observed: &Observed<'_>, point: &Point, scale: f64) -> Vec<f64> {
    let mut trial = *point;
    trial[gyro::SCALE.start] = scale;
    let calibration = Calibration::from_point(&trial);
    let up = observed.forces_m_s2(&calibration);
    let miss = |k: usize| {
        let turn = observed.turn(&trial, &calibration, None, k);
        (turn.rotation.transpose() * up[k]).angle(&up[k + 1])
    };
    (0..up.len().saturating_sub(1)).map(miss).collect()
}

/// Returns the turns by the gyro over the angles between gravity before and after, in counts: about the largest scale
/// that there can be, for no way is shorter than the angle.
pub(super) fn turned_over_angle(observed: &Observed<'_>, point: &Point) -> f64 {
    let calibration = Calibration::from_point(point);
    let up: Vec<Vector3<f64>> = observed.forces_m_s2(&calibration).iter().map(Vector3::normalize).collect();
    let mut ratios: Vec<(f64, f64)> = Vec::new();
    for k in 0..observed.poses.len().saturating_sub(1) {
        let between = observed.poses[k].samples.end..observed.poses[k + 1].samples.start;
        let turned: Vector3<f64> =
            between.map(|s| (observed.imu.gyro_at(s) - calibration.gyro.offset) / observed.imu.rate_hz).sum();
        let angle = up[k].dot(&up[k + 1]).clamp(-1.0, 1.0).acos();
        ratios.push((angle, turned.norm() / angle));
    }
    // Small turns are mostly handling, where there are larger ones.
    let largest = ratios.iter().map(|r| r.0).fold(0.0, f64::max);
    ratios.retain(|r| r.0 > 0.3f64.min(0.5 * largest));
    median(ratios.into_iter().map(|r| r.1).collect()).filter(|r| *r > 0.0).unwrap_or(1.0)
}

/// Scales to try: up to an eighth more than this, and down to 1/2.5 of it, because a hand often turns further than the
/// shortest way. Never three times as large: a quarter turn backwards would then pass for one forwards.
pub(super) fn scales(most: f64, step: f64) -> impl Iterator<Item = f64> {
    let fewest = (2.5f64.ln() / step.ln()).round() as i32;
    let further = (1.125f64.ln() / step.ln()).round() as i32;
    (-fewest..=further).map(move |n| most * step.powi(n))
}
