//! Asks about every recording of an atlas, with the tools that a user has.

use std::path::Path;

use super::measured::Measured;
use super::recipe::{Question, Recipe, Rest, Set};
use crate::ask::{self, Subject};
use crate::said::Said;
use crate::scratch::Scratch;
use crate::workers::side_by_side;
use proofmass_base::control::Control;
use proofmass_base::error::{Error, Kind, Result};
use proofmass_diagnosis::verdict::Verdict;

/// Anything that measures the noise, and the drift where that is asked for, of a log at rest.
pub type AtRest<'a> = dyn Fn(&Path, &Rest) -> Result<Measured> + Sync + 'a;

/// Tools that an atlas is made with.
pub struct Instruments<'a> {
    /// Turns a recording and a base model into a verdict.
    pub diagnose: &'a Subject<'a>,
    /// Measures a log at rest.
    pub rest: &'a AtRest<'a>,
    /// Folder of the recordings.
    pub data: &'a Path,
    /// Watcher that sees progress and may stop the work.
    pub control: &'a Control,
}

/// A set with all that was found of it.
#[derive(Debug, Clone)]
pub struct Surveyed {
    /// The set as the recipe has it.
    pub set: Set,
    /// An answer to each of its questions, in their order.
    pub answers: Vec<Answered>,
    /// Noise of each of its logs at rest, in their order.
    pub rests: Vec<Measured>,
}

impl Surveyed {
    /// Returns the questions with their answers.
    pub fn questions(&self) -> impl Iterator<Item = (&Question, &Answered)> {
        self.set.diagnosis.iter().zip(&self.answers)
    }

    /// Returns the logs at rest with what was measured of them.
    pub fn at_rest(&self) -> impl Iterator<Item = (&Rest, &Measured)> {
        self.set.rest.iter().zip(&self.rests)
    }
}

/// A verdict, or in words why there is none.
#[derive(Debug, Clone)]
pub struct Answered {
    /// Holds what was said.
    pub said: Said,
    /// The verdict itself, where the diagnosis did not stop with an error.
    pub verdict: Option<Verdict>,
}

/// Asks every question of a recipe.
///
/// # Errors
/// A recording that is not there, a log at rest that cannot be measured, a folder that cannot be
/// written, or Ctrl-C. A diagnosis that fails is an answer that says so.
pub fn survey(recipe: Recipe, tools: &Instruments<'_>) -> Result<Vec<Surveyed>> {
    for set in &recipe.set {
        present(set, tools.data)?;
    }
    let scratch = Scratch::new(None)?;
    let questions: Vec<&Question> = recipe.set.iter().flat_map(|set| &set.diagnosis).collect();
    let progress = tools.control.stage("diagnosing", questions.len() as u64);
    let answers = side_by_side(&questions, |question| {
        let answer = answered(question, tools, &scratch).map_err(without_resume);
        progress.step();
        answer
    })?;
    drop(progress);
    let mut answers = answers.into_iter();
    let logs: usize = recipe.set.iter().map(|set| set.rest.len()).sum();
    let progress = tools.control.stage("measuring noise", logs as u64);
    let mut found = Vec::new();
    for set in recipe.set {
        let mut rests = Vec::new();
        for rest in &set.rest {
            let folder = scratch.case()?;
            let path = rest.excerpt().path(tools.data, folder.path())?;
            rests.push((tools.rest)(&path, rest)?);
            progress.step();
        }
        let answers = answers.by_ref().take(set.diagnosis.len()).collect();
        found.push(Surveyed { set, answers, rests });
    }
    Ok(found)
}

fn answered(question: &Question, tools: &Instruments<'_>, scratch: &Scratch) -> Result<Answered> {
    let folder = scratch.case()?;
    let files = question.excerpt().files(tools.data, folder.path(), &question.model, &question.test)?;
    let (mut said, verdict) = ask::ask(&files, tools.diagnose)?;
    // An error names the files that it is about; where they lie is nobody's business.
    for place in [folder.path(), tools.data] {
        said.words = said.words.replace(&format!("{}/", place.display()), "");
    }
    Ok(Answered { said, verdict })
}

/// Nothing of an atlas is kept before its end.
fn without_resume(error: Error) -> Error {
    match error.kind {
        Kind::Interrupted => Error { hint: "run it again".into(), ..error },
        Kind::Failed => error,
    }
}

/// Refuses a set with a recording that is not there, before an hour of verdicts.
fn present(set: &Set, data: &Path) -> Result<()> {
    let asked = set.diagnosis.iter().flat_map(|q| q.test.iter().chain([&q.file]));
    let mut files = asked.chain(set.rest.iter().map(|rest| &rest.file));
    match files.find(|file| !data.join(file).is_file()) {
        None => Ok(()),
        Some(file) => Err(Error::new(
            format!("could not survey the set `{}`", set.id),
            format!("{} is not in {}", file.display(), data.display()),
            "put it there, set PROOFMASS_DATA to the folder that has it, or take the set out of the recipe",
        )),
    }
}
