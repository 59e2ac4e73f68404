//! An IMU in motion, next to a reference of that motion: which physics a calibrated IMU leaves out.
//!
//! `start` → `intake` → `fit` → `conclusion`: clocks, axes and biases roughly; readings and poses
//! on one clock, and whether they agree; attitude and position of the reference against dead
//! reckoning, linear in every parameter (`attitude`, `position`), made white (`whitening`) and
//! summed in blocks of time (`blocks`); candidates judged on blocks that were held out, also with
//! laws free that are no candidates (`beyond`); the verdict. Where the reference has positions alone, `start_by_position` and `along_gyro` stand in:
//! attitude is reckoned from the gyro, and turns by block. The base model has constant biases,
//! gravity of the place and the IMU's stamps and axes as they are given. Not for motion without
//! sensors (`motion`), nor for how far a sensor drifts (`strapdown`).

pub mod account;
mod alignment;
mod along_gyro;
mod attitude;
mod beyond;
mod blocks;
pub mod candidate;
mod clipping;
mod colour;
mod conclusion;
mod course;
mod derivatives;
pub mod detail;
mod effects;
mod faults;
mod fit;
mod fitted;
mod intake;
mod integral;
mod judgement;
mod known;
mod left_out;
mod log;
mod mistaken;
mod mounted;
mod orientation;
mod parameters;
mod permutation;
mod plausible;
mod position;
mod published;
mod rates;
mod remains;
pub mod repaired;
mod rows;
mod scatter;
mod selection;
mod sensor;
mod shown;
mod slow;
mod start;
mod start_by_position;
mod undetermined;
mod upright;
pub mod vibration;
mod whitening;

pub use candidate::CANDIDATES;
pub use detail::Detail;

use nalgebra::{UnitQuaternion, Vector3};

use super::answer::Answer;
use super::model;
use crate::control::{Control, Stopped};
use crate::error::{Error, Result};
use crate::motion::{Earth, Place};
use crate::recording::Recording;
use crate::repeatability::run::Run;
use crate::units::DEGREE;
use beyond::Left;
use conclusion::{Examined, Found};
use course::{Anchor, Case};
use derivatives::Derivatives;
use fit::Fit;
use integral::Rule;
use judgement::COLOUR;
use log::Log;
use parameters::{DRIFT, EARTH_RATE, FORCE_BIAS, GYRO_BIAS, LEVER_ARM, OFFSET, PARAMETERS};
use permutation::Permutation;
use selection::{Allowed, Selection};

/// Whitened residual over that of the finer rule, below which straight lines are clearly better.
const CLEARLY: f64 = 0.8;

/// States how many times what noise makes of an attitude an axis must turn for an arm along it to
/// show.
const SEEN: f64 = 10.0;
const LEVER_ARM_UNDETERMINED: &str = "the lever arm cannot be estimated from positions alone, because one axis hardly \
                                      rotates; rotate about all three";

/// A difference of the clocks by fewer readings than this may come from vibration alone: no difference is tried too.
const AS_NEAR: f64 = 2.0;

/// Searches of the library at most, each about what the one before named: the second sees no noise that was an
/// effect, and further ones follow where it named something else.
const SELECTIONS: usize = 5;

/// Diagnoses a recording of an IMU in motion.
///
/// # Errors
/// Readings or a reference that cannot be used, which do not overlap or do not move alike; when
/// stopped.
pub fn diagnose(recording: &Recording, model: &model::Trajectory, control: &Control) -> Result<Answer> {
    examined(recording, model, control, |examined, found| {
        Ok(match found {
            Ok(found) => examined.conclude(found),
            Err(log) => examined.without_reference(log),
        })
    })
}

/// Returns what a recording in motion can know of its IMU, what it finds, and the same of its halves.
///
/// # Errors
/// As [`diagnose`]; no reference.
pub fn known(recording: &Recording, model: &model::Trajectory, control: &Control) -> Result<Run> {
    examined(recording, model, control, |examined, found| match found {
        Ok(found) => Ok(known::check(found, examined.findings)),
        Err(_) => Err(Error::new(
            format!("could not check {}", recording.path.display()),
            "its model has no reference of the motion",
            "name the motion capture or navigation solution under [reference]; `proofmass diagnose` says what the \
             readings alone show",
        )),
    })
}

/// Fits everything and searches the library; `then` takes what was found, or the log where there is no
/// reference.
fn examined<T>(
    recording: &Recording,
    model: &model::Trajectory,
    control: &Control,
    then: impl FnOnce(Examined<'_>, std::result::Result<&Found<'_>, &Log>) -> Result<T>,
) -> Result<T> {
    let stopped = |s: Stopped| s.during(format!("could not finish {}", recording.path.display()), "start it again");
    let mut findings = recording.sentences();
    let names = intake::names(recording, model)?;
    let (log, began) = intake::log(recording, &names, &mut findings)?;
    intake::units(recording, &log)?;
    let mut held = vec![false; log.time_s.len()];
    let mut masked = held.clone();
    let limits = [clipping::limits(&log.rate, &mut held), clipping::limits(&log.force, &mut masked)];
    let vibration = conclusion::vibration(&log, model);
    let examined = Examined { recording, names, findings, limits, vibration, stated: model.noise };
    let Some(reference) = &model.reference else { return then(examined, Err(&log)) };
    let mut examined = examined;
    let motion = intake::motion(recording, reference, &log, began, &mut examined.findings)?;
    let place = place(model, motion.place);
    let gravity_m_s2 = gravity(place);
    let (whole, mut left_out) = (motion, left_out::Found::default());
    if whole.halves.attitude {
        left_out = left_out::faults(&log, &mut examined.limits[0], &mut held, &whole);
        examined.findings.extend(faults::words(&left_out.faults, &whole));
    }
    if whole.halves.position
        && let Some((before, angle_rad)) = left_out.lost_bearings(&log, &held, &whole)
    {
        return Err(intake::lost_bearings(recording, reference, whole.row[before], angle_rad));
    }
    masked.iter_mut().zip(&held).for_each(|(masked, held)| *masked |= held);
    let motion = faults::sound(&left_out.faults, &whole);
    let work = control.stage("aligning the clocks", 0);
    let own = scatter::random_walks(&log, model.noise);
    let as_given = Case {
        log: &log,
        derivatives: None,
        motion: &motion,
        turned: UnitQuaternion::identity(),
        gravity_m_s2,
        random_walks: own,
        masked: &masked,
        cuts_s: &[],
        rule: Rule::Straight,
        anchor: Anchor::Reference,
    };
    let (start, anchor, least_turn_rad) = if motion.halves.attitude {
        let start = start::start(&log, &held, &motion, gravity_m_s2);
        let kept = motion.time_s.len() as f64 / whole.time_s.len() as f64;
        intake::alike(recording, reference, (&log, &held, &whole), (&start, kept), gravity_m_s2)?;
        (start, Anchor::Reference, f64::INFINITY)
    } else {
        let found = start_by_position::start(&as_given, control).map_err(stopped)?;
        if found.start.explained < start_by_position::ALIKE {
            let mistake = mistaken::mistake(&as_given, control).map_err(stopped)?;
            return Err(intake::not_alike(recording, reference, found.start.explained, mistake));
        }
        (found.start, found.anchor, found.least_turn_rad)
    };
    let log = unswapped(&log, &start);
    let derivatives = motion.halves.attitude.then(|| Derivatives::of(&log));
    let motion = motion.within(&log, start.offset_s);
    work.rename("searching the library");
    let cuts_s = left_out.cuts_s(&log, &held, &whole, start.offset_s);
    let case = Case {
        log: &log,
        cuts_s: &cuts_s,
        derivatives: derivatives.as_ref(),
        motion: &motion,
        turned: start.turned,
        anchor,
        ..as_given
    };
    // What the gyro's white noise makes of an attitude that is right in the middle.
    let wander_rad = (0.25 * own[0] * log.duration_s()).sqrt();
    let mut library = candidate::terms(motion.halves);
    if least_turn_rad < SEEN * wander_rad {
        // Its slope would be made of the noise that it is judged by.
        library.retain(|t| t.parameters != LEVER_ARM);
        examined.findings.push(LEVER_ARM_UNDETERMINED.into());
    }
    let base = selection::base(&case);
    // What is free anyway is no candidate.
    library.retain(|t| t.parameters.clone().all(|p| !base.contains(&p)));
    // The Earth's rate is too small to bend anything: its slope is judged, and it is never
    // followed.
    // Next to positions alone most of the library is poorly observable, and a fit of everything
    // goes astray: at first only clock and lever arm are free.
    let first = |t: &&&candidate::Term| motion.halves.attitude || t.sensor.is_none();
    let first = library.iter().filter(first).copied();
    let everything: Vec<usize> =
        selection::with(&base, first).into_iter().filter(|p| !EARTH_RATE.contains(p)).collect();
    let mut point = [0.0; PARAMETERS];
    point[OFFSET] = start.offset_s;
    point[GYRO_BIAS].copy_from_slice(start.gyro_bias.as_slice());
    point[FORCE_BIAS].copy_from_slice(start.force_bias.as_slice());
    let about_start = Fit::at(&case, &point, &everything, control).map_err(stopped)?;
    let open = if motion.halves.attitude { undetermined::open(&about_start, own) } else { Vec::new() };
    let base: Vec<usize> = base.into_iter().filter(|p| !open.contains(p)).collect();
    let everything: Vec<usize> = everything.into_iter().filter(|p| !open.contains(p)).collect();
    // What the motion does not determine next to all the rest is judged by itself, about zero.
    let everything = undetermined::told(&about_start.linear, &everything, &library);
    // A body moves smoothly: straight lines cut its curves, which would pass for a scale factor. They
    // stand only where the reference follows them clearly more closely: where it vibrates about as fast as it is
    // sampled.
    let straight = Fit::new(&case, &point, &everything, control).map_err(stopped)?;
    let smooth = Case { rule: Rule::Cubic, ..case };
    let cubic = Fit::new(&smooth, &point, &everything, control).map_err(stopped)?;
    let clearly = straight.innovation() < CLEARLY * cubic.innovation();
    let (case, fit) = if clearly { (case, straight) } else { (smooth, cubic) };
    if fit.linear.point.iter().any(|v| !v.is_finite()) {
        return Err(Error::new(
            format!("could not diagnose {}", recording.path.display()),
            "the fit diverged: no IMU with plausible errors fits the reference",
            "are reference and recording from the same run, and are the reference's quaternions body to world?",
        ));
    }
    // Weighed for everything first, so that no effect counts as noise; then about what was named,
    // so that no noise of the reference counts as an effect.
    let beside = |fit: &Fit, laws: &[&'static candidate::Term]| {
        let tilt_rad = if motion.halves.attitude { fit.tilt_rad() } else { wander_rad };
        // Attitude that is reckoned from the gyro gives the residual a colour that changes with the
        // motion: what falls by less than such colour may is not named.
        let least_part = if motion.halves.attitude { 0.0 } else { COLOUR };
        let base = selection::with(&base, laws.iter().copied());
        let allowed = Allowed { base: &base, open: &open, least_part, tilt_rad, interval_s: log.interval_s };
        selection::select(&fit.linear, &library, &allowed, control).map_err(stopped)
    };
    let select = |fit: &Fit| beside(fit, &[]);
    let about = |fit: &Fit, selection: &Selection| {
        let active: Vec<usize> = selection.active().into_iter().filter(|p| !EARTH_RATE.contains(p)).collect();
        let solved = fit.linear.solve(&active, |_| true).point;
        let found = Fit::new(&case, &solved, &active, control).map_err(stopped)?;
        // Straight lines between readings are smoother than the readings, more or less as the clocks lie: noise makes
        // valleys a reading apart, and what is linear in one says nothing of the next.
        let is_near = found.linear.point[OFFSET].abs() < AS_NEAR * log.interval_s;
        if !is_near || !active.contains(&OFFSET) {
            return Ok(found);
        }
        let mut none = solved;
        (none[OFFSET], none[DRIFT]) = (0.0, 0.0);
        let other = Fit::new(&case, &none, &active, control).map_err(stopped)?;
        Ok(if other.innovation() < found.innovation() { other } else { found })
    };
    let mut selection = select(&fit)?;
    let mut fit = about(&fit, &selection)?;
    for _ in 1..SELECTIONS {
        let before = selection.active();
        selection = select(&fit)?;
        if selection.active() == before {
            break;
        }
        fit = about(&fit, &selection)?;
    }
    let left = Left { linear: &fit.linear, halves: motion.halves, selection: &selection, interval_s: log.interval_s };
    let laws = left.laws(|laws| beside(&fit, laws))?;
    if !laws.is_empty() {
        selection = Selection { base: base.clone(), ..beside(&fit, &laws)? };
        fit = about(&fit, &selection)?;
    }
    drop(work);
    let found = Found {
        log: &log,
        case: &case,
        start: &start,
        fit: &fit,
        selection: &selection,
        laws: &laws,
        reference,
        place,
    };
    then(examined, Ok(&found))
}

/// Latitude, °, and height, m, as the model states them, else as the reference does.
fn place(model: &model::Trajectory, of_reference: Option<Place>) -> Option<(f64, f64)> {
    let stated = model.latitude_deg.map(|latitude_deg| (latitude_deg, model.height_m.unwrap_or_default()));
    stated.or_else(|| of_reference.map(|place| (place.latitude_rad / DEGREE, place.height_m)))
}

/// Gravity of a place, m/s².
fn gravity(place: Option<(f64, f64)>) -> f64 {
    let (latitude_rad, height_m) =
        (place.map(|(degrees, _)| degrees * DEGREE), place.map_or(0.0, |(_, height)| height));
    let earth = Earth { latitude_rad, height_m, rotation: false };
    earth.gravity_m_s2(earth.start())
}

/// Every reading on the axis that it belongs to.
fn unswapped(log: &Log, start: &start::Start) -> Log {
    let back = |values: &[Vector3<f64>], swap: Permutation| {
        let back = swap.matrix().transpose();
        values.iter().map(|v| back * v).collect()
    };
    Log { rate: back(&log.rate, start.gyro), force: back(&log.force, start.accelerometer), ..log.clone() }
}
