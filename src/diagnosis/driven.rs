//! Input and output of one proof mass, or its free ring-down: which physics its model leaves out.

pub mod alignment;
pub mod answer;
pub mod begin;
pub mod conclude;
pub mod contact;
pub mod damping;
pub mod defects;
pub mod drift;
pub mod drive;
pub mod ensemble;
pub mod excerpt;
pub mod filter;
pub mod fineness;
pub mod fit;
pub mod folds;
pub mod friction;
pub mod gain;
pub mod held_out;
pub mod hysteresis;
pub mod input;
pub mod interval;
pub mod isolation;
pub mod lag;
pub mod limits;
pub mod mode;
pub mod noise;
pub mod pickup;
pub mod prepare;
pub mod profile;
mod propagator;
pub mod quantisation;
pub mod readout;
pub mod remainder;
pub mod rivals;
pub mod scales;
pub mod select;
pub mod sensor;
pub mod series;
pub mod shape;
pub mod spring;
pub mod start;
mod step;
pub mod stepwise;
pub mod stretches;
pub mod surface;
pub mod term;
pub mod valleys;
pub mod weigh;
pub mod words;
pub mod work;

use std::ops::Range;

use crate::error::{Error, Result};
use crate::numerics::order;
use crate::progress;
use crate::recording::Recording;

use super::Diagnosis;
use super::candidate::Candidate;
use super::model;

use prepare::Prepared;
use surface::Surface;
use term::Term;
use work::Stage;

/// What can be named in this kind of recording.
pub const CANDIDATES: &[Candidate] = &[
    spring::CUBIC,
    spring::QUADRATIC,
    damping::QUADRATIC,
    damping::SQUEEZE_FILM,
    damping::COULOMB,
    hysteresis::BOUC_WEN,
    spring::DRIFT,
    mode::PARASITIC,
    drive::SQUARE,
    contact::END_STOP,
    noise::FORCE,
    readout::SATURATION,
    readout::QUANTISATION,
    lag::DELAY,
    lag::LOWPASS,
    readout::POLYNOMIAL,
    drive::FEEDTHROUGH,
    drift::RAMP,
    drift::WARM_UP,
    noise::WALK,
    pickup::PERIODIC,
];

/// Plain numbers behind the figures.
#[derive(Debug, Clone, Default)]
pub struct Detail {
    /// Output column.
    pub output: String,
    /// Its unit.
    pub unit: String,
    /// Sampling rate.
    pub rate_hz: f64,
    /// The stretch of held-out samples that is shown.
    pub shown: Shown,
    /// Displacement (base model) on the fitted stretch.
    pub state: Vec<f64>,
    /// Error of the base model's free simulation there.
    pub before: Vec<f64>,
    /// Error of the repaired model's free simulation there.
    pub after: Vec<f64>,
    /// One-step error of the repaired model there.
    pub innovations: Vec<f64>,
    /// Sample at which that stretch begins.
    pub from: usize,
    /// The force that the base model leaves unexplained over displacement and velocity, and the repaired one.
    pub surfaces: [Surface; 2],
    /// Where nothing is named: root-mean-square, over the noise, from which on something would have been.
    pub least_over_noise: f64,
    /// Candidates whose signatures could then not have been told apart.
    pub alike: Vec<[&'static str; 2]>,
    /// Whether anything was named.
    pub named: bool,
    /// How the misfit rises around each named parameter.
    pub profiles: Vec<profile::Profile>,
    /// Candidates: id, gain, interval, named.
    pub candidates: Vec<(String, f64, [f64; 2], bool)>,
}

/// Recording and both models where they differ most, sample by sample.
#[derive(Debug, Clone, Default)]
pub struct Shown {
    /// First sample.
    pub from: usize,
    /// Samples of it that were not fitted.
    pub held_out: Vec<Range<usize>>,
    /// Recording.
    pub reading: Vec<f64>,
    /// Base model, freely simulated.
    pub base: Vec<f64>,
    /// Repaired model, freely simulated.
    pub repaired: Vec<f64>,
}

/// Diagnoses it.
///
/// # Errors
/// As `prepare::prepare`; and where no oscillator at all can be fitted.
pub fn diagnose(recording: &Recording, model: &model::Driven) -> Result<Diagnosis> {
    let part = excerpt::excerpt(recording, model);
    let (kept, model) = part.as_ref().map_or((recording, model), |p| (&p.recording, &p.model));
    let Prepared { mut data, own_test, filled, mut notes } = prepare::prepare(kept, model)?;
    notes.doubts.extend(part.as_ref().and_then(|p| p.doubt.clone()));
    let mut narrow = stretches::loudest(&data).unwrap_or_else(|| data.clone());
    if narrow.hull != data.hull {
        notes.findings.push(format!(
            "terms were chosen on the loudest {} samples, from sample {}, and fitted to all",
            narrow.hull.len(),
            narrow.hull.start
        ));
    }
    let mut budget = narrow.work.budget(Stage::Search, narrow.hull.len());
    let (base, scales) = begin::base(&narrow, &model.start, &mut notes).map_err(|cause| {
        Error::new(
            format!("could not diagnose {}", recording.path.display()),
            cause,
            "check that input and output are the right columns and that the input moves the output",
        )
    })?;
    begin::bridge(&mut narrow, &base, &filled);
    if narrow.hull == data.hull {
        data.reading.clone_from(&narrow.reading);
    }
    let scales = select::refined(&narrow, &base, &scales);
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
    let base = select::judge(&narrow, base, &scales);
    let mut selection = stepwise::search(&narrow, base, &scales, &candidates, budget);
    if let Some(how) = begin::other_input(&mut narrow, &selection.chosen, &scales) {
        notes.findings.push(format!("the input fits best when it goes by {} between samples", how.words()));
        let again = fit::fit(&narrow, &selection.base.fit.shape, &selection.base.fit.point, &scales, 25);
        let base = select::judge(&narrow, again.unwrap_or_else(|| selection.base.fit.clone()), &scales);
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
    notes
        .findings
        .extend(conclusion.left_out.iter().map(|what| format!("{what}, as the work for the conclusion was spent")));
    let last = &conclusion.model.fit;
    notes.mind_jumps(&data, &fit::trace(&data, &last.shape, &last.point, &last.run(&data, true)).0);
    let mut answer = answer::answer(recording, model, &data, &scales, &selection, &conclusion, notes.findings);
    answer.verdict.sentence += &words::doubts(&notes.doubts);
    Ok(answer)
}
