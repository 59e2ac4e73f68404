//! model.toml: what a recording is and what the engineer believes of it. Paths are relative to the file.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::diagnosis::candidate::Kind;
use crate::document::{parse_toml, read_text};
use crate::error::{Error, Result};
use crate::recording::{self, Recording, Request};

/// A model, by kind of recording.
#[derive(Debug, Clone, PartialEq)]
pub enum Model {
    /// Input and output of one proof mass.
    Driven(Driven),
    /// A sensor at rest.
    Static(Static),
    /// An IMU in many still poses.
    Tumble(Tumble),
}

/// Half-open ranges of samples.
pub type Ranges = Vec<[usize; 2]>;

/// Which samples are fitted and which judge; absent means interleaved blocks.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// Fitted.
    #[serde(default)]
    pub train: Ranges,
    /// Held out.
    #[serde(default)]
    pub test: Ranges,
}

/// kind = "driven".
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Driven {
    /// Sampling rate, or `columns.time`.
    pub rate_hz: Option<f64>,
    /// Columns by role.
    pub columns: DrivenColumns,
    /// Hints, which may be off by a factor of two.
    #[serde(default)]
    pub start: Start,
    /// Which samples are fitted.
    #[serde(default)]
    pub split: Split,
}

/// Columns of a driven recording.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrivenColumns {
    /// Time in s.
    pub time: Option<String>,
    /// Force; absent for a free ring-down.
    pub input: Option<String>,
    /// Reading.
    pub output: String,
    /// Offered to candidates.
    #[serde(default)]
    pub environment: Vec<String>,
}

/// Hints for the base model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// ω₀/2π.
    pub resonance_hz: Option<f64>,
    /// ζ.
    pub damping_ratio: Option<f64>,
}

/// kind = "static".
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Static {
    /// Sampling rate, or `columns.time`.
    pub rate_hz: Option<f64>,
    /// Unit of the channels, for words and plots.
    #[serde(default)]
    pub unit: String,
    /// Columns by role.
    pub columns: StaticColumns,
    /// What the datasheet promises; absent, white noise whose level is estimated.
    pub noise: Option<Noise>,
    /// Which samples are fitted.
    #[serde(default)]
    pub split: Split,
}

/// Columns of a static recording.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StaticColumns {
    /// Time in s.
    pub time: Option<String>,
    /// Readings.
    pub channels: Vec<String>,
    /// Temperature and the like.
    #[serde(default)]
    pub environment: Vec<String>,
}

/// Noise as a datasheet states it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// One-sided, unit/√Hz.
    pub density: f64,
    /// B, unit.
    #[serde(default)]
    pub bias_instability: f64,
    /// K, unit/√s.
    #[serde(default)]
    pub random_walk: f64,
}

/// kind = "tumble".
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tumble {
    /// Sampling rate, or `columns.time`.
    pub rate_hz: Option<f64>,
    /// |g| where it was recorded.
    pub gravity_m_s2: f64,
    /// CSV of start_row,end_row_exclusive; absent: found by the tool.
    pub poses: Option<PathBuf>,
    /// Columns by role.
    pub columns: TumbleColumns,
    /// Which samples are fitted.
    #[serde(default)]
    pub split: Split,
}

/// Columns of a tumble recording.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TumbleColumns {
    /// Time in s.
    pub time: Option<String>,
    /// Three rates.
    pub gyro: [String; 3],
    /// Three specific forces.
    pub accelerometer: [String; 3],
    /// Temperature and the like.
    #[serde(default)]
    pub environment: Vec<String>,
}

/// The first key that is read: which of the kinds follows.
#[derive(Debug, Deserialize)]
struct Head {
    kind: toml::Spanned<Kind>,
}

/// A model from text; `name` stands in messages for where it came from.
///
/// # Errors
/// As `document::parse_toml`.
pub fn parse(name: &str, text: &str) -> Result<Model> {
    let kind = parse_toml::<Head>(name, text)?.kind;
    // A choice by a key inside the table would lose the line and column of every other mistake; so the key is blanked, and
    // the rest is read as what it is.
    let end = kind.span().end.min(text.len());
    let start = text[..end].rfind('\n').map_or(0, |i| i + 1);
    let rest = format!("{}{}{}", &text[..start], " ".repeat(end - start), &text[end..]);
    Ok(match kind.into_inner() {
        Kind::Driven => Model::Driven(parse_toml(name, &rest)?),
        Kind::Static => Model::Static(parse_toml(name, &rest)?),
        Kind::Tumble => Model::Tumble(parse_toml(name, &rest)?),
    })
}

/// Reads model.toml; `poses` becomes a path that can be opened.
///
/// # Errors
/// As [`parse`], and when the file cannot be read.
pub fn read(path: &Path) -> Result<Model> {
    let mut model = parse(&path.display().to_string(), &read_text(path)?)?;
    if let Model::Tumble(Tumble { poses: Some(poses), .. }) = &mut model
        && poses.is_relative()
    {
        *poses = path.parent().unwrap_or(Path::new(".")).join(&*poses);
    }
    Ok(model)
}

/// Reads the columns of a recording that its model names.
///
/// # Errors
/// As [`recording::read`], and a column that is given two roles.
pub fn read_recording(path: &Path, model: &Model) -> Result<Recording> {
    let (rate_hz, time, columns): (Option<f64>, &Option<String>, Vec<&String>) = match model {
        Model::Driven(m) => {
            let c = &m.columns;
            (m.rate_hz, &c.time, c.input.iter().chain([&c.output]).chain(&c.environment).collect())
        }
        Model::Static(m) => {
            let c = &m.columns;
            (m.rate_hz, &c.time, c.channels.iter().chain(&c.environment).collect())
        }
        Model::Tumble(m) => {
            let c = &m.columns;
            (m.rate_hz, &c.time, c.gyro.iter().chain(&c.accelerometer).chain(&c.environment).collect())
        }
    };
    if matches!(model, Model::Static(m) if m.columns.channels.is_empty()) {
        return Err(Error::new(
            format!("could not use {}", path.display()),
            "the model names no channel",
            "name at least one: channels = [\"ax\"] under [columns]",
        ));
    }
    for (n, column) in columns.iter().enumerate() {
        if columns[..n].contains(column) {
            return Err(Error::new(
                format!("could not use {}", path.display()),
                format!("the model gives the column `{column}` two roles"),
                "name each column once under [columns]",
            ));
        }
    }
    let columns = columns.into_iter().cloned().collect();
    recording::read(path, &Request { columns, rate_hz, time: time.clone(), rows: None })
}
