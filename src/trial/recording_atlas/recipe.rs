//! The list that an atlas is made of: sets of recordings with source and licence, what is diagnosed
//! of them, and what lies at rest.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::excerpt::Excerpt;
use proofmass_base::document::{read_text, read_toml};
use proofmass_base::error::{Error, Result};

/// A list of sets of recordings.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// The sets, in the order of the index.
    pub set: Vec<Set>,
}

/// Recordings of one origin: a page of the atlas.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Set {
    /// Name of the page's file, without its ending: small letters, digits and hyphens.
    pub id: String,
    /// Title of the page.
    pub title: String,
    /// States what was recorded, in a sentence or two.
    pub about: String,
    /// Authors and work in which the recordings were published.
    pub source: String,
    /// Licence of the recordings, or that none is stated.
    pub licence: String,
    /// Holds what is diagnosed of them.
    #[serde(default)]
    pub diagnosis: Vec<Question>,
    /// Logs at rest, whose noise is measured.
    #[serde(default)]
    pub rest: Vec<Rest>,
}

/// A recording, and the base model that it is diagnosed with.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Question {
    /// Name of the recording in tables.
    pub name: String,
    /// Path within the folder of recordings.
    pub file: PathBuf,
    /// Base model, relative to the recipe.
    pub model: PathBuf,
    /// Recordings of the same sensor that only judge.
    #[serde(default)]
    pub test: Vec<PathBuf>,
    /// Data rows used, half-open; absent means all.
    pub rows: Option<[usize; 2]>,
}

impl Question {
    /// Returns the part of the file that is used.
    pub fn excerpt(&self) -> Excerpt<'_> {
        Excerpt { file: &self.file, rows: self.rows, every: None }
    }
}

/// A log at rest, and what its columns are: as the options of `proofmass allan` state it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rest {
    /// Name of the recording in tables.
    pub name: String,
    /// Path within the folder of recordings.
    pub file: PathBuf,
    /// Data rows used, half-open; absent means all.
    pub rows: Option<[usize; 2]>,
    /// Sampling rate where the file has no clock, Hz.
    pub rate_hz: Option<f64>,
    /// Columns that are angular rate.
    #[serde(default)]
    pub gyro: Vec<String>,
    /// One unit of them, such as "0.05deg/s"; absent: the unit that the file states.
    pub gyro_scale: Option<String>,
    /// Columns that are specific force.
    #[serde(default)]
    pub accelerometer: Vec<String>,
    /// One unit of them, such as "3.33mg"; absent: the unit that the file states.
    pub accelerometer_scale: Option<String>,
    /// Record of the temperature: what is slow may be its doing.
    pub temperature: Temperature,
    /// States whether its drift in windows is laid next to the predicted one.
    #[serde(default)]
    pub drift: bool,
}

/// Record of the temperature next to a log at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Temperature {
    /// There is none.
    NotLogged,
    /// It was logged in a separate file, which the tool is not given.
    Withheld,
}

impl Rest {
    /// Returns the part of the file that is used.
    pub fn excerpt(&self) -> Excerpt<'_> {
        Excerpt { file: &self.file, rows: self.rows, every: None }
    }

    /// Returns whether a diagnosis is of the same rows of the same file.
    pub fn is_judged_by(&self, question: &Question) -> bool {
        (&self.file, self.rows) == (&question.file, question.rows)
    }
}

/// Names of pages that are not a set's.
pub const OTHER_PAGES: [&str; 2] = ["README", "random-walk"];

/// Reads a recipe; models become paths that can be opened.
///
/// # Errors
/// Fails as `document::read_toml` does; for an id that is none or another's, rows that end before they begin, a
/// model that cannot be read, and a log at rest that nothing diagnoses: its random walk could not be
/// judged.
pub fn read(path: &Path) -> Result<Recipe> {
    let mut recipe: Recipe = read_toml(path)?;
    let home = path.parent().unwrap_or(Path::new("."));
    let mut ids = BTreeSet::new();
    for set in &mut recipe.set {
        let fail = |cause: String, hint: &str| {
            Err(Error::new(format!("could not use {}", path.display()), format!("set `{}`: {cause}", set.id), hint))
        };
        let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if set.id.is_empty() || !set.id.chars().all(is_plain) || OTHER_PAGES.contains(&set.id.as_str()) {
            return fail(
                "its id cannot name a page".into(),
                "use small letters, digits and hyphens, other than random-walk",
            );
        }
        if !ids.insert(set.id.clone()) {
            return fail("another set has the same id".into(), "give every set a different id");
        }
        let rows = set.diagnosis.iter().map(|q| q.rows).chain(set.rest.iter().map(|r| r.rows));
        if rows.flatten().any(|[from, to]| from >= to) {
            return fail("rows end before they begin".into(), "give rows = [from, to], counted from 0");
        }
        if let Some(rest) = set.rest.iter().find(|rest| !set.diagnosis.iter().any(|q| rest.is_judged_by(q))) {
            let cause = format!("nothing diagnoses the log at rest `{}`", rest.name);
            return fail(cause, "add a [[set.diagnosis]] of the same file and rows, with a model of kind = \"static\"");
        }
        for question in &mut set.diagnosis {
            question.model = home.join(&question.model);
            read_text(&question.model)?;
        }
    }
    Ok(recipe)
}
