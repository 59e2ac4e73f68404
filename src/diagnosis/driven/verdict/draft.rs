//! A conclusion in the making: models, their residuals, and the terms that still have a name. Not
//! for what speaks against a term (`objection`, `naming_rules`, `unexplained`).

use crate::driven::identification::fit::{Fit, fit};
use crate::driven::identification::local_minima::deepest;
use crate::driven::identification::step_length::enough;
use crate::driven::intake::data::Data;
use crate::driven::intake::work::{Budget, Stage};
use crate::driven::selection::held_out::{held_out, ratio_interval};
use crate::driven::selection::identifiability::FEWEST_CYCLES;
use crate::driven::selection::judged::{Departing, Judged, Rival, Selection};
use crate::driven::selection::residual_structure::{Residual, residual_structure_of_noise};
use crate::driven::selection::term_worth::{Named, growth, weighed};
use crate::driven::verdict::dropped::{Dropped, LeftOut};
use crate::gate::Gate;
use crate::parallel;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::remainder::Remainder;
use crate::ruling::Evidence;
use crate::trace::Step;

/// Objection against a term.
pub(super) struct Objection {
    pub(super) reason: Dropped,
    pub(super) step: Step,
}

/// For gates that compare no numbers.
pub(super) const UNMEASURED: [f64; 2] = [f64::NAN; 2];

/// A conclusion in the making.
pub(super) struct Draft<'a> {
    pub(super) data: &'a Data,
    pub(super) selection: &'a Selection,
    pub(super) scales: Scales,
    pub(super) budget: Budget,
    pub(super) base: Judged,
    pub(super) model: Judged,
    /// The model with the form of one law free, where that law departs from its stated form.
    pub(super) departing: Option<Departing>,
    /// Residual of the model; of the one with a free form, where there is one.
    pub(super) after: Residual,
    pub(super) rivals: Vec<Vec<Rival>>,
    pub(super) named: Vec<Named>,
    pub(super) dropped: Vec<(Term, Dropped)>,
    pub(super) left_out: Vec<LeftOut>,
}

impl<'a> Draft<'a> {
    /// Base and final model, as finely integrated as their numbers need, and judged.
    pub(super) fn fitted(data: &'a Data, selection: &'a Selection, scales: &Scales) -> Self {
        let budget = data.work.budget(Stage::Conclusion, data.hull.len());
        let refit = |old: &Fit, scales: &Scales| {
            fit(data, &old.structure, &old.point, scales, 20).unwrap_or_else(|| old.clone())
        };
        let (base, model) =
            parallel::join(|| refit(&selection.base.fit, scales), || refit(&selection.chosen.fit, scales));
        let model = deepest(data, model, scales);
        let fineness = enough(data, &model, scales);
        let scales = Scales { fineness, ..scales.clone() };
        let model =
            if model.steps == model.structure.steps(&model.point, &scales) { model } else { refit(&model, &scales) };
        let judge = |fit: Fit| Judged { held_out: held_out(data, &fit, &scales, &data.test), fit };
        let (base, model) = parallel::join(|| judge(base), || judge(model));
        let (after, rivals) = (residual_structure_of_noise(data, &model.fit), selection.rivals.clone());
        let (named, dropped, left_out) = (Vec::new(), Vec::new(), Vec::new());
        let departing = None;
        Self { data, selection, scales, budget, base, model, departing, after, rivals, named, dropped, left_out }
    }

    /// Fits the model with a free form like the others. Its residual counts: the stated form would
    /// leave its own inexactness besides.
    pub(super) fn free(&mut self, selection: &Selection) {
        let Some(found) = &selection.departing else { return };
        let old = &found.judged.fit;
        let fit = fit(self.data, &old.structure, &old.point, &self.scales, 20).unwrap_or_else(|| old.clone());
        self.after = residual_structure_of_noise(self.data, &fit);
        let held_out = held_out(self.data, &fit, &self.scales, &self.data.test);
        self.departing = Some(Departing { judged: Judged { fit, held_out }, index: found.index });
    }

    /// Returns whether the law whose form is free is named.
    pub(super) fn names(&self, departing: &Departing) -> bool {
        let id = departing.judged.fit.structure.terms[departing.index].id();
        self.named.iter().any(|n| self.term(n.index).id() == id)
    }

    /// Share of the innovations' variance that can still be predicted beyond chance, at this level.
    pub(super) fn structured(&self, level: f64) -> f64 {
        let after = &self.after.structure;
        if after.p_value < level { after.r_squared } else { 0.0 }
    }

    /// One term of the model.
    pub(super) fn term(&self, index: usize) -> Term {
        self.model.fit.structure.terms[index]
    }

    /// Returns whether it is a noise term.
    pub(super) fn is_noise(&self, named: &Named) -> bool {
        self.term(named.index).noise().is_some()
    }

    /// Takes a term's name, and records why.
    pub(super) fn drop_term(&mut self, index: usize, reason: Dropped) {
        let term = self.term(index);
        self.dropped.push((term, reason));
    }

    /// Takes a term's name for what speaks against it.
    pub(super) fn drop_for(&mut self, index: usize, objection: Objection) {
        self.data.trace.acts(objection.step);
        self.drop_term(index, objection.reason);
    }

    /// Returns whether a gate takes a term's name, with what was measured and its threshold.
    pub(super) fn drops(&self, gate: Gate, named: &Named, [value, threshold]: [f64; 2]) -> bool {
        self.data.trace.acts(Step::drops(gate, self.term(named.index).id()).measured(value, threshold))
    }

    /// Returns the objection that a gate has against a term, with what was measured and its
    /// threshold; nothing where it is switched off.
    pub(super) fn objects(
        &self,
        named: &Named,
        gate: Gate,
        reason: Dropped,
        [value, threshold]: [f64; 2],
    ) -> Option<Objection> {
        let step = Step::drops(gate, self.term(named.index).id()).measured(value, threshold);
        self.data.trace.is_on(gate).then_some(Objection { reason, step })
    }

    /// Weighs every term of the model.
    pub(super) fn weigh(&mut self) {
        self.named = weighed(self.data, self.selection, &self.model, &self.scales, &self.rivals, &self.base);
    }

    /// Returns how many times the final model's variance the terms removed.
    pub(super) fn removed(&self) -> f64 {
        self.base.fit.variance / self.model.fit.variance.max(1e-300) - 1.0
    }

    /// Named terms in whose place another does as well, in this recording or in any with this
    /// input.
    fn tied(&self) -> usize {
        let class = self.selection.reach.class(&self.model.fit.structure.terms);
        let in_class = |n: &Named| {
            let id = self.term(n.index).id();
            let step = || Step { term: Some(id), ..Step::of(Gate::LinearClass, "told apart", "tied") };
            class.contains(&id) && self.data.trace.acts(step())
        };
        self.named.iter().filter(|n| !n.rivals.is_empty() || in_class(n)).count()
    }

    /// Returns whether the recording is long enough for the base model, where anything is named
    /// next to it.
    fn is_base_determined(&self) -> bool {
        let step = |cycles| Step::of(Gate::FewCycles, "determined", "not determined").measured(cycles, FEWEST_CYCLES);
        let acts = |cycles| !self.named.is_empty() && self.data.trace.acts(step(cycles));
        !self.selection.reach.few_cycles.is_some_and(acts)
    }

    /// Collects the evidence of the verdict; `carried` is the growth of the error without the
    /// laws that stay in the model unnamed.
    pub(super) fn evidence(&self, carried: f64, stand_ins: bool, rounded: bool, remainder: Remainder) -> Evidence {
        let (model, base) = (&self.model, &self.base);
        let [after, before] = [model, base].map(|j| j.held_out.free());
        Evidence {
            named: self.named.len() + usize::from(rounded),
            departs: self.departing.is_some(),
            tied: self.tied(),
            stand_ins,
            // A base model whose error goes only with terms that earn no name is not adequate.
            nameless: self.removed(),
            remainder: remainder.size,
            // By what has a name: what is carried without one does not explain.
            removed: 1.0 - after * (1.0 + carried) / before.max(1e-300),
            carried: carried / growth(model, base).max(1e-300),
            search_complete: !self.selection.cut_short,
            has_power: self.after.structure.detectable_r_squared < 1.0,
            predicts_worse: after > before && self.named.iter().any(|n| !self.is_noise(n)),
            held_out_ratio: ratio_interval(&base.held_out, &model.held_out)[0],
            base_determined: self.is_base_determined(),
            base_follows: self.selection.base_follows,
        }
    }
}
