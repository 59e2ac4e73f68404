//! model.toml: what a recording is and what the engineer believes of it. Paths are relative to the file.

use std::collections::HashSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

#[cfg(feature = "cli")]
use schemars::JsonSchema;
use serde::Deserialize;

use crate::diagnosis::candidate::Kind;
use crate::document::{from_table, parse_toml, read_text};
use crate::error::{Error, Result};
use crate::recording::{self, Recording, Request};

/// Longer recordings of a sensor at rest are averaged over neighbouring samples to at most this many.
pub const MOST_AT_REST: usize = 1 << 19;

/// Memory that a diagnosis at rest takes per value: six channels of 500,000 values took 775 MB.
const BYTES_PER_VALUE: f64 = 260.0;
/// A diagnosis that takes more is announced.
const MUCH_MEMORY_BYTES: f64 = 400e6;

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

impl Model {
    /// Topic, message or array that is read of each recording.
    pub fn topic(&self) -> Option<&String> {
        match self {
            Self::Driven(m) => m.topic.as_ref(),
            Self::Static(m) => m.topic.as_ref(),
            Self::Tumble(m) => m.topic.as_ref(),
        }
    }

    /// The same model of another topic.
    pub fn of_topic(mut self, topic: &str) -> Self {
        let own = match &mut self {
            Self::Driven(m) => &mut m.topic,
            Self::Static(m) => &mut m.topic,
            Self::Tumble(m) => &mut m.topic,
        };
        *own = Some(topic.to_owned());
        self
    }
}

/// Half-open ranges of samples.
pub type Ranges = Vec<[usize; 2]>;

/// Which samples are fitted and which judge; absent means interleaved blocks.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// Fitted.
    #[serde(default)]
    pub train: Ranges,
    /// Held out.
    #[serde(default)]
    pub test: Ranges,
}

impl Split {
    /// From the first sample named to the last; `None` where none is, or only empty ranges.
    pub fn hull(&self) -> Option<Range<usize>> {
        let all = || self.train.iter().chain(&self.test);
        let hull = all().map(|r| r[0]).min()?..all().map(|r| r[1]).max()?;
        (hull.start < hull.end).then_some(hull)
    }

    /// Whether the ranges lie in so many samples, and no sample is to be fitted and to judge.
    ///
    /// # Errors
    /// Cause and hint.
    pub fn check(&self, samples: usize) -> Result<(), (String, &'static str)> {
        if let Some([from, to]) = self.train.iter().chain(&self.test).find(|r| r[0] >= r[1] || r[1] > samples) {
            return Err((
                format!("the range [{from}, {to}) does not lie in the {samples} samples"),
                "ranges are half-open, counted from zero: [[0, 10000]]",
            ));
        }
        let pairs = self
            .train
            .iter()
            .flat_map(|a| self.test.iter().map(move |b| a[1].min(b[1]).saturating_sub(a[0].max(b[0]))));
        match pairs.sum() {
            0usize => Ok(()),
            lost => Err((
                format!("[split] train and test overlap in {lost} samples"),
                "training samples cannot validate: make the ranges disjoint",
            )),
        }
    }
}

/// kind = "driven".
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Driven {
    /// Topic, message or array, where the recording has several.
    pub topic: Option<String>,
    /// Sampling rate, or `columns.time`.
    pub rate_hz: Option<f64>,
    /// Data rows used, counted from zero after the header; absent means all. One range.
    #[serde(default)]
    pub rows: Ranges,
    /// Unit of the output, for words, plots and numbers; absent, what its heading ends in.
    pub unit: Option<String>,
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
#[cfg_attr(feature = "cli", derive(JsonSchema))]
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
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// ω₀/2π.
    pub resonance_hz: Option<f64>,
    /// ζ.
    pub damping_ratio: Option<f64>,
}

/// kind = "static".
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Static {
    /// Topic, message or array, where the recording has several.
    pub topic: Option<String>,
    /// Sampling rate, or `columns.time`.
    pub rate_hz: Option<f64>,
    /// Data rows used, counted from zero after the header; absent means all. One range.
    #[serde(default)]
    pub rows: Ranges,
    /// Unit of the channels, for words and plots.
    #[serde(default)]
    pub unit: String,
    /// Geodetic latitude of the place: gravity and the Earth's rate there stand beside the means.
    pub latitude_deg: Option<f64>,
    /// Height above the ellipsoid.
    pub height_m: Option<f64>,
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
#[cfg_attr(feature = "cli", derive(JsonSchema))]
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
#[cfg_attr(feature = "cli", derive(JsonSchema))]
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
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Tumble {
    /// Topic, message or array, where the recording has several.
    pub topic: Option<String>,
    /// Sampling rate, or `columns.time`.
    pub rate_hz: Option<f64>,
    /// Data rows used, counted from zero after the header; absent means all. One range.
    #[serde(default)]
    pub rows: Ranges,
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
#[cfg_attr(feature = "cli", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TumbleColumns {
    /// Time in s.
    pub time: Option<String>,
    /// Three rates; absent: the accelerometer alone.
    pub gyro: Option<[String; 3]>,
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

/// A model that was never text.
///
/// # Errors
/// As [`parse`], without a place in a file.
pub fn of_table(name: &str, mut table: toml::Table) -> Result<Model> {
    #[derive(Deserialize)]
    struct Only {
        kind: Kind,
    }
    let Only { kind } = from_table(name, table.remove_entry("kind").into_iter().collect())?;
    Ok(match kind {
        Kind::Driven => Model::Driven(from_table(name, table)?),
        Kind::Static => Model::Static(from_table(name, table)?),
        Kind::Tumble => Model::Tumble(from_table(name, table)?),
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

/// Seconds of a recording that are used, counted from its first row.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seconds {
    /// From here; absent means the first row.
    pub from_s: Option<f64>,
    /// To here, exclusive; absent means the last row.
    pub to_s: Option<f64>,
}

/// Reads the columns of a recording that its model names.
///
/// # Errors
/// As [`recording::read`](fn@recording::read), and a column that is given two roles.
pub fn read_recording(path: &Path, model: &Model) -> Result<Recording> {
    read_part(path, model, Seconds::default())
}

/// The same of some seconds alone.
///
/// # Errors
/// As [`read_recording`].
pub fn read_part(path: &Path, model: &Model, seconds: Seconds) -> Result<Recording> {
    recording::read(path, &requested(path, model, seconds)?)
}

/// What a model asks of a recording; `path` stands for it in messages.
///
/// # Errors
/// A column that is given two roles, rows that are none.
pub fn requested(path: &Path, model: &Model, seconds: Seconds) -> Result<Request> {
    let fail = |cause: String, hint: &str| Err(Error::new(format!("could not use {}", path.display()), cause, hint));
    let (rate_hz, rows, time, columns): (Option<f64>, &Ranges, &Option<String>, Vec<&String>) = match model {
        Model::Driven(m) => {
            let c = &m.columns;
            (m.rate_hz, &m.rows, &c.time, c.input.iter().chain([&c.output]).chain(&c.environment).collect())
        }
        Model::Static(m) => {
            let c = &m.columns;
            (m.rate_hz, &m.rows, &c.time, c.channels.iter().chain(&c.environment).collect())
        }
        Model::Tumble(m) => {
            let c = &m.columns;
            (
                m.rate_hz,
                &m.rows,
                &c.time,
                c.gyro.iter().flatten().chain(&c.accelerometer).chain(&c.environment).collect(),
            )
        }
    };
    if matches!(model, Model::Static(m) if m.columns.channels.is_empty()) {
        return fail("the model names no channel".into(), "name at least one: channels = [\"ax\"] under [columns]");
    }
    let mut known = HashSet::with_capacity(columns.len());
    if let Some(twice) = columns.iter().find(|c| !known.insert(c.as_str())) {
        return fail(
            format!("the model gives the column `{twice}` two roles"),
            "name each column once under [columns]",
        );
    }
    let rows = match &rows[..] {
        [] => None,
        [[from, to]] if from < to => Some(*from..*to),
        [[from, to]] => {
            return fail(
                format!("rows = [[{from}, {to}]] holds no row"),
                "ranges are half-open, counted from zero: [[0, 10000]]",
            );
        }
        several => {
            return fail(
                format!("rows names {} ranges, and a recording is one stretch in time", several.len()),
                "give one range; which parts of it are fitted and which judge is for [split]",
            );
        }
    };
    let columns = columns.into_iter().cloned().collect();
    let mut request = Request { columns, rate_hz, time: time.clone(), rows, ..Request::default() };
    (request.from_s, request.to_s) = (seconds.from_s, seconds.to_s);
    request.topic = model.topic().cloned();
    if let Model::Static(m) = model {
        request.at_most = Some(MOST_AT_REST);
        request.samples = m.split.hull();
    }
    Ok(request)
}

/// What a diagnosis of this recording will take of memory, where that is much: for a word beforehand.
pub fn memory_note(recording: &Recording, model: &Model) -> Option<String> {
    let values: usize = recording.columns.iter().map(|c| c.values.len().min(MOST_AT_REST)).sum();
    let bytes = values as f64 * BYTES_PER_VALUE;
    (matches!(model, Model::Static(_)) && bytes > MUCH_MEMORY_BYTES).then(|| {
        format!(
            "{} columns of {} values: the spectra of all columns under competing models take about {:.1} GB of memory, however \
             long the recording",
            recording.columns.len(),
            values / recording.columns.len(),
            bytes / 1e9
        )
    })
}
