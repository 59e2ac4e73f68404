//! A diagnosis under way: what is searched, on what part of the recording, and what is concluded.
//! Not for the base model that it begins with (`base_form`).

mod base_form;

use crate::control::{Control, Stopped};
use crate::gate::Gate;
use crate::model;
use crate::numerics::order;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::trace::Step;
use crate::verdict::Outcome;

use super::identification::fit::{self, Fit};
use super::intake::data::Data;
use super::intake::input::Interpolation;
use super::intake::notes::Notes;
use super::intake::prepare::Prepared;
use super::intake::stretches::{self, Stretches};
use super::intake::work::{Budget, Stage};
use super::selection::base_model;
use super::selection::folds::{self, Fold};
use super::selection::held_input;
use super::selection::judged::{self, Judged, Selection};
use super::selection::stepwise;
use super::simulation::run;
use super::verdict::by_simulation::{self, Searched, Simulation};
use super::verdict::conclude::{self, Conclusion};
use super::verdict::dropped::Dropped;
use super::verdict::findings;

/// A diagnosis under way. Terms are chosen on a stretch of a long recording and fitted to all of
/// it.
pub(super) struct Course {
    pub(super) data: Data,
    /// What terms are chosen on: the loudest stretch of a long recording, else all of it.
    narrow: Data,
    /// Hints that can be right.
    start: model::Start,
    /// Whether the model file named its own test samples.
    pub(super) own_test: bool,
    /// Whether the reading follows a linear oscillator at all.
    pub(super) follows: bool,
    /// Samples that were not recorded.
    filled: Stretches,
    pub(super) notes: Notes,
    /// What the search may cost.
    budget: Budget,
    /// What free simulation found over the base model.
    searched: Option<Searched>,
}

impl Course {
    pub(super) fn begin(prepared: Prepared) -> Self {
        let Prepared { data, start, own_test, filled, mut notes, .. } = prepared;
        let narrow = stretches::loudest(&data).unwrap_or_else(|| data.clone());
        if narrow.hull != data.hull {
            notes.findings.push(format!(
                "terms were chosen on the loudest {} samples, from sample {}, and fitted to all",
                narrow.hull.len(),
                narrow.hull.start
            ));
        }
        let budget = narrow.work.budget(Stage::Search, narrow.hull.len());
        Self { data, narrow, start, own_test, follows: true, filled, notes, budget, searched: None }
    }

    /// Whether terms are chosen on all of the recording.
    fn is_whole(&self) -> bool {
        self.narrow.hull == self.data.hull
    }

    /// Laws that free simulation finds, and the noise beside them, where all of these laws keep their
    /// names.
    pub(super) fn explained(
        &mut self,
        base: &Fit,
        scales: &Scales,
        control: &Control,
    ) -> Result<Option<(Selection, Conclusion)>, Stopped> {
        if !self.follows || self.notes.broken.is_some() || self.narrow.windows.is_some() {
            return Ok(None);
        }
        let base = judged::judge(&self.narrow, base.clone(), scales);
        let Some((searched, selection)) = by_simulation::searched(&self.narrow, &base, scales) else { return Ok(None) };
        self.searched = Some(searched);
        let Some(mut selection) = selection else { return Ok(None) };
        let laws = selection.chosen.fit.structure.terms.clone();
        if selection.departing.is_none() {
            let mut noise = self.candidates(scales);
            noise.retain(|t| t.noise().is_some());
            selection = stepwise::with_noise(&self.narrow, selection, scales, &noise, self.budget, control)?;
        }
        let (data, notes) = (self.data.clone(), self.notes.clone());
        let conclusion = self.conclude(&selection, scales);
        let terms = &conclusion.model.fit.structure.terms;
        let keeps_all = laws.iter().all(|law| conclusion.named.iter().any(|n| terms[n.index] == *law));
        if keeps_all && conclusion.outcome != Outcome::Unexplained {
            return Ok(Some((selection, conclusion)));
        }
        (self.data, self.notes) = (data, notes);
        Ok(None)
    }

    /// The terms that the recording asks for; searched again where another way of the input between
    /// its samples fits better.
    pub(super) fn select(&mut self, base: Fit, scales: &Scales, control: &Control) -> Result<Selection, Stopped> {
        let candidates = self.candidates(scales);
        let base = self.with_what_is_rare(base, scales);
        let base = judged::judge(&self.narrow, base, scales);
        let mut selection = stepwise::search(&self.narrow, base, scales, &candidates, self.budget, control)?;
        if let Some(base) = self.on_another_input(&selection, scales) {
            self.budget = self.budget.or(self.narrow.work.budget(Stage::SearchAgain, self.narrow.hull.len()));
            selection = stepwise::search(&self.narrow, base, scales, &candidates, self.budget, control)?;
        }
        if self.data.trace.is_on(Gate::SmoothInput)
            && let Some(smooth) = held_input::smooth_input(&self.narrow, &selection.chosen)
        {
            let base = base_again(&smooth, &selection, scales);
            let is_half =
                self.data.trace.is_on(Gate::HalfSample) && held_input::is_half_a_sample(&self.narrow, &selection);
            let other = if is_half {
                held_input::on_a_smooth_one(&smooth, base, &selection, scales, control)?
            } else {
                self.budget = self.budget.or(self.narrow.work.budget(Stage::SearchAgain, self.narrow.hull.len()));
                let other = stepwise::search(&smooth, base, scales, &candidates, self.budget, control)?;
                held_input::is_better(&smooth, &other, &selection).then_some(other)
            };
            if let Some(other) = other {
                let how = self.narrow.input.as_ref().map(|i| base_model::interpolated(i.interpolation));
                self.notes.findings.retain(|finding| Some(finding) != how.as_ref());
                (self.narrow, selection) = (smooth, other);
            }
        }
        if !self.follows {
            // No resonance is known whose cycles could be counted.
            selection.base_follows = false;
            selection.reach.few_cycles = None;
        }
        self.data.input.clone_from(&self.narrow.input);
        self.note_what_was_not_tried(&selection);
        Ok(selection)
    }

    /// Terms that can be tried on this recording.
    fn candidates(&self, scales: &Scales) -> Vec<Term> {
        let all = Term::tried(self.data.environments, self.data.input.is_some());
        // A window begins from a displacement and a velocity: what has states beside them begins
        // unknown each time.
        let begins = |t: &Term| self.data.windows.is_none() || (t.states() == 0 && t.noise().is_none());
        all.into_iter().filter(|t| self.notes.broken.is_none() && begins(t) && !t.starts(scales).is_empty()).collect()
    }

    /// The base model fitted to what is rare, where that lies in samples that were to judge: others
    /// judge then.
    fn with_what_is_rare(&mut self, base: Fit, scales: &Scales) -> Fit {
        let rare = if self.narrow.windows.is_some() { None } else { folds::fold_with_rare_events(&self.narrow, &base) };
        let step = Step::of(Gate::RareEvents, "validation judges", "exchanged");
        let Some(Fold { train, validation }) = rare.filter(|_| self.data.trace.acts(step)) else { return base };
        let said = "the largest errors fell in validation samples; training and validation samples were exchanged";
        self.notes.findings.push(said.to_owned());
        if self.is_whole() {
            (self.data.train, self.data.validation) = (train.clone(), validation.clone());
            if !self.own_test {
                self.data.test.clone_from(&validation);
            }
        }
        (self.narrow.train, self.narrow.validation) = (train, validation);
        fit::fit(&self.narrow, &base.structure, &base.point, scales, 25).unwrap_or(base)
    }

    /// The base model with the input going another way between its samples, where that fits better
    /// than the terms chosen.
    fn on_another_input(&mut self, selection: &Selection, scales: &Scales) -> Option<Judged> {
        let settled = self.narrow.input.as_ref().is_none_or(|i| i.interpolation != Interpolation::BandLimited);
        if self.narrow.windows.is_some() || settled || !self.data.trace.is_on(Gate::OtherInput) {
            return None;
        }
        // A stated form that departs bends what stands beside it: half a sample is seen where it is free.
        let best = selection.departing.as_ref().map_or(&selection.chosen, |d| &d.judged);
        let how = base_model::other_input(&mut self.narrow, best, scales)?;
        self.data.trace.acts(Step::of(Gate::OtherInput, best.words(), how.words()));
        self.notes.findings.push(base_model::interpolated(how));
        Some(base_again(&self.narrow, selection, scales))
    }

    fn note_what_was_not_tried(&mut self, selection: &Selection) {
        if selection.follows_input {
            let reason = findings::dropped(Dropped::FollowsInput);
            self.notes.findings.push(format!("an oscillation in the residual has no name: {reason}"));
        }
        if selection.cut_short {
            let said = "the search for terms stopped at its work limit, with structure left in the residual";
            self.notes.findings.push(said.to_owned());
        }
        if selection.rivals_left_out {
            let clause = "not every rival of the identified effects was tried: the work limit was reached";
            self.notes.doubt(clause.to_owned(), "");
        }
    }

    /// What may be said of the model chosen, fitted to all samples but those that the model file
    /// keeps for the test.
    pub(super) fn conclude(&mut self, selection: &Selection, scales: &Scales) -> Conclusion {
        let data = &mut self.data;
        if self.own_test {
            data.train.extend(data.validation.iter().cloned());
            order::sort_by_key(&mut data.train, |r| r.start as f64);
        }
        let conclusion = if self.is_whole() {
            conclude::conclude(&self.data, selection, scales)
        } else {
            self.narrow.test.clone_from(&self.data.test);
            conclude::widened(conclude::conclude(&self.narrow, selection, scales), &self.data, scales)
        };
        let left_out = conclusion.left_out.iter();
        let left_out =
            left_out.map(|what| format!("{}: the work limit of the conclusion was reached", findings::left_out(*what)));
        self.notes.findings.extend(left_out);
        let last = &conclusion.model.fit;
        let (errors, _) = run::trace(&self.data, &last.structure, &last.point, &last.run(&self.data, true));
        self.notes.report_jumps(&self.data, &errors);
        conclusion
    }

    /// What free simulation adds to a conclusion.
    pub(super) fn simulated(
        &mut self,
        selection: Selection,
        conclusion: Conclusion,
        scales: &Scales,
    ) -> (Selection, Conclusion, Simulation) {
        let searched = self.searched.take();
        if self.is_whole() {
            return by_simulation::simulated(&self.data, selection, conclusion, scales, searched);
        }
        let had = conclusion.named.len();
        let (selection, conclusion, simulation) =
            by_simulation::simulated(&self.narrow, selection, conclusion, scales, searched);
        let is_new = conclusion.named.len() > had;
        let conclusion = if is_new { conclude::widened(conclusion, &self.data, scales) } else { conclusion };
        (selection, conclusion, simulation)
    }
}

/// The base model of a search on another input.
fn base_again(data: &Data, selection: &Selection, scales: &Scales) -> Judged {
    let base = &selection.base.fit;
    let again = fit::fit(data, &base.structure, &base.point, scales, 25);
    judged::judge(data, again.unwrap_or_else(|| base.clone()), scales)
}
