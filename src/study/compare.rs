//! `[compare]` checked: the log's clock, the axes' scales, and the windows into which the log is
//! cut.

use super::alignment::Alignment;
use super::file::File;
use super::refusal::refuse;
use crate::error::Result;

/// Most window lengths.
const MOST_WINDOWS: usize = 16;

/// `[compare]`: a clock, for each axis one scale, and windows only after a still start.
pub(super) fn check(name: &str, file: &File, alignment: Alignment) -> Result<()> {
    let Some(section) = &file.compare else { return Ok(()) };
    match section.rate_hz {
        Some(rate_hz) if !(rate_hz > 0.0 && rate_hz.is_finite()) => {
            let cause = format!("`compare.rate_hz` = {rate_hz} Hz: need more than zero");
            return Err(refuse(name, cause, "give the sampling rate of the log"));
        }
        None if section.time.is_none() && section.topic.is_none() => {
            return Err(refuse(
                name,
                "the log of [compare] has no clock",
                "add rate_hz = …, time = \"t_s\" with the heading of its time column in s, or topic = \"/imu\" of a robot's log",
            ));
        }
        _ => {}
    }
    if let Some(windows_s) = &section.windows_s {
        windows(name, windows_s, alignment)?;
        if let (Some(log_hz), Some(sensor_hz)) = (section.rate_hz, file.sensor.sample_rate_hz)
            && (log_hz / sensor_hz - 1.0).abs() > 0.01
        {
            return Err(refuse(
                name,
                format!("`compare.rate_hz` = {log_hz} Hz disagrees with `sensor.sample_rate_hz` = {sensor_hz} Hz"),
                "the windows are simulated at the rate of the log: make the two agree, or leave sample_rate_hz out",
            ));
        }
    }
    for axis in &section.axis {
        let scale = match (axis.scale_mg, axis.scale_deg_s) {
            (Some(scale), None) | (None, Some(scale)) => Some(scale),
            // The log's own unit, which is looked at where the log is.
            (None, None) => None,
            (Some(_), Some(_)) => Some(f64::NAN),
        };
        if scale.is_some_and(|scale| !(scale > 0.0 && scale.is_finite())) {
            return Err(refuse(
                name,
                format!("the axis `{}` of [compare] needs one scale above zero", axis.column),
                "scale_mg = … for an accelerometer, scale_deg_s = … for a gyro: the value of one unit of the column; \
                 without any, the unit in the heading holds",
            ));
        }
    }
    Ok(())
}

/// `windows_s`: some lengths, each above zero, after a still start.
fn windows(name: &str, windows_s: &[f64], alignment: Alignment) -> Result<()> {
    let example = "e.g. windows_s = [10.0, 60.0]";
    if windows_s.is_empty() || windows_s.len() > MOST_WINDOWS {
        let cause = format!("`compare.windows_s` has {} lengths: need 1 to {MOST_WINDOWS}", windows_s.len());
        return Err(refuse(name, cause, format!("{example}; leave it out to compare Allan deviations only")));
    }
    if let Some(wrong) = windows_s.iter().find(|w| !(**w > 0.0 && w.is_finite())) {
        let cause = format!("`compare.windows_s` holds {wrong:?} s: need more than zero");
        return Err(refuse(name, cause, format!("give lengths in seconds, {example}")));
    }
    if windows_s.windows(2).any(|w| w[0] >= w[1]) {
        return Err(refuse(name, "`compare.windows_s` does not increase", "sort the lengths and drop repeated ones"));
    }
    match alignment {
        Alignment::Still { .. } => Ok(()),
        Alignment::Ideal => Err(refuse(
            name,
            "`compare.windows_s` needs a still start: the bias and tilt of a recorded sensor are not known, only removed",
            "add [alignment] with kind = \"still\" and still_s = 10.0",
        )),
    }
}
