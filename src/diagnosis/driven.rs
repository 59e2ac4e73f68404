//! Input and output of one proof mass, or its free ring-down: which physics its model leaves out.
//!
//! One room per stage, each of which imports only those before it: `intake` → `simulation` → `identification` → `selection` →
//! `verdict`, over the laws in `physics`.

pub mod base;
pub mod identification;
pub mod intake;
pub mod selection;
pub mod simulation;
pub mod verdict;

use crate::error::{Error, Result};
use crate::numerics::order;
pub use crate::physics::library::CANDIDATES;
use crate::physics::library::Term;
use crate::progress;
use crate::recording::Recording;

use super::answer::Answer;
use super::model;

use identification::fit;
use identification::refined_scales::refined;
use intake::prepare::{self, Prepared};
use intake::work::Stage;
use intake::{excerpt, stretches};
use selection::{base_model, folds, judged, stepwise};
use simulation::run;
pub use verdict::detail::Detail;
use verdict::{answer, conclude, findings};

/// Diagnoses it.
///
/// # Errors
/// As `prepare::prepare`; and where no oscillator at all can be fitted.
pub fn diagnose(recording: &Recording, model: &model::Driven) -> Result<Answer> {
    let part = excerpt::excerpt(recording, model);
    let (kept, model) = part.as_ref().map_or((recording, model), |p| (&p.recording, &p.model));
    let Prepared { mut data, own_test, filled, mut notes } = prepare::prepare(kept, model)?;
    notes.doubts.extend(part.as_ref().and_then(|p| p.doubt.clone()));
    notes.findings.extend(part.as_ref().map(|p| p.said.clone()));
    let mut narrow = stretches::loudest(&data).unwrap_or_else(|| data.clone());
    if narrow.hull != data.hull {
        notes.findings.push(format!(
            "terms were chosen on the loudest {} samples, from sample {}, and fitted to all",
            narrow.hull.len(),
            narrow.hull.start
        ));
    }
    let mut budget = narrow.work.budget(Stage::Search, narrow.hull.len());
    let (base, scales) = base_model::base(&narrow, &model.start, &mut notes).map_err(|cause| {
        Error::new(
            format!("could not diagnose {}", recording.path.display()),
            cause,
            "check that input and output are the right columns and that the input moves the output",
        )
    })?;
    base_model::bridge(&mut narrow, &base, &filled);
    if narrow.hull == data.hull {
        data.reading.clone_from(&narrow.reading);
    }
    let scales = refined(&narrow, &base, &scales);
    let candidates: Vec<Term> = Term::tried(data.environments, data.input.is_some())
        .into_iter()
        .filter(|t| !notes.broken && !t.starts(&scales).is_empty())
        .collect();
    let base = match folds::for_the_rare(&narrow, &base) {
        Some(fold) => {
            let said = "what stands out lies in samples that were to judge: they are fitted, and others judge";
            notes.findings.push(said.to_owned());
            if narrow.hull == data.hull {
                (data.train, data.validation) = (fold.train.clone(), fold.validation.clone());
                if !own_test {
                    data.test = fold.validation.clone();
                }
            }
            (narrow.train, narrow.validation) = (fold.train, fold.validation);
            fit::fit(&narrow, &base.shape, &base.point, &scales, 25).unwrap_or(base)
        }
        None => base,
    };
    let base = judged::judge(&narrow, base, &scales);
    let mut selection = stepwise::search(&narrow, base, &scales, &candidates, budget);
    if let Some(how) = base_model::other_input(&mut narrow, &selection.chosen, &scales) {
        notes.findings.push(format!("the input fits best when it goes by {} between samples", how.words()));
        let again = fit::fit(&narrow, &selection.base.fit.shape, &selection.base.fit.point, &scales, 25);
        let base = judged::judge(&narrow, again.unwrap_or_else(|| selection.base.fit.clone()), &scales);
        budget = budget.or(narrow.work.budget(Stage::SearchAgain, narrow.hull.len()));
        selection = stepwise::search(&narrow, base, &scales, &candidates, budget);
    }
    if selection.cut_short {
        notes
            .findings
            .push("the search for terms was cut short when its work was spent, with structure left".to_owned());
    }
    if selection.rivals_left_out {
        let clause = "not every candidate that might do as well as those named was tried, as the work for it was spent";
        notes.doubt(clause.to_owned(), "");
    }
    data.input = narrow.input.clone();
    if progress::interrupted() {
        return Err(Error::interrupted(format!("could not diagnose {}", recording.path.display()), "start it again"));
    }
    if own_test {
        data.train = std::mem::take(&mut data.train).into_iter().chain(data.validation.iter().cloned()).collect();
        order::sort_by_key(&mut data.train, |r| r.start as f64);
    }
    let conclusion = if narrow.hull == data.hull {
        conclude::conclude(&data, &selection, &scales)
    } else {
        narrow.test = data.test.clone();
        conclude::widened(conclude::conclude(&narrow, &selection, &scales), &data, &scales)
    };
    notes.findings.extend(
        conclusion
            .left_out
            .iter()
            .map(|what| format!("{}, as the work for the conclusion was spent", findings::left_out(*what))),
    );
    let last = &conclusion.model.fit;
    notes.mind_jumps(&data, &run::trace(&data, &last.shape, &last.point, &last.run(&data, true)).0);
    Ok(answer::answer(recording, model, &data, &scales, &selection, &conclusion, notes))
}
