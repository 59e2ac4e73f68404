//! Decides whether a term earns its place: by the samples that judge, or where these show less than
//! the fitted ones, by all samples in turn; and builds a model without the terms that do not.

use crate::driven::identification::fit::{Fit, Search, fit};
use crate::driven::intake::data::Data;
use crate::driven::simulation::structure::ModelStructure;
use crate::gate::Gate;
use crate::parallel;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::trace::Step;

use super::folds::{Fold, turned};
use super::held_out::{Comparison, compare, held_out};
use super::judged::{Judged, judge};

/// Level of the test on validation samples. Only the few candidates that are best on the fitted
/// samples come before it, at a penalty there of ln(tried), so that no further correction is due.
pub(crate) const LEVEL: f64 = 0.002;
/// Log-likelihood that a term must gain beyond what its parameters and the choice among candidates cost.
pub(crate) const PENALTY: f64 = 3.0;
/// Lead on the fitted samples at which validation samples that show nothing are doubted: what is
/// rare may have missed them.
pub(crate) const DOUBT: f64 = 25.0;
/// Iterations of one fit.
pub(crate) const ITERATIONS: usize = 14;

/// Evidence for a larger model against a reduced one that lacks some of its terms: the validation
/// samples, or where these show less than the fitted ones, all samples in turn.
pub(crate) fn earned(
    data: &Data,
    reduced: &Judged,
    larger: &Judged,
    scales: &Scales,
    tried: usize,
) -> Option<Comparison> {
    let added = larger.fit.structure.terms.iter().map(Term::id).find(|id| !reduced.has(id));
    let score_gain = larger.score() - reduced.score() - (tried.max(1) as f64).ln();
    let convinces = |c: &Comparison| c.p_value < LEVEL;
    let plain = compare(&reduced.held_out, &larger.held_out);
    if score_gain <= PENALTY || convinces(&plain) {
        return (score_gain > PENALTY).then_some(plain);
    }
    let doubted = score_gain > DOUBT && data.trace.is_on(Gate::InTurn);
    let in_turn = if doubted { in_turn(data, reduced, larger, scales) } else { None };
    let found = in_turn.filter(convinces)?;
    let step = Step { term: added, ..Step::of(Gate::InTurn, "tried", "earned") };
    data.trace.acts(step.measured(found.p_value, LEVEL));
    Some(found)
}

/// Compares two models on all samples, each third predicted from the others.
fn in_turn(data: &Data, reduced: &Judged, larger: &Judged, scales: &Scales) -> Option<Comparison> {
    let mut both = [reduced.held_out.clone(), larger.held_out.clone()];
    for Fold { train, validation } in turned(data) {
        let data = Data { train, validation, ..data.clone() };
        for (all, model) in both.iter_mut().zip([reduced, larger]) {
            let here = fit(&data, &model.fit.structure, &model.fit.point, scales, ITERATIONS)?;
            all.blocks.extend(held_out(&data, &here, scales, &data.validation).blocks);
        }
    }
    Some(compare(&both[0], &both[1]))
}

/// Drops every term whose absence costs nothing, the cheapest first.
pub(super) fn pruned(data: &Data, mut model: Judged, scales: &Scales, tried: usize) -> Judged {
    while model.fit.structure.terms.len() > 1 && data.trace.is_on(Gate::Pruned) {
        let reduced = parallel::map_indices(model.fit.structure.terms.len(), |i| without(data, &model, i, scales));
        let cheapest = reduced
            .into_iter()
            .flatten()
            .filter(|p| earned(data, p, &model, scales, tried).is_none())
            .max_by(|a, b| a.score().total_cmp(&b.score()));
        match cheapest {
            Some(reduced) => {
                let lead = model.score() - reduced.score();
                let gone = model.fit.structure.terms.iter().map(Term::id).find(|id| !reduced.has(id));
                let step = Step::of(Gate::Pruned, "in the model", "removed");
                data.trace.acts(Step { term: gone, ..step.measured(lead, (tried.max(1) as f64).ln() + PENALTY) });
                model = reduced;
            }
            None => break,
        }
    }
    model
}

/// A model refitted without one of its terms: at once, or where that breaks down, with the term
/// made smaller step by step. `None` only where neither leads to a model.
pub(crate) fn without(data: &Data, model: &Judged, index: usize, scales: &Scales) -> Option<Judged> {
    let (structure, point): (ModelStructure, Vec<f64>) = model.fit.without(index);
    let at_once = fit(data, &structure, &point, scales, ITERATIONS);
    Some(judge(data, at_once.or_else(|| continued(data, &model.fit, index, scales))?, scales))
}

/// Parts of its strength that a term passes through on the way to nothing.
const WAY: [f64; 5] = [0.7, 0.45, 0.25, 0.1, 0.03];
/// Iterations of the others at each.
const ON_THE_WAY: usize = 6;

/// A fit without one term, which is made smaller step by step while the others follow.
fn continued(data: &Data, model: &Fit, index: usize, scales: &Scales) -> Option<Fit> {
    let (first, term) = (model.structure.first[index], model.structure.terms[index]);
    let own = first..first + term.values();
    let strength = model.point[first];
    let mut here = model.clone();
    for part in WAY {
        let mut search = Search::all(data, &here.structure, &here.point, scales);
        search.free.retain(|i| !own.contains(i));
        search.point[first] = part * strength;
        let found = search.minimise(ON_THE_WAY)?;
        here.point = search.point(&found.z);
    }
    let (structure, point) = here.without(index);
    fit(data, &structure, &point, scales, ITERATIONS)
}
