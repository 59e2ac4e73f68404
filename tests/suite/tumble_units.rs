//! The units that headings state hold for a tumble's scales, also where each turn is small; readings that contradict them
//! are said, and the unit is taken for unknown.

use libtest_mimic::{Failed, Trial};
use nalgebra::Vector3;
use proofmass::control::Control;
use proofmass::diagnosis::repeatability::parameter::{Element, Role};
use proofmass::diagnosis::repeatability::run::Run;
use proofmass::diagnosis::tumble::known_in;
use proofmass::sensor::Sense;

use super::tumble_bench::{Imu, model};
use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("tumble units: steps of a dividing head give the scale of the axis, with a unit and without", steps),
        test("tumble units: readings in another unit than their headings state are said", contradicted),
    ]
}

/// Scale errors of x, y and z.
const ERRORS: [f64; 3] = [0.004, -0.006, 0.009];
/// Counts per m/s² in milli-g, and per rad/s in millidegrees per second.
const MILLI: [f64; 2] = [1e3 / 9.80665, 180e3 / std::f64::consts::PI];

/// Checks an IMU that reads this many counts per SI unit, under these headings.
fn checked(imu: Imu, counts: [f64; 2], headings: [&str; 2]) -> Result<Run, Failed> {
    let scale = counts.map(|per| Vector3::from(ERRORS).map(|error| per * (1.0 + error)));
    let (mut recording, poses) = Imu { scale, offset: [Vector3::zeros(); 2], ..imu }.record(41);
    let mut model = model();
    let three = |sensor: &str, unit: &str| ["x", "y", "z"].map(|axis| format!("{sensor}{axis}{unit}"));
    let (force, rate) = (three("a", headings[0]), three("g", headings[1]));
    recording.columns.iter_mut().zip(force.iter().chain(&rate)).for_each(|(column, name)| column.name.clone_from(name));
    (model.columns.accelerometer, model.columns.gyro) = (force, Some(rate));
    Ok(known_in(&recording, &model, Some(poses), &Control::silent())?)
}

/// The scale of an axis, where it is determined, and whether it is relative to its unit.
fn scale(run: &Run, of: Sense, along: usize) -> Option<(f64, bool)> {
    let is = |e: &Element| e.sensor == of && e.role == Role::Scale && e.axis == along;
    let place = run.estimate.parameters.iter().position(|p| p.element().is_some_and(is))?;
    let is_si = run.estimate.parameters[place].element()?.is_si;
    run.estimate.determines(place).then_some((run.estimate.value[place], is_si))
}

/// Twenty-five poses about y, 15° apart: a gyro whose scale is 1/145 of the true one would turn by 15° − 360° · 6.
fn steps() -> Result<(), Failed> {
    for (headings, per) in [(["_mg", "_mdps"], 1.0), (["", ""], MILLI[1])] {
        let turned = Vector3::new(0.0, 1.0, 0.0);
        let imu = Imu { turned, poses: 25, step_rad: Some(15f64.to_radians()), ..Imu::without_defect(41) };
        let run = checked(imu, MILLI, headings)?;
        let (value, is_si) = scale(&run, Sense::Gyro, 1).ok_or("the scale of the turned axis is not determined")?;
        check(is_si != headings[0].is_empty(), format!("{headings:?}: relative to its unit: {is_si}"))?;
        near(&format!("scale of y, {headings:?}"), value / per, 1.0 + ERRORS[1], 1e-3)?;
        check(scale(&run, Sense::Gyro, 0).is_none(), "a scale is given for an axis that was never turned about")?;
    }
    Ok(())
}

/// Under a heading in mg stand mm/s², under one in mdps stand mrad/s.
fn contradicted() -> Result<(), Failed> {
    let said =
        |run: &Run| run.findings.iter().filter(|finding| finding.contains("the unit?")).cloned().collect::<Vec<_>>();
    let imu = || Imu { poses: 24, ..Imu::without_defect(41) };
    let right = checked(imu(), MILLI, ["_mg", "_mdps"])?;
    check(said(&right).is_empty(), format!("the right units: {:?}", said(&right)))?;
    let wrong = checked(imu(), [1e3, 1e3], ["_mg", "_mdps"])?;
    check(said(&wrong).len() == 2, format!("findings: {:?}", wrong.findings))?;
    for (sense, per) in [(Sense::Accelerometer, 1e3), (Sense::Gyro, 1e3)] {
        let (value, is_si) = scale(&wrong, sense, 2).ok_or("no scale of z")?;
        check(!is_si, "a contradicted unit is used")?;
        near(&format!("counts of the {}'s z", sense.name()), value / per, 1.0 + ERRORS[2], 2e-3)?;
    }
    Ok(())
}
