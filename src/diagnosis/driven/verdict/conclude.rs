//! Concludes from the model chosen: which terms hold, which are indistinguishable, and what the
//! residual is.

use crate::detection::Predictability;
use crate::driven::base::OMEGA;
use crate::driven::identification::fit::{Fit, fit};
use crate::driven::identification::interval::{self, Spread};
use crate::driven::intake::data::Data;
use crate::driven::intake::work::{Budget, Stage};
use crate::driven::selection::coloured_noise::Coloured;
use crate::driven::selection::held_out::held_out;
use crate::driven::selection::judged::{Departing, Judged, Selection};
use crate::driven::selection::noise_character::{LoudStretch, NoiseCharacter, ReadoutMemory, noise_character};
use crate::driven::selection::noise_scale::MassMotion;
use crate::driven::selection::quantisation_grid::QuantisationGrid;
use crate::driven::selection::residual_structure::residual_structure_of_noise;
use crate::driven::selection::term_worth::{LEAST_ROUNDING_GAIN, Named, rounding};
use crate::driven::simulation::run::trace;
use crate::driven::verdict::dropped::{Dropped, LeftOut};
use crate::gate::Gate;
use crate::numerics::order;
use crate::parallel;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::remainder::{REAL, Remainder, Size};
use crate::ruling::rule;
use crate::trace::Step;
use crate::verdict::Outcome;

use super::draft::Draft;
use super::residual_tests::{self, QUESTIONS, WHITE};

/// Probability below which one of them counts as answered.
const LEVEL: f64 = REAL / QUESTIONS;

/// Conclusion that the chosen model allows.
#[derive(Debug, Clone)]
pub struct Conclusion {
    /// The verdict, one of four.
    pub outcome: Outcome,
    /// The base model fitted like the final one.
    pub base: Judged,
    /// The final model with its held-out record.
    pub model: Judged,
    /// Terms that hold, strongest first.
    pub named: Vec<Named>,
    /// Terms that were in the model and do not hold, with the reason.
    pub dropped: Vec<(Term, Dropped)>,
    /// The final model with the form of one law free, where that law departs from its stated form.
    pub departing: Option<Departing>,
    /// Structure that remains in the final model's innovations.
    pub after: Predictability,
    /// All tests of the residual, in the vocabulary of every kind.
    pub remainder: Remainder,
    /// Size of what the model leaves of samples outside the recordings fitted, where such judge it.
    pub elsewhere: Size,
    /// Character of the noise, where nothing else is left.
    pub noise: NoiseCharacter,
    /// Coarse rounding, where it explains the residual.
    pub lattice: Option<QuantisationGrid>,
    /// Uncertainty of the final model's parameters.
    pub spread: Spread,
    /// Fineness of the integration of the final models' terms, as `Scales::fineness`.
    pub fineness: f64,
    /// Work that the conclusion may spend.
    pub budget: Budget,
    /// Steps not done because the budget was spent.
    pub left_out: Vec<LeftOut>,
}

/// Draws the conclusion: models fitted to the train samples of `data`, judged on its test samples.
pub(crate) fn conclude(data: &Data, selection: &Selection, scales: &Scales) -> Conclusion {
    let mut draft = Draft::fitted(data, selection, scales);
    draft.free(selection);
    draft.prefer_coloured_readout();
    // What the full model leaves is the measure.
    let r_squared = draft.structured(LEVEL);
    draft.weigh();
    draft.drop_what_cannot_stay();
    let carried = draft.carry_what_is_small();
    let followed = draft.drop_noise_that_follows() | draft.drop_walk_that_is_smooth();
    let twins = draft.drop_twins();
    order::sort_by_key(&mut draft.named, |n| -n.growth);
    let named = |l: &QuantisationGrid| {
        let step = Step::of(Gate::RoundedReadings, "not named", "named");
        data.trace.acts(step.measured(l.gain, LEAST_ROUNDING_GAIN))
    };
    let lattice = rounding(data, &draft.model).filter(named);
    draft.departing = draft.departing.take().filter(|d| draft.names(d));
    let left = draft.departing.as_ref().map_or(&draft.model, |d| &d.judged);
    let elsewhere = residual_tests::of_what_was_not(data, &left.fit, &draft.scales);
    let remainder = residual_tests::of_what_was_fitted(data, left, &draft.after).and(elsewhere);
    let outcome = rule(&draft.evidence(carried, followed || twins, lattice.is_some(), remainder));
    if outcome == Outcome::Unexplained {
        draft.settle_unexplained(r_squared, WHITE);
    }
    let noise = if remainder.size == Size::Negligible {
        character(data, &draft.model.fit, draft.after.coloured.as_ref())
    } else {
        NoiseCharacter::default()
    };
    let (spread, finished) = if outcome == Outcome::Unexplained {
        (interval::spread(&draft.model.fit), true)
    } else {
        intervals(data, &draft.model.fit, &draft.scales, &draft.named, draft.budget)
    };
    if !finished {
        draft.left_out.push(LeftOut::Profiles);
    }
    let Draft { base, model, named, dropped, after, scales, budget, left_out, departing, .. } = draft;
    Conclusion {
        outcome,
        base,
        model,
        named,
        dropped,
        departing,
        remainder,
        elsewhere: elsewhere.size,
        noise,
        after: after.structure,
        lattice,
        spread,
        fineness: scales.fineness,
        budget,
        left_out,
    }
}

/// The same conclusion with base and final model fitted to more samples than it was drawn on.
pub(crate) fn widened(c: Conclusion, data: &Data, scales: &Scales) -> Conclusion {
    let scales = &Scales { fineness: c.fineness, ..scales.clone() };
    let budget = data.work.budget(Stage::Conclusion, data.hull.len());
    let refit = |j: &Judged| -> Option<Judged> {
        let fit = fit(data, &j.fit.structure, &j.fit.point, scales, 12)?;
        Some(Judged { held_out: held_out(data, &fit, scales, &data.test), fit })
    };
    let (Some(base), Some(model)) = parallel::join(|| refit(&c.base), || refit(&c.model)) else { return c };
    let after = residual_structure_of_noise(data, &model.fit);
    let mut left_out = c.left_out.clone();
    left_out.retain(|what| *what != LeftOut::Profiles);
    let (spread, finished) = if c.outcome == Outcome::Unexplained {
        (interval::spread(&model.fit), true)
    } else {
        intervals(data, &model.fit, scales, &c.named, budget)
    };
    if !finished {
        left_out.push(LeftOut::Profiles);
    }
    let elsewhere = residual_tests::of_what_was_not(data, &model.fit, scales);
    let remainder = residual_tests::of_what_was_fitted(data, &model, &after).and(elsewhere);
    let noise = if remainder.size == Size::Negligible {
        character(data, &model.fit, after.coloured.as_ref())
    } else {
        NoiseCharacter::default()
    };
    let elsewhere = elsewhere.size;
    Conclusion { base, model, after: after.structure, remainder, elsewhere, noise, spread, budget, left_out, ..c }
}

/// Returns the character of the noise that a model leaves; `coloured` is its memory.
fn character(data: &Data, fit: &Fit, coloured: Option<&Coloured>) -> NoiseCharacter {
    let (innovations, states) = trace(data, &fit.structure, &fit.point, &fit.run(data, true));
    let noise =
        noise_character(&innovations, &MassMotion { x: &states.x, v: &states.v, omega_rad_s: fit.point[OMEGA] });
    let start = data.hull.start;
    let stretch = noise.stretch.map(|s| LoudStretch { from: start + s.from, to: start + s.to, ..s });
    let memory = coloured.map(|c| ReadoutMemory { neighbour: c.neighbour, low_frequency: c.low_frequency });
    NoiseCharacter { stretch, memory, ..noise }
}

/// Uncertainty of a model's parameters, and whether laws with a corner have the profiles that they
/// need.
fn intervals(data: &Data, fit: &Fit, scales: &Scales, named: &[Named], budget: Budget) -> (Spread, bool) {
    let mut spread = interval::spread(fit);
    let cornered: Vec<usize> = named.iter().map(|n| n.index).filter(|i| fit.structure.terms[*i].has_corner()).collect();
    let over = data.work.is_spent(budget);
    if !over {
        interval::profiled(data, fit, scales, &cornered, &mut spread);
    }
    (spread, cornered.is_empty() || !over)
}
