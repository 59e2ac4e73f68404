//! Free forms, for laws that are near the library's and not it: each law that was chosen is given
//! freedom in its form, and what that absorbs is no second effect. A law whose free form predicts
//! samples better that were not fitted departs from its name.
//!
//! Not for how far it departs (`verdict::form`) and not for what follows for the verdict
//! (`ruling`).

use crate::driven::base::OFFSET;
use crate::driven::identification::fit::{Fit, Search, fit};
use crate::driven::intake::data::Data;
use crate::driven::intake::work::Budget;
use crate::driven::simulation::run::trace;
use crate::driven::simulation::structure::ModelStructure;
use crate::gate::Gate;
use crate::numerics::least_squares::Residuals;
use crate::numerics::moments::rms;
use crate::physics::free_form::{Argument, Extent, FreeForm, Freed};
use crate::physics::law::Law;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::physics::stiffness_drift::StiffnessDrift;
use crate::trace::Step;

use super::earned::{ITERATIONS, earned, without};
use super::heats::best_of;
use super::held_out::compare;
use super::identifiability::is_linear;
use super::judged::{Departing, Judged, Rival, Selection, judge};
use super::residual_structure::residual_structure;
use super::rivals::TIE;

/// Log-likelihood that a law's free form must gain, beyond what its values cost, to be
/// distinguished from the stated one.
pub(super) const LEAST_LEAD: f64 = 3.0;
/// Log-likelihood that one linear step must promise for the free form of a law to be fitted.
const LEAST_PROMISE: f64 = 8.0;
/// Laws next to the chosen ones that are tried alone with a free form, of those that were fitted
/// alone.
const OTHERS: usize = 4;
/// Share of the residual's variance from which on one law with a free form is tried instead of
/// all.
pub(super) const UNDONE: f64 = 0.02;
/// Terms beyond which a model is that of a series.
pub(super) const MANY: usize = 3;
/// Gain on samples that were not fitted below which a departure changes no prediction beyond noise.
pub(super) const IMMATERIAL: f64 = 0.02;

/// Values of a law's argument on the samples that are fitted.
pub(crate) fn visits(data: &Data, fit: &Fit, argument: Argument) -> Vec<f64> {
    let rows = || data.train.iter().flat_map(Clone::clone).map(|k| k - data.hull.start);
    match argument {
        Argument::Input => {
            let values = data.input.as_ref().map(|i| &i.samples()[data.hull.clone()]);
            values.map_or_else(Vec::new, |u| rows().map(|k| u[k]).collect())
        }
        Argument::Time => rows().map(|k| (k + data.hull.start) as f64 * data.interval_s()).collect(),
        Argument::Displacement | Argument::Velocity => {
            let (_, states) = trace(data, &fit.structure, &fit.point, &fit.run(data, false));
            let values = if argument == Argument::Velocity { states.v } else { states.x };
            rows().map(|k| values[k]).filter(|v| v.is_finite()).collect()
        }
    }
}

/// Returns the law to free, where the term has a form that can be freed.
fn freed_law(term: &Term) -> Option<Freed> {
    match term {
        Term::CubicStiffness(_) => Some(Freed::CubicSpring),
        Term::QuadraticStiffness(_) => Some(Freed::QuadraticSpring),
        Term::QuadraticDamping(_) => Some(Freed::Drag),
        Term::SqueezeFilmDamping(_) => Some(Freed::Film),
        Term::DriveNonlinearity(_) => Some(Freed::Drive),
        Term::EndStop(stop) => Some(Freed::Stop(stop.0)),
        Term::StiffnessDrift(StiffnessDrift { environment: None }) => Some(Freed::Drift),
        Term::ReadoutNonlinearity(_) => Some(Freed::Readout),
        _ => None,
    }
}

/// Returns whether the stated form may promise nothing where a near one does all: a corner in the
/// middle of the motion is no square and no cube.
fn is_unseen_as_stated(term: &Term) -> bool {
    matches!(term, Term::ReadoutNonlinearity(_))
}

/// A typical argument of a law, and the size by which its free form is measured; `None` where it
/// never moves.
fn sizes(data: &Data, model: &Fit, law: Freed, stated: &[f64]) -> Option<(f64, f64)> {
    let values = visits(data, model, law.argument());
    let typical = rms(values.iter().copied());
    let size = match law {
        Freed::Stop(_) => {
            let furthest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            0.5 * (furthest - stated[1]).max(0.02 * furthest)
        }
        _ => 2.0 * typical,
    };
    (size > 0.0 && size.is_finite()).then_some((typical, size))
}

/// A model with another term instead of one of its own.
pub(super) fn with_instead(model: &Fit, index: usize, term: Term, values: &[f64]) -> (ModelStructure, Vec<f64>) {
    let mut terms = model.structure.terms.clone();
    terms[index] = term;
    let structure = ModelStructure::over(&terms, model.structure.further);
    // In every recording its states begin at zero.
    let own = values.iter().copied().chain(std::iter::repeat(0.0)).take(structure.block(index).len());
    let mut point = model.point.clone();
    point.splice(model.structure.block(index), own);
    (structure, point)
}

/// Returns what one linear step from the stated form promises, as a log-likelihood; infinite for
/// laws with a corner, where it is unknown.
fn promise(data: &Data, structure: &ModelStructure, point: &[f64], scales: &Scales) -> f64 {
    let search = Search::all(data, structure, point, scales);
    let Some(linear) = search.linearise(&search.z(point)) else { return f64::INFINITY };
    let (rows, normal) = (linear.residual.len() as f64, linear.normal());
    0.5 * rows * (normal.sum / normal.predicted().max(1e-300)).ln()
}

/// A model with the form of one of its laws freed, fitted; `None` where the law has no form to
/// free, or where one linear step promises nothing. All of the form is free where that promises
/// more than one value does.
pub(crate) fn freed(data: &Data, model: &Fit, index: usize, scales: &Scales, screened: bool) -> Option<Fit> {
    let law = freed_law(&model.structure.terms[index])?;
    let stated = model.structure.of(index, &model.point);
    let (typical, size) = sizes(data, model, law, stated)?;
    let best = |model: &Fit, term: Term, starts: &[Vec<f64>]| {
        let starts: Vec<_> = starts.iter().map(|start| with_instead(model, index, term, start)).collect();
        best_of(data, &starts, scales)
    };
    let wide = FreeForm { law, size, extent: Extent::Wide };
    let narrow = FreeForm { extent: Extent::Narrow, ..wide };
    let starts = narrow.narrow_starts(stated, typical);
    if screened && !wide.has_corner() {
        let all = wide.wide_starts(&starts[0], typical);
        let (structure, point) = with_instead(model, index, Term::FreeForm(wide), &all[0]);
        if promise(data, &structure, &point, scales) < LEAST_PROMISE {
            return None;
        }
    }
    let first = best(model, Term::FreeForm(narrow), &starts)?;
    let starts = wide.wide_starts(first.structure.of(index, &first.point), typical);
    let (structure, point) = with_instead(&first, index, Term::FreeForm(wide), &starts[0]);
    if !wide.has_corner() && promise(data, &structure, &point, scales) < LEAST_PROMISE {
        return Some(first);
    }
    let second = best(&first, Term::FreeForm(wide), &starts);
    let better = |second: &Fit| {
        let penalty = 0.5 * (second.free.len() - first.free.len()) as f64 * (first.linear.residual.len() as f64).ln();
        second.log_likelihood() - first.log_likelihood() > penalty
    };
    second.filter(better).or(Some(first))
}

/// Returns whether the model chosen is one law that brings the error to the noise and may all the
/// same be a law near another one: a corner of the reading where there is an edge of some other
/// kind, and any law under one line or two.
fn may_be_another(selection: &Selection) -> bool {
    match selection.chosen.fit.structure.terms.as_slice() {
        [Term::ReadoutSaturation(_)] => true,
        // Springs and stops are distinguished elsewhere (`stop_or_spring`).
        [Term::EndStop(_)] => false,
        [term] => selection.reach.tells_nothing_linear_apart() && term.noise().is_none() && !is_linear(term),
        _ => false,
    }
}

/// Ties the first term with these laws.
fn add_rivals<'r>(data: &Data, selection: &mut Selection, further: impl Iterator<Item = &'r Rival>) {
    for rival in further {
        if selection.rivals.is_empty() {
            selection.rivals.push(Vec::new());
        }
        let is_new = !selection.rivals[0].iter().any(|r| r.id == rival.id) && !selection.chosen.has(rival.id);
        let step = || Step::of(Gate::FreeRival, "rival", format!("tied with {}", selection.chosen.words()));
        if is_new && data.trace.acts(Step { term: Some(rival.id), ..step() }) {
            selection.rivals[0].push(rival.clone());
        }
    }
}

/// Returns laws next to the chosen ones whose forms are freed, each alone.
fn others(selection: &Selection, scales: &Scales) -> Vec<Fit> {
    let is_free = |fit: &Fit| freed_law(&fit.structure.terms[0]).is_some();
    let fitted = selection.alone.iter().filter_map(|t| t.judged.as_ref().map(|j| j.fit.clone()));
    let mut all: Vec<Fit> = fitted.filter(is_free).take(OTHERS).collect();
    if may_be_another(selection) {
        let further = selection.stand_ins.iter().map(|r| &r.judged.fit).filter(|fit| is_free(fit));
        for fit in further {
            if !all.iter().any(|known| known.structure.terms == fit.structure.terms) {
                all.push(fit.clone());
            }
        }
    }
    let is_tied = may_be_another(selection) && selection.rivals.iter().any(|r| !r.is_empty());
    for term in selection.alone.iter().map(|t| t.term) {
        let Some(start) = term.starts(scales).first().cloned() else { continue };
        let from = |base: Fit| {
            let (structure, point) = base.with(term, &start);
            Fit { structure, point, ..base }
        };
        let is_known = all.iter().any(|fit| fit.structure.terms == [term]);
        if !is_known && (is_unseen_as_stated(&term) || is_tied && freed_law(&term).is_some()) {
            all.push(from(selection.base.fit.clone()));
        }
        if is_unseen_as_stated(&term) {
            // Before the others, as these may end in a form that is far from it.
            all.splice(0..0, at_rails(&selection.chosen.fit, scales).into_iter().map(from));
        }
    }
    all
}

/// A model that clips, without its terms and with its offset at a rail: what is flat on one side of
/// the motion may be the middle of a dead zone.
fn at_rails(clipping: &Fit, scales: &Scales) -> Vec<Fit> {
    let is_clipped = |t: &Term| matches!(t, Term::ReadoutSaturation(_));
    let Some(index) = clipping.structure.terms.iter().position(is_clipped) else { return Vec::new() };
    let structure = ModelStructure::over(&[], clipping.structure.further);
    let (low, high) = scales.output_range;
    let visited = clipping.structure.of(index, &clipping.point).iter().filter(|rail| low < **rail && **rail < high);
    let at = |rail: &f64| {
        let mut point = clipping.point[..structure.parameters].to_vec();
        point[OFFSET] = *rail;
        Fit { structure: structure.clone(), point, ..clipping.clone() }
    };
    visited.map(at).collect()
}

impl Departing {
    /// Id of the law that is free.
    fn id(&self) -> &'static str {
        self.judged.fit.structure.terms[self.index].id()
    }

    /// Removes its terms, other than the one that is free, that are not worth what they cost next
    /// to it.
    pub(super) fn pruned(mut self, data: &Data, scales: &Scales, least: f64) -> Self {
        loop {
            let others = (0..self.judged.fit.structure.terms.len()).filter(|j| *j != self.index);
            let reduced = others.filter_map(|j| Some((j, without(data, &self.judged, j, scales)?)));
            let bar = self.judged.score().max(least) - LEAST_LEAD;
            let idle = reduced.filter(|(_, p)| p.score() >= bar);
            let Some((j, reduced)) = idle.max_by(|a, b| a.1.score().total_cmp(&b.1.score())) else { return self };
            self = Self { judged: reduced, index: self.index - usize::from(j < self.index) };
        }
    }

    /// The same terms with the form as stated, fitted.
    pub(super) fn as_stated(&self, data: &Data, like: &Fit, scales: &Scales) -> Option<Judged> {
        let freed = &self.judged.fit;
        let id = self.id();
        let place = like.structure.terms.iter().position(|t| t.id() == id)?;
        let (structure, point) =
            with_instead(freed, self.index, like.structure.terms[place], like.structure.of(place, &like.point));
        Some(judge(data, fit(data, &structure, &point, scales, ITERATIONS)?, scales))
    }
}

/// Frees the forms of the laws chosen, and where these are several or leave something, that of each
/// law that does well alone. Where a free form does the work of more than one term, or predicts
/// better, the selection holds its law and no more than still earns its place next to it.
pub(crate) fn decide(data: &Data, selection: &mut Selection, scales: &Scales, budget: Budget) {
    let chosen = selection.chosen.clone();
    let tried = selection.tried;
    let laws = chosen.fit.structure.terms.iter().filter(|t| t.noise().is_none()).count();
    let is_empty = laws == 0 && chosen.fit.structure.terms.is_empty();
    if is_empty || !data.trace.is_on(Gate::FreeForm) {
        return;
    }
    let mut best: Option<(Departing, Fit)> = None;
    let consider = |best: &mut Option<(Departing, Fit)>, found: Departing, like: &Fit| {
        if best.as_ref().is_none_or(|(b, _)| found.judged.score() > b.judged.score()) {
            *best = Some((found, like.clone()));
        }
    };
    // No freedom of one law ends a series that is far from done.
    let is_series = chosen.fit.structure.terms.len() > MANY && residual_structure(data, &chosen.fit).r_squared > UNDONE;
    let own = if is_series { 0 } else { chosen.fit.structure.terms.len() };
    for index in 0..own {
        if data.work.is_spent(budget) {
            break;
        }
        // Where another term may only patch this law's form, the form is free to do so itself,
        // whatever one step promises.
        let Some(found) = freed(data, &chosen.fit, index, scales, chosen.fit.structure.terms.len() == 1) else {
            continue;
        };
        let found = Departing { judged: judge(data, found, scales), index }.pruned(data, scales, chosen.score());
        consider(&mut best, found, &chosen.fit);
    }
    // Ahead of both what was chosen and its own free form, another law may take its place.
    let mut as_good: Vec<(f64, Rival)> = Vec::new();
    // What is as likely with more freedom is nothing that parsimony could settle between laws that
    // are indistinguishable in any case.
    let mut freer: Vec<Rival> = Vec::new();
    let likelihoods = best.iter().map(|(own, _)| own.judged.fit.log_likelihood());
    let most_likely = likelihoods.fold(chosen.fit.log_likelihood(), f64::max);
    let (mut other_best, mut left_out): (Option<(Departing, Fit)>, bool) = (None, false);
    let bar = best.as_ref().map_or(chosen.score(), |(own, _)| own.judged.score().max(chosen.score()));
    let is_doubtful = chosen.fit.structure.terms.len() > 1 || may_be_another(selection);
    if is_doubtful || residual_structure(data, &chosen.fit).r_squared > UNDONE {
        for other in others(selection, scales) {
            let same = |b: &Departing| {
                b.judged.fit.structure.terms.len() == 1
                    && b.judged.fit.structure.terms[0].id() == other.structure.terms[0].id()
            };
            if best.as_ref().is_some_and(|(b, _)| same(b)) {
                continue;
            }
            if data.work.is_spent(budget) {
                left_out = may_be_another(selection);
                break;
            }
            let Some(found) = freed(data, &other, 0, scales, false) else { continue };
            let found = Departing { judged: judge(data, found, scales), index: 0 };
            if !may_be_another(selection) {
                consider(&mut best, found, &other);
                continue;
            }
            // At the end of its range a form is that of another law.
            let lead = found.judged.score() - bar;
            let is_as_likely = found.judged.fit.log_likelihood() > most_likely - TIE;
            if chosen.has(found.id()) || lead < -TIE && !is_as_likely || found.judged.fit.at_bound(scales) {
                continue;
            }
            let stated = found.as_stated(data, &other, scales);
            let stated = stated.filter(|s| !s.fit.at_bound(scales));
            let rival = stated.map(|judged| (found.judged.score(), Rival { id: found.id(), judged }));
            if lead < -TIE {
                freer.extend(rival.map(|(_, rival)| rival));
                continue;
            }
            as_good.extend(rival);
            if lead > TIE {
                consider(&mut other_best, found, &other);
            }
        }
    }
    selection.rivals_left_out |= left_out;
    best = other_best.or(best);
    selection.rivals.resize_with(chosen.fit.structure.terms.len(), Vec::new);
    add_rivals(data, selection, as_good.iter().map(|(_, rival)| rival));
    if selection.rivals.iter().any(|rivals| !rivals.is_empty()) {
        add_rivals(data, selection, freer.iter());
    }
    let Some((found, like)) = best else { return };
    let fewer = found.judged.fit.structure.terms.len() < chosen.fit.structure.terms.len();
    let score_gain = found.judged.score() - chosen.score();
    // In the place of a law that does as well, another one is only its rival.
    let least = match fewer {
        true => -LEAST_LEAD,
        false if chosen.has(found.id()) => LEAST_LEAD,
        false => TIE,
    };
    if score_gain < least {
        return;
    }
    // Of many terms none but the strongest is named: where freedom in one form does not end them,
    // they stay as details.
    if chosen.fit.structure.terms.len() > MANY && residual_structure(data, &found.judged.fit).r_squared > UNDONE {
        return;
    }
    let Some(stated) = found.as_stated(data, &like, scales) else { return };
    let gain = compare(&stated.held_out, &found.judged.held_out);
    let departs = earned(data, &stated, &found.judged, scales, tried).is_some() && gain.gain >= IMMATERIAL;
    if !departs && !fewer {
        return;
    }
    let after = if departs { format!("{}, departing from its form", stated.words()) } else { stated.words() };
    data.trace.acts(Step::of(Gate::FreeForm, chosen.words(), after).measured(score_gain, least));
    selection.rivals = stated
        .fit
        .structure
        .terms
        .iter()
        .map(|term| {
            let place = chosen.fit.structure.terms.iter().position(|t| t.id() == term.id());
            let rivals = place.and_then(|p| selection.rivals.get(p)).into_iter().flatten();
            rivals.filter(|rival| !stated.has(rival.id)).cloned().collect()
        })
        .collect();
    selection.chosen = stated;
    let near = as_good.iter().filter(|(score, rival)| *score > found.judged.score() - TIE && rival.id != found.id());
    add_rivals(data, selection, near.map(|(_, rival)| rival));
    selection.departing = departs.then_some(found);
}
