//! limits.toml: what the next experiment may be.

use std::path::Path;

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

use crate::document::{from_table, parse_toml, read_text};
use crate::error::{Error, Result};

/// limits.toml.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Largest input, peak, m/s²; where the recorded input has another unit, in that.
    pub largest_input_m_s2: f64,
    /// Highest sampling rate, Hz.
    pub rate_hz: f64,
    /// Longest recording, s.
    pub longest_s: f64,
    /// Lowest and highest frequency that the shaker plays, Hz; absent: a tenth of the resonance to three
    /// times it.
    pub band_hz: Option<[f64; 2]>,
    /// Largest reading, in its unit, where the sensor has an end.
    pub largest_reading: Option<f64>,
    /// Kinds of experiment, and whether their level may be lower than the largest; absent: all.
    #[serde(default = "Way::all")]
    pub vary: Vec<Way>,
    /// The sensor, where it is known from a model.toml alone.
    pub sensor: Option<Given>,
}

/// A thing that can be varied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// Levels below the largest.
    Level,
    /// One sine.
    Sine,
    /// Sines one after another, stepped in level or in frequency.
    SineLadder,
    /// A sine whose frequency rises.
    Chirp,
    /// Many sines at once.
    Multisine,
    /// Steps between two levels.
    Step,
}

impl Way {
    fn all() -> Vec<Self> {
        vec![Self::Level, Self::Sine, Self::SineLadder, Self::Chirp, Self::Multisine, Self::Step]
    }
}

/// A sensor of which nothing was recorded yet.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Given {
    /// Standard deviation of the noise of one reading, in its unit.
    pub noise: f64,
    /// Reading per unit of input, at rest.
    #[serde(default = "one")]
    pub static_gain: f64,
}

fn one() -> f64 {
    1.0
}

/// A limit that can be in the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// The largest input.
    Input,
    /// The longest recording.
    Length,
    /// The sampling rate.
    Rate,
}

impl Limit {
    /// Every one.
    pub const ALL: [Self; 3] = [Self::Input, Self::Length, Self::Rate];
}

impl Limits {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// A file that cannot be read; a key that is not known; a number that cannot be.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(&path.display().to_string(), &read_text(path)?)
    }

    /// Checks the text of one; `name` stands in messages.
    ///
    /// # Errors
    /// As [`Limits::read`].
    pub fn parse(name: &str, text: &str) -> Result<Self> {
        parse_toml::<Self>(name, text)?.checked(name)
    }

    /// Checks a table with the keys of one.
    ///
    /// # Errors
    /// As [`Limits::read`].
    pub fn of_table(name: &str, table: toml::Table) -> Result<Self> {
        from_table::<Self>(name, table)?.checked(name)
    }

    fn checked(self, name: &str) -> Result<Self> {
        let limits = self;
        let refuse = |cause: String, hint: &str| Err(Error::new(format!("could not use {name}"), cause, hint));
        let given = limits.sensor.map(|s| [("sensor.noise", s.noise), ("sensor.static_gain", s.static_gain.abs())]);
        let numbers = [
            ("largest_input_m_s2", limits.largest_input_m_s2),
            ("rate_hz", limits.rate_hz),
            ("longest_s", limits.longest_s),
            ("largest_reading", limits.largest_reading.unwrap_or(1.0)),
        ];
        for (key, value) in numbers.into_iter().chain(given.into_iter().flatten()) {
            if !(value > 0.0 && value.is_finite()) {
                return refuse(format!("{key} = {value}, and it needs a number above zero"), "correct the number");
            }
        }
        if let Some([low, high]) = limits.band_hz
            && !(low > 0.0 && low < high && high < 0.5 * limits.rate_hz)
        {
            let cause = format!("band_hz = [{low}, {high}] at rate_hz = {}", limits.rate_hz);
            return refuse(cause, "need 0 < low < high < rate_hz / 2");
        }
        if limits.vary.iter().all(|way| *way == Way::Level) {
            return refuse(
                "vary names no kind of experiment".into(),
                "name one, as vary = [\"level\", \"sine-ladder\"]",
            );
        }
        Ok(limits)
    }

    /// The same with one of them larger by this factor.
    pub fn with(&self, limit: Limit, factor: f64) -> Self {
        let mut larger = self.clone();
        match limit {
            Limit::Input => larger.largest_input_m_s2 *= factor,
            Limit::Length => larger.longest_s *= factor,
            Limit::Rate => larger.rate_hz *= factor,
        }
        larger
    }
}
