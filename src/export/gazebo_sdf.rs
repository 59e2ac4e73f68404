//! Gazebo's `<sensor>`: gz-sensors' GaussianNoiseModel draws `stddev` per sample, whatever the
//! rate, and drives the bias with `dynamic_bias_stddev` as a continuous density: σ_d² = σ²τ/2 (1 −
//! e^(−2Δt/τ)), which is K²Δt for long τ.

use super::drift::{self, Form};
use super::imu::{Errors, Imu, Value};
use super::sheet::{Field, Sheet};
use proofmass_base::error::{Error, Result};

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.line("<sensor name=\"imu\" type=\"imu\">");
    sheet.indent(2);
    sheet.head("SDFormat, element <noise>, and gz-sensors, class GaussianNoiseModel");
    sheet.note("Gazebo picks the sign of bias_mean at random, each with probability 1/2");
    sheet.note("update_rate: Hz; stddev holds only for this rate");
    sheet.line(&format!("<update_rate>{:?}</update_rate>", imu.rate_hz));
    sheet.line("<imu>");
    for (element, sense, unit) in [("angular_velocity", 1, "rad/s"), ("linear_acceleration", 0, "m/s^2")] {
        sheet.indent(4);
        sheet.line(&format!("<{element}>"));
        for (number, axis) in ["x", "y", "z"].into_iter().enumerate() {
            sheet.indent(6);
            sheet.line(&format!("<{axis}>"));
            sheet.indent(8);
            noise(&imu.axis(number)[sense], unit, imu.rate_hz, imu.axes.is_some() || axis == "x", sheet);
            sheet.indent(6);
            sheet.line(&format!("</{axis}>"));
        }
        sheet.indent(4);
        sheet.line(&format!("</{element}>"));
    }
    sheet.indent(2);
    sheet.line("</imu>");
    sheet.indent(0);
    sheet.line("</sensor>");
}

fn noise(errors: &Errors, unit: &str, rate_hz: f64, first: bool, sheet: &mut Sheet) {
    let drift = drift::process(errors, Form::GaussMarkov);
    sheet.line("<noise type=\"gaussian\">");
    if first && !drift.remark.is_empty() {
        sheet.note(&drift.remark);
    }
    let per_root_s = format!("{unit}/sqrt(s)");
    for (key, value, unit, means) in [
        ("mean", 0.0, unit, "mean of the white noise"),
        ("stddev", errors.white.mean * rate_hz.sqrt(), unit, "sigma per sample, not per sqrt(Hz): N sqrt(update_rate)"),
        ("bias_mean", errors.bias.mean, unit, "constant bias"),
        ("bias_stddev", errors.bias.sd, unit, "sigma of the bias from run to run"),
        (
            "dynamic_bias_stddev",
            drift.drive,
            &per_root_s,
            "not the bias' sigma but the continuous density that drives it: the random walk K",
        ),
        ("dynamic_bias_correlation_time", drift.correlation_s, "s", "1e6 s makes the bias a random walk"),
    ] {
        sheet.field(Field { key, value, unit, means });
    }
    sheet.line("</noise>");
}

pub(super) fn read(name: &str, text: &str) -> Result<Imu> {
    let text = without_comments(text);
    let fail = |cause: String| {
        Error::new(format!("could not import {name}"), cause, "give the <sensor> of an IMU, as `export` writes it")
    };
    let number = |within: &str, tag: &str| -> Result<Option<f64>> {
        let Some(inside) = element(within, tag) else { return Ok(None) };
        match inside.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(fail(format!("<{tag}>: need a number, got `{}`", inside.trim()))),
        }
    };
    let rate_hz = number(&text, "update_rate")?.filter(|r| *r > 0.0);
    let rate_hz =
        rate_hz.ok_or_else(|| fail("it has no <update_rate> above 0, without which stddev has no density".into()))?;
    if text.matches("<angular_velocity>").count() > 1 {
        return Err(fail("it has more than one <angular_velocity>: the sensors of several IMUs".into()));
    }
    let mut imu = Imu::new(name, rate_hz);
    let mut axes = [[imu.accelerometer, imu.gyro]; 3];
    let places = [("angular_velocity", 1), ("linear_acceleration", 0)];
    let places = places
        .into_iter()
        .flat_map(|(tag, sense)| ["x", "y", "z"].into_iter().enumerate().map(move |a| (tag, sense, a)));
    for (tag, sense, (number_of_axis, name)) in places {
        let Some(axis) = element(&text, tag).and_then(|sense| element(sense, name)) else {
            if number_of_axis == 0 {
                return Err(fail(format!("it has no <{tag}> with an <x>")));
            }
            imu.unread
                .push(format!("<{tag}> has no <{name}>, which Gazebo takes for an axis without noise: so it is here"));
            continue;
        };
        let errors = &mut axes[number_of_axis][sense];
        let place = format!("<{tag}> <{name}>");
        match axis.split_once("<noise").and_then(|(_, rest)| attribute(rest, "type")) {
            None | Some("gaussian" | "gaussian_quantized") => {}
            Some("none") => continue,
            Some(other) => return Err(fail(format!("{place}: noise of the type `{other}` has no density"))),
        }
        let or_zero = |tag| Ok::<f64, Error>(number(axis, tag)?.unwrap_or(0.0));
        let size = |tag| match or_zero(tag)? {
            size if size < 0.0 => Err(fail(format!("{place} <{tag}>: need zero or more, got {size}"))),
            size => Ok(size),
        };
        let fixed = |mean| Value { mean, sd: 0.0 };
        errors.white = fixed(size("stddev")? / rate_hz.sqrt());
        errors.walk = fixed(size("dynamic_bias_stddev")?);
        errors.bias = Value { mean: or_zero("mean")? + or_zero("bias_mean")?, sd: size("bias_stddev")? };
        errors.step = size("precision")?;
        let memory_s = size("dynamic_bias_correlation_time")?;
        if errors.walk.mean > 0.0 && memory_s > 0.0 && memory_s < drift::WALK_S {
            imu.unread.push(format!("{place}: the bias forgets in {memory_s} s; it is taken as a random walk"));
        }
    }
    Ok(imu.with_axes(axes))
}

fn without_comments(text: &str) -> String {
    let mut parts = text.split("<!--");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |kept, part| kept + part.split_once("-->").map_or("", |(_, rest)| rest))
}

/// Returns the text between the first start and end of an element.
fn element<'a>(text: &'a str, tag: &str) -> Option<&'a str> {
    let inside = text.split_once(&format!("<{tag}>"))?.1;
    Some(inside.split_once(&format!("</{tag}>"))?.0)
}

/// Returns the value of an attribute in a start tag that `rest` goes on with.
fn attribute<'a>(rest: &'a str, name: &str) -> Option<&'a str> {
    let tag = rest.split('>').next()?;
    let value = tag.split_once(&format!("{name}="))?.1;
    let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    value[1..].split(quote).next()
}
