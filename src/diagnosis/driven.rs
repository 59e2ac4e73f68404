//! Input and output of one proof mass, or its free ring-down: which physics its model leaves out.
//!
//! One room per stage, each of which imports only those before it: `intake` → `simulation` →
//! `identification` → `selection` → `verdict`, over the laws in `physics`. A free decay goes its own way,
//! through the engine (`decay`); under an input a `course` asks the engine first and last (`simulated`).

pub mod base;
mod course;
pub mod decay;
pub mod free_body;
pub mod identification;
pub mod intake;
pub mod selection;
mod simulated;
pub mod simulation;
pub mod verdict;

use crate::control::Control;
use crate::error::Result;
use crate::gate::Gate;
pub use crate::physics::library::CANDIDATES;
use crate::physics::library::Term;
use crate::recording::Recording;
use crate::trace::Step;

use super::answer::Answer;
use super::model;
use super::recordings::Recordings;

use course::Course;
use identification::settled_shift::settled;
use intake::refusal::Refusal;
use intake::several::{self, Taken};
use verdict::answer;
use verdict::asked::Asked;
pub use verdict::detail::Detail;

/// Diagnoses it.
///
/// # Errors
/// As `prepare::prepare`; where no oscillator at all can be fitted; when stopped.
pub fn diagnose(recording: &Recording, model: &model::Driven, control: &Control) -> Result<Answer> {
    diagnose_all(Recordings::one(recording), model, control)
}

/// Diagnoses several recordings of one sensor together.
///
/// # Errors
/// As [`diagnose`], and as `several::taken`.
pub(crate) fn diagnose_all(recordings: Recordings<'_>, model: &model::Driven, control: &Control) -> Result<Answer> {
    let recording = &recordings.train[0];
    let taken = several::taken(recordings, model, settled, control)?;
    let trace = taken.prepared.data.trace.clone();
    let answer = match decayed(recording, &taken, model) {
        None => by_likelihood(recording, taken, model, control)?,
        Some((answer, false)) => answer,
        // Noise is named last, from what remains, by its likelihood.
        Some((answer, true)) => {
            by_likelihood(recording, taken, model, control).ok().filter(names_noise_alone).unwrap_or(answer)
        }
    };
    Ok(Answer { trace: trace.steps(), ..answer })
}

/// The answer of a free decay, and whether what its model leaves is noise with a memory; `None` where
/// an input drives it, samples are kept for validation, or nothing swings.
fn decayed(recording: &Recording, taken: &Taken, model: &model::Driven) -> Option<(Answer, bool)> {
    let Taken { prepared, pieces, judging } = taken;
    if prepared.data.input.is_some() || prepared.own_test || pieces.len() != 1 {
        return None;
    }
    let decay = decay::searched::decay(&prepared.data, &prepared.filled)?;
    let asked = Asked { recording, pieces, judging, columns: &model.columns, unit: model.unit.as_deref() };
    let answer = decay::answer::answer(&asked, &prepared.data, &decay, prepared.notes.clone());
    Some((answer, decay.leaves_noise_with_memory()))
}

/// Whether an answer names something, and noise alone.
fn names_noise_alone(answer: &Answer) -> bool {
    let is_noise = |id: &str| Term::all().iter().any(|t| t.id() == id && t.noise().is_some());
    !answer.effects.is_empty() && answer.effects.iter().all(|e| is_noise(&e.id))
}

/// The answer by terms that are added step by step, judged by their likelihood.
fn by_likelihood(recording: &Recording, taken: Taken, model: &model::Driven, control: &Control) -> Result<Answer> {
    let Taken { prepared, pieces, judging } = taken;
    let mut course = Course::begin(prepared);
    let (base, scales) = course.base(control).map_err(|refusal| refusal.of(recording))?;
    let asked =
        Asked { recording, pieces: &pieces, judging: &judging, columns: &model.columns, unit: model.unit.as_deref() };
    if course.follows
        && let Some(turns) = free_body::turns_if_free(&course.data, &base)
        && course.data.trace.acts(Step::of(Gate::FreeBody, "oscillator", "free body").measured(turns, free_body::TURNS))
        && let Some(answer) = free_body::conclusion::answer(&asked, &course.data, course.own_test, course.notes.clone())
    {
        return Ok(answer);
    }
    let explained = course.explained(&base, &scales, control).map_err(|s| Refusal::from(s).of(recording))?;
    let (selection, conclusion) = match explained {
        Some(found) => found,
        None => {
            let selection = course.select(base, &scales, control).map_err(|s| Refusal::from(s).of(recording))?;
            let conclusion = course.conclude(&selection, &scales);
            (selection, conclusion)
        }
    };
    let (selection, conclusion, simulation) = course.simulated(selection, conclusion, &scales);
    let Course { data, notes, .. } = course;
    let mut answer = answer::answer(&asked, &data, &scales, &selection, &conclusion, notes);
    simulation.told(&mut answer, &conclusion);
    Ok(answer)
}
