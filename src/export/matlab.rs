//! MATLAB's imuSensor: with NoiseType "double-sided", white noise of NoiseDensity × √SampleRate per
//! sample and a bias that walks by RandomWalk/√SampleRate: N and K. ("single-sided", older
//! releases' only way, divides the first by √2.) NoiseDensity, RandomWalk and ConstantBias are one
//! number or a row of three, x, y and z.

use super::drift::{self, Form};
use super::imu::{Errors, Imu, Value};
use super::sheet::{Field, Sheet, WALK, WHITE};
use proofmass_base::error::{Error, Result};

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("MATLAB, accelparams and gyroparams, Properties, and imuSensor, Algorithms");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    sheet.note(
        "BiasInstability stays 0: with its default filter it is not flicker noise but white noise over two samples",
    );
    for (sense, name, class, drift, unit, density, per_root_s) in [
        (0, "accelerometer", "accelparams", &a, "m/s^2", "m/s^2/sqrt(Hz)", "m/s^2*sqrt(Hz)"),
        (1, "gyroscope", "gyroparams", &g, "rad/s", "rad/s/sqrt(Hz)", "rad/s*sqrt(Hz)"),
    ] {
        let errors = [&imu.accelerometer, &imu.gyro][sense];
        let axes = [0, 1, 2].map(|axis| imu.axis(axis)[sense]);
        let of = |number: &dyn Fn(&Errors) -> f64| axes.each_ref().map(number);
        sheet.line(&format!("{name} = {class};"));
        sheet.note(
            "NoiseType: makes NoiseDensity and RandomWalk two-sided, N and K; \"single-sided\" would be sqrt(2) off",
        );
        sheet.line(&format!("{name}.NoiseType = \"double-sided\";"));
        for (key, value, axes, unit, means) in [
            ("NoiseDensity", errors.white.mean, of(&|e| e.white.mean), density, WHITE),
            ("RandomWalk", drift.drive, of(&|e| drift::process(e, Form::Walk).drive), per_root_s, WALK),
            ("ConstantBias", errors.bias.mean, of(&|e| e.bias.mean), unit, "constant bias, the mean over sensors"),
        ] {
            sheet.axes(Field { key: &format!("{name}.{key}"), value, unit, means }, axes);
        }
        let (key, means) = (format!("{name}.Resolution"), "step of the reading; 0 for none");
        sheet.field(Field { key: &key, value: errors.step, unit, means });
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
        let hint = "give a script that sets properties of accelparams and gyroparams, as `export` writes it";
        Error::new(format!("could not import {name}"), cause, hint)
    };
    let text = text.replace('\'', "\"");
    let code = statements(&text);
    // Other sensors of the same script have rates of their own.
    let made = code.iter().find_map(|s| s.split_once('=').filter(|(_, made)| made.trim().starts_with("imuSensor")));
    let (unit, made) = made.map_or(("", ""), |(unit, made)| (unit.trim(), made));
    let property = |statement: &&'_ str| {
        let rest = statement.strip_prefix(unit)?.strip_prefix(".SampleRate")?;
        Some(rest.trim_start().strip_prefix('=')?.to_owned())
    };
    let argument = made.split_once("\"SampleRate\",").map(|(_, rest)| rest.to_owned());
    let rate = argument.or_else(|| code.iter().find_map(property));
    let rate = rate.and_then(|rest| rest.split([',', ')']).next()?.trim().parse::<f64>().ok());
    let rate_hz = rate.filter(|r| r.is_finite() && *r > 0.0);
    let mut imu = Imu::new(name, rate_hz.ok_or_else(|| fail("it sets no \"SampleRate\" of an imuSensor".into()))?);
    let mut senses = [[imu.accelerometer; 3], [imu.gyro; 3]];
    for (class, errors) in ["accelparams", "gyroparams"].into_iter().zip(&mut senses) {
        let mut variables =
            code.iter().filter_map(|statement| statement.split_once('=').filter(|(_, made)| made.trim() == class));
        let Some((variable, _)) = variables.next() else { return Err(fail(format!("it makes no {class}"))) };
        if variables.next().is_some() {
            return Err(fail(format!("it makes more than one {class}")));
        }
        imu.unread.extend(properties(&code, variable.trim(), errors).map_err(fail)?);
    }
    let [accelerometers, gyros] = senses;
    let axes = [0, 1, 2].map(|axis| [accelerometers[axis], gyros[axis]]);
    Ok(match axes == [axes[0]; 3] {
        true => Imu { accelerometer: accelerometers[0], gyro: gyros[0], ..imu },
        false => imu.with_axes(axes),
    })
}

/// Cuts a script into statements, without comments; a semicolon in brackets parts rows, and no statements.
fn statements(text: &str) -> Vec<&str> {
    let lines = text.lines().map(|line| line.split('%').next().unwrap_or_default());
    let parts = lines.flat_map(|line| {
        let mut depth = 0usize;
        line.split(move |letter| {
            match letter {
                '[' => depth += 1,
                ']' => depth = depth.saturating_sub(1),
                _ => {}
            }
            letter == ';' && depth == 0
        })
    });
    parts.map(str::trim).filter(|part| !part.is_empty()).collect()
}

/// Reads the numbers set for one variable, axis by axis, and returns the settings that have no
/// place here; the cause where one cannot be read.
fn properties(code: &[&str], variable: &str, axes: &mut [Errors; 3]) -> Result<Vec<String>, String> {
    let mut one_sided = false;
    let mut unread = Vec::new();
    for statement in code {
        let set = statement.strip_prefix(variable).and_then(|rest| rest.strip_prefix('.'));
        let Some((property, value)) = set.and_then(|rest| rest.split_once('=')) else { continue };
        let (property, value) = (property.trim(), value.trim());
        if property == "NoiseType" {
            one_sided = value.contains("single-sided");
            continue;
        }
        let set: fn(&mut Errors, f64) = match property {
            "NoiseDensity" => |errors, number| errors.white = Value { mean: number, sd: 0.0 },
            "RandomWalk" => |errors, number| errors.walk = Value { mean: number, sd: 0.0 },
            "ConstantBias" => |errors, number| errors.bias = Value { mean: number, sd: 0.0 },
            "Resolution" => |errors, number| errors.step = number,
            "MeasurementRange" => |errors, number| errors.range = number,
            _ => {
                if three(value) != Some([0.0; 3]) {
                    unread.push(format!("{variable}.{property} = {value}"));
                }
                continue;
            }
        };
        let numbers = three(value)
            .ok_or_else(|| format!("{variable}.{property}: need one number or three in brackets, got `{value}`"))?;
        if property != "ConstantBias" && numbers.iter().any(|number| *number < 0.0) {
            return Err(format!("{variable}.{property}: need zero or more, got `{value}`"));
        }
        axes.iter_mut().zip(numbers).for_each(|(errors, number)| set(errors, number));
    }
    if one_sided {
        // A one-sided density n is N = n/√2; imuSensor's walk then steps by
        // RandomWalk/√(SampleRate/2).
        for errors in axes {
            errors.white.mean *= std::f64::consts::FRAC_1_SQRT_2;
            errors.walk.mean *= std::f64::consts::SQRT_2;
        }
    }
    Ok(unread)
}

/// One number for all axes, or x, y and z in brackets.
fn three(value: &str) -> Option<[f64; 3]> {
    let inside = value.strip_prefix('[').map_or(Some(value), |rest| rest.strip_suffix(']'))?;
    let parts = inside.split([' ', ',']).filter(|part| !part.is_empty());
    let numbers: Vec<f64> =
        parts.map(|part| part.parse().ok().filter(|n: &f64| n.is_finite())).collect::<Option<_>>()?;
    match numbers[..] {
        [one] => Some([one; 3]),
        [x, y, z] => Some([x, y, z]),
        _ => None,
    }
}
