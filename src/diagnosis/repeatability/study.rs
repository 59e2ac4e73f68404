//! A sensor for a study from what its runs have in common and what differs from run to run:
//! `sensor.toml`, whose keys draw each part about the mean with the spread.

use super::agreement::{Agreement, Line};
use super::at_rest;
use super::parameter::{Element, Estimate, Role};
use crate::by_axis::{Drawn, three};
use crate::sensor::{Sense, SensorTerm, coupling};
use crate::units::key::Key;

/// The sensor as the next run will find it; `None` where no parameter that a study has was compared.
///
/// What is in units of the reading alone is calibrated: its mean is zero and its spread relative.
pub fn sensor_toml(agreement: &Agreement, of: &Estimate, rate_hz: f64) -> Option<String> {
    let mut body = String::new();
    for sense in [Sense::Accelerometer, Sense::Gyro] {
        let by_role = keys(sense)
            .into_iter()
            .map(|(key, role)| three(key, [0, 1, 2].map(|axis| drawn(agreement, of, (sense, role, axis)))));
        let section: String = by_role.chain(at_rest::section(agreement, of, sense)).collect();
        if !section.is_empty() {
            body += &format!("\n[{}]\n{section}", sense.name());
        }
    }
    let more = match of.parameters.iter().all(|p| p.element().is_some()) {
        true => "; `proofmass allan` adds the noise of a log at rest",
        false => {
            ".\n# The mean of an accelerometer at rest is left out as well: gravity is in it, and how it was levelled"
        }
    };
    (!body.is_empty()).then(|| {
        format!(
            "# Mean over the runs, and the standard deviation with which the next run differs from it: the spread\n\
             # between the runs together with the error of the mean; of several elements that one key draws, zero and their\n\
             # size. By proofmass {}.\n# What not every run determines is left out, or zero. Paste it into a study.toml{more}.\n\n[sensor]\nsample_rate_hz = {rate_hz:?}\n{body}",
            env!("CARGO_PKG_VERSION")
        )
    })
}

fn keys(sense: Sense) -> Vec<(&'static Key, Role)> {
    let row = |term: SensorTerm| &term.row().keys[0];
    match sense {
        Sense::Accelerometer => vec![
            (row(SensorTerm::AccelerometerBias), Role::Bias),
            (row(SensorTerm::ScaleFactor), Role::Scale),
            (&coupling::ACCELEROMETER_MISALIGNMENT, Role::Misalignment),
        ],
        Sense::Gyro => vec![
            (row(SensorTerm::GyroBias), Role::Bias),
            (&coupling::GYRO_SCALE_FACTOR, Role::Scale),
            (&coupling::GYRO_MISALIGNMENT, Role::Misalignment),
            (&coupling::G_SENSITIVITY, Role::GSensitivity),
        ],
    }
}

/// Draw of a study for one axis: of several elements, which a study draws apart from one key, their size about zero;
/// without their means where a calibration takes those out.
fn drawn(agreement: &Agreement, of: &Estimate, (sense, role, axis): (Sense, Role, usize)) -> Drawn {
    let is_asked = |p: &Element| (p.sensor, p.role, p.axis) == (sense, role, axis);
    let elements = agreement.lines.iter().filter_map(|line| Some((line, of.parameters[line.parameter].element()?)));
    let found = elements.filter(|(_, element)| is_asked(element)).filter_map(|(line, parameter)| {
        let spread = line.spread?;
        let (mean, sd) = (spread.mean, spread.of_the_next_run());
        Some(match (role, parameter.is_si) {
            (Role::Scale, true) => Drawn { mean: mean - 1.0, sd },
            (Role::Scale, false) => Drawn { mean: 0.0, sd: sd / mean.abs().max(f64::MIN_POSITIVE) },
            (Role::Bias, true) => Drawn { mean, sd },
            (Role::Bias, false) => Drawn { mean: 0.0, sd: sd / scale(agreement, of, sense)? },
            (_, true) => Drawn { mean, sd },
            (_, false) => Drawn { mean: 0.0, sd },
        })
    });
    let found: Vec<Drawn> = found.filter(|d| d.mean.is_finite() && d.sd.is_finite()).collect();
    match found[..] {
        [] => Drawn::default(),
        [only] => only,
        _ => {
            let square = |d: &Drawn| d.mean * d.mean + d.sd * d.sd;
            Drawn { mean: 0.0, sd: (found.iter().map(square).sum::<f64>() / found.len() as f64).sqrt() }
        }
    }
}

/// Reading per unit of input of a sensor, over its axes.
fn scale(agreement: &Agreement, of: &Estimate, sense: Sense) -> Option<f64> {
    let is_scale = |line: &&Line| {
        of.parameters[line.parameter].element().is_some_and(|e| (e.sensor, e.role) == (sense, Role::Scale))
    };
    let means: Vec<f64> = agreement.lines.iter().filter(is_scale).filter_map(|l| Some(l.spread?.mean.abs())).collect();
    let mean = means.iter().sum::<f64>() / means.len().max(1) as f64;
    (mean > 0.0).then_some(mean)
}
