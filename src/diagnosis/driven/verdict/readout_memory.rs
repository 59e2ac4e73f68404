//! Decides whether noise that a model has inside is the readout's, with a short memory.

use crate::driven::selection::earned::without;
use crate::driven::selection::held_out::held_out;
use crate::driven::selection::judged::Judged;
use crate::driven::selection::residual_structure::residual_structure_of_noise;
use crate::driven::verdict::dropped::Dropped;
use crate::gate::Gate;
use crate::numerics::moments::rms;
use crate::trace::Step;

use super::draft::Draft;

impl Draft<'_> {
    /// Readout noise whose neighbours are correlated is absorbed, in part, by noise inside the
    /// model. Where the model without any describes the readings as well once that memory is taken
    /// out, and nothing else is left, the noise is the readout's.
    pub(super) fn prefer_coloured_readout(&mut self) {
        let is_noise = |draft: &Self, i: usize| draft.term(i).noise().is_some();
        let terms = self.model.fit.structure.terms.len();
        let noisy: Vec<usize> = (0..terms).rev().filter(|i| is_noise(self, *i)).collect();
        let is_asked = self.data.windows.is_none() && self.data.trace.is_on(Gate::ColouredReadout);
        if noisy.is_empty() || self.departing.is_some() || !is_asked {
            return;
        }
        let mut lean = self.model.clone();
        for index in &noisy {
            let Some(reduced) = without(self.data, &lean, *index, &self.scales) else { return };
            lean = reduced;
        }
        let after = residual_structure_of_noise(self.data, &lean.fit);
        let Some(coloured) = &after.coloured else { return };
        let inside = rms(self.model.fit.linear.residual.iter().copied());
        let fresh = rms(coloured.whitened(&lean.fit.linear.residual));
        if fresh > inside {
            return;
        }
        for index in noisy {
            let step = Step::drops(Gate::ColouredReadout, self.term(index).id());
            self.data.trace.acts(step.measured(fresh / inside, 1.0));
            self.drop_term(index, Dropped::Coloured);
            if index < self.rivals.len() {
                self.rivals.remove(index);
            }
        }
        let held_out = held_out(self.data, &lean.fit, &self.scales, &self.data.test);
        self.model = Judged { held_out, fit: lean.fit };
        self.after = after;
    }
}
