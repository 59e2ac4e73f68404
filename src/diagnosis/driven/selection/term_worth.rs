//! Weighs each term of the final model: how the model fares without it, on fitted samples and on
//! others.
//!
//! Not what follows from that (`conclude`).

use crate::driven::intake::data::Data;
use crate::driven::selection::quantisation_grid::{QuantisationGrid, lattice};
use crate::parallel;
use crate::physics::scales::Scales;

use super::earned::without;
use super::held_out::{Comparison, HeldOut, compare, held_out};
use super::judged::{Judged, Rival, Selection};

/// Mean square of the test error with a term over that without it from which the test samples speak
/// against it.
pub(crate) const WORSE: f64 = 1.02;

/// Mean log-likelihood per sample that rounding must add to count.
pub(crate) const LEAST_ROUNDING_GAIN: f64 = 0.01;

/// A term of the final model and what it is worth.
#[derive(Debug, Clone)]
pub struct Named {
    /// Place of the term in the model.
    pub index: usize,
    /// Fraction by which the innovations' variance grows without it, or the test error of free
    /// simulation if that is more.
    pub growth: f64,
    /// Comparison with the model without it, on validation samples.
    pub comparison: Comparison,
    /// Errors on the test samples without it.
    pub without: HeldOut,
    /// Mean log-likelihood per test sample without it.
    pub log_score_without: f64,
    /// Candidates that would do as well.
    pub rivals: Vec<Rival>,
}

impl Named {
    /// Returns whether the test samples speak against it.
    pub fn worsens(&self, model: &Judged) -> bool {
        let term = model.fit.structure.terms[self.index];
        term.noise().is_none() && model.held_out.free() > WORSE * self.without.free()
    }
}

/// Coarse rounding, where it explains what a model leaves.
pub(crate) fn rounding(data: &Data, model: &Judged) -> Option<QuantisationGrid> {
    lattice(&data.reading[data.hull.clone()], &model.fit.linear.residual).filter(|l| l.gain > LEAST_ROUNDING_GAIN)
}

/// Returns by what fraction the error of another model is larger: of the innovations' variance, or of
/// free simulation on the test samples if that is more.
pub(crate) fn growth(model: &Judged, other: &Judged) -> f64 {
    let fitted = other.fit.variance / model.fit.variance.max(1e-300);
    fitted.max(other.held_out.free() / model.held_out.free().max(1e-300)) - 1.0
}

/// Returns whether the samples that chose the terms have been fitted since.
fn validation_is_fitted(data: &Data) -> bool {
    data.validation.iter().any(|v| data.train.iter().any(|t| t.start < v.end && v.start < t.end))
}

/// Weighs every term of a model. Where there is no model without it, however slowly it is taken
/// away, the base model stands in for that: a term that nothing can be fitted without is worth all
/// that the terms do together.
pub(crate) fn weighed(
    data: &Data,
    selection: &Selection,
    model: &Judged,
    scales: &Scales,
    rivals: &[Vec<Rival>],
    base: &Judged,
) -> Vec<Named> {
    let weigh = |index: usize| {
        let mut reduced = without(data, model, index, scales).unwrap_or_else(|| base.clone());
        let unseen = if validation_is_fitted(data) { &data.test } else { &data.validation };
        let mut comparison =
            compare(&held_out(data, &reduced.fit, scales, unseen), &held_out(data, &model.fit, scales, unseen));
        comparison.p_value = (comparison.p_value * selection.tried as f64).min(1.0);
        reduced.held_out = held_out(data, &reduced.fit, scales, &data.test);
        Named {
            index,
            growth: growth(model, &reduced),
            comparison,
            log_score_without: reduced.held_out.log_score(reduced.fit.variance),
            without: reduced.held_out,
            rivals: rivals.get(index).cloned().unwrap_or_default(),
        }
    };
    parallel::map_indices(model.fit.structure.terms.len(), weigh)
}
