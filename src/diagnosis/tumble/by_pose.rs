//! Residuals pose by pose, in public units, for the figures.

use nalgebra::Vector3;

use super::detail::PoseDetail;
use super::fit::Fit;
use super::group::Group;
use super::imu::Observed;

/// Every pose before and after repair; `forces` as the repaired model sees them.
pub(super) fn pose_details(
    observed: &Observed<'_>,
    base: &Fit,
    repaired: &Fit,
    forces: &[Vector3<f64>],
) -> Vec<PoseDetail> {
    let count = observed.poses.len();
    let ((before, _), (after, noise)) = (by_pose(base, count), by_pose(repaired, count));
    let seconds = |sample: usize| sample as f64 / observed.imu.rate_hz;
    (0..count)
        .map(|k| PoseDetail {
            time_s: [seconds(observed.poses[k].samples.start), seconds(observed.poses[k].samples.end)],
            share: (forces[k] / observed.imu.gravity_m_s2).into(),
            before: before[k],
            after: after[k],
            noise: noise[k],
        })
        .collect()
}

/// Residuals of one pose in public units: |f| − g, three rates, direction error.
fn by_pose(fit: &Fit, poses: usize) -> (Vec<[f64; 5]>, Vec<[f64; 5]>) {
    let mut value = vec![[0.0; 5]; poses];
    let mut noise = vec![[0.0; 5]; poses];
    let mut still = vec![0; poses];
    for r in 0..fit.rows.group.len() {
        let (pose, group) = (fit.rows.pose[r], fit.rows.group[r]);
        let (v, d) =
            (fit.rows.residual[r] * fit.rows.deviation[r] * group.factor(), fit.rows.deviation[r] * group.factor());
        match group {
            Group::Gravity => (value[pose][0], noise[pose][0]) = (v, d),
            Group::Still => {
                let place = 1 + still[pose];
                (value[pose][place], noise[pose][place]) = (v, d);
                still[pose] += 1;
            }
            Group::Turn => {
                value[pose][4] = value[pose][4].hypot(v);
                noise[pose][4] = noise[pose][4].hypot(d);
            }
        }
    }
    (value, noise)
}
