//! Real recordings as rows of the proof: the effect withheld, an independent truth compared
//! afterwards.
//!
//! A recipe names files in a folder of recordings, the base model of each, and what is known from
//! another source. The diagnosis gets the (cut) recording and the model; the truth stays in the
//! recipe until the verdict is there.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::ask::{self, Files, Subject};
use super::excerpt::Excerpt;
use super::independent::truth::{Effect, Family, Truth};
use super::said::Said;
use super::scratch::Scratch;
use super::workers::side_by_side;
use proofmass_base::document::{read_text, read_toml};
use proofmass_base::error::{Error, Result, nearest};
use proofmass_diagnosis as diagnosis;
use proofmass_diagnosis::verdict::Verdict;

/// A list of real recordings with their models and known effects.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// The recordings, in the order of the report.
    pub recording: Vec<Real>,
}

/// One real recording of the list.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Real {
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
    /// Every k-th of these rows; absent means all.
    pub every: Option<usize>,
    /// Holds what is left out of the base model, as far as another source knows; names of which any
    /// one is right, joined by "|".
    pub truth: Vec<String>,
    /// Names that are right as well, by the same source or by the nature of the sensor.
    #[serde(default)]
    pub also: Vec<String>,
    /// States how it is judged: to the letter where something is known to be left out, else as
    /// physics that no name is known for.
    pub family: Option<Family>,
    /// Source of the known effects.
    pub source: String,
    /// Numbers known from another source.
    #[serde(default)]
    pub numbers: Vec<Known>,
    /// Errors that are compared with published ones.
    #[serde(default)]
    pub scores: Vec<Score>,
}

/// An error on samples that were not fitted, and what others reached there.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Score {
    /// Name of the data that judge, and the measure.
    pub on: String,
    /// A judging recording, as under `test`; absent means samples that the model file names.
    pub file: Option<PathBuf>,
    /// One of several judging ranges of the model file; absent means all that judge.
    pub range: Option<[usize; 2]>,
    /// States whether the relative error of the force is meant, not that of free simulation.
    #[serde(default)]
    pub force: bool,
    /// Factor from our unit to the published one.
    pub factor: f64,
    /// Unit of the known value.
    pub unit: String,
    /// The best published, in that unit; absent where none is comparable.
    pub published: Option<f64>,
    /// Source of the published error, or why there is none.
    pub by: String,
}

impl Real {
    /// Returns its name in small letters and digits, joined by hyphens.
    pub fn id(&self) -> String {
        let letters = self.name.to_lowercase();
        let words = letters.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join("-")
    }

    /// Returns how it is judged, and against what. Recordings are listed because of what is in
    /// them: what is known to be left out can be seen.
    pub fn judged(&self) -> (Family, Truth) {
        let seen = |names: &String| Effect {
            right: names.split('|').map(str::to_owned).collect(),
            evidence: f64::INFINITY,
            over_noise: f64::INFINITY,
        };
        let family = self.family.unwrap_or(if self.truth.is_empty() { Family::Foreign } else { Family::Letter });
        let effects: Vec<Effect> = self.truth.iter().map(seen).collect();
        let evidence = effects.iter().map(|e| e.evidence).sum();
        (family, Truth { effects, evidence, also: self.also.clone(), ..Truth::default() })
    }

    /// Puts the files of the verdict together in a folder of their own: recording, base model, and
    /// recordings that only judge. In the model, `$PROOFMASS_DATA` stands for the folder of
    /// recordings.
    ///
    /// # Errors
    /// When files cannot be read or written.
    pub fn files(&self, data: &Path, folder: &Path) -> Result<Files> {
        let excerpt = Excerpt { file: &self.file, rows: self.rows, every: self.every };
        excerpt.files(data, folder, &self.model, &self.test)
    }
}

/// An error found next to a published one, in the unit of the latter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scored {
    /// Name of the test data in tables.
    pub on: String,
    /// Unit of the errors.
    pub unit: String,
    /// Error of the base model.
    pub before: Option<f64>,
    /// Error with the named physics.
    pub after: Option<f64>,
    /// Best published error.
    pub published: Option<f64>,
    /// Source of the published error.
    pub by: String,
}

impl Score {
    fn of(&self, verdict: &Verdict) -> Scored {
        let fit = &verdict.fit;
        let entry = self.file.as_ref().map(|file| fit.recordings.iter().find(|r| Path::new(&r.file).ends_with(file)));
        let pair = match (entry, self.range) {
            (Some(Some(r)), _) if self.force => (r.force_error_before, r.force_error_after),
            (Some(Some(r)), _) => (Some(r.rmse_before), r.rmse_after),
            (Some(None), _) => (None, None),
            (None, Some([from, to])) => {
                let found = fit.test_ranges.iter().find(|r| [r.from, r.to] == [from, to]);
                (found.map(|r| r.rmse_before), found.and_then(|r| r.rmse_after))
            }
            (None, None) => (Some(fit.test.rmse_before), fit.test.rmse_after),
        };
        let [before, after] = [pair.0, pair.1].map(|error| error.map(|e| e * self.factor));
        let (on, unit, by) = (self.on.clone(), self.unit.clone(), self.by.clone());
        Scored { on, unit, before, after, published: self.published, by }
    }
}

/// A number known from another source.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// Library id of the effect.
    pub id: String,
    /// Column, where several have the number.
    pub channel: Option<String>,
    /// Symbol of the parameter.
    pub name: String,
    /// Value from the other source.
    pub value: f64,
}

/// Result for one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// Name of the recording in tables.
    pub name: String,
    /// Effects known from elsewhere.
    pub truth: Vec<String>,
    /// Source of that knowledge.
    pub source: String,
    /// Holds what the diagnosis said.
    pub said: Said,
    /// Known effects that were named.
    pub named: Vec<String>,
    /// Named effects that no other source knows of; they may be there all the same.
    pub more: Vec<String>,
    /// "beta 7.3e5, found 7.21e5 [7.1e5, 7.4e5]" for each known number.
    pub numbers: Vec<String>,
    /// Errors next to published ones.
    pub scores: Vec<Scored>,
}

/// The folder of recordings: `PROOFMASS_DATA`, else `../shared/data` next to the working directory.
pub fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("PROOFMASS_DATA").map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    folder.is_dir().then_some(folder)
}

/// Reads a recipe; models become paths that can be opened.
///
/// # Errors
/// As `document::read_toml`; a name that two recordings have, an effect that the library does not
/// have, a number that is none, and a model that cannot be read. These would be marks against the
/// diagnosis otherwise.
pub fn read(path: &Path) -> Result<Recipe> {
    let mut recipe: Recipe = read_toml(path)?;
    let home = path.parent().unwrap_or(Path::new("."));
    let mut names = BTreeSet::new();
    for real in &mut recipe.recording {
        real.model = home.join(&real.model);
        read_text(&real.model)?;
        let fail = |cause: String, hint: String| {
            Error::new(format!("could not use {}", path.display()), format!("recording `{}`: {cause}", real.name), hint)
        };
        if !names.insert(real.id()) || real.id().is_empty() {
            let cause = "its name is another's too, or has neither letters nor digits";
            return Err(fail(cause.into(), "give each recording a name of its own".into()));
        }
        let known: Vec<&str> = diagnosis::library().map(|candidate| candidate.id).collect();
        let ids = real.truth.iter().chain(&real.also).flat_map(|names| names.split('|'));
        if let Some(id) = ids.chain(real.numbers.iter().map(|n| n.id.as_str())).find(|id| !known.contains(id)) {
            let near = nearest(id, known.iter().copied());
            let hint = near.map_or("`proofmass candidates` lists them".into(), |id| format!("did you mean `{id}`?"));
            return Err(fail(format!("`{id}` is no effect that can be named"), hint));
        }
        if let Some(number) = real.numbers.iter().find(|n| !n.value.is_finite()) {
            return Err(fail(format!("{} is {}", number.name, number.value), "give a number".into()));
        }
        if real.rows.is_some_and(|[from, to]| from >= to) {
            return Err(fail("its rows end before they begin".into(), "give rows = [from, to], counted from 0".into()));
        }
    }
    Ok(recipe)
}

/// Asks about every recording of a recipe and compares with what is known.
///
/// # Errors
/// When files cannot be read; a diagnosis that fails is a row that says so.
pub fn run(recipe: &Recipe, data: &Path, subject: &Subject<'_>, scratch: &Scratch) -> Result<Vec<Found>> {
    side_by_side(&recipe.recording, |real| {
        let folder = scratch.case()?;
        let (said, verdict) = ask::ask(&real.files(data, folder.path())?, subject)?;
        let scores = verdict.map_or_else(Vec::new, |verdict| real.scores.iter().map(|s| s.of(&verdict)).collect());
        Ok(compare(real, said, scores))
    })
}

fn compare(real: &Real, said: Said, scores: Vec<Scored>) -> Found {
    let (_, truth) = real.judged();
    let (named, more) = said.ids().into_iter().partition(|id| truth.allows(id));
    let numbers = real
        .numbers
        .iter()
        .map(|known| {
            let found = said.numbers.iter().find(|n| {
                n.id == known.id && n.name == known.name && known.channel.as_ref().is_none_or(|c| *c == n.channel)
            });
            let place = known.channel.as_deref().map(|c| format!(" of {c}")).unwrap_or_default();
            match found {
                Some(n) => format!(
                    "{}{place} known {:.4e}, found {:.4e} [{:.4e}, {:.4e}]",
                    known.name, known.value, n.value, n.ci95[0], n.ci95[1]
                ),
                None => format!("{}{place} known {:.4e}, not given", known.name, known.value),
            }
        })
        .collect();
    Found {
        name: real.name.clone(),
        truth: real.truth.clone(),
        source: real.source.clone(),
        said,
        named,
        more,
        numbers,
        scores,
    }
}
