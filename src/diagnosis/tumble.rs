//! An IMU in many still poses: which physics its calibration model leaves out.
//!
//! In every pose |f| = g and the rate is zero; the moves between poses carry gravity's direction
//! along by the gyro. The base model has per axis an offset and per sensor one common scale, the
//! axes orthogonal and shared by both sensors. Not for motion next to a reference trajectory.

pub mod account;
mod by_axis;
mod by_pose;
pub mod calibration;
mod candidate;
mod check;
mod conclusion;
mod consequence;
pub mod detail;
mod estimated;
mod fit;
mod flicker;
pub mod group;
mod imu;
mod isolation;
mod jackknife;
mod knock;
mod known;
mod linear;
mod memory;
mod motion;
mod noise;
pub mod poses;
mod residual;
pub mod rows;
mod selection;
mod slopes;
mod standing;
mod start;
mod stated;
mod turn;
mod units;
mod wander;

use std::ops::Range;

pub use calibration::{Calibration, Slow};
pub use candidate::CANDIDATES;
pub(crate) use check::enough;
pub use detail::{Detail, PoseDetail};
pub use imu::Imu;

use super::answer::Answer;
use super::model;
use crate::control::{Control, Stopped};
use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::repeatability::run::Run;
use conclusion::Found;
use fit::Fit;
use imu::Observed;
use residual::Residual;
use standing::Folds;

/// Diagnoses a tumble recording.
///
/// # Errors
/// Columns that do not behave as what they are called, poses that cannot be used or found, too few
/// of them; when stopped.
pub fn diagnose(recording: &Recording, model: &model::Tumble, control: &Control) -> Result<Answer> {
    let given = model.poses.as_ref().map(|path| poses::read(path, recording)).transpose()?;
    diagnose_in(recording, model, given, control)
}

/// The same with poses as row ranges in order of time; `None` lets the tool find them.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_in(
    recording: &Recording,
    model: &model::Tumble,
    given: Option<Vec<Range<usize>>>,
    control: &Control,
) -> Result<Answer> {
    let poses_found = given.is_none();
    let Taken { mut observed, guess, mut findings } = taken(recording, model, given)?;
    let folds = check::folds(&observed, &model.split, &mut findings)?;
    let found = searched(&mut observed, &guess, &folds, control).map_err(|stopped| {
        stopped.during(format!("could not finish {}", recording.path.display()), "start it again")
    })?;
    let case = conclusion::Case { recording, model, observed: &observed, folds: &folds, findings, poses_found };
    Ok(case.conclude(found))
}

/// A recording in poses, with what was found on the way and a first guess.
struct Taken<'a> {
    observed: Observed<'a>,
    guess: calibration::Point,
    findings: Vec<String>,
}

/// Takes the poses of a recording, given or found, and checks that they can be used.
fn taken<'a>(recording: &'a Recording, model: &model::Tumble, given: Option<Vec<Range<usize>>>) -> Result<Taken<'a>> {
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
    let units = stated::units(recording, model);
    observed.told = units.each_ref().map(|unit| unit.as_ref().map(|unit| unit.si));
    let bounded = start::bounded_guess(&mut observed);
    findings.extend(stated::contradicted(&mut observed, &bounded, &units));
    let guess = start::guess(&mut observed);
    check::axes(&recording.path, &observed, &guess, model)?;
    Ok(Taken { observed, guess, findings })
}

/// Returns what a recording in poses can know of its IMU, what it finds, and the same of its
/// halves.
///
/// # Errors
/// As [`diagnose`].
pub fn known(recording: &Recording, model: &model::Tumble, control: &Control) -> Result<Run> {
    let given = model.poses.as_ref().map(|path| poses::read(path, recording)).transpose()?;
    known_in(recording, model, given, control)
}

/// The same with poses as row ranges in order of time; `None` lets the tool find them.
///
/// # Errors
/// As [`diagnose`].
pub fn known_in(
    recording: &Recording,
    model: &model::Tumble,
    given: Option<Vec<Range<usize>>>,
    control: &Control,
) -> Result<Run> {
    let stopped = |s: Stopped| s.during(format!("could not finish {}", recording.path.display()), "start it again");
    let _stage = control.stage("fitting the poses and their halves", 0);
    let Taken { mut observed, guess, findings } = taken(recording, model, given)?;
    control.go_on().map_err(stopped)?;
    let left_out = knock::leave_out(&mut observed, &guess);
    control.go_on().map_err(stopped)?;
    let linear = linear::Linear::new(observed.imu.gyro.is_some(), observed.told);
    let guess = start::bounded_guess(&mut observed);
    Ok(known::check(known::Poses { observed, guess, linear, left_out, findings }))
}

/// The search, with poses that disagree with all others left out where the rest then agrees, and
/// with the noise between poses raised where it is more than the noise inside them says.
fn searched(
    observed: &mut Observed<'_>,
    guess: &calibration::Point,
    folds: &Folds,
    control: &Control,
) -> std::result::Result<Found, Stopped> {
    let work = control.stage("searching the library", 0);
    let mut knocked = knock::leave_out(observed, guess);
    let mut selection = selection::select(observed, guess, folds, control)?;
    let wanders = wander::raise(observed, &selection.chosen);
    if wanders {
        work.rename("searching again with the noise between poses");
        selection = selection::select(observed, guess, folds, control)?;
    }
    let foreign = Residual::of(&selection.chosen).above.iter().any(|a| a.1 > knock::CLEAR);
    if !knocked.is_empty() && foreign {
        work.rename("searching again with every pose");
        observed.poses.iter_mut().for_each(|p| p.counts = true);
        knocked.clear();
        selection = selection::select(observed, guess, folds, control)?;
    }
    Ok(Found { selection, knocked, wanders })
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
        [] => None,
        [first, rest @ ..] => {
            if !rest.is_empty() {
                findings.push(format!("only the first environment column, `{first}`, is used"));
            }
            let values = column(first)?;
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            Some(values.iter().map(|v| v - mean).collect())
        }
    };
    check::gravity(model.gravity_m_s2, findings)?;
    Ok(Imu {
        rate_hz: recording.rate_hz,
        gyro: model.columns.gyro.as_ref().map(three).transpose()?,
        accelerometer: three(&model.columns.accelerometer)?,
        covariate,
        gravity_m_s2: model.gravity_m_s2,
    })
}

/// Calibrates an IMU from its poses with everything that a careful engineer would fit: offsets, a
/// scale per axis, misalignment and the gyro's g-sensitivity. No selection, no verdict: for using a
/// recording, not for judging one.
///
/// # Errors
/// Fewer poses than the fit needs.
pub fn calibrate(imu: Imu<'_>, poses: &[Range<usize>]) -> Result<Calibration> {
    use calibration::{accelerometer, gyro};
    check::enough(std::path::Path::new("the recording"), poses.len())?;
    let mut observed = imu.observe(poses);
    let guess = start::guess(&mut observed);
    let with_gyro = observed.imu.gyro.is_some();
    let more = [accelerometer::AXIS_SCALE, accelerometer::MISALIGNMENT];
    let more_of_gyro = [gyro::AXIS_SCALE, gyro::MISALIGNMENT, gyro::G_SENSITIVITY];
    let active: Vec<usize> = start::base(with_gyro)
        .into_iter()
        .chain(more.into_iter().flatten())
        .chain(more_of_gyro.into_iter().flatten().filter(|_| with_gyro))
        .collect();
    Ok(Calibration::from_point(&Fit::balanced(&observed, &guess, &active).point))
}
