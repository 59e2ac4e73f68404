//! From the model chosen to what may be said of it: which terms hold, which are tied, what is left.

use crate::diagnosis::detection::Structure;
use crate::diagnosis::verdict::Outcome;
use crate::numerics::order;
use crate::parallel;

use super::fineness::enough;
use super::fit::{Data, Fit, fit};
use super::held_out::{Comparison, compare, held_out};
use super::interval::{self, Spread};
use super::quantisation::{Lattice, lattice};
use super::remainder::{left, loudest_by_chance, power_left};
use super::rivals::{Rival, alike};
use super::select::{Judged, SMALLEST_GAIN, Selection, without};
use super::term::{Scales, Term};
use super::valleys::deepest;

/// Share of the innovations' variance that may be foreseen before they are no longer called white.
pub const WHITE: f64 = 0.02;
/// A remainder of less than this share, with no candidate that earns a name, is too faint to say that the library fails.
const FAINT: f64 = 0.05;
/// Share of the innovations' power that may be foreseen before noise is no longer taken for the sensor's own.
const EVEN: f64 = 0.01;
/// Level at which structure counts as found.
const LEVEL: f64 = 1e-3;
/// Level at which a stretch louder than the others counts as found.
const LOUD: f64 = 1e-5;
/// With a remainder as structured as this, a term must stand far above it.
const COLOURED: f64 = 0.15;
/// How far.
const FAR_ABOVE: f64 = 30.0;
/// Part of all that is removed that a term must add to be named: a law is rarely truer than to three parts in a hundred of what
/// it does, and a tenth of a percent in power of it is no other effect.
const LEAST_PART: f64 = 1e-3;
/// The same for noise, which no law's inexactness but that of the simulation itself can imitate.
const LEAST_PART_OF_NOISE: f64 = 1e-5;
/// Part of the held-out error that must go before a coloured remainder may be called a detail.
const NEARLY_ALL: f64 = 0.99;

/// Laws that may be named together: to say that a model left out more at once claims more than one recording can show.
const MOST_LAWS: usize = 3;

/// One named term.
#[derive(Debug, Clone)]
pub struct Named {
    /// Its place in the model.
    pub index: usize,
    /// Fraction by which the innovations' variance grows without it, or the test error of free simulation if that is more.
    pub growth: f64,
    /// On validation samples, against the model without it.
    pub comparison: Comparison,
    /// Mean squared error of free simulation on the test samples without it.
    pub free_without: f64,
    /// Mean log-likelihood per test sample without it.
    pub log_score_without: f64,
    /// Log-likelihood that it gains where readings are known to be rounded, less the price of its parameters; else `None`.
    pub rounded_lead: Option<f64>,
    /// Candidates that would do as well.
    pub rivals: Vec<Rival>,
}

/// What may be said.
#[derive(Debug, Clone)]
pub struct Conclusion {
    /// The verdict.
    pub outcome: Outcome,
    /// The base model fitted like the final one.
    pub base: Judged,
    /// The final model.
    pub model: Judged,
    /// Terms that hold, strongest first.
    pub named: Vec<Named>,
    /// Terms that were in the model and do not hold, with the reason.
    pub dropped: Vec<(Term, &'static str)>,
    /// What is left of the final model's innovations.
    pub after: Structure,
    /// Coarse rounding, where it explains the remainder.
    pub lattice: Option<Lattice>,
    /// Uncertainty of the final model's parameters.
    pub spread: Spread,
    /// How finely the terms of the final models are integrated, as `Scales::fineness`.
    pub fineness: f64,
}

/// Draws the conclusion: models fitted to the train samples of `data`, judged on its test samples.
pub fn conclude(data: &Data, selection: &Selection, scales: &Scales) -> Conclusion {
    let refit =
        |old: &Fit, scales: &Scales| fit(data, &old.shape, &old.point, scales, 20).unwrap_or_else(|| old.clone());
    let (base, model) = parallel::join(|| refit(&selection.base.fit, scales), || refit(&selection.chosen.fit, scales));
    let model = deepest(data, model, scales);
    let fineness = enough(data, &model, scales);
    let scales = &Scales { fineness, ..scales.clone() };
    let model = if model.steps == model.shape.steps(&model.point, scales) { model } else { refit(&model, scales) };
    let judge = |fit: Fit| Judged { held_out: held_out(data, &fit, scales, &data.test), fit };
    let (base, mut model) = parallel::join(|| judge(base), || judge(model));
    let mut after = left(data, &model.fit);
    let mut dropped = Vec::new();
    let mut rivals = selection.rivals.clone();
    // What the full model leaves is the measure.
    let share = if after.p_value < LEVEL { after.share } else { 0.0 };
    let need = if share <= COLOURED { share } else { FAR_ABOVE * share };
    let mut named = weighed(data, selection, &model, scales, &rivals);
    // A term that the test samples speak against goes, and the others are weighed again without it.
    let worst = |named: &[Named], model: &Judged| {
        let all = named.iter().filter(|n| worse(n, model));
        all.min_by(|a, b| a.free_without.total_cmp(&b.free_without)).map(|n| n.index)
    };
    while let Some(index) = worst(&named, &model) {
        dropped.push((model.fit.shape.terms[index], "made the prediction of the test samples worse"));
        let Some(poorer) = without(data, &model, index, scales) else { break };
        model = Judged { held_out: held_out(data, &poorer.fit, scales, &data.test), fit: poorer.fit };
        if index < rivals.len() {
            rivals.remove(index);
        }
        after = left(data, &model.fit);
        named = weighed(data, selection, &model, scales, &rivals);
    }
    // What is known of rounded readings does not bear out what only follows the rounding.
    let bar = (selection.tried.max(1) as f64).ln() + 3.0;
    named.retain(|n| {
        let holds = n.rounded_lead.is_none_or(|lead| lead > bar);
        if !holds {
            dropped.push((
                model.fit.shape.terms[n.index],
                "follows only the rounding of the readings; carried along, not named",
            ));
        }
        holds
    });
    // What is smaller than the remainder, or than the other laws can be trusted, stays in the model, so that it does not bias
    // the others, but is not named.
    let need = need.max(SMALLEST_GAIN);
    let removed = base.fit.variance / model.fit.variance.max(1e-300) - 1.0;
    let (holds, carried): (Vec<Named>, Vec<Named>) = named.into_iter().partition(|n| {
        if model.fit.shape.terms[n.index].noise().is_some() {
            // Noise follows whatever is left: beside it, what is left must be next to nothing.
            return n.growth >= need.max(FAR_ABOVE * share).max(removed * LEAST_PART_OF_NOISE);
        }
        n.growth >= need.max(removed * LEAST_PART)
    });
    named = holds;
    let is_noise = |n: &&Named| model.fit.shape.terms[n.index].noise().is_some();
    let nameless: f64 = carried.iter().filter(|n| !is_noise(n)).map(|n| n.growth).sum();
    for n in carried {
        let reason = if n.growth < need {
            "smaller than what is still unexplained; carried along, not named"
        } else {
            "too small beside what the other terms explain to be told from their inexactness; carried along, not named"
        };
        dropped.push((model.fit.shape.terms[n.index], reason));
    }
    // Two terms that can be mistaken for each other, neither above the noise, are one thing that the library does not hold.
    let faint: Vec<usize> = named.iter().filter(|n| n.growth < 1.0).map(|n| n.index).collect();
    let term = |i: usize| model.fit.shape.terms[i];
    let twins: Vec<usize> =
        faint.iter().copied().filter(|i| faint.iter().any(|j| i != j && alike(&term(*i), &term(*j)))).collect();
    dropped.extend(twins.iter().map(|i| (term(*i), "only together with another that it can be mistaken for")));
    named.retain(|n| !twins.contains(&n.index));
    // Three that can all be mistaken for each other, or many laws at once, are the beginning of a series for something else;
    // whatever stands beside them was fitted to what they leave.
    let look_alikes = |i: usize| named.iter().filter(|n| n.index != i && alike(&term(i), &term(n.index))).count();
    let laws = named.iter().filter(|n| term(n.index).noise().is_none()).count();
    let series = laws > MOST_LAWS || named.iter().any(|n| look_alikes(n.index) > 1);
    if series {
        let reason = "only in a series: three that can be mistaken for each other, or more than three laws at once";
        dropped.extend(named.drain(..).map(|n| (term(n.index), reason)));
    }
    // Noise of the sensor's own keeps its strength whatever the sensor does; what does not is a stand-in for physics.
    let power = power_left(data, &model.fit);
    let tidy = !model.fit.shape.is_noisy() || power.share < EVEN || power.p_value > LEVEL;
    order::sort_by_key(&mut named, |n| -n.growth);
    let lattice = rounding(data, &model);
    let even = loudest_by_chance(&model.fit.linear.residual) > LOUD;
    let single = twins.is_empty() && !series;
    let white = tidy && even && single && (after.share < WHITE || after.p_value > LEVEL);
    // By what has a name: what is carried without one does not explain.
    let gone = 1.0 - model.held_out.free() * (1.0 + nameless) / base.held_out.free().max(1e-300);
    let something = !named.is_empty() || lattice.is_some();
    // A base model whose error goes only with terms that earn no name is not adequate.
    let nothing = !something && removed < FAINT;
    let outcome = if named.iter().any(|n| !n.rivals.is_empty()) {
        Outcome::Undecidable
    } else if something && (white || gone > NEARLY_ALL && single && !selection.cut_short) {
        Outcome::Explained
    } else if white && nothing {
        Outcome::Adequate
    } else if named.is_empty() && single && nothing && after.share < FAINT {
        Outcome::Undecidable
    } else {
        Outcome::Unexplained
    };
    if outcome == Outcome::Unexplained {
        // Only what towers above the remainder holds by itself.
        let bar = FAR_ABOVE * share.max(WHITE);
        // Noise takes up whatever the library lacks: beside it the remainder is no measure, only the noise itself is.
        let noisy = model.fit.shape.is_noisy();
        let towers = |n: &Named| {
            let physics = model.fit.shape.terms[n.index].noise().is_none();
            n.growth >= if noisy && physics { bar.max(FAR_ABOVE) } else { bar }
        };
        for n in named.iter().filter(|n| !towers(n)) {
            dropped.push((model.fit.shape.terms[n.index], "a stand-in: does not bring the residual to the noise"));
        }
        named.retain(towers);
        if named.iter().all(|n| model.fit.shape.terms[n.index].noise().is_some()) {
            named.clear();
        }
    }
    let mut spread = interval::spread(&model.fit);
    if outcome != Outcome::Unexplained {
        interval::profiled(data, &model.fit, scales, named.iter().map(|n| n.index), &mut spread);
    }
    Conclusion { outcome, base, model, named, dropped, after, lattice, spread, fineness }
}

/// The same conclusion with base and final model fitted to more samples than it was drawn on.
pub fn widened(c: Conclusion, data: &Data, scales: &Scales) -> Conclusion {
    let scales = &Scales { fineness: c.fineness, ..scales.clone() };
    let refit = |j: &Judged| -> Option<Judged> {
        let fit = fit(data, &j.fit.shape, &j.fit.point, scales, 12)?;
        Some(Judged { held_out: held_out(data, &fit, scales, &data.test), fit })
    };
    let (Some(base), Some(model)) = parallel::join(|| refit(&c.base), || refit(&c.model)) else { return c };
    let after = left(data, &model.fit);
    let mut spread = interval::spread(&model.fit);
    if c.outcome != Outcome::Unexplained {
        interval::profiled(data, &model.fit, scales, c.named.iter().map(|n| n.index), &mut spread);
    }
    Conclusion { base, model, after, spread, ..c }
}

/// Coarse rounding, where it explains what a model leaves.
fn rounding(data: &Data, model: &Judged) -> Option<Lattice> {
    lattice(&data.reading[data.hull.clone()], &model.fit.linear.residual).filter(|l| l.gain > 0.01)
}

/// A term that the test samples speak against.
fn worse(named: &Named, model: &Judged) -> bool {
    let term = model.fit.shape.terms[named.index];
    term.noise().is_none() && model.held_out.free() > 1.02 * named.free_without
}

/// Whether the samples that chose the terms have been fitted since.
fn validation_is_fitted(data: &Data) -> bool {
    data.validation.iter().any(|v| data.train.iter().any(|t| t.start < v.end && v.start < t.end))
}

fn weighed(data: &Data, selection: &Selection, model: &Judged, scales: &Scales, rivals: &[Vec<Rival>]) -> Vec<Named> {
    let rounded = rounding(data, model);
    let price = |j: &Judged| 0.5 * j.fit.free.len() as f64 * (data.train_len().max(2) as f64).ln();
    let weigh = |index: usize| {
        let poorer = without(data, model, index, scales)?;
        let unseen = if validation_is_fitted(data) { &data.test } else { &data.validation };
        let mut comparison =
            compare(&held_out(data, &poorer.fit, scales, unseen), &held_out(data, &model.fit, scales, unseen));
        comparison.p_value = (comparison.p_value * selection.tried as f64).min(1.0);
        let judged = held_out(data, &poorer.fit, scales, &data.test);
        Some(Named {
            index,
            growth: (poorer.fit.variance / model.fit.variance.max(1e-300))
                .max(judged.free() / model.held_out.free().max(1e-300))
                - 1.0,
            comparison,
            free_without: judged.free(),
            log_score_without: judged.log_score(poorer.fit.variance),
            rounded_lead: rounded.and_then(|l| {
                let without = lattice(&data.reading[data.hull.clone()], &poorer.fit.linear.residual)?;
                let rows = data.train_len() as f64;
                Some(rows * (l.log_score - without.log_score) - price(model) + price(&poorer))
            }),
            rivals: rivals.get(index).cloned().unwrap_or_default(),
        })
    };
    parallel::map_indices(model.fit.shape.terms.len(), weigh).into_iter().flatten().collect()
}
