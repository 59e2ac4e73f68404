//! An IMU in many still poses: which physics its calibration model leaves out.
//!
//! In every pose |f| = g and the rate is zero; the moves between poses carry gravity's direction along by the gyro. The base
//! model has per axis an offset and per sensor one common scale, the axes orthogonal and shared by both sensors.
//! Not for motion beside a reference trajectory.

pub mod account;
mod by_pose;
pub mod calibration;
mod candidate;
mod check;
mod conclusion;
mod consequence;
pub mod detail;
mod fit;
pub mod group;
mod imu;
mod isolation;
mod noise;
pub mod poses;
mod residual;
pub mod rows;
mod selection;
mod slopes;
mod start;
mod units;

use std::ops::Range;

pub use calibration::Calibration;
pub use candidate::CANDIDATES;
pub use detail::{Detail, PoseDetail};
pub use imu::Imu;

use super::answer::Answer;
use super::model;
use crate::error::{Error, Result};
use crate::recording::Recording;
use fit::Fit;

/// Diagnoses a tumble recording.
///
/// # Errors
/// Columns that do not behave as what they are called, poses that cannot be used or found, too few of them.
pub fn diagnose(recording: &Recording, model: &model::Tumble) -> Result<Answer> {
    let given = model.poses.as_ref().map(|path| poses::read(path, recording)).transpose()?;
    diagnose_in(recording, model, given)
}

/// The same with poses as row ranges in order of time; `None` lets the tool find them.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_in(recording: &Recording, model: &model::Tumble, given: Option<Vec<Range<usize>>>) -> Result<Answer> {
    let mut findings = recording.sentences();
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
