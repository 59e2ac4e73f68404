//! repaired.toml of an IMU in motion: a study that runs as it is, with the numbers that were named.

use libtest_mimic::{Failed, Trial};
use proofmass::backend::flight::Quantity;
use proofmass::control::Control;
use proofmass::diagnosis::repaired;
use proofmass::diagnosis::{diagnose, model};
use proofmass::ensemble::Choice;
use proofmass::report::diagnosis::worded;
use proofmass::strapdown::answer::answer;
use proofmass::study::{self, Overrides, Study};
use toml::{Table, Value};

use super::super::world::{check, near, test};
use super::flight::{Files, Flight, made_up};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("trajectory: the repaired sensor is a study that runs, with the numbers that were named", runs),
        test("trajectory: the repaired sensor has the clock that was named, from where its study begins", gains),
        test("trajectory: the repaired sensor has the gyro's range that was named", ends),
        test("trajectory: a repaired IMU flies without the constants that were calibrated", corrected),
    ]
}

/// uncorrected.toml of a recording, with every number that was named.
fn document(files: &Files, folder: &std::path::Path) -> Result<String, Failed> {
    let [imu, model] = files.write(folder)?;
    let model = model::read(&model)?;
    let recording = model::read_recording(&imu, &model, &Control::silent())?;
    let answer = diagnose(&recording, &model, &Control::silent())?;
    let found = worded(answer);
    repaired::uncorrected(&found.detail, &found.verdict).ok_or_else(|| "no study".into())
}

fn number(value: Option<&Value>) -> f64 {
    value.and_then(|v| v.as_float().or_else(|| v.as_integer().map(|n| n as f64))).unwrap_or(f64::NAN)
}

fn mean(table: &Table, section: &str, key: &str, axis: usize) -> f64 {
    let value = table.get(section).and_then(|s| s.get(key));
    let value = value.and_then(|v| v.get(axis)).or(value);
    number(value.and_then(|v| v.get("mean")))
}

fn runs() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let scaled = made_up(1)?.with_rate(|w| w.map(|v| v * 1.004)).shifted(0.004);
    let text = document(&scaled.files(), folder.path())?;
    let table: Table = text.parse()?;
    // A reading of y = (1 + s) ω + b: the scale acts on the planted bias as well.
    let degree_per_hour = std::f64::consts::PI / 180.0 / 3600.0;
    for (axis, (gyro, force)) in [(0.01, 0.05), (-0.02, -0.03), (0.005, 0.1)].into_iter().enumerate() {
        near("gyro bias", mean(&table, "gyro", "bias_deg_h", axis) * degree_per_hour, gyro * 1.004, 1e-4)?;
        near("force bias", mean(&table, "accelerometer", "bias_mg", axis) * 9.80665e-3, force, 2e-2)?;
        near("scale", mean(&table, "gyro", "scale_factor_ppm", axis), 4000.0, 500.0)?;
    }
    near("offset", mean(&table, "sensor", "time_offset_us", 0), 4000.0, 200.0)?;
    check(table.get("gyro").and_then(|g| g.get("misalignment_mrad")).is_none(), "a misalignment that was not named")?;
    // It runs from another folder, as it is but for the number of members.
    let path = folder.path().join("repaired.toml");
    std::fs::write(&path, &text)?;
    let few = Overrides { members: Some(64), ..Overrides::default() };
    // The flight stands still for three seconds: a bias of 0.1 m/s² along z is ½ b t² after one,
    // within the 0.02 m/s² above.
    let still = down_m(&study::read(&path, &few, &Control::silent())?)?;
    near("down", still, 0.05, 0.01)?;
    std::fs::write(&path, without(&table, "accelerometer").to_string())?;
    check(
        (down_m(&study::read(&path, &few, &Control::silent())?)? - 0.05).abs() > 0.01,
        "a sensor without that bias would pass",
    )
}

/// The table of a recording's study, which can be read.
fn table(flight: &Flight) -> Result<Table, Failed> {
    let folder = tempfile::tempdir()?;
    let text = document(&flight.files(), folder.path())?;
    let path = folder.path().join("repaired.toml");
    std::fs::write(&path, &text)?;
    study::read(&path, &Overrides::default(), &Control::silent())?;
    Ok(text.parse()?)
}

/// Stamps that gain from the first reading on, where the study begins: there is no offset there, while
/// the diagnosis states that of the middle, 22 ms. The drift is known to some ppm.
fn gains() -> Result<(), Failed> {
    let flight = made_up(2)?;
    let of = |part: f64| -> Result<[f64; 2], Failed> {
        let table = table(&flight.gaining(part))?;
        let offset_us = mean(&table, "sensor", "time_offset_us", 0);
        Ok([mean(&table, "sensor", "clock_drift_ppm", 0), if offset_us.is_nan() { 0.0 } else { offset_us }])
    };
    let [drift_ppm, offset_us] = of(500e-6)?;
    near("drift, ppm", drift_ppm, 500.0, 30.0)?;
    near("offset at the beginning, µs", offset_us, 0.0, 1500.0)?;
    // Controls: a clock that loses has the other sign, and one that does neither has no key.
    near("drift of a clock that loses, ppm", of(-500e-6)?[0], -500.0, 30.0)?;
    check(of(0.0)?[0].is_nan(), "a drift that was not planted")
}

/// What clips at 0.6 rad/s has this range, 34.4 °/s.
fn ends() -> Result<(), Failed> {
    let flight = made_up(3)?;
    let range_deg_s = |limit: f64| -> Result<f64, Failed> {
        let table = table(&flight.with_rate(|w| w.map(|v| v.clamp(-limit, limit))))?;
        Ok(number(table.get("gyro").and_then(|gyro| gyro.get("range_deg_s"))))
    };
    for limit in [0.6f64, 0.5] {
        near("range, °/s", range_deg_s(limit)?, limit.to_degrees(), 0.01)?;
    }
    // Control: what reads all there is has none.
    check(range_deg_s(1e3)?.is_nan(), "a range that was not planted")
}

fn without(table: &Table, section: &str) -> Table {
    table.iter().filter(|(key, _)| *key != section).map(|(key, value)| (key.clone(), value.clone())).collect()
}

/// Mean error of the position along the vertical after the first report time, m.
fn down_m(study: &Study) -> Result<f64, Failed> {
    let motion = study.in_motion.as_ref().ok_or("no trajectory")?;
    let found = answer(study, motion, Choice::Cpu, &Control::silent())?;
    check(found.report_times_s().first().is_some_and(|t| (t - 1.0).abs() < 1e-9), "it does not report after a second")?;
    Ok(found.ensemble.summary(found.report[0], Quantity::Position(2)).mean)
}

/// Constants are subtracted: their means are zero and their standard errors stay, and an IMU with a
/// bias of 0.1 m/s² is within the interval of that bias after one second, ½ b t² without.
fn corrected() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let [imu, model] = made_up(1)?.files().write(folder.path())?;
    let model = model::read(&model)?;
    let recording = model::read_recording(&imu, &model, &Control::silent())?;
    let found = worded(diagnose(&recording, &model, &Control::silent())?);
    let text = repaired::document(found.repair.as_ref(), &found.detail, &found.verdict).ok_or("no study")?;
    let table: Table = text.parse()?;
    for axis in 0..3 {
        near("gyro bias", mean(&table, "gyro", "bias_deg_h", axis), 0.0, 0.0)?;
        near("force bias", mean(&table, "accelerometer", "bias_mg", axis), 0.0, 0.0)?;
    }
    let path = folder.path().join("repaired.toml");
    std::fs::write(&path, &text)?;
    let few = Overrides { members: Some(64), ..Overrides::default() };
    near("down", down_m(&study::read(&path, &few, &Control::silent())?)?, 0.0, 0.01)?;
    let left_in = repaired::uncorrected(&found.detail, &found.verdict).ok_or("nothing is left in")?;
    std::fs::write(&path, &left_in)?;
    let down = down_m(&study::read(&path, &few, &Control::silent())?)?;
    check((down - 0.05).abs() < 0.01, format!("with its constants left in it falls by {down} m, not by 0.05 m"))
}
