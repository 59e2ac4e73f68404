//! model.toml: what a recording is and what the engineer believes of it. Paths are relative to the
//! file.

mod asked;
mod driven;
mod output;
mod response;
mod rest;
mod split;
mod trajectory;
mod tumble;

pub use asked::{Seconds, read_part, read_recording, requested};
pub use driven::{Driven, DrivenColumns, Start};
pub use output::Output;
pub use response::{Response, ResponseColumns, Thermal};
pub use rest::{Noise, Static, StaticColumns};
pub use split::{Ranges, Split};
pub use trajectory::{Half, InertialNoise, Reference, Trajectory, TrajectoryColumns};
pub use tumble::{Tumble, TumbleColumns};

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::candidate::Kind;
use crate::document::{from_table, parse_toml, read_text};
use crate::error::Result;
use crate::gate::Gate;
use crate::recording::Recording;

/// Longer recordings of a sensor at rest are averaged over neighbouring samples to at most this
/// many.
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
    /// An IMU in motion.
    Trajectory(Box<Trajectory>),
    /// Stepped-sine sweeps of a resonator.
    Response(Response),
}

impl Model {
    /// Topic, message or array that is read of each recording.
    pub fn topic(&self) -> Option<&String> {
        match self {
            Self::Driven(m) => m.topic.as_ref(),
            Self::Static(m) => m.topic.as_ref(),
            Self::Tumble(m) => m.topic.as_ref(),
            Self::Trajectory(m) => m.topic.as_ref(),
            Self::Response(m) => m.topic.as_ref(),
        }
    }

    /// Headings of environment columns.
    pub fn environment(&self) -> &[String] {
        match self {
            Self::Driven(m) => &m.columns.environment,
            Self::Static(m) => &m.columns.environment,
            Self::Tumble(m) => &m.columns.environment,
            Self::Response(_) | Self::Trajectory(_) => &[],
        }
    }

    /// Files besides the recording that the model names: its poses, its reference, the times of that.
    pub fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::Tumble(tumble) => tumble.poses.iter().cloned().collect(),
            Self::Trajectory(model) => {
                model.reference.iter().flat_map(|r| [Some(r.file.clone()), r.times.clone()]).flatten().collect()
            }
            Self::Driven(_) | Self::Static(_) | Self::Response(_) => Vec::new(),
        }
    }

    /// The same model whose rate holds against the recording's own clock.
    pub fn with_forced_rate(mut self) -> Self {
        match &mut self {
            Self::Driven(m) => m.force_rate = true,
            Self::Static(m) => m.force_rate = true,
            Self::Tumble(m) => m.force_rate = true,
            Self::Trajectory(m) => m.force_rate = true,
            // Its rows are steps, whatever the clock.
            Self::Response(_) => {}
        }
        self
    }

    /// The same model diagnosed without these rules: for measuring what they are worth. Only kind =
    /// "driven" has any.
    pub fn without(mut self, gates: &[Gate]) -> Self {
        if let Self::Driven(m) = &mut self {
            m.without.extend_from_slice(gates);
        }
        self
    }

    /// The same model of another topic.
    pub fn of_topic(mut self, topic: &str) -> Self {
        let own = match &mut self {
            Self::Driven(m) => &mut m.topic,
            Self::Static(m) => &mut m.topic,
            Self::Tumble(m) => &mut m.topic,
            Self::Trajectory(m) => &mut m.topic,
            Self::Response(m) => &mut m.topic,
        };
        *own = Some(topic.to_owned());
        self
    }
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
    // A choice by a key inside the table would lose the line and column of every other mistake; so
    // the key is blanked, and the rest is read as what it is.
    let end = kind.span().end.min(text.len());
    let start = text[..end].rfind('\n').map_or(0, |i| i + 1);
    let rest = format!("{}{}{}", &text[..start], " ".repeat(end - start), &text[end..]);
    Ok(match kind.into_inner() {
        Kind::Driven => Model::Driven(parse_toml(name, &rest)?),
        Kind::Static => Model::Static(parse_toml(name, &rest)?),
        Kind::Tumble => Model::Tumble(parse_toml(name, &rest)?),
        Kind::Trajectory => Model::Trajectory(parse_toml(name, &rest)?),
        Kind::Response => Model::Response(parse_toml(name, &rest)?),
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
        Kind::Trajectory => Model::Trajectory(from_table(name, table)?),
        Kind::Response => Model::Response(from_table(name, table)?),
    })
}

/// Reads model.toml; the files that it names become paths that can be opened.
///
/// # Errors
/// As [`parse`], and when the file cannot be read.
pub fn read(path: &Path) -> Result<Model> {
    let mut model = parse(&path.display().to_string(), &read_text(path)?)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    match &mut model {
        Model::Tumble(tumble) => tumble.poses = tumble.poses.take().map(|poses| folder.join(poses)),
        Model::Trajectory(model) => model.reference.iter_mut().for_each(|r| r.in_folder(folder)),
        Model::Driven(_) | Model::Static(_) | Model::Response(_) => {}
    }
    Ok(model)
}

/// Returns what a diagnosis of this recording will take of memory, where that is much: for a word
/// beforehand.
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
