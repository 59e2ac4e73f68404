//! Laws that are sharp or smooth as the data say: a friction that falls with speed, and hysteresis with
//! an exponent. Each stands in the place of one whose own form leaves something.

use crate::gate::Gate;
use crate::physics::hysteresis::{Hysteresis, Sharpness};
use crate::physics::library::Term;
use crate::physics::shaped_friction::{Shape, ShapedFriction};
use crate::trace::Step;

use super::earned::earned;
use super::exponent_forms::{self, Search};
use super::free_forms::{LEAST_LEAD, UNDONE};
use super::judged::{Departing, Judged, Selection};
use super::residual_structure::residual_structure;
use super::rivals::TIE;

/// Place of the exponent among the values of hysteresis.
const OF_MEMORY: usize = 3;
/// Exponents of a memory from which fits begin, next to the stated one.
const MEMORIES: [f64; 4] = [0.7, 1.0, 1.6, 2.6];
/// Starting value of v_s, as a part of the motion's velocity, where the friction so far was sharp.
const SHARP: f64 = 0.03;
/// Starting values of r and of v_r, the latter as a part of the motion's velocity.
const FALLING: [(f64, f64); 4] = [(0.3, 0.15), (0.3, 0.5), (1.0, 0.15), (1.0, 0.5)];

/// Records for the trace that a friction was given a fitted shape.
pub(super) fn step(stated: &Judged, shaped: &Judged) -> Step {
    let lead = shaped.score() - stated.score();
    Step::of(Gate::OwnSharpness, stated.words(), shaped.words()).measured(lead, LEAST_LEAD)
}

impl Search<'_> {
    /// The model with a fitted shape of friction, or with damping by a power where that fits better; `None`
    /// where the friction as it is leaves nothing.
    pub(super) fn shaped(&self, chosen: &Judged) -> Option<Judged> {
        let found = self.data.trace.is_on(Gate::OwnSharpness).then(|| self.shape(chosen)).flatten()?;
        let departing = exponent_forms::shaped(&found).filter(|_| self.data.trace.is_on(Gate::OwnPower));
        Some(departing.and_then(|departing| self.power(chosen, &departing)).unwrap_or(found))
    }

    /// Returns whether a model leaves nothing. Noise in it absorbs what another law or shape would.
    pub(super) fn is_at_noise(&self, model: &Judged) -> bool {
        !model.fit.structure.is_noisy() && residual_structure(self.data, &model.fit).r_squared <= UNDONE
    }

    /// A friction that falls with speed instead of one that leaves something, begun where that ended.
    fn shape(&self, chosen: &Judged) -> Option<Judged> {
        let is_plain =
            |t: &Term| matches!(t, Term::CoulombFriction(_) | Term::ShapedFriction(ShapedFriction(Shape::Smooth)));
        let index = chosen.fit.structure.terms.iter().position(is_plain)?;
        if self.is_over() || self.is_at_noise(chosen) {
            return None;
        }
        let (own, v) = (chosen.fit.structure.of(index, &chosen.fit.point), self.scales.velocity);
        let v_s = own.get(1).copied().unwrap_or(SHARP * v);
        let starts = FALLING.map(|(r, part)| vec![own[0], v_s, r, part * v]);
        let of = |shape| self.best(&chosen.fit, index, Term::ShapedFriction(ShapedFriction(shape)), &starts);
        let found = [Shape::Falling, Shape::Bell].into_iter().filter_map(of);
        let found = found.max_by(|a, b| a.score().total_cmp(&b.score()))?;
        let Departing { judged: found, .. } =
            Departing { judged: found, index }.pruned(self.data, self.scales, chosen.score());
        let holds = found.score() - chosen.score() >= LEAST_LEAD
            && !found.fit.at_bound(self.scales)
            && earned(self.data, chosen, &found, self.scales, self.tried).is_some()
            && self.leaves_no_more(&found, chosen);
        holds.then_some(found)
    }

    /// Hysteresis with an exponent instead of one with n = 1 that was chosen; or of all that was
    /// chosen, where that leaves something, departs or is several laws.
    pub(super) fn memory(&self, selection: &Selection) -> Option<Judged> {
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
            && self.is_apart(&found.fit, found.fit.structure.first[index] + OF_MEMORY, 1.0, &[1.0])
            && self.leaves_no_more(&found, before);
        holds.then_some(found)
    }
}
