//! Looks for other candidates that would do as well instead of a term that was chosen: a
//! better one takes it, an equal one is remembered, so that no name is given where the recording
//! cannot distinguish two.

use crate::control::{Control, Stopped};
use crate::driven::base::BASE;
use crate::driven::identification::fit::{Fit, fit};
use crate::driven::identification::refined_scales::refined;
use crate::driven::intake::data::Data;
use crate::driven::intake::work::Budget;
use crate::gate::Gate;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::trace::Step;

use super::candidates_round::round;
use super::earned::{ITERATIONS, earned, pruned, without};
use super::judged::{Judged, Rival, Selection, Trial, judge};

/// Times that a better stand-in may take a term's place.
const SWAPS: usize = 1;
/// Log-likelihood by which a stand-in must lead to take a term's place.
const LEAST_LEAD: f64 = 1.0;
/// Log-likelihood by which a model must lead to be distinguished from another: odds of 400 to 1.
pub(crate) const TIE: f64 = 6.0;

/// Returns whether the library states that one can be mistaken for the other.
pub(crate) fn alike(a: &Term, b: &Term) -> bool {
    a.candidate().confusable_with.contains(&b.id()) || b.candidate().confusable_with.contains(&a.id())
}

/// A look for other candidates that would do as well, as far as its budget reaches.
pub(super) struct Look<'a> {
    pub data: &'a Data,
    /// Sizes that the base fit found.
    pub scales: &'a Scales,
    pub candidates: &'a [Term],
    /// Work that it may spend.
    pub budget: Budget,
    /// States whether something was not looked at because that was spent.
    pub left_out: bool,
    /// Control that may stop it.
    pub control: &'a Control,
}

impl Look<'_> {
    /// Tries every other candidate instead of each chosen term.
    ///
    /// # Errors
    /// Stopped.
    pub(super) fn settle(&mut self, selection: &mut Selection) -> Result<(), Stopped> {
        for attempt in 0..=SWAPS {
            let stand_ins = self.stand_ins(selection)?;
            selection.stand_ins = if let [alone] = stand_ins.as_slice() { alone.clone() } else { Vec::new() };
            let score = selection.chosen.score();
            let ahead = |r: &Rival| r.judged.score() - score;
            let all = stand_ins.iter().enumerate().flat_map(|(i, others)| others.iter().map(move |r| (i, r)));
            let is_better = |r: &Rival| ahead(r) > LEAST_LEAD && self.data.trace.is_on(Gate::Swap);
            let mut better: Vec<(usize, &Rival)> = all.filter(|(_, r)| is_better(r)).collect();
            better.sort_by(|(_, a), (_, b)| ahead(b).total_cmp(&ahead(a)));
            let better = better.into_iter().find(|(place, r)| self.earns(selection, *place, &r.judged));
            let again = attempt < SWAPS && !self.data.work.is_spent(self.budget);
            match better {
                Some((place, better)) if again => {
                    self.data.trace.acts(swapped(selection, place, better));
                    selection.chosen = pruned(self.data, better.judged.clone(), self.scales, selection.tried);
                }
                // Too late to look around from there: what has been seen from here is weighed
                // against it.
                Some((place, better)) => {
                    self.data.trace.acts(swapped(selection, place, better));
                    let id = selection.chosen.fit.structure.terms[place].id();
                    let old = Rival { judged: selection.chosen.clone(), id };
                    selection.chosen = better.judged.clone();
                    let mut others = stand_ins.clone();
                    others.remove(place);
                    others.push(stand_ins[place].iter().cloned().chain([old]).collect());
                    selection.rivals = self.tied(&selection.chosen, others);
                    break;
                }
                None => {
                    selection.rivals = self.tied(&selection.chosen, stand_ins);
                    break;
                }
            }
        }
        Ok(())
    }

    /// Returns whether a stand-in earns the place that it would take, as the term in it did: one that leads on
    /// the fitted samples alone is a rival of that term, and no better name.
    fn earns(&self, selection: &Selection, place: usize, stand_in: &Judged) -> bool {
        let chosen = &selection.chosen;
        let alone = chosen.fit.structure.terms.len() == 1;
        let reduced = if alone { Some(selection.base.clone()) } else { without(self.data, chosen, place, self.scales) };
        reduced.is_some_and(|r| earned(self.data, &r, stand_in, self.scales, selection.tried).is_some())
    }

    /// For each chosen term, the other candidates that could be fitted in its place.
    fn stand_ins(&mut self, selection: &Selection) -> Result<Vec<Vec<Rival>>, Stopped> {
        let here = refined(self.data, &selection.chosen.fit, self.scales);
        let of_term = |(index, term): (usize, &Term)| {
            if self.is_over() {
                return Ok(Vec::new());
            }
            let others = self.in_place_of(selection, index, &here)?;
            let others = others.into_iter().filter(|t| t.term.id() != term.id());
            let any = selection.reach.tells_nothing_linear_apart();
            let fitted = others.filter_map(|t| {
                let judged = t.judged?;
                let is_near = any || alike(&t.term, term);
                let ended = is_near.then(|| self.to_its_end(&judged, &selection.chosen, &here)).flatten();
                Some(Rival { id: t.term.id(), judged: ended.unwrap_or(judged) })
            });
            Ok(fitted.filter(|r| !r.judged.fit.at_bound(&here)).collect())
        };
        selection.chosen.fit.structure.terms.iter().enumerate().map(of_term).collect()
    }

    /// Fits a stand-in on that stopped before it converged, from there and from the chosen model's numbers: only
    /// a finished fit can be beaten. `None` where it had converged, or gets no better.
    fn to_its_end(&self, stand_in: &Judged, chosen: &Judged, scales: &Scales) -> Option<Judged> {
        let Fit { structure, point, converged, variance, .. } = &stand_in.fit;
        let from = |start: &[f64]| fit(self.data, structure, start, scales, ITERATIONS);
        if *converged {
            return None;
        }
        let there: Vec<f64> = chosen.fit.point.iter().take(BASE).chain(point.iter().skip(BASE)).copied().collect();
        let ends = [from(point), from(&there)].into_iter().flatten().filter(|end| end.variance < *variance);
        let best = ends.min_by(|a, b| a.variance.total_cmp(&b.variance))?;
        Some(judge(self.data, best, self.scales))
    }

    /// Candidates instead of one chosen term: all that it can be mistaken for, and where it is
    /// the only one, all that were fitted. Under one line or two a law of any kind is seen at one
    /// amplitude and phase, and by harmonics if these are above the noise: there any can be mistaken
    /// for any other.
    fn in_place_of(&self, selection: &Selection, index: usize, scales: &Scales) -> Result<Vec<Trial>, Stopped> {
        let (data, candidates) = (self.data, self.candidates);
        let chosen = &selection.chosen;
        let term = &chosen.fit.structure.terms[index];
        let alone = chosen.fit.structure.terms.len() == 1;
        let reduced = if alone { Some(selection.base.clone()) } else { without(data, chosen, index, scales) };
        let Some(reduced) = reduced else { return Ok(Vec::new()) };
        let mut trials = if alone { selection.alone.clone() } else { Vec::new() };
        let any = selection.reach.tells_nothing_linear_apart();
        let is_candidate = |t: &Term| alike(t, term) || any && t.noise().is_none();
        let fitted = |t: &Term| trials.iter().any(|other| other.judged.is_some() && other.term == *t);
        let open: Vec<Term> = candidates
            .iter()
            .copied()
            .filter(|t| reduced.may_hold(t) && t.id() != term.id() && is_candidate(t) && !fitted(t))
            .collect();
        trials.extend(round(data, &reduced, &open, scales, open.len(), self.control)?);
        Ok(trials)
    }

    /// For each term of a model, the stand-ins that it does not clearly lead, each id once.
    fn tied(&self, chosen: &Judged, stand_ins: Vec<Vec<Rival>>) -> Vec<Vec<Rival>> {
        let score = chosen.score();
        let equal = |(term, others): (&Term, Vec<Rival>)| {
            let mut equal: Vec<Rival> = Vec::new();
            for rival in others {
                let behind = score - rival.judged.score();
                let is_new = !chosen.has(rival.id) && !equal.iter().any(|e| e.id == rival.id);
                let step =
                    Step { term: Some(rival.id), ..Step::of(Gate::Tie, "rival", format!("tied with {}", term.id())) };
                if behind < TIE && is_new && self.data.trace.acts(step.measured(behind, TIE)) {
                    equal.push(rival);
                }
            }
            equal
        };
        chosen.fit.structure.terms.iter().zip(stand_ins).map(equal).collect()
    }

    /// Returns whether the budget is spent; asked only where something would still have to be
    /// looked at.
    fn is_over(&mut self) -> bool {
        let over = self.data.work.is_spent(self.budget);
        self.left_out |= over;
        over
    }
}

/// Records that a better candidate takes a term's place.
fn swapped(selection: &Selection, place: usize, better: &Rival) -> Step {
    let term = selection.chosen.fit.structure.terms[place].id();
    let lead = better.judged.score() - selection.chosen.score();
    Step { term: Some(term), ..Step::of(Gate::Swap, term, better.id) }.measured(lead, LEAST_LEAD)
}
