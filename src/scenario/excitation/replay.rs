//! A recorded acceleration played back, linear between its samples.

use super::plan::{Plan, Spectrum};
use super::reader::{Kind, Reader};
use super::section::Form;
use super::waveform::Waveform;
use crate::error::Result;
use crate::recording;
use crate::recording::roles::{self, Stated};
use crate::recording::unit::Quantity;
use crate::units::number::Number;

pub(crate) const KIND: Kind = Kind {
    name: "replay",
    keys: &[
        ("file", Form::Text),
        ("column", Form::Text),
        ("scale", Form::Number),
        ("rate_hz", Form::Real),
        ("time", Form::Text),
    ],
    plan: |given| {
        let Read { replay, sha256, si } = read(given)?;
        let scale = given.number("scale").unwrap_or(Number::Fixed(si));
        let (column, samples) = (given.need_text("column")?, replay.samples_m_s2.len());
        let words = format!("replay of column {column}, {samples} samples at {} Hz", replay.rate_hz);
        let shape = |factor: f64| Replay {
            samples_m_s2: replay.samples_m_s2.iter().map(|v| v * factor).collect(),
            rate_hz: replay.rate_hz,
        };
        Ok(Plan { replayed_sha256: Some(sha256), ..Plan::sized(scale, shape, words, Spectrum::Shape) })
    },
};

/// A recording to play back, in its own unit.
struct Read {
    replay: Replay,
    sha256: String,
    /// The unit that its file states, m/s²; 1 where it states none.
    si: f64,
}

/// The recording to play back, which must last as long as the run.
fn read(given: &Reader<'_>) -> Result<Read> {
    let (file, column) = (given.file("file")?, given.need_text("column")?);
    let (rate_hz, time) = (given.real("rate_hz"), given.text("time").map(str::to_owned));
    if rate_hz.is_none() && time.is_none() {
        return Err(given.refuse(
            "a replay needs its clock",
            "add rate_hz = …, or time = \"t_s\" with the heading of a time column in s",
        ));
    }
    let (columns, control) = (vec![column.to_owned()], given.run.control.clone());
    let request = recording::Request { columns, rate_hz, time, control, ..Default::default() };
    let mut recording = recording::read(&file, &request)?;
    // A scale may also be an amplitude: only without one does the file's unit hold.
    let si = match roles::stated(column, recording.stated(column)) {
        Some(Stated::Inertial(unit)) if unit.quantity == Quantity::Accelerometer => unit.si,
        _ => 1.0,
    };
    let samples_m_s2 = recording.columns.pop().map(|c| c.values).unwrap_or_default();
    let replay = Replay { samples_m_s2, rate_hz: recording.rate_hz };
    let duration_s = given.run.duration_s;
    if replay.length_s() + 1.0 / replay.rate_hz < duration_s * (1.0 - 1e-9) {
        return Err(given.refuse(
            format!("the recording to replay lasts {} s, the run {duration_s} s", replay.length_s()),
            format!("set duration_s to {} or less", replay.length_s()),
        ));
    }
    Ok(Read { replay, sha256: recording.sha256, si })
}

/// Samples on a uniform clock that starts at t = 0.
#[derive(Debug, Clone, PartialEq)]
struct Replay {
    /// Specific force at k / `rate_hz`, m/s².
    pub samples_m_s2: Vec<f64>,
    /// Sampling rate of the recording.
    pub rate_hz: f64,
}

impl Replay {
    /// Time of the last sample, s.
    pub(crate) fn length_s(&self) -> f64 {
        self.samples_m_s2.len().saturating_sub(1) as f64 / self.rate_hz
    }
}

impl Waveform for Replay {
    /// Linear between samples; outside the recording its first or last value.
    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        let place = (time_s * self.rate_hz).max(0.0);
        let before = place.floor() as usize;
        match (self.samples_m_s2.get(before), self.samples_m_s2.get(before + 1)) {
            (Some(a), Some(b)) => a + (b - a) * (place - before as f64),
            _ => self.samples_m_s2.last().copied().unwrap_or(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_passes_through_its_samples_and_halfway_between_them() {
        let replay = Replay { samples_m_s2: vec![0.0, 1.0, -1.0], rate_hz: 10.0 };
        let at = |t| replay.specific_force_m_s2(t);
        assert_eq!([at(0.0), at(0.05), at(0.1), at(0.15), at(0.2), at(9.0)], [0.0, 0.5, 1.0, 0.0, -1.0, -1.0]);
        assert_eq!(replay.length_s(), 0.2);
    }
}
