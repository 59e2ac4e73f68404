//! The order in which terms are added: stepwise forward, with backward pruning after every step. Not what
//! makes a term worth its place (`earned`).

use crate::control::{Control, Progress, Stopped};
use crate::driven::identification::refined_scales::refined;
use crate::driven::intake::data::Data;
use crate::driven::intake::work::{Budget, Stage};
use crate::gate::Gate;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::trace::Step;

use super::candidates_round::{SURE, round};
use super::deferred_linear::try_deferred_linear;
use super::earned::{earned, pruned};
use super::exponent_forms::{self, decide_exponents};
use super::free_forms;
use super::identifiability::Identifiability;
use super::judged::{Judged, Selection, Trial};
use super::own_sharpness;
use super::residual_structure::residual_structure;
use super::rivals::Look;
use super::stop_or_spring::decide_stop_or_spring;

/// Most terms in a model.
const MOST_TERMS: usize = 6;
/// A term must explain at least this fraction of the remaining residual variance.
const LEAST_OF_REST: f64 = 0.03;
/// The same for the third term and later ones: a model that needs so many is probably misspecified.
const FAIR_PART_OF_REST: f64 = 0.2;
/// Unless next to nothing is left of the base model's error: the rest is detail then.
const NEARLY_NOTHING: f64 = 0.01;
/// Share of the variance that may still be predicted in a model that is done.
const DONE: f64 = 0.02;
/// The same for a model of several terms that will not be.
const FAR_FROM_DONE: f64 = 0.15;

/// Searches stepwise forward, with backward pruning after every step.
///
/// # Errors
/// Stopped.
pub(crate) fn search(
    data: &Data,
    base: Judged,
    scales: &Scales,
    candidates: &[Term],
    budget: Budget,
    control: &Control,
) -> Result<Selection, Stopped> {
    let progress = control.stage("candidates", MOST_TERMS as u64);
    let tried = candidates.len();
    let mut steps = Stepwise {
        data,
        base: &base,
        scales,
        tried,
        control,
        progress,
        budget,
        alone: Vec::new(),
        follows_input: false,
    };
    let reach = Identifiability::of(data, &base.fit);
    let Way { chosen, predictable: rest, cut_short, follows_input } = steps.forward(candidates)?;
    let mut look = Look {
        data,
        scales,
        candidates,
        budget: data.work.budget(Stage::Rivals, data.hull.len()),
        left_out: false,
        control,
    };
    // What is far from explained needs no rivals: it will not be named.
    let no_rivals = || Step::of(Gate::NoRivals, "compared", "not compared").measured(rest, FAR_FROM_DONE);
    let hopeless = chosen.fit.structure.terms.len() > 2 && rest > FAR_FROM_DONE && data.trace.acts(no_rivals());
    let Stepwise { alone, tried, progress, .. } = steps;
    drop(progress);
    let _stage = control.stage("rivals and other forms", 0);
    let mut selection = Selection {
        base,
        chosen,
        base_follows: true,
        alone,
        tried,
        rivals: Vec::new(),
        stand_ins: Vec::new(),
        departing: None,
        reach,
        cut_short,
        follows_input,
        rivals_left_out: false,
    };
    if !cut_short && !hopeless {
        look.settle(&mut selection)?;
    }
    selection.rivals_left_out = look.left_out;
    // In windows a form has too little of the motion at a time.
    if data.windows.is_none() {
        let budget = data.work.budget(Stage::KeptBack, data.hull.len());
        try_deferred_linear(data, &mut selection, scales, budget, control)?;
        let budget = data.work.budget(Stage::Forms, data.hull.len());
        free_forms::decide(data, &mut selection, scales, budget);
        decide_stop_or_spring(data, &mut selection, scales, budget);
        let budget = data.work.budget(Stage::KeptShapes, data.hull.len());
        decide_exponents(data, &mut selection, scales, budget);
    }
    Ok(selection)
}

/// A search's steps from a model to richer ones.
struct Stepwise<'a> {
    data: &'a Data,
    base: &'a Judged,
    scales: &'a Scales,
    tried: usize,
    control: &'a Control,
    progress: Progress,
    budget: Budget,
    /// Every candidate alone, once it has been tried.
    alone: Vec<Trial>,
    /// States whether the last step left an oscillation that the input may cause.
    follows_input: bool,
}

/// Result of one walk forward.
struct Way {
    chosen: Judged,
    /// Share of its variance that can still be predicted.
    predictable: f64,
    /// States whether it ended because the work was spent.
    cut_short: bool,
    /// States whether it left an oscillation that the input may cause.
    follows_input: bool,
}

impl Stepwise<'_> {
    /// Walks from the base model as far as these candidates lead.
    fn forward(&mut self, candidates: &[Term]) -> Result<Way, Stopped> {
        let (data, mut chosen, mut cut_short, mut follows_input) = (self.data, self.base.clone(), false, false);
        for _ in 0..=MOST_TERMS {
            let shaped = self.shapes().shaped(&chosen);
            let best = match &shaped {
                Some(shaped) if self.shapes().is_at_noise(shaped) => None,
                _ => self.step(&chosen, candidates)?,
            };
            self.progress.step();
            // Either the friction gets a fitted shape, or a further law is added: whichever fits better.
            let leads = |shaped: &Judged| best.as_ref().is_none_or(|best| shaped.score() >= best.score());
            let best = match shaped.filter(leads) {
                Some(shaped) => {
                    data.trace.acts(own_sharpness::step(&chosen, &shaped));
                    Some(shaped)
                }
                None => best,
            };
            let Some(best) = best else {
                follows_input = self.follows_input;
                break;
            };
            chosen = pruned(data, best, self.scales, self.tried);
            if chosen.fit.structure.terms.len() >= MOST_TERMS {
                break;
            }
            if data.work.is_spent(self.budget) && residual_structure(data, &chosen.fit).r_squared > DONE {
                cut_short = true;
                break;
            }
        }
        let predictable = residual_structure(data, &chosen.fit).r_squared;
        Ok(Way { predictable, chosen, cut_short, follows_input })
    }

    /// The search for fitted shapes, on the work of this one.
    fn shapes(&self) -> exponent_forms::Search<'_> {
        let Self { data, scales, tried, budget, .. } = *self;
        exponent_forms::Search { data, scales, tried, budget }
    }

    /// Returns whether next to nothing is left of the base model's error.
    fn is_nearly_done(&self, chosen: &Judged) -> bool {
        chosen.held_out.free() < NEARLY_NOTHING * self.base.held_out.free()
    }

    /// The best model with one term more that earns it.
    fn step(&mut self, chosen: &Judged, candidates: &[Term]) -> Result<Option<Judged>, Stopped> {
        let (data, tried) = (self.data, self.tried);
        let first = chosen.fit.structure.terms.is_empty();
        let known = self.alone.iter().filter(|t| candidates.contains(&t.term));
        let trials = if first && known.clone().filter(|t| t.judged.is_some()).count() >= SURE {
            known.filter(|t| t.judged.is_some() || t.follows_input).cloned().collect()
        } else {
            let here = refined(data, &chosen.fit, self.scales);
            let open: Vec<Term> = candidates.iter().copied().filter(|t| chosen.may_hold(t)).collect();
            round(data, chosen, &open, &here, SURE, self.control)?
        };
        self.follows_input = trials.iter().any(|t| t.follows_input);
        for trial in trials.iter().filter(|t| t.follows_input) {
            data.trace.acts(Step::keeps_out(Gate::InputLine, Some(trial.term.id())));
        }
        let rest = if chosen.fit.structure.terms.len() < 2 || self.is_nearly_done(chosen) {
            LEAST_OF_REST
        } else {
            FAIR_PART_OF_REST
        };
        let mut qualifying = trials
            .iter()
            .filter_map(|t| t.judged.as_ref())
            // At the end of its plausible range a law is not what its name states: the others
            // answer without it.
            .filter(|j| !(j.fit.at_bound(self.scales) && data.trace.acts(not_added(Gate::SearchBound, chosen, j))))
            .take(3)
            .filter(|j| {
                let Some(earned) = earned(data, chosen, j, self.scales, tried) else { return false };
                let least = residual_structure(data, &j.fit).r_squared * rest;
                let step = || not_added(Gate::PartOfRest, chosen, j).measured(earned.gain, least);
                earned.gain > least || !data.trace.acts(step())
            });
        let best = qualifying.next().cloned();
        drop(qualifying);
        if first && self.alone.is_empty() {
            self.alone = trials;
        }
        Ok(best)
    }
}

/// Records that a gate keeps a candidate from being added to a model.
fn not_added(gate: Gate, chosen: &Judged, with: &Judged) -> Step {
    let added = with.fit.structure.terms.iter().find(|t| !chosen.has(t.id()));
    Step::keeps_out(gate, added.map(Term::id))
}
