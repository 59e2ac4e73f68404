//! Tells what the sensor was put through, and what it would have to be put through for what is not
//! determined.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector3;

use super::calibration::Calibration;
use super::fit::Fit;
use super::group::{GROUPS, Group};
use super::imu::Observed;
use super::linear::shares;
use crate::numerics::order::median;
use crate::repeatability::parameter::{Element, Estimate, Role};
use crate::repeatability::run::{Motion, Remedy};
use crate::sensor::Sense;

/// Standard error, as a share of the input, that a remedy is asked to give: what a hand-turned
/// calibration reaches (Tedaldi, Pretto & Menegatti, ICRA 2014, table II).
const WANTED: f64 = 1e-3;
/// Fewest turns or pairs of poses that are asked for: fewer leave nothing to judge them by.
const FEWEST: usize = 4;
/// More are not asked for: the noise does not allow that precision by hand.
const MOST: f64 = 200.0;

/// Tells what was done.
pub(super) fn of(observed: &Observed<'_>, fit: &Fit, left_out: &[usize]) -> Motion {
    let calibration = Calibration::from_point(&fit.point);
    let forces = observed.forces_m_s2(&calibration);
    let shares: Vec<Vector3<f64>> =
        forces.iter().zip(&observed.poses).filter(|(_, pose)| pose.counts).map(|(f, _)| shares(f)).collect();
    let end = |axis: usize, pick: fn(f64, f64) -> f64| shares.iter().map(|s| s[axis]).reduce(pick).unwrap_or(0.0);
    Motion {
        poses: Some(observed.counting()),
        left_out: left_out.iter().map(|k| k + 1).collect(),
        turned_rad: observed.imu.gyro.is_some().then(|| turned_rad(observed, &calibration)),
        reached: [0, 1, 2].map(|axis| [end(axis, f64::min), end(axis, f64::max)]),
    }
}

/// Angle turned about each axis between the poses, whichever way.
fn turned_rad(observed: &Observed<'_>, calibration: &Calibration) -> [f64; 3] {
    let imu = &observed.imu;
    let mut sum = Vector3::zeros();
    for pair in observed.poses.windows(2) {
        for k in pair[0].samples.end..pair[1].samples.start {
            let slow = imu.slow_at(k);
            let force = calibration.specific_force_m_s2(imu.accelerometer_at(k).into(), &slow);
            sum += calibration.rate_rad_s(imu.gyro_at(k).into(), &force, &slow).abs() / imu.rate_hz;
        }
    }
    sum.into()
}

/// Tells what would determine the parameters that are not, each once; `left` is what the fit leaves of each
/// group over its noise.
pub(super) fn remedies(
    observed: &Observed<'_>,
    fit: &Fit,
    left: &[f64; GROUPS.len()],
    estimate: &Estimate,
) -> Vec<Remedy> {
    let error = |group: Group| {
        let rows = (0..fit.rows.group.len()).filter(|r| fit.rows.group[*r] == group);
        let usual = median(rows.map(|r| fit.rows.deviation[r]).collect());
        usual.map(|deviation| deviation * left[group.place()].sqrt())
    };
    let count = |needed: f64| (needed.ceil().min(MOST) as usize).max(FEWEST);
    let turns = |axis: usize| {
        let error = error(Group::Turn)?;
        // A quarter turn that is misread by a share errs by that share of a right angle.
        let count = count((error / (FRAC_PI_2 * WANTED)).powi(2));
        Some(Remedy::Turns { axis, count, to: error / FRAC_PI_2 / (count as f64).sqrt() })
    };
    let up_and_down = |sensor: Sense, axis: usize| {
        let error = error(Group::Gravity).filter(|_| sensor == Sense::Accelerometer);
        let share = error.map(|e| e / observed.imu.gravity_m_s2);
        let count = share.map_or(FEWEST, |s| count(0.5 * (s / WANTED).powi(2)));
        let to = share.map(|s| s / (2.0 * count as f64).sqrt());
        Some(Remedy::UpAndDown { sensor, axis, count, to })
    };
    let of = |p: &Element| match (p.sensor, p.role, p.of) {
        (Sense::Accelerometer, Role::Misalignment, Some(other)) => Some(Remedy::Between { axes: [p.axis, other] }),
        (Sense::Accelerometer, ..) => up_and_down(p.sensor, p.axis),
        (Sense::Gyro, Role::Scale, _) => turns(p.axis),
        (Sense::Gyro, Role::Misalignment, Some(other)) => turns(other),
        (Sense::Gyro, Role::GSensitivity, Some(other)) => up_and_down(p.sensor, other),
        _ => None,
    };
    let mut out: Vec<Remedy> = Vec::new();
    let undetermined = (0..estimate.parameters.len()).filter(|p| !estimate.determines(*p));
    for remedy in undetermined.filter_map(|p| of(estimate.parameters[p].element()?)) {
        if !out.contains(&remedy) {
            out.push(remedy);
        }
    }
    out
}
