//! Input and output of one proof mass, or its free ring-down: finds which physics its model leaves
//! out.
//!
//! One room per stage, each of which imports only those before it: `intake` → `simulation` →
//! `identification` → `selection` → `verdict`, over the laws in `physics`. A free decay goes its own way,
//! through the engine (`decay`); under an input the engine has the last word (`simulated`).

pub mod base;
pub mod decay;
pub mod free_body;
pub mod identification;
pub mod intake;
pub mod selection;
mod simulated;
pub mod simulation;
pub mod verdict;

use crate::control::{Control, Stopped};
use crate::error::Result;
use crate::gate::Gate;
use crate::numerics::moments::mean_sd;
use crate::numerics::order;
pub use crate::physics::library::CANDIDATES;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::recording::Recording;
use crate::trace::Step;

use super::answer::Answer;
use super::model;
use super::recordings::Recordings;

use decay::alone;
use identification::chaos;
use identification::fit::{self, Fit};
use identification::refined_scales::refined;
use identification::settled_shift::settled;
use identification::start;
use intake::data::Data;
use intake::input::Interpolation;
use intake::notes::Notes;
use intake::prepare::Prepared;
use intake::refusal::Refusal;
use intake::several::{self, Taken};
use intake::stretches::{self, Stretches};
use intake::work::{Budget, Stage};
use selection::at_once;
use selection::base_model::{self, NoOscillator};
use selection::held_input;
use selection::judged::{self, Judged, Selection};
use selection::stepwise;
use simulation::run;
use verdict::asked::Asked;
use verdict::by_simulation::{self, Simulation};
use verdict::conclude::{self, Conclusion};
pub use verdict::detail::Detail;
use verdict::dropped::Dropped;
use verdict::{answer, findings, of_class};

/// Part of the base model's error to which another way of the input between its samples must bring
/// it.
const BY_FAR: f64 = 0.5;

/// Reason why a reading of velocity or acceleration is refused.
const NOT_SIMULATED: &str = "a velocity or an acceleration (`output_is`) is diagnosed only in a single recording that shows a \
     resonance, without [split] test and without further recordings";

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
    let answer = match alone::decayed(recording, &taken, model) {
        None if model.output_is != model::Output::Displacement => {
            return Err(Refusal::Cause(NOT_SIMULATED.to_owned()).of(recording, &model.columns));
        }
        None => {
            let alone = alone::may_be_segmented(&taken).then(|| taken.clone());
            by_likelihood(recording, taken, model, control).or_else(|refusal| {
                let alone = alone.filter(|_| !control.cancelled());
                alone.and_then(|one| alone::segmented(recording, &one, model)).ok_or(refusal)
            })?
        }
        Some((answer, false)) => answer,
        Some((answer, true)) if model.output_is != model::Output::Displacement => answer,
        // Noise is named last, from what remains, by its likelihood.
        Some((answer, true)) => {
            by_likelihood(recording, taken, model, control).ok().filter(names_noise_alone).unwrap_or(answer)
        }
    };
    Ok(Answer { trace: trace.steps(), ..answer })
}

/// Returns whether an answer names something, and noise alone.
fn names_noise_alone(answer: &Answer) -> bool {
    let is_noise = |id: &str| Term::all().iter().any(|t| t.id() == id && t.noise().is_some());
    !answer.effects.is_empty() && answer.effects.iter().all(|e| is_noise(&e.id))
}

/// The answer by terms that are added step by step, judged by their likelihood.
fn by_likelihood(recording: &Recording, taken: Taken, model: &model::Driven, control: &Control) -> Result<Answer> {
    let Taken { prepared, pieces, judging } = taken;
    let mut diagnosis = Diagnosis::begin(prepared);
    let (base, scales) = diagnosis.base(control).map_err(|refusal| refusal.of(recording, &model.columns))?;
    let asked =
        Asked { recording, pieces: &pieces, judging: &judging, columns: &model.columns, unit: model.unit.as_deref() };
    if diagnosis.follows
        && let Some(turns) = free_body::turns_if_free(&diagnosis.data, &base)
        && diagnosis
            .data
            .trace
            .acts(Step::of(Gate::FreeBody, "oscillator", "free body").measured(turns, free_body::TURNS))
        && let Some(answer) = free_body::conclusion::answer(&asked, &diagnosis.data, diagnosis.notes.clone())
    {
        return Ok(answer);
    }
    let selection =
        diagnosis.select(base, &scales, control).map_err(|s| Refusal::from(s).of(recording, &model.columns))?;
    let _stage = control.stage("intervals, forms and limits of detection", 0);
    let conclusion = diagnosis.conclude(&selection, &scales);
    let (selection, conclusion, simulation) = diagnosis.simulated(selection, conclusion, &scales);
    let Diagnosis { data, notes, .. } = diagnosis;
    let conclusion = of_class::fitted(&data, &selection, conclusion, &scales, control)
        .map_err(|s| Refusal::from(s).of(recording, &model.columns))?;
    let mut answer = answer::answer(&asked, &data, &scales, &selection, &conclusion, notes);
    simulation.told(&mut answer, &conclusion, data.own_test);
    Ok(answer)
}

/// A diagnosis under way. Terms are chosen on a stretch of a long recording and fitted to all of
/// it.
struct Diagnosis {
    data: Data,
    /// Data on which terms are chosen: the loudest stretch of a long recording, else all of it.
    excerpt: Data,
    /// Hints that can be right.
    start: model::Start,
    /// States whether the reading follows a linear oscillator at all.
    follows: bool,
    /// Samples that were not recorded.
    filled: Stretches,
    notes: Notes,
    /// Work that the search may spend.
    budget: Budget,
}

impl Diagnosis {
    fn begin(prepared: Prepared) -> Self {
        let Prepared { data, start, filled, mut notes, .. } = prepared;
        let excerpt = stretches::loudest(&data).unwrap_or_else(|| data.clone());
        if excerpt.hull != data.hull {
            notes.findings.push(format!(
                "terms were chosen on the loudest {} samples, from sample {}, and fitted to all",
                excerpt.hull.len(),
                excerpt.hull.start
            ));
        }
        let budget = excerpt.work.budget(Stage::Search, excerpt.hull.len());
        Self { data, excerpt, start, follows: true, filled, notes, budget }
    }

    /// Returns whether terms are chosen on all of the recording.
    fn is_whole(&self) -> bool {
        self.excerpt.hull == self.data.hull
    }

    /// The base model; what was not recorded is bridged by its readings.
    fn base(&mut self, control: &Control) -> Result<(Fit, Scales), Refusal> {
        let mut notes = self.notes.clone();
        let mut free = base_model::base(&self.excerpt, &self.start, &mut notes);
        let left = free.as_ref().map_or(self.power(), |found| found.0.variance);
        if self.settle_interpolation(left) {
            notes.clone_from(&self.notes);
            free = base_model::base(&self.excerpt, &self.start, &mut notes);
        }
        let at_once = free.as_ref().is_ok_and(|(_, scales)| scales.at_once);
        [&mut self.data, &mut self.excerpt].into_iter().for_each(|data| data.observed.at_once = at_once);
        self.settle_whether_it_follows(&free, &mut notes, control)?;
        if let Some(found) = self.chaotic(free.as_ref().ok().map(|f| &f.0)) {
            return Ok(found);
        }
        let (base, scales) = match free {
            Ok(found) => found,
            Err(NoOscillator::Poor { best, .. }) if !self.follows => *best,
            Err(none) => {
                let also: String = notes.doubts.iter().map(|doubt| format!("; {doubt}")).collect();
                return Err(Refusal::Cause(none.cause() + &also));
            }
        };
        self.notes = notes;
        base_model::bridge(&mut self.excerpt, &base, &self.filled);
        if self.is_whole() {
            self.data.reading.clone_from(&self.excerpt.reading);
        }
        let scales = refined(&self.excerpt, &base, &scales);
        Ok((base, scales))
    }

    /// Decides whether a poor linear fit is due to noise or to another law.
    fn settle_whether_it_follows(
        &mut self,
        free: &Result<(Fit, Scales), NoOscillator>,
        notes: &mut Notes,
        control: &Control,
    ) -> Result<(), Stopped> {
        let clause = match (self.notes.bent.take(), free) {
            (Some(clause), _) => clause,
            (None, Err(NoOscillator::Poor { explains, .. })) if self.notes.broken.is_none() => {
                format!("the output depends on its input, but by no linear law: the best oscillator {explains}")
            }
            _ => return Ok(()),
        };
        self.follows = match free {
            Ok((fit, _)) => !base_model::leaves_more_than_noise(&self.excerpt, fit, control)?,
            Err(NoOscillator::Poor { best, .. }) => !base_model::follows_another_law(&self.excerpt, &best.0, control)?,
            Err(NoOscillator::None) => true,
        };
        self.follows |= !self.follows && !self.data.trace.acts(Step::of(Gate::NoLinearLaw, "followed", "not followed"));
        if !self.follows {
            for notes in [&mut self.notes, notes] {
                notes.doubt(clause.clone(), "; a law is named only where it brings the error to the noise");
            }
        }
        Ok(())
    }

    /// Tries an input that is held between its samples, or linear: at few samples a cycle the wrong
    /// interpolation causes a phase error that looks like physics, the mean square `left`. Returns whether the base model follows the reading on such an input,
    /// and no other.
    fn settle_interpolation(&mut self, left: f64) -> bool {
        let least = start::POOR * self.power();
        let is_asked = left >= least && self.filled.is_empty() && self.data.trace.is_on(Gate::BaseInterpolation);
        let Some(input) = self.excerpt.input.as_ref().filter(|_| is_asked) else {
            return false;
        };
        let fitted = |data: &Data| start::base(data, &self.start).map_or(f64::INFINITY, |found| found.0.variance);
        let others = [Interpolation::Hold, Interpolation::Linear].map(|how| {
            let data = Data { input: Some(input.clone().gone(how)), ..self.excerpt.clone() };
            (how, fitted(&data))
        });
        let best = others.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((how, variance)) = best.filter(|(_, variance)| *variance < least.min(BY_FAR * left)) else {
            return false;
        };
        let step = Step::of(Gate::BaseInterpolation, input.interpolation.words(), how.words());
        if !self.data.trace.acts(step.measured(variance / left, BY_FAR)) {
            return false;
        }
        self.notes.findings.push(base_model::interpolated(how));
        for data in [&mut self.data, &mut self.excerpt] {
            data.input = data.input.take().map(|input| input.gone(how));
        }
        true
    }

    /// Mean square of the reading that is fitted, about its mean.
    fn power(&self) -> f64 {
        let rows = self.excerpt.train.iter().flat_map(|r| &self.excerpt.reading[r.clone()]).copied();
        mean_sd(&rows.collect::<Vec<f64>>()).1.powi(2)
    }

    /// The base model in windows, where the response is chaotic and its free simulation therefore
    /// leaves much.
    fn chaotic(&mut self, free: Option<&Fit>) -> Option<(Fit, Scales)> {
        let follows = free.is_some_and(|fit| fit.variance < start::POOR * self.power());
        if follows || self.notes.broken.is_some() || !self.filled.is_empty() || !self.data.breaks.is_empty() {
            return None;
        }
        let chaos = chaos::chaos(&self.excerpt)?;
        let step = Step::of(Gate::Chaos, "whole", "windows").measured(chaos.exponent_per_s, 0.0);
        if !self.data.trace.acts(step) {
            return None;
        }
        let mut excerpt = self.excerpt.clone();
        chaos.in_windows(&mut excerpt);
        let (base, scales) = start::base_from(&excerpt, &chaos.force.base)?;
        if self.is_whole() {
            self.data = excerpt.clone();
        } else {
            chaos.in_windows(&mut self.data);
        }
        self.excerpt = excerpt;
        let scales = refined(&self.excerpt, &base, &scales);
        let [clause, more] = findings::chaos(&chaos);
        self.notes.doubt(clause, &more);
        Some((base, scales))
    }

    /// The terms that the recording asks for; searched again where another way of the input between
    /// its samples fits better.
    fn select(&mut self, base: Fit, scales: &Scales, control: &Control) -> Result<Selection, Stopped> {
        let candidates = self.candidates(scales);
        let base = judged::judge(&self.excerpt, base, scales);
        let mut selection = stepwise::search(&self.excerpt, base, scales, &candidates, self.budget, control)?;
        if let Some(base) = self.on_another_input(&selection, scales) {
            self.budget = self.budget.or(self.excerpt.work.budget(Stage::SearchAgain, self.excerpt.hull.len()));
            selection = stepwise::search(&self.excerpt, base, scales, &candidates, self.budget, control)?;
        }
        if self.data.trace.is_on(Gate::SmoothInput)
            && let Some(smooth) = held_input::smooth_input(&self.excerpt, &selection.chosen)
        {
            let base = base_again(&smooth, &selection, scales);
            let is_half =
                self.data.trace.is_on(Gate::HalfSample) && held_input::is_half_a_sample(&self.excerpt, &selection);
            let other = if is_half {
                held_input::on_a_smooth_one(&smooth, base, &selection, scales, control)?
            } else {
                self.budget = self.budget.or(self.excerpt.work.budget(Stage::SearchAgain, self.excerpt.hull.len()));
                let other = stepwise::search(&smooth, base, scales, &candidates, self.budget, control)?;
                held_input::is_better(&smooth, &other, &selection).then_some(other)
            };
            if let Some(other) = other {
                let how = self.excerpt.input.as_ref().map(|i| base_model::interpolated(i.interpolation));
                self.notes.findings.retain(|finding| Some(finding) != how.as_ref());
                (self.excerpt, selection) = (smooth, other);
            }
        }
        if !self.follows {
            // No resonance is known whose cycles could be counted.
            selection.base_follows = false;
            selection.reach.few_cycles = None;
        }
        self.data.input.clone_from(&self.excerpt.input);
        self.note_what_was_not_tried(&selection);
        Ok(selection)
    }

    /// Terms that can be tried on this recording.
    fn candidates(&self, scales: &Scales) -> Vec<Term> {
        let all = Term::tried(self.data.environments, self.data.input.is_some());
        // A window begins from a displacement and a velocity: what has states next to them begins
        // unknown each time.
        let begins = |t: &Term| self.data.windows.is_none() || (t.states() == 0 && t.noise().is_none());
        let shows = |t: &Term| !scales.at_once || at_once::shows(t);
        let all = all.into_iter().filter(shows);
        all.filter(|t| self.notes.broken.is_none() && begins(t) && !t.starts(scales).is_empty()).collect()
    }

    /// The base model with the input going another way between its samples, where that fits better
    /// than the terms chosen.
    fn on_another_input(&mut self, selection: &Selection, scales: &Scales) -> Option<Judged> {
        let settled = self.excerpt.input.as_ref().is_none_or(|i| i.interpolation != Interpolation::BandLimited);
        if settled || !self.data.trace.is_on(Gate::OtherInput) {
            return None;
        }
        // A stated form that departs bends what stands next to it: half a sample is seen where it
        // is free.
        let best = selection.departing.as_ref().map_or(&selection.chosen, |d| &d.judged);
        let how = base_model::other_input(&mut self.excerpt, best, scales)?;
        self.data.trace.acts(Step::of(Gate::OtherInput, best.words(), how.words()));
        self.notes.findings.push(base_model::interpolated(how));
        Some(base_again(&self.excerpt, selection, scales))
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

    /// Concludes on the model chosen, fitted to all samples but those that the model file keeps for
    /// the test.
    fn conclude(&mut self, selection: &Selection, scales: &Scales) -> Conclusion {
        let data = &mut self.data;
        if data.own_test {
            data.train.extend(data.validation.iter().cloned());
            order::sort_by_key(&mut data.train, |r| r.start as f64);
        }
        let conclusion = if self.is_whole() {
            conclude::conclude(&self.data, selection, scales)
        } else {
            self.excerpt.test.clone_from(&self.data.test);
            conclude::widened(conclude::conclude(&self.excerpt, selection, scales), &self.data, scales)
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

    /// Adds to a conclusion what free simulation shows.
    fn simulated(
        &self,
        selection: Selection,
        conclusion: Conclusion,
        scales: &Scales,
    ) -> (Selection, Conclusion, Simulation) {
        if self.is_whole() {
            return by_simulation::simulated(&self.data, selection, conclusion, scales);
        }
        let had = conclusion.named.len();
        let (selection, conclusion, simulation) =
            by_simulation::simulated(&self.excerpt, selection, conclusion, scales);
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
