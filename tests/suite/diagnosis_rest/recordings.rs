//! Sensors at rest that were really recorded.

use std::path::Path;

use libtest_mimic::Failed;
use proofmass::diagnosis::model::{Static, StaticColumns};
use proofmass::diagnosis::verdict::{Outcome, Verdict};
use proofmass::recording::{self, Request};

use super::diagnose;
use crate::suite::world::check;

/// The first 200,000 rows (33 min) of a gyro that nothing shakes, one with a vibration near 20 Hz
/// (a spectrum shows ten times the noise between 18 and 22 Hz) and an accelerometer that sways with
/// its building at 0.564 Hz.
pub(super) fn adis(folder: &Path) -> Result<(), Failed> {
    let names = ["gx_lsb", "gz_lsb", "ax_lsb"].map(str::to_owned).to_vec();
    let request =
        Request { columns: names.clone(), rate_hz: Some(100.0), rows: Some(0..200_000), ..Request::default() };
    let model = Static {
        force_rate: false,
        topic: None,
        rate_hz: Some(100.0),
        rows: Vec::new(),
        unit: String::new(),
        latitude_deg: None,
        height_m: None,
        columns: StaticColumns { time: None, channels: names.clone(), environment: Vec::new() },
        noise: None,
        split: Default::default(),
    };
    let recording = recording::read(&folder.join("adis16405/run1_counts.csv"), &request)?;
    let verdict = diagnose(&recording, &model)?.verdict;
    check(verdict.verdict == Outcome::Unexplained, verdict.sentence.clone())?;
    check(verdict.effects.iter().all(|e| e.id != "sinusoid"), verdict.sentence.clone())?;
    check(verdict.sentence.contains("The residual of gx_lsb is noise"), verdict.sentence.clone())?;
    for finding in &names {
        let of = |f: &&String| f.contains(finding.as_str()) && f.contains("filter");
        check(verdict.findings.iter().any(|f| of(&f)), format!("no word of the roll-off of {finding}"))?;
    }
    for name in ["gz_lsb: most between", "ax_lsb: most between"] {
        check(verdict.location.summary.contains(name), verdict.location.summary.clone())?;
    }
    Ok(())
}

pub(super) fn sense_hat(folder: &Path) -> Result<(), Failed> {
    // Rows 4101 on: before them lie a gap and a re-orientation (README of the data).
    let request = |columns: &[&str]| Request {
        columns: columns.iter().map(|c| (*c).to_owned()).collect(),
        rate_hz: Some(0.1),
        time: None,
        rows: Some(4101..24_603),
        ..Request::default()
    };
    let model = |columns: &[&str], environment: &[&str]| Static {
        force_rate: false,
        topic: None,
        rate_hz: Some(0.1),
        rows: Vec::new(),
        unit: String::new(),
        latitude_deg: None,
        height_m: None,
        columns: StaticColumns {
            time: None,
            channels: columns.iter().map(|c| (*c).to_owned()).collect(),
            environment: environment.iter().map(|c| (*c).to_owned()).collect(),
        },
        noise: None,
        split: Default::default(),
    };
    let follows =
        |v: &Verdict| v.effects.iter().filter(|e| e.id == "temperature-sensitivity").cloned().collect::<Vec<_>>();
    let imu = folder.join("sensehat/imu_10s.csv");
    let (accelerometer, gyro) = (["ax_g", "ay_g", "az_g"], ["gx_rad_s", "gy_rad_s", "gz_rad_s"]);
    let blind = diagnose(&recording::read(&imu, &request(&accelerometer))?, &model(&accelerometer, &[]))?.verdict;
    check(follows(&blind).iter().any(|e| e.channels.len() >= 2), format!("without the column: {}", blind.sentence))?;
    let still = diagnose(&recording::read(&imu, &request(&gyro))?, &model(&gyro, &[]))?.verdict;
    check(follows(&still).is_empty(), format!("gyro: {}", still.sentence))?;
    // The power of gy goes from 0.14 to 1.8 of its median over the log (64 stretches, differences
    // of neighbours); the other two are steady within 20 %. Their spectrum falls towards slow
    // frequencies, as no law of the library does: squared cosine coefficients of gx, means over
    // bands half as wide again as they begin, in 10⁻⁸ (rad/s)²: 3.2 from 14 mHz, 10 from 3.8 mHz,
    // 26 from 1.0 mHz, 42 from 0.43 mHz (so far nearly 1/f), but 6.3 from 0.049 mHz and 2.9 from
    // 0.012 mHz. The power of gy changes by at most a factor of 2.0 from one of 64 stretches to the
    // next, 2.5 to the next but one, and 3.9 among 16: below the fourfold change of a disturbance,
    // so it is uneven noise, a statement and no mismatch.
    let is_uneven = still.findings.iter().any(|f| f.contains("gy_rad_s") && f.contains("uneven"));
    check(is_uneven, format!("{:?}", still.findings))?;
    check(still.location.summary.contains("gx_rad_s: below"), still.location.summary.clone())?;
    check(still.effects.iter().all(|e| e.channels == ["gz_rad_s"]), still.sentence.clone())?;

    // Both files side by side, as a user would log them.
    let temperature = std::fs::read_to_string(folder.join("sensehat/temperature.csv"))?;
    let text = std::fs::read_to_string(&imu)?;
    let both: Vec<String> = text
        .lines()
        .zip(temperature.lines())
        .map(|(a, b)| format!("{a},{}", b.split_once(',').map_or("", |c| c.1)))
        .collect();
    let together = tempfile::tempdir()?;
    let path = together.path().join("both.csv");
    std::fs::write(&path, both.join("\n"))?;
    let columns = [&accelerometer[..], &["temp_p"]].concat();
    let told = diagnose(&recording::read(&path, &request(&columns))?, &model(&accelerometer, &["temp_p"]))?.verdict;
    let slopes = follows(&told);
    check(slopes.len() == 3, format!("with the column: {}", told.sentence))?;
    // Slopes of a straight line through each axis, mg/°C (README of the data); signs must agree and
    // sizes within a factor of two, because a line also takes in what the walk explains here.
    for (channel, slope_mg) in [("ax_g", 0.568), ("ay_g", 0.411), ("az_g", -0.407)] {
        let found = slopes.iter().find(|e| e.channels == [channel]).map_or(f64::NAN, |e| 1e3 * e.parameters[0].value);
        check((0.5..2.0).contains(&(found / slope_mg)), format!("{channel}: {found} mg/°C, a line has {slope_mg}"))?;
    }
    let columns = [&gyro[..], &["temp_p"]].concat();
    let told = diagnose(&recording::read(&path, &request(&columns))?, &model(&gyro, &["temp_p"]))?.verdict;
    check(follows(&told).is_empty(), format!("gyro with the column: {}", told.sentence))
}
