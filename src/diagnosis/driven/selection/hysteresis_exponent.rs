//! Hysteresis with an exponent of its own, which the search keeps back: beside the stated law it would
//! fit whatever departs from that a little. It takes a place only where the data tell the exponent.

use crate::driven::identification::fit::{Fit, fit};
use crate::driven::identification::interval;
use crate::driven::intake::data::Data;
use crate::driven::intake::work::Budget;
use crate::gate::Gate;
use crate::parallel;
use crate::physics::hysteresis::{Hysteresis, Sharpness};
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::trace::Step;

use super::earned::{ITERATIONS, earned};
use super::forms::{LEAST_LEAD, UNDONE, with_instead};
use super::judged::{Departing, Judged, Selection, judge};
use super::residual_structure::residual_structure;
use super::rivals::TIE;

/// Most further heats of a fit that moves exponent and strength along each other.
const HEATS: usize = 4;
/// A heat that gains less log-likelihood than this was the last.
const AT_REST: f64 = 0.1;
/// Place of the exponent among the values of hysteresis.
const OF_MEMORY: usize = 3;
/// Exponents of a memory from which fits begin, beside the stated one.
const MEMORIES: [f64; 4] = [0.7, 1.0, 1.6, 2.6];

/// Puts hysteresis with its own exponent in the place of what departs, where the data tell that
/// exponent.
pub(super) fn settle_exponent(data: &Data, selection: &mut Selection, scales: &Scales, budget: Budget) {
    let search = Search { data, scales, tried: selection.tried, budget };
    let memory = data.trace.is_on(Gate::OwnSharpness).then(|| search.memory(selection)).flatten();
    if let Some(found) = memory {
        let lead = found.score() - selection.chosen.score();
        let step = Step::of(Gate::OwnSharpness, selection.chosen.words(), found.words());
        data.trace.acts(step.measured(lead, 0.0));
        take(selection, found);
    }
}

/// A model takes the place of the chosen one: what stood beside each of its terms and is not clearly
/// behind it stays its rival.
fn take(selection: &mut Selection, found: Judged) {
    let before = &selection.chosen.fit.structure.terms;
    let score = found.score();
    let rivals_of = |t: &Term, only: bool| {
        // The law of a power stands where the law of which it is a power stood.
        let place = before.iter().position(|b| b.id() == t.id()).or(only.then_some(0));
        let all = place.and_then(|p| selection.rivals.get(p)).into_iter().flatten();
        all.filter(|r| !found.has(r.id) && score - r.judged.score() < TIE).cloned().collect()
    };
    let only = before.len() == 1;
    selection.rivals = found.fit.structure.terms.iter().map(|t| rivals_of(t, only)).collect();
    selection.chosen = found;
    selection.departing = None;
}

struct Search<'a> {
    data: &'a Data,
    scales: &'a Scales,
    tried: usize,
    budget: Budget,
}

impl Search<'_> {
    fn is_over(&self) -> bool {
        self.data.work.is_spent(self.budget)
    }

    fn fitted(&self, model: &Fit, index: usize, term: Term, values: &[f64]) -> Option<Fit> {
        let (structure, point) = with_instead(model, index, term, values);
        fit(self.data, &structure, &point, self.scales, ITERATIONS)
    }

    /// The best of fits from these values of one law, taken further until it rests.
    fn best(&self, model: &Fit, index: usize, term: Term, starts: &[Vec<f64>]) -> Option<Judged> {
        let all: Vec<Fit> = parallel::filter_map(starts, |start| self.fitted(model, index, term, start));
        let mut best = all.into_iter().min_by(|a, b| a.variance.total_cmp(&b.variance))?;
        for _ in 0..HEATS {
            if best.converged || self.is_over() {
                break;
            }
            let Some(further) = fit(self.data, &best.structure, &best.point, self.scales, ITERATIONS) else { break };
            let gained = further.log_likelihood() - best.log_likelihood();
            if gained <= 0.0 {
                break;
            }
            best = further;
            if gained < AT_REST {
                break;
            }
        }
        Some(judge(self.data, best, self.scales))
    }

    /// Whether the interval of an exponent does not hold this one.
    fn is_apart(&self, model: &Fit, place: usize, known: f64) -> bool {
        let Some(free) = model.free.iter().position(|f| *f == place) else { return false };
        let (n, reach) = (model.point[place], interval::spread(model).reach[free]);
        // By its logarithm, as it is fitted.
        let holds = n * (-reach[0]).exp() <= known && known <= n * reach[1].exp();
        reach.iter().all(|r| r.is_finite()) && !holds
    }

    /// Whether a model leaves next to nothing, or no more than another.
    fn leaves_no_more(&self, model: &Judged, than: &Judged) -> bool {
        let left = |j: &Judged| residual_structure(self.data, &j.fit).r_squared;
        let found = left(model);
        found <= UNDONE || found <= left(than)
    }

    /// Hysteresis with an exponent in the place of one with n = 1 that was chosen; or of all that was
    /// chosen, where that leaves something, departs or is several laws.
    fn memory(&self, selection: &Selection) -> Option<Judged> {
        let chosen = &selection.chosen;
        let is_memory = |t: &Term| matches!(t, Term::Hysteresis(Hysteresis(Sharpness::One)));
        let own = chosen.fit.structure.terms.iter().position(is_memory);
        let beside = || {
            let leaves = selection.departing.is_some() || chosen.fit.structure.terms.len() > 1;
            let is_law = chosen.fit.structure.terms.iter().any(|t| t.role().acts_on_mass());
            let alone = selection.alone.iter().filter_map(|t| t.judged.as_ref());
            let mut all = alone.filter(|j| matches!(j.fit.structure.terms.as_slice(), [t] if is_memory(t)));
            if is_law && leaves { all.next() } else { None }
        };
        let (from, index) = match own {
            Some(index) => (chosen, index),
            None => (beside()?, 0),
        };
        if self.is_over() {
            return None;
        }
        let mut values = from.fit.structure.of(index, &from.fit.point).to_vec();
        values.insert(OF_MEMORY, 1.0);
        let starts: Vec<Vec<f64>> = MEMORIES
            .map(|n| {
                values[OF_MEMORY] = n;
                values.clone()
            })
            .to_vec();
        let found = self.best(&from.fit, index, Term::Hysteresis(Hysteresis(Sharpness::Own)), &starts)?;
        let found = Departing { judged: found, index }.pruned(self.data, self.scales, chosen.score());
        let Departing { judged: found, index } = found;
        let before = selection.departing.as_ref().map_or(chosen, |d| &d.judged);
        let fewer = found.fit.structure.terms.len() < before.fit.structure.terms.len();
        let lead = found.score() - before.score();
        let least = match (own.is_some(), fewer) {
            (true, true) => -LEAST_LEAD,
            (true, false) => LEAST_LEAD,
            (false, _) => TIE,
        };
        let is_earned = fewer || earned(self.data, chosen, &found, self.scales, self.tried).is_some();
        let holds = lead >= least
            && is_earned
            && !found.fit.at_bound(self.scales)
            && self.is_apart(&found.fit, found.fit.structure.first[index] + OF_MEMORY, 1.0)
            && self.leaves_no_more(&found, before);
        holds.then_some(found)
    }
}
