//! From the model chosen to what may be said of it: which terms hold, which are tied, what is left.

use crate::diagnosis::detection::Structure;
use crate::diagnosis::driven::base::OMEGA;
use crate::diagnosis::driven::identification::fit::{Fit, fit};
use crate::diagnosis::driven::identification::interval::{self, Spread};
use crate::diagnosis::driven::identification::local_minima::deepest;
use crate::diagnosis::driven::identification::step_length::enough;
use crate::diagnosis::driven::intake::data::Data;
use crate::diagnosis::driven::intake::work::{Budget, Stage};
use crate::diagnosis::driven::selection::earned::{SMALLEST_GAIN, without};
use crate::diagnosis::driven::selection::held_out::{held_out, ratio_interval};
use crate::diagnosis::driven::selection::judged::{Departing, Judged, Rival, Selection};
use crate::diagnosis::driven::selection::lattice::Lattice;
use crate::diagnosis::driven::selection::noise_character::{
    LoudStretch, NoiseCharacter, disturbance_by_chance, noise_character,
};
use crate::diagnosis::driven::selection::noise_scale::Motion;
use crate::diagnosis::driven::selection::residual_structure::{left_evenly, power_left};
use crate::diagnosis::driven::selection::rivals::alike;
use crate::diagnosis::driven::selection::series::{Series, series};
use crate::diagnosis::driven::selection::term_worth::{Named, rounding, weighed};
use crate::diagnosis::driven::simulation::run::trace;
use crate::diagnosis::driven::verdict::dropped::{Dropped, LeftOut};
use crate::diagnosis::remainder::{REAL, Remainder, Size, Test};
use crate::diagnosis::ruling::{Evidence, rule};
use crate::diagnosis::verdict::Outcome;
use crate::numerics::order;
use crate::parallel;
use crate::physics::library::Term;
use crate::physics::scales::{Coordinate, Scales};

/// Share of the innovations' variance that may be foreseen before they are no longer called white.
pub const WHITE: f64 = 0.02;
/// A remainder of less than this share, with no candidate that earns a name, is too faint to say that the library fails.
const FAINT: f64 = 0.05;
/// Share of the innovations' power that may be foreseen before noise is no longer taken for the sensor's own.
const EVEN: f64 = 0.01;
/// Questions that are asked of what is left: structure in the innovations, structure in their power, a disturbance.
const QUESTIONS: f64 = 3.0;
/// Probability below which one of them counts as answered.
const LEVEL: f64 = REAL / QUESTIONS;
/// With a remainder as structured as this, a term must stand far above it.
const COLOURED: f64 = 0.15;
/// How far.
const FAR_ABOVE: f64 = 30.0;
/// Part of all that is removed that a term must add to be named: a law is rarely truer than to three parts in a hundred of what
/// it does, and a tenth of a percent in power of it is no other effect.
const LEAST_PART: f64 = 1e-3;
/// The same for noise, which no law's inexactness but that of the simulation itself can imitate.
const LEAST_PART_OF_NOISE: f64 = 1e-5;

/// What may be said.
#[derive(Debug, Clone)]
pub struct Conclusion {
    /// The verdict.
    pub outcome: Outcome,
    /// The base model fitted like the final one.
    pub base: Judged,
    /// The final model.
    pub model: Judged,
    /// Terms that hold, strongest first.
    pub named: Vec<Named>,
    /// Terms that were in the model and do not hold, with the reason.
    pub dropped: Vec<(Term, Dropped)>,
    /// The final model with the form of one law free, where that law departs from its stated form.
    pub departing: Option<Departing>,
    /// Why terms that each earn a place got no name together, where they did not.
    pub series: Option<Series>,
    /// What is left of the final model's innovations.
    pub after: Structure,
    /// All tests of what is left, in the vocabulary of every kind.
    pub remainder: Remainder,
    /// What kind of noise it is, where nothing else is left.
    pub noise: NoiseCharacter,
    /// Coarse rounding, where it explains the remainder.
    pub lattice: Option<Lattice>,
    /// Uncertainty of the final model's parameters.
    pub spread: Spread,
    /// How finely the terms of the final models are integrated, as `Scales::fineness`.
    pub fineness: f64,
    /// What the conclusion may cost.
    pub budget: Budget,
    /// What was not done because that was spent.
    pub left_out: Vec<LeftOut>,
}

/// Draws the conclusion: models fitted to the train samples of `data`, judged on its test samples.
pub fn conclude(data: &Data, selection: &Selection, scales: &Scales) -> Conclusion {
    let mut draft = Draft::fitted(data, selection, scales);
    draft.free(selection);
    // What the full model leaves is the measure.
    let share = draft.structured();
    draft.weigh();
    draft.drop_what_cannot_stay();
    draft.drop_what_follows_rounding();
    let nameless = draft.carry_what_is_small(share);
    let twins = draft.drop_twins();
    let series = draft.drop_series();
    order::sort_by_key(&mut draft.named, |n| -n.growth);
    let lattice = rounding(data, &draft.model);
    draft.departing = draft.departing.take().filter(|d| draft.names(d));
    let remainder = remainder(data, draft.departing.as_ref().map_or(&draft.model, |d| &d.judged), &draft.after);
    let outcome = rule(&draft.evidence(nameless, twins || series.is_some(), lattice.is_some(), remainder));
    if outcome == Outcome::Unexplained {
        draft.drop_stand_ins(share);
        draft.keep_what_is_named();
    }
    let noise =
        if remainder.size == Size::Negligible { character(data, &draft.model.fit) } else { NoiseCharacter::default() };
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
        series,
        remainder,
        noise,
        after,
        lattice,
        spread,
        fineness: scales.fineness,
        budget,
        left_out,
    }
}

/// The same conclusion with base and final model fitted to more samples than it was drawn on.
pub fn widened(c: Conclusion, data: &Data, scales: &Scales) -> Conclusion {
    let scales = &Scales { fineness: c.fineness, ..scales.clone() };
    let budget = data.work.budget(Stage::Conclusion, data.hull.len());
    let refit = |j: &Judged| -> Option<Judged> {
        let fit = fit(data, &j.fit.shape, &j.fit.point, scales, 12)?;
        Some(Judged { held_out: held_out(data, &fit, scales, &data.test), fit })
    };
    let (Some(base), Some(model)) = parallel::join(|| refit(&c.base), || refit(&c.model)) else { return c };
    let after = left_evenly(data, &model.fit);
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
    let remainder = remainder(data, &model, &after);
    let noise =
        if remainder.size == Size::Negligible { character(data, &model.fit) } else { NoiseCharacter::default() };
    Conclusion { base, model, after, remainder, noise, spread, budget, left_out, ..c }
}

/// What kind of noise a model leaves.
fn character(data: &Data, fit: &Fit) -> NoiseCharacter {
    let (innovations, states) = trace(data, &fit.shape, &fit.point, &fit.run(data, true));
    let noise = noise_character(&innovations, &Motion { x: &states.x, v: &states.v, omega_rad_s: fit.point[OMEGA] });
    let start = data.hull.start;
    let stretch = noise.stretch.map(|s| LoudStretch { from: start + s.from, to: start + s.to, ..s });
    NoiseCharacter { stretch, ..noise }
}

/// The three questions asked of what a model leaves.
fn remainder(data: &Data, model: &Judged, after: &Structure) -> Remainder {
    let structure = Test { p_value: QUESTIONS * after.p_value, size: Size::of(after.share, WHITE, FAINT) };
    // Noise of the sensor's own keeps its strength whatever the sensor does; what does not is a stand-in for physics.
    let power = model.fit.shape.is_noisy().then(|| power_left(data, &model.fit));
    let power = power.map(|p| Test { p_value: QUESTIONS * p.p_value, size: Size::of(p.share, EVEN, f64::INFINITY) });
    // A disturbance does not say that the library fails.
    let by_chance = QUESTIONS * disturbance_by_chance(&model.fit.linear.residual);
    let disturbance = Test { p_value: by_chance, size: Size::Faint };
    Remainder::of([structure, disturbance].into_iter().chain(power))
}

/// Uncertainty of a model's parameters, and whether laws with a corner have the profiles that they need.
fn intervals(data: &Data, fit: &Fit, scales: &Scales, named: &[Named], budget: Budget) -> (Spread, bool) {
    let mut spread = interval::spread(fit);
    let cornered: Vec<usize> = named.iter().map(|n| n.index).filter(|i| fit.shape.terms[*i].has_corner()).collect();
    let over = data.work.is_spent(budget);
    if !over {
        interval::profiled(data, fit, scales, &cornered, &mut spread);
    }
    (spread, cornered.is_empty() || !over)
}

/// A conclusion in the making.
struct Draft<'a> {
    data: &'a Data,
    selection: &'a Selection,
    scales: Scales,
    budget: Budget,
    base: Judged,
    model: Judged,
    /// The model with the form of one law free, where that law departs from its stated form.
    departing: Option<Departing>,
    /// What is left of the model; of the one with a free form, where there is one.
    after: Structure,
    rivals: Vec<Vec<Rival>>,
    named: Vec<Named>,
    dropped: Vec<(Term, Dropped)>,
    left_out: Vec<LeftOut>,
}

impl<'a> Draft<'a> {
    /// Base and final model, as finely integrated as their numbers need, and judged.
    fn fitted(data: &'a Data, selection: &'a Selection, scales: &Scales) -> Self {
        let budget = data.work.budget(Stage::Conclusion, data.hull.len());
        let refit =
            |old: &Fit, scales: &Scales| fit(data, &old.shape, &old.point, scales, 20).unwrap_or_else(|| old.clone());
        let (base, model) =
            parallel::join(|| refit(&selection.base.fit, scales), || refit(&selection.chosen.fit, scales));
        let model = deepest(data, model, scales);
        let fineness = enough(data, &model, scales);
        let scales = Scales { fineness, ..scales.clone() };
        let model =
            if model.steps == model.shape.steps(&model.point, &scales) { model } else { refit(&model, &scales) };
        let judge = |fit: Fit| Judged { held_out: held_out(data, &fit, &scales, &data.test), fit };
        let (base, model) = parallel::join(|| judge(base), || judge(model));
        let (after, rivals) = (left_evenly(data, &model.fit), selection.rivals.clone());
        let (named, dropped, left_out) = (Vec::new(), Vec::new(), Vec::new());
        let departing = None;
        Self { data, selection, scales, budget, base, model, departing, after, rivals, named, dropped, left_out }
    }

    /// Fits the model with a free form like the others. What it leaves is what is left: the stated form would leave its own
    /// inexactness besides.
    fn free(&mut self, selection: &Selection) {
        let Some(found) = &selection.departing else { return };
        let old = &found.judged.fit;
        let fit = fit(self.data, &old.shape, &old.point, &self.scales, 20).unwrap_or_else(|| old.clone());
        self.after = left_evenly(self.data, &fit);
        let held_out = held_out(self.data, &fit, &self.scales, &self.data.test);
        self.departing = Some(Departing { judged: Judged { fit, held_out }, index: found.index });
    }

    /// Whether the law whose form is free is named.
    fn names(&self, departing: &Departing) -> bool {
        let id = departing.judged.fit.shape.terms[departing.index].id();
        self.named.iter().any(|n| self.term(n.index).id() == id)
    }

    /// Share of the innovations' variance that can still be foreseen beyond chance.
    fn structured(&self) -> f64 {
        if self.after.p_value < LEVEL { self.after.share } else { 0.0 }
    }

    fn term(&self, index: usize) -> Term {
        self.model.fit.shape.terms[index]
    }

    fn is_noise(&self, named: &Named) -> bool {
        self.term(named.index).noise().is_some()
    }

    fn drop_term(&mut self, index: usize, reason: Dropped) {
        let term = self.term(index);
        self.dropped.push((term, reason));
    }

    /// Weighs every term of the model.
    fn weigh(&mut self) {
        self.named = weighed(self.data, self.selection, &self.model, &self.scales, &self.rivals, &self.base);
    }

    /// Why a term may not stay, if it may not: the test samples speak against it, it is not what its name says, or it may be
    /// nothing.
    fn objection(&self, named: &Named) -> Option<Dropped> {
        if named.worsens(&self.model) {
            return Some(Dropped::Worsens);
        }
        let fit = &self.model.fit;
        if fit.term_at_bound(named.index, &self.scales) {
            return Some(Dropped::AtBound);
        }
        if self.is_noise(named) {
            return None;
        }
        // A law of several strengths is nothing only where each of them may be.
        let (first, spread) = (fit.shape.first[named.index], interval::spread(fit));
        let term = self.term(named.index);
        let parameters = term.candidate().parameters.len();
        let strengths: Vec<usize> = term
            .coordinates(&self.scales)
            .iter()
            .take(parameters)
            .enumerate()
            .filter(|(_, c)| !matches!(c, Coordinate::Log(..)))
            .map(|(j, _)| first + j)
            .collect();
        let may_be_nothing = |place: &usize| {
            let free = fit.free.iter().position(|f| f == place);
            free.is_none_or(|f| fit.point[*place].abs() <= spread.reach[f][0] * fit.slopes[f].abs())
        };
        let nothing = !strengths.is_empty() && strengths.iter().all(may_be_nothing);
        nothing.then_some(Dropped::MayBeNothing)
    }

    /// A term against which something speaks goes, and the others are weighed again without it.
    fn drop_what_cannot_stay(&mut self) {
        let worst = |draft: &Self| {
            let all = draft.named.iter().filter_map(|n| Some((n, draft.objection(n)?)));
            all.min_by(|a, b| a.0.free_without.total_cmp(&b.0.free_without)).map(|(n, reason)| (n.index, reason))
        };
        while let Some((index, reason)) = worst(self) {
            self.drop_term(index, reason);
            if self.data.work.is_spent(self.budget) {
                self.named.retain(|n| n.index != index);
                self.left_out.push(LeftOut::WeighingAgain);
                continue;
            }
            let Some(poorer) = without(self.data, &self.model, index, &self.scales) else { break };
            let held_out = held_out(self.data, &poorer.fit, &self.scales, &self.data.test);
            self.model = Judged { held_out, fit: poorer.fit };
            if index < self.rivals.len() {
                self.rivals.remove(index);
            }
            // Without that term the form is another question.
            self.departing = None;
            self.after = left_evenly(self.data, &self.model.fit);
            self.weigh();
        }
    }

    /// What is known of rounded readings does not bear out what only follows the rounding.
    fn drop_what_follows_rounding(&mut self) {
        let bar = (self.selection.tried.max(1) as f64).ln() + 3.0;
        let holds = |n: &Named| n.rounded_lead.is_none_or(|lead| lead > bar);
        let (holding, following): (Vec<Named>, Vec<Named>) = self.named.iter().cloned().partition(holds);
        self.named = holding;
        for n in following {
            self.drop_term(n.index, Dropped::FollowsRounding);
        }
    }

    /// What is smaller than the remainder, or than the other laws can be trusted, stays in the model, so that it does not bias
    /// the others, but is not named. How much of the variance these laws carry together.
    fn carry_what_is_small(&mut self, share: f64) -> f64 {
        let need = SMALLEST_GAIN.max(if share <= COLOURED { share } else { FAR_ABOVE * share });
        let removed = self.removed();
        let holds = |n: &Named| {
            if self.is_noise(n) {
                // Noise follows whatever is left: beside it, what is left must be next to nothing.
                return n.growth >= need.max(FAR_ABOVE * share).max(removed * LEAST_PART_OF_NOISE);
            }
            n.growth >= need.max(removed * LEAST_PART)
        };
        let (named, carried): (Vec<Named>, Vec<Named>) = self.named.iter().cloned().partition(holds);
        self.named = named;
        for n in &carried {
            let reason = if n.growth < need { Dropped::SmallerThanTheRest } else { Dropped::WithinInexactness };
            self.drop_term(n.index, reason);
        }
        carried.iter().filter(|n| !self.is_noise(n)).map(|n| n.growth).sum()
    }

    /// How many times the final model's variance the terms removed.
    fn removed(&self) -> f64 {
        self.base.fit.variance / self.model.fit.variance.max(1e-300) - 1.0
    }

    /// Two terms that can be mistaken for each other, neither above the noise, are one thing that the library does not hold.
    fn drop_twins(&mut self) -> bool {
        let faint: Vec<usize> = self.named.iter().filter(|n| n.growth < 1.0).map(|n| n.index).collect();
        let has_twin = |i: usize| faint.iter().any(|j| i != *j && alike(&self.term(i), &self.term(*j)));
        let twins: Vec<usize> = faint.iter().copied().filter(|i| has_twin(*i)).collect();
        twins.iter().for_each(|i| self.drop_term(*i, Dropped::Twin));
        self.named.retain(|n| !twins.contains(&n.index));
        !twins.is_empty()
    }

    /// Nothing of a series has a name.
    fn drop_series(&mut self) -> Option<Series> {
        let terms: Vec<Term> = self.named.iter().map(|n| self.term(n.index)).collect();
        let found = series(&terms)?;
        for n in std::mem::take(&mut self.named) {
            self.drop_term(n.index, Dropped::Series(found));
        }
        Some(found)
    }

    /// Named terms in whose place another does as well, in this recording or in any with this input.
    fn tied(&self) -> usize {
        let class = self.selection.reach.class(&self.model.fit.shape.terms);
        let in_class = |n: &Named| class.contains(&self.term(n.index).id());
        self.named.iter().filter(|n| !n.rivals.is_empty() || in_class(n)).count()
    }

    /// Whether the recording is long enough for the base model, where anything is named beside it.
    fn is_base_determined(&self) -> bool {
        self.selection.reach.few_cycles.is_none() || self.named.is_empty()
    }

    /// What the verdict rests on; `nameless` is what is carried without a name, in variances of the final model.
    fn evidence(&self, nameless: f64, stand_ins: bool, rounded: bool, remainder: Remainder) -> Evidence {
        let (model, base) = (&self.model, &self.base);
        Evidence {
            named: self.named.len() + usize::from(rounded),
            departs: self.departing.is_some(),
            tied: self.tied(),
            stand_ins,
            // A base model whose error goes only with terms that earn no name is not adequate.
            nameless: self.removed(),
            remainder: remainder.size,
            // By what has a name: what is carried without one does not explain.
            removed: 1.0 - model.held_out.free() * (1.0 + nameless) / base.held_out.free().max(1e-300),
            search_complete: !self.selection.cut_short,
            has_power: self.after.detectable_share < 1.0,
            predicts_worse: model.held_out.free() > base.held_out.free()
                && self.named.iter().any(|n| !self.is_noise(n)),
            held_out_ratio: ratio_interval(&base.held_out, &model.held_out)[0],
            base_determined: self.is_base_determined(),
        }
    }

    /// The model of a verdict that explains nothing holds what it names and nothing else; and predicts no worse than the base.
    fn keep_what_is_named(&mut self) {
        let terms = self.model.fit.shape.terms.len();
        let named = |draft: &Self, index: usize| draft.named.iter().any(|n| n.index == index);
        for index in (0..terms).rev() {
            if named(self, index) {
                continue;
            }
            let poorer =
                if self.named.is_empty() { None } else { without(self.data, &self.model, index, &self.scales) };
            let Some(poorer) = poorer else {
                self.named.clear();
                break;
            };
            let held_out = held_out(self.data, &poorer.fit, &self.scales, &self.data.test);
            self.model = Judged { held_out, fit: poorer.fit };
            self.named.iter_mut().filter(|n| n.index > index).for_each(|n| n.index -= 1);
        }
        if self.named.is_empty() || self.model.held_out.free() > self.base.held_out.free() {
            self.named.clear();
            self.departing = None;
            self.model = self.base.clone();
        }
        if self.departing.is_none() && self.model.fit.shape.terms.len() < terms {
            self.after = left_evenly(self.data, &self.model.fit);
        }
    }

    /// Beside a mismatch that stays unexplained, only what towers above the remainder holds by itself.
    fn drop_stand_ins(&mut self, share: f64) {
        let bar = FAR_ABOVE * share.max(WHITE);
        // Noise takes up whatever the library lacks: beside it the remainder is no measure, only the noise itself is.
        let noisy = self.model.fit.shape.is_noisy();
        let towers = |n: &Named| n.growth >= if noisy && !self.is_noise(n) { bar.max(FAR_ABOVE) } else { bar };
        let (towering, others): (Vec<Named>, Vec<Named>) = self.named.iter().cloned().partition(towers);
        for n in others {
            self.drop_term(n.index, Dropped::StandIn);
        }
        self.named = towering;
        if self.named.iter().all(|n| self.is_noise(n)) {
            self.named.clear();
        }
    }
}
