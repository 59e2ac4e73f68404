//! An IMU in many still poses: which physics its calibration model leaves out.
//!
//! In every pose |f| = g and the rate is zero; the moves between poses carry gravity's direction along by the gyro. The base
//! model has per axis an offset and per sensor one common scale, the axes orthogonal and shared by both sensors.
//! Not for motion beside a reference trajectory.

pub mod calibration;
mod candidate;
mod check;
mod conclusion;
mod consequence;
mod fit;
mod imu;
mod isolation;
mod noise;
pub mod poses;
mod remainder;
pub mod rows;
mod selection;
mod slopes;
mod start;
mod units;
mod words;

use std::ops::Range;

use nalgebra::Vector3;

pub use calibration::Calibration;
pub use candidate::CANDIDATES;
pub use imu::Imu;

use super::model;
use super::{Detail as AnyDetail, Diagnosis};
use crate::error::{Error, Result};
use crate::recording::Recording;
use fit::Fit;
use rows::Group;

/// Plain numbers behind the figures.
#[derive(Debug, Clone)]
pub struct Detail {
    /// One per pose, in order of time.
    pub poses: Vec<PoseDetail>,
    /// Whether the tool found the poses itself.
    pub poses_found: bool,
    /// Root-mean-square residuals on poses that were not fitted, in the units of `Group`: base model, repaired model.
    pub held_out: [[f64; 2]; 3],
    /// The repaired calibration.
    pub calibration: Calibration,
    /// K's entries with their 95 % intervals, °/s/g, by rows; empty unless named.
    pub g_sensitivity: Vec<(String, f64, [f64; 2])>,
    /// Length of specific force over time, m/s², thinned for plotting, as (time in s, |f|).
    pub length_m_s2: Vec<(f64, f64)>,
    /// Gravity as the model states it.
    pub gravity_m_s2: f64,
}

/// One pose in the figures.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseDetail {
    /// From and to, s.
    pub time_s: [f64; 2],
    /// Specific force over g, as the repaired model sees it.
    pub share: [f64; 3],
    /// Residuals before, in the units of `Group`: |f| − g; rate x, y, z; direction error after the following move.
    pub before: [f64; 5],
    /// Residuals after.
    pub after: [f64; 5],
    /// Noise of each.
    pub noise: [f64; 5],
}

/// Diagnoses a tumble recording.
///
/// # Errors
/// Columns that do not behave as what they are called, poses that cannot be used or found, too few of them.
pub fn diagnose(recording: &Recording, model: &model::Tumble) -> Result<Diagnosis> {
    let given = model.poses.as_ref().map(|path| poses::read(path, recording.samples())).transpose()?;
    diagnose_in(recording, model, given)
}

/// The same with poses as row ranges in order of time; `None` lets the tool find them.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_in(
    recording: &Recording,
    model: &model::Tumble,
    given: Option<Vec<Range<usize>>>,
) -> Result<Diagnosis> {
    let mut findings = recording.findings.clone();
    let imu = columns(recording, model, &mut findings)?;
    check::channels(recording, model)?;
    let poses_found = given.is_none();
    let ranges = given.unwrap_or_else(|| poses::find(&imu));
    if poses_found {
        findings.push(format!("no poses were given; {} still stretches were found", ranges.len()));
    }
    check::enough(&recording.path, ranges.len())?;
    let mut observed = imu.observe(&ranges);
    if !poses_found {
        check::still(&recording.path, &observed, &mut findings)?;
    }
    check::moving(&recording.path, &observed)?;
    let guess = start::guess(&mut observed);
    check::axes(&recording.path, &observed, &guess, model)?;
    let folds = check::folds(&observed, &model.split, &mut findings)?;
    let base = Fit::new(&observed, &guess, &start::base());
    let selection = selection::select(&observed, base, &folds);
    let case = conclusion::Case { recording, model, observed: &observed, folds: &folds, findings, poses_found };
    Ok(case.conclude(selection))
}

fn columns<'a>(recording: &'a Recording, model: &model::Tumble, findings: &mut Vec<String>) -> Result<Imu<'a>> {
    let column = |name: &String| {
        recording.column(name).ok_or_else(|| {
            Error::new(
                format!("could not diagnose {}", recording.path.display()),
                format!("the column `{name}` was not read"),
                "check [columns] in the model",
            )
        })
    };
    let three = |names: &[String; 3]| -> Result<[&'a [f64]; 3]> {
        Ok([column(&names[0])?, column(&names[1])?, column(&names[2])?])
    };
    let covariate = match model.columns.environment.as_slice() {
        [] => Imu::minutes(recording.samples(), recording.rate_hz),
        [first, rest @ ..] => {
            if !rest.is_empty() {
                findings.push(format!("only the first environment column, `{first}`, is used"));
            }
            let values = column(first)?;
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            values.iter().map(|v| v - mean).collect()
        }
    };
    check::gravity(model.gravity_m_s2, findings)?;
    Ok(Imu {
        rate_hz: recording.rate_hz,
        gyro: three(&model.columns.gyro)?,
        accelerometer: three(&model.columns.accelerometer)?,
        covariate,
        gravity_m_s2: model.gravity_m_s2,
    })
}

/// Calibrates an IMU from its poses with everything that a careful engineer would fit: offsets, a scale per axis,
/// misalignment and the gyro's g-sensitivity. No selection, no verdict: for using a recording, not for judging one.
///
/// # Errors
/// Fewer poses than the fit needs.
pub fn calibrate(imu: Imu<'_>, poses: &[Range<usize>]) -> Result<Calibration> {
    use calibration::{accelerometer, gyro};
    check::enough(std::path::Path::new("the recording"), poses.len())?;
    let mut observed = imu.observe(poses);
    let guess = start::guess(&mut observed);
    let base = Fit::new(&observed, &guess, &start::base());
    let more = [
        accelerometer::AXIS_SCALE,
        accelerometer::MISALIGNMENT,
        gyro::AXIS_SCALE,
        gyro::MISALIGNMENT,
        gyro::G_SENSITIVITY,
    ];
    let active: Vec<usize> = start::base().into_iter().chain(more.into_iter().flatten()).collect();
    Ok(Calibration::from_point(&Fit::new(&observed, &base.point, &active).point))
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

fn pose_details(observed: &imu::Observed<'_>, base: &Fit, repaired: &Fit, forces: &[Vector3<f64>]) -> Vec<PoseDetail> {
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

impl From<Detail> for AnyDetail {
    fn from(detail: Detail) -> Self {
        Self::Tumble(Box::new(detail))
    }
}
