//! What keeps a name where the named terms do not account for the mismatch, and the model that such
//! a verdict quotes.

use crate::driven::selection::earned::without;
use crate::driven::selection::held_out::held_out;
use crate::driven::selection::judged::Judged;
use crate::driven::selection::residual_structure::residual_structure_of_noise;
use crate::driven::selection::term_worth::Named;
use crate::driven::verdict::dropped::Dropped;
use crate::gate::Gate;
use crate::trace::Step;

use super::draft::{Draft, Objection, UNMEASURED};
use super::second_resonance::{is_resolved, is_second_resonance};
use super::standing::FAR_ABOVE;

impl Draft<'_> {
    /// Leaves the names that hold by themselves, in the model that holds them and nothing else. In
    /// that model each must still be what its name says.
    pub(super) fn settle_unexplained(&mut self, r_squared: f64, tolerated: f64) {
        self.drop_stand_ins(r_squared, tolerated);
        self.drop_beside_no_base();
        self.keep_what_is_named();
        while let Some((index, objection)) = self.named.iter().find_map(|n| Some((n.index, self.stands_in(n)?))) {
            self.drop_for(index, objection);
            self.named.retain(|n| n.index != index);
            self.keep_what_is_named();
        }
    }

    /// Over a base model that the recording does not follow, whatever bends takes up most of the
    /// error: a law that leaves some has no name.
    fn drop_beside_no_base(&mut self) {
        if self.selection.base_follows || !self.data.trace.is_on(Gate::NoBase) {
            return;
        }
        for named in std::mem::take(&mut self.named) {
            self.drops(Gate::NoBase, &named, UNMEASURED);
            self.drop_term(named.index, Dropped::StandIn);
        }
    }

    /// Why a term cannot be told from what the library lacks, if it cannot: beside a misfit of the
    /// linear dynamics a mode takes up whatever is broad, and only a peak of its own is evidence of
    /// a resonance.
    fn stands_in(&self, named: &Named) -> Option<Objection> {
        let blurred = is_second_resonance(&self.term(named.index)) && !is_resolved(&self.model.fit, named.index);
        let gate = Gate::BlurredResonance;
        let blurred = || blurred.then(|| self.objects(named, gate, Dropped::NoSecondResonance, UNMEASURED)).flatten();
        self.misnamed(named).or_else(blurred)
    }

    /// The model of a verdict that explains nothing holds what it names and nothing else; and
    /// predicts no worse than the base.
    fn keep_what_is_named(&mut self) {
        let terms = self.model.fit.structure.terms.len();
        let named = |draft: &Self, index: usize| draft.named.iter().any(|n| n.index == index);
        for index in (0..terms).rev() {
            if named(self, index) {
                continue;
            }
            let reduced =
                if self.named.is_empty() { None } else { without(self.data, &self.model, index, &self.scales) };
            let Some(reduced) = reduced else {
                self.named.clear();
                break;
            };
            let held_out = held_out(self.data, &reduced.fit, &self.scales, &self.data.test);
            self.model = Judged { held_out, fit: reduced.fit };
            self.named.iter_mut().filter(|n| n.index > index).for_each(|n| n.index -= 1);
        }
        let ratio = self.model.held_out.free() / self.base.held_out.free();
        let step = || Step::of(Gate::PredictsWorse, self.model.words(), "base model").measured(ratio, 1.0);
        if self.named.is_empty() || ratio > 1.0 && self.data.trace.acts(step()) {
            self.named.clear();
            self.departing = None;
            self.model = self.base.clone();
        }
        if self.departing.is_none() && self.model.fit.structure.terms.len() < terms {
            self.after = residual_structure_of_noise(self.data, &self.model.fit);
        }
    }

    /// Beside a mismatch that stays unexplained, only what towers above the remainder holds by
    /// itself.
    fn drop_stand_ins(&mut self, r_squared: f64, tolerated: f64) {
        let bar = FAR_ABOVE * r_squared.max(tolerated);
        // Noise takes up whatever the library lacks: beside it the remainder is no measure, only
        // the noise itself is.
        let noisy = self.model.fit.structure.is_noisy();
        let least = |n: &Named| if noisy && !self.is_noise(n) { bar.max(FAR_ABOVE) } else { bar };
        let dominates = |n: &Named| n.growth >= least(n) || !self.drops(Gate::StandIn, n, [n.growth, least(n)]);
        let (towering, others): (Vec<Named>, Vec<Named>) = self.named.iter().cloned().partition(dominates);
        for n in others {
            self.drop_term(n.index, Dropped::StandIn);
        }
        self.named = towering;
        if self.data.trace.is_on(Gate::NoiseAlone) && self.named.iter().all(|n| self.is_noise(n)) {
            for named in std::mem::take(&mut self.named) {
                self.drops(Gate::NoiseAlone, &named, UNMEASURED);
            }
        }
    }
}
