//! Decides what keeps a name where the named terms do not account for the mismatch, and which model
//! such a verdict quotes.

use crate::driven::selection::earned::without;
use crate::driven::selection::held_out::held_out;
use crate::driven::selection::judged::Judged;
use crate::driven::selection::residual_structure::residual_structure_of_noise;
use crate::driven::selection::term_worth::Named;
use crate::driven::verdict::dropped::Dropped;
use crate::gate::Gate;

use super::draft::{Draft, UNMEASURED};
use super::naming_rules::FAR_ABOVE;

impl Draft<'_> {
    /// Leaves the names that hold by themselves, in the model that holds them and nothing else. In
    /// that model each must still be what its name states.
    pub(super) fn settle_unexplained(&mut self, r_squared: f64, tolerated: f64) {
        self.drop_stand_ins(r_squared, tolerated);
        self.drop_beside_no_base();
        self.keep_what_is_named();
        while let Some((index, objection)) = self.named.iter().find_map(|n| Some((n.index, self.misnamed(n)?))) {
            self.drop_for(index, objection);
            self.named.retain(|n| n.index != index);
            self.keep_what_is_named();
        }
    }

    /// Over a base model that the recording does not follow, whatever bends absorbs most of the
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

    /// Keeps in the model of a verdict that explains nothing what it names and nothing else.
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
        if self.named.is_empty() {
            self.departing = None;
            self.model = self.base.clone();
        }
        if self.departing.is_none() && self.model.fit.structure.terms.len() < terms {
            self.after = residual_structure_of_noise(self.data, &self.model.fit);
        }
    }

    /// Next to a mismatch that stays unexplained, only what towers above the residual holds by
    /// itself.
    fn drop_stand_ins(&mut self, r_squared: f64, tolerated: f64) {
        let bar = FAR_ABOVE * r_squared.max(tolerated);
        // Noise absorbs whatever the library lacks: next to it the residual is no measure, only the
        // noise itself is.
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
