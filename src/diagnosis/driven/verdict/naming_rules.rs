//! Naming rules: they decide which terms keep a name next to the residual and next to each other.

use crate::driven::identification::fit::{Fit, fit as refitted};
use crate::driven::selection::earned::{ITERATIONS, without};
use crate::driven::selection::held_out::held_out;
use crate::driven::selection::independence::{Explained, explained_by_known};
use crate::driven::selection::judged::Judged;
use crate::driven::selection::rivals::alike;
use crate::driven::selection::smooth_course::is_smooth;
use crate::driven::selection::term_worth::{Named, growth};
use crate::driven::verdict::dropped::Dropped;
use crate::gate::Gate;
use crate::physics::law::Noise;
use crate::physics::library::Term;

use super::draft::{Draft, UNMEASURED};
use super::form;

/// Times the residual's structure that what is named next to it must stand above it.
pub(super) const FAR_ABOVE: f64 = 30.0;
/// Part of all that is removed that a term must add to be named: laws hold to about 3 %, so that what
/// is below 0.1 % of their power may be model error.
const LEAST_PART: f64 = 1e-3;
/// The same for noise, which no law's inexactness can imitate but that of the simulation itself and
/// that of its form.
const LEAST_PART_OF_NOISE: f64 = 1e-5;
/// Departure from the stated form, as a part of the law, above which it is not asked how far it may
/// be: as the square, the part of what a law removes that it may leave.
const MOST_DEPARTURE: f64 = 0.1;

/// Growth of the error without a term below which it is not above the noise.
const FAINT: f64 = 1.0;

impl Draft<'_> {
    /// Noise that follows what is known is no noise: a law is missing, and the noise has taken its
    /// place. Returns whether any does.
    pub(super) fn drop_noise_that_follows(&mut self) -> bool {
        let is_asked = self.data.windows.is_none() && self.data.trace.is_on(Gate::KnownSignal);
        if !is_asked || !self.named.iter().any(|n| self.is_noise(n)) {
            return false;
        }
        let lean = self.only_named();
        let follows = |n: &Named| {
            let noise = self.term(n.index).noise()?;
            let found = explained_by_known(self.data, &lean, noise).filter(Explained::is_real)?;
            self.drops(Gate::KnownSignal, n, [found.r_squared, found.least()]);
            let percent = (100.0 * found.r_squared.min(1.0)).round() as u8;
            Some((n.index, Dropped::Dependent { by: found.by, percent, is_power: found.is_power }))
        };
        let all: Vec<(usize, Dropped)> = self.named.iter().filter_map(follows).collect();
        for (index, reason) in &all {
            self.drop_term(*index, *reason);
            self.named.retain(|n| n.index != *index);
        }
        !all.is_empty()
    }

    /// A walk goes where a smooth trend describes the same errors better: then a law of time is
    /// missing or not exact. Returns whether one went.
    pub(super) fn drop_walk_that_is_smooth(&mut self) -> bool {
        let is_asked = self.data.windows.is_none() && self.data.trace.is_on(Gate::SmoothTrend);
        let walk = self.named.iter().find(|n| self.term(n.index).noise() == Some(Noise::Walk));
        let Some(walk) = walk.filter(|_| is_asked) else { return false };
        let index = walk.index;
        let reduced = without(self.data, &self.model, index, &self.scales);
        if !reduced.is_some_and(|reduced| is_smooth(self.data, &reduced.fit, &self.model.fit)) {
            return false;
        }
        self.drops(Gate::SmoothTrend, walk, UNMEASURED);
        self.drop_term(index, Dropped::SmoothCourse);
        self.named.retain(|n| n.index != index);
        true
    }

    /// The model with its named terms alone, fitted. What is carried without a name bears on the
    /// noise too, and is not what the verdict states.
    fn only_named(&self) -> Fit {
        self.keeping(|index| self.named.iter().any(|n| n.index == index))
    }

    /// The model with these of its terms alone, fitted.
    fn keeping(&self, keeps: impl Fn(usize) -> bool) -> Fit {
        let mut fit = self.model.fit.clone();
        for index in (0..fit.structure.terms.len()).rev().filter(|i| !keeps(*i)) {
            let (structure, point) = fit.without(index);
            let Some(found) = refitted(self.data, &structure, &point, &self.scales, ITERATIONS) else { continue };
            fit = found;
        }
        fit
    }

    /// Takes the name from what lies within the modelling error of the other laws; it stays in the model, so that
    /// it does not bias them. Returns the growth of the error without all of them: laws that stand in
    /// for each other each add little, and much together.
    pub(super) fn carry_what_is_small(&mut self) -> f64 {
        let removed = self.removed();
        let inexactness = self.inexactness();
        let reason = |n: &Named| {
            let below = |gate: Gate, least: f64| n.growth < least && self.drops(gate, n, [n.growth, least]);
            let is_detail = || match self.is_noise(n) {
                true => below(Gate::Inexactness, (removed * LEAST_PART_OF_NOISE).max(inexactness)),
                false => below(Gate::LeastPart, removed * LEAST_PART),
            };
            is_detail().then_some(Dropped::WithinInexactness)
        };
        let reasons: Vec<Option<Dropped>> = self.named.iter().map(reason).collect();
        let (mut carried, mut laws) = (Vec::new(), Vec::new());
        for (n, reason) in std::mem::take(&mut self.named).into_iter().zip(reasons) {
            match reason {
                None => self.named.push(n),
                Some(reason) => carried.push((n, reason)),
            }
        }
        for (n, reason) in carried {
            self.drop_term(n.index, reason);
            if !self.is_noise(&n) {
                laws.push(n.index);
            }
        }
        if laws.is_empty() {
            return 0.0;
        }
        let without = self.keeping(|index| !laws.contains(&index));
        let held_out = held_out(self.data, &without, &self.scales, &self.data.test);
        growth(&self.model, &Judged { fit: without, held_out }).max(0.0)
    }

    /// Returns what the named laws may leave because they are not quite what their names state, in
    /// variances of the final model: of what each removes, the square of how far its form may
    /// depart; where that is unknown, the part below which no law next to it would be named. Zero
    /// where no noise would absorb it.
    fn inexactness(&self) -> f64 {
        if self.data.windows.is_some() || !self.named.iter().any(|n| self.is_noise(n)) {
            return 0.0;
        }
        let left = |n: &Named| {
            // What a trend leaves is one of time, which noise is tested for by itself.
            if matches!(self.term(n.index), Term::WarmUp(_) | Term::BiasDrift(_)) {
                return 0.0;
            }
            let form = form::form(self.data, &self.model, n.index, &self.scales, None);
            n.growth * form.map_or(LEAST_PART, |f| f.ci95[1].min(MOST_DEPARTURE).powi(2))
        };
        self.named.iter().filter(|n| !self.is_noise(n)).map(left).sum()
    }

    /// Two terms that can be mistaken for each other, neither above the noise, are one thing that
    /// the library does not hold.
    pub(super) fn drop_twins(&mut self) -> bool {
        let faint: Vec<&Named> = self.named.iter().filter(|n| n.growth < FAINT).collect();
        let is_twin = |n: &Named| {
            let mut others = faint.iter().filter(|other| other.index != n.index);
            others.any(|other| alike(&self.term(n.index), &self.term(other.index)))
                && self.drops(Gate::Twins, n, [n.growth, FAINT])
        };
        let twins: Vec<usize> = faint.iter().filter(|n| is_twin(n)).map(|n| n.index).collect();
        twins.iter().for_each(|i| self.drop_term(*i, Dropped::Twin));
        self.named.retain(|n| !twins.contains(&n.index));
        !twins.is_empty()
    }
}
