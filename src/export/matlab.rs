//! MATLAB's imuSensor: with NoiseType "double-sided", white noise of NoiseDensity × √SampleRate per
//! sample and a bias that walks by RandomWalk/√SampleRate: N and K. ("single-sided", older
//! releases' only way, divides the first by √2.)

use super::drift::{self, Form};
use super::imu::{Errors, Imu, Value};
use super::sheet::{Field, Sheet, WALK, WHITE};
use crate::error::{Error, Result};

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("MATLAB, accelparams and gyroparams, Properties, and imuSensor, Algorithms");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    sheet.note(
        "BiasInstability stays 0: with its default filter it is not flicker noise but white noise over two samples",
    );
    for (name, class, errors, drift, unit, density, per_root_s) in [
        ("accelerometer", "accelparams", &imu.accelerometer, &a, "m/s^2", "m/s^2/sqrt(Hz)", "m/s^2*sqrt(Hz)"),
        ("gyroscope", "gyroparams", &imu.gyro, &g, "rad/s", "rad/s/sqrt(Hz)", "rad/s*sqrt(Hz)"),
    ] {
        sheet.line(&format!("{name} = {class};"));
        sheet.note(
            "NoiseType: makes NoiseDensity and RandomWalk two-sided, N and K; \"single-sided\" would be sqrt(2) off",
        );
        sheet.line(&format!("{name}.NoiseType = \"double-sided\";"));
        for (key, value, unit, means) in [
            ("NoiseDensity", errors.white.mean, density, WHITE),
            ("RandomWalk", drift.drive, per_root_s, WALK),
            ("ConstantBias", errors.bias.mean, unit, "constant bias, the mean over sensors"),
            ("Resolution", errors.step, unit, "step of the reading; 0 for none"),
        ] {
            sheet.field(Field { key: &format!("{name}.{key}"), value, unit, means });
        }
        if errors.range.is_finite() {
            let key = format!("{name}.MeasurementRange");
            sheet.field(Field { key: &key, value: errors.range, unit, means: "full scale" });
        }
    }
    sheet.line(&format!(
        "imu = imuSensor(\"accel-gyro\", \"SampleRate\", {:?}, \"Accelerometer\", accelerometer, \"Gyroscope\", gyroscope);",
        imu.rate_hz
    ));
}

pub(super) fn read(name: &str, text: &str) -> Result<Imu> {
    let fail = |cause: String| {
        let hint = "give a script that sets properties of accelparams and gyroparams one a line, as `export` writes it";
        Error::new(format!("could not import {name}"), cause, hint)
    };
    let code: Vec<&str> = text.lines().map(|line| line.split('%').next().unwrap_or_default().trim()).collect();
    let rate = code.iter().find_map(|line| line.split_once("\"SampleRate\",")).map(|(_, rest)| rest);
    let rate = rate.and_then(|rest| rest.split([',', ')']).next()?.trim().parse::<f64>().ok());
    let rate_hz = rate.filter(|r| r.is_finite() && *r > 0.0);
    let mut imu = Imu::new(name, rate_hz.ok_or_else(|| fail("it sets no \"SampleRate\" of an imuSensor".into()))?);
    for (class, errors) in [("accelparams", &mut imu.accelerometer), ("gyroparams", &mut imu.gyro)] {
        let variable =
            code.iter().find_map(|line| line.strip_suffix(';')?.split_once('=').filter(|(_, c)| c.trim() == class));
        let Some((variable, _)) = variable else { return Err(fail(format!("it makes no {class}"))) };
        properties(&code, variable.trim(), errors).map_err(fail)?;
    }
    Ok(imu)
}

/// Reads the numbers set for one variable; the cause where one cannot be read.
fn properties(code: &[&str], variable: &str, errors: &mut Errors) -> Result<(), String> {
    let mut one_sided = false;
    for line in code {
        let set =
            line.strip_prefix(variable).and_then(|rest| rest.strip_prefix('.')).and_then(|rest| rest.split_once('='));
        let Some((property, value)) = set else { continue };
        let (property, value) = (property.trim(), value.trim().trim_end_matches(';').trim());
        if property == "NoiseType" {
            one_sided = value.contains("single-sided");
            continue;
        }
        let number = || match value.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(format!("{variable}.{property}: need one number, got `{value}`")),
        };
        match property {
            "NoiseDensity" => errors.white = Value { mean: number()?, sd: 0.0 },
            "RandomWalk" => errors.walk = Value { mean: number()?, sd: 0.0 },
            "ConstantBias" => errors.bias = Value { mean: number()?, sd: 0.0 },
            "Resolution" => errors.step = number()?,
            "MeasurementRange" => errors.range = number()?,
            _ => {}
        }
    }
    if one_sided {
        // A one-sided density n is N = n/√2; imuSensor's walk then steps by
        // RandomWalk/√(SampleRate/2).
        errors.white.mean *= std::f64::consts::FRAC_1_SQRT_2;
        errors.walk.mean *= std::f64::consts::SQRT_2;
    }
    Ok(())
}
