//! Kalibr's flat imu.yaml: continuous-time densities, which it makes discrete with √rate (wiki,
//! "IMU Noise Model").

use super::drift::{self, Form};
use super::imu::{Imu, Value};
use super::sheet::{Field, Sheet, WALK, WHITE};
use proofmass_base::error::{Error, Result, nearest};

const DOCUMENTED: &str = "the Kalibr wiki, IMU Noise Model, section The Noise Model Parameters in Kalibr";

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head(DOCUMENTED);
    fields(imu, sheet);
    sheet.line("rostopic: /imu0");
    sheet.line(&format!("update_rate: {:?}  # Hz", imu.rate_hz));
}

/// The four numbers, as OpenVINS reads them too.
pub(super) fn fields(imu: &Imu, sheet: &mut Sheet) {
    let (accelerometer, gyro) = (&imu.accelerometer, &imu.gyro);
    let [a, g] = [accelerometer, gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    for (key, value, unit, means) in [
        ("accelerometer_noise_density", accelerometer.white.mean, "m/s^2/sqrt(Hz)", WHITE),
        ("accelerometer_random_walk", a.drive, "m/s^3/sqrt(Hz)", WALK),
        ("gyroscope_noise_density", gyro.white.mean, "rad/s/sqrt(Hz)", WHITE),
        ("gyroscope_random_walk", g.drive, "rad/s^2/sqrt(Hz)", WALK),
    ] {
        sheet.field(Field { key, value, unit, means });
    }
}

pub(super) fn read(name: &str, text: &str) -> Result<Imu> {
    let number = |key: &str| -> Result<f64> {
        let mut lines = text.lines().enumerate().filter_map(|(i, line)| {
            let (found, rest) = line.split('#').next()?.split_once(':')?;
            (found.trim() == key).then(|| (i + 1, rest.trim().to_owned()))
        });
        let fail = |cause: String, hint: String| Error::new(format!("could not import {name}"), cause, hint);
        let Some((line, value)) = lines.next() else {
            let keys = text.lines().filter_map(|line| line.split_once(':')).map(|(found, _)| found.trim());
            return Err(fail(
                format!("it has no `{key}`"),
                nearest(key, keys).map_or("is this an imu.yaml of Kalibr?".into(), |k| format!("it has `{k}`")),
            ));
        };
        if let Some((again, _)) = lines.next() {
            let cause = format!("{name}:{again}: {key} stands in line {line} already");
            return Err(fail(cause, "give the lines of one IMU, each key once".into()));
        }
        let read = value.parse().ok().filter(|v: &f64| v.is_finite() && *v >= 0.0);
        read.ok_or_else(|| {
            fail(format!("{name}:{line}: {key}: need a number, zero or more, got `{value}`"), "correct it".into())
        })
    };
    let rate_hz = number("update_rate")?;
    if rate_hz == 0.0 {
        return Err(Error::new(format!("could not import {name}"), "update_rate is 0", "give the rate of the IMU, Hz"));
    }
    let mut imu = Imu::new(name, rate_hz);
    let fixed = |mean| Value { mean, sd: 0.0 };
    imu.accelerometer.white = fixed(number("accelerometer_noise_density")?);
    imu.accelerometer.walk = fixed(number("accelerometer_random_walk")?);
    imu.gyro.white = fixed(number("gyroscope_noise_density")?);
    imu.gyro.walk = fixed(number("gyroscope_random_walk")?);
    imu.unread = unread(text);
    Ok(imu)
}

/// States what a calibration found and a sensor file has no place for here: matrices that are neither the identity
/// nor nothing, a clock that is off.
fn unread(text: &str) -> Vec<String> {
    let lines: Vec<&str> = text.lines().map(|line| line.split('#').next().unwrap_or_default().trim()).collect();
    let mut sensor = "";
    let mut found = Vec::new();
    for (place, line) in lines.iter().enumerate() {
        let Some((key, value)) = line.split_once(':') else { continue };
        let (key, value) = (key.trim(), value.trim());
        let rows: Vec<&str> =
            lines[place + 1..].iter().map_while(|row| row.strip_prefix("- ")).map(str::trim).collect();
        if value.is_empty() && rows.is_empty() {
            sensor = key;
        }
        let is_off = key == "time_offset" && value.parse() != Ok(0.0);
        if is_off {
            found.push(format!("{key}: {value}"));
        }
        if key != MOUNTING && !is_plain(&rows) {
            found.push(format!("{key} of {sensor}: {}", rows.join(", ")));
        }
    }
    found
}

/// From the IMU to the body: where it is mounted, and no error of it.
const MOUNTING: &str = "T_i_b";

/// Returns whether rows are those of the identity or of nothing; text that is no matrix is.
fn is_plain(rows: &[&str]) -> bool {
    let numbers = |row: &&str| -> Option<Vec<f64>> {
        let inside = row.strip_prefix('[')?.strip_suffix(']')?;
        inside.split(',').map(|cell| cell.trim().parse().ok()).collect()
    };
    let Some(matrix) = rows.iter().map(numbers).collect::<Option<Vec<_>>>() else { return true };
    let all = |expected: fn(usize, usize) -> f64| {
        matrix.iter().enumerate().all(|(i, row)| row.iter().enumerate().all(|(j, value)| *value == expected(i, j)))
    };
    all(|_, _| 0.0) || all(|i, j| if i == j { 1.0 } else { 0.0 })
}
