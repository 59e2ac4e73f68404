//! Which terms keep a name beside what is left and beside each other.

use crate::driven::identification::fit::{Fit, fit as refitted};
use crate::driven::selection::earned::{ITERATIONS, SMALLEST_GAIN, without};
use crate::driven::selection::independence::{Explained, explained_by_known};
use crate::driven::selection::rivals::alike;
use crate::driven::selection::series::{Series, series};
use crate::driven::selection::smooth_course::is_smooth;
use crate::driven::selection::term_worth::Named;
use crate::driven::verdict::dropped::Dropped;
use crate::physics::law::Noise;
use crate::physics::library::Term;

use super::draft::Draft;
use super::form;

/// With a remainder as structured as this, a term must stand far above it.
const COLOURED: f64 = 0.15;
pub(super) const FAR_ABOVE: f64 = 30.0;
/// Part of all that is removed that a term must add to be named: a law is rarely truer than to
/// three parts in a hundred of what it does, and a tenth of a percent in power of it is no other
/// effect.
const LEAST_PART: f64 = 1e-3;
/// The same for noise, which no law's inexactness can imitate but that of the simulation itself and
/// that of its form.
const LEAST_PART_OF_NOISE: f64 = 1e-5;
/// Departure from the stated form, as a part of the law, above which it is not asked how far it may
/// be: as the square, the part of what a law removes that it may leave.
const MOST_DEPARTURE: f64 = 0.1;

impl Draft<'_> {
    /// Noise that follows what is known is no noise: a law is missing, and the noise has taken its
    /// place. Whether any does.
    pub(super) fn drop_noise_that_follows(&mut self) -> bool {
        if self.data.windows.is_some() {
            return false;
        }
        if !self.named.iter().any(|n| self.is_noise(n)) {
            return false;
        }
        let lean = self.only_named();
        let follows = |n: &Named| {
            let noise = self.term(n.index).noise()?;
            let found = explained_by_known(self.data, &lean, noise).filter(Explained::is_real)?;
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

    /// A walk goes where a smooth course of time describes the same errors better: then a law of
    /// time is missing or not exact. Whether one went.
    pub(super) fn drop_walk_that_is_smooth(&mut self) -> bool {
        let walk = self.named.iter().find(|n| self.term(n.index).noise() == Some(Noise::Walk)).map(|n| n.index);
        let Some(index) = walk.filter(|_| self.data.windows.is_none()) else { return false };
        let reduced = without(self.data, &self.model, index, &self.scales);
        if !reduced.is_some_and(|reduced| is_smooth(self.data, &reduced.fit, &self.model.fit)) {
            return false;
        }
        self.drop_term(index, Dropped::SmoothCourse);
        self.named.retain(|n| n.index != index);
        true
    }

    /// The model with its named terms alone, fitted. What is carried without a name says something
    /// of the noise too, and is not what the verdict states.
    fn only_named(&self) -> Fit {
        let mut fit = self.model.fit.clone();
        for index in (0..fit.structure.terms.len()).rev().filter(|i| self.named.iter().all(|n| n.index != *i)) {
            let (structure, point) = fit.without(index);
            let Some(found) = refitted(self.data, &structure, &point, &self.scales, ITERATIONS) else { continue };
            fit = found;
        }
        fit
    }

    /// What is known of rounded readings does not bear out what only follows the rounding.
    pub(super) fn drop_what_follows_rounding(&mut self) {
        let bar = (self.selection.tried.max(1) as f64).ln() + 3.0;
        let holds = |n: &Named| n.rounded_lead.is_none_or(|lead| lead > bar);
        let (holding, following): (Vec<Named>, Vec<Named>) = self.named.iter().cloned().partition(holds);
        self.named = holding;
        for n in following {
            self.drop_term(n.index, Dropped::FollowsRounding);
        }
    }

    /// What is smaller than the remainder, or than the other laws can be trusted, stays in the
    /// model, so that it does not bias the others, but is not named. How much of the variance these
    /// laws carry together.
    pub(super) fn carry_what_is_small(&mut self, r_squared: f64) -> f64 {
        let need = SMALLEST_GAIN.max(if r_squared <= COLOURED { r_squared } else { FAR_ABOVE * r_squared });
        let removed = self.removed();
        let inexactness = self.inexactness();
        let holds = |n: &Named| {
            if self.is_noise(n) {
                // Noise follows whatever is left: beside it, what is left must be next to nothing.
                let least = (removed * LEAST_PART_OF_NOISE).max(inexactness);
                return n.growth >= need.max(FAR_ABOVE * r_squared).max(least);
            }
            !self.pushes_along(n) && n.growth >= need.max(removed * LEAST_PART)
        };
        let (named, carried): (Vec<Named>, Vec<Named>) = self.named.iter().cloned().partition(holds);
        self.named = named;
        for n in &carried {
            let reason = if self.pushes_along(n) {
                Dropped::PushesAlong
            } else if n.growth < need {
                Dropped::SmallerThanTheRest
            } else {
                Dropped::WithinInexactness
            };
            self.drop_term(n.index, reason);
        }
        carried.iter().filter(|n| !self.is_noise(n)).map(|n| n.growth).sum()
    }

    /// Whether a term is a friction that pushes along the velocity: it does the work of another law
    /// beside those named.
    fn pushes_along(&self, named: &Named) -> bool {
        let strength = self.model.fit.structure.of(named.index, &self.model.fit.point).first();
        matches!(self.term(named.index), Term::CoulombFriction(_)) && strength.is_some_and(|f_c| *f_c < 0.0)
    }

    /// What the named laws may leave because they are not quite what their names say, in variances
    /// of the final model: of what each removes, the square of how far its form may depart; where
    /// that cannot be told, the part below which no law beside it would be named. Zero where no
    /// noise would take it up.
    fn inexactness(&self) -> f64 {
        if self.data.windows.is_some() || !self.named.iter().any(|n| self.is_noise(n)) {
            return 0.0;
        }
        let left = |n: &Named| {
            // What a course of time leaves is one of time, which noise is tested for by itself.
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
        let faint: Vec<usize> = self.named.iter().filter(|n| n.growth < 1.0).map(|n| n.index).collect();
        let has_twin = |i: usize| faint.iter().any(|j| i != *j && alike(&self.term(i), &self.term(*j)));
        let twins: Vec<usize> = faint.iter().copied().filter(|i| has_twin(*i)).collect();
        twins.iter().for_each(|i| self.drop_term(*i, Dropped::Twin));
        self.named.retain(|n| !twins.contains(&n.index));
        !twins.is_empty()
    }

    /// Nothing of a series has a name.
    pub(super) fn drop_series(&mut self) -> Option<Series> {
        let terms: Vec<Term> = self.named.iter().map(|n| self.term(n.index)).collect();
        let found = series(&terms)?;
        for n in std::mem::take(&mut self.named) {
            self.drop_term(n.index, Dropped::Series(found));
        }
        Some(found)
    }
}
