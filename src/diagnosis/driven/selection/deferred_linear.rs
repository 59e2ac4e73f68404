//! Deferred linear laws: a low-pass with a second pole, and a second mass on the first. The search
//! defers them, because they nest simpler laws, and listing both would turn a clear verdict into a
//! tie. Where nothing simpler suffices, they are tried instead of all linear
//! terms together: what one of them absorbs is no delay, no lag and no second effect.

use crate::control::{Control, Stopped};
use crate::driven::identification::fit::{Fit, GAIN, OMEGA, ZETA, fit as fitted};
use crate::driven::identification::refined_scales::refined;
use crate::driven::intake::data::Data;
use crate::driven::intake::work::Budget;
use crate::gate::Gate;
use crate::numerics::order;
use crate::physics::coupled_mode::CoupledMode;
use crate::physics::library::Term;
use crate::physics::parasitic_mode::ParasiticMode;
use crate::physics::readout_lowpass::{Poles, ReadoutLowpass};
use crate::physics::scales::Scales;
use crate::trace::Step;

use super::candidates_round::round;
use super::earned::{ITERATIONS, earned, without};
use super::free_forms::{LEAST_LEAD, UNDONE, with_instead};
use super::identifiability::is_linear;
use super::judged::{Judged, Rival, Selection, judge};
use super::residual_structure::residual_structure;
use super::rivals::TIE;

const TWO_POLES: Term = Term::ReadoutLowpass(ReadoutLowpass(Poles::Two));
const MODE: Term = Term::ParasiticMode(ParasiticMode(0));
const TWO_MASSES: Term = Term::CoupledMode(CoupledMode);
/// Iterations of poles, or of masses and springs, that move along each other.
const HEAT: usize = 3 * ITERATIONS;
/// Most heats of one fit.
const HEATS: usize = 4;

/// Looks for them where the chosen model leaves something, or is made of several linear terms, or
/// of a low-pass that a second pole may extend; and for a second mass next to a mode, which only
/// the way the two share the damping distinguishes from it.
///
/// # Errors
/// Stopped.
pub(super) fn try_deferred_linear(
    data: &Data,
    selection: &mut Selection,
    scales: &Scales,
    budget: Budget,
    control: &Control,
) -> Result<(), Stopped> {
    let chosen = &selection.chosen;
    let linear = chosen.fit.structure.terms.iter().filter(|t| is_linear(t)).count();
    let is_plain = linear <= 1 && !chosen.has(TWO_POLES.id());
    let is_done = is_plain && residual_structure(data, &chosen.fit).r_squared <= UNDONE;
    let is_undecided = data.input.is_none() || selection.reach.tells_nothing_linear_apart();
    if is_undecided || is_of_another_kind(selection) || !data.trace.is_on(Gate::KeptBack) {
        return Ok(());
    }
    let search = KeptBack { data, chosen, budget };
    let (mut all, mut left_out): (Vec<Judged>, bool) = (Vec::new(), false);
    if is_done {
        let mode = the_mode(selection);
        all.extend(mode.and_then(|mode| search.two_masses(mode, &refined(data, &mode.fit, scales))));
    } else {
        let Reduced { starts, plain } = reduced(data, &selection.base, chosen, scales);
        let plain = plain.as_ref().unwrap_or(&selection.base);
        for (place, reduced) in starts.iter().enumerate() {
            if data.work.is_spent(budget) {
                left_out = true;
                break;
            }
            // A model whose linear terms were taken out and that was not fitted again is where others
            // begin, and nothing that they could be held against.
            let against = if place == 0 { &selection.base } else { plain };
            let is_earned = |f: &Judged| earned(data, against, f, scales, selection.tried).is_some();
            let here = refined(data, &reduced.fit, scales);
            let alone = |term: Term| -> Result<Option<Judged>, Stopped> {
                let found = round(data, reduced, &[term], &here, 1, control)?.into_iter().find_map(|t| t.judged);
                Ok(found.map(|f| search.rested(f, &here)))
            };
            let mode = alone(MODE)?;
            let masses = mode.as_ref().and_then(|mode| search.two_masses(mode, &here));
            // One mode instead of one linear term, or of none, the search has had.
            let mode = mode.filter(|_| linear > 1);
            let found = [alone(TWO_POLES)?, mode, masses].into_iter().flatten();
            all.extend(found.filter(is_earned));
        }
        if let Some(mode) = own_mode(data, chosen, scales) {
            let masses = search.two_masses(&mode, scales);
            let found = [Some(mode), masses].into_iter().flatten();
            all.extend(found.filter(|f| earned(data, plain, f, scales, selection.tried).is_some()));
        }
    }
    all.retain(|f| !f.fit.at_bound(&refined(data, &f.fit, scales)));
    order::sort_by_key(&mut all, |j| -score_without_initial_states(j));
    selection.rivals_left_out |= left_out;
    for found in all {
        weigh(data, selection, found);
    }
    Ok(())
}

/// Returns whether what alone does best is not linear: the linear terms next to it patch its form,
/// and none takes its place.
fn is_of_another_kind(selection: &Selection) -> bool {
    let mut laws = selection.alone.iter().filter(|t| t.judged.is_some() && t.term.noise().is_none());
    laws.next().is_some_and(|t| !is_linear(&t.term))
}

/// The model with a mode where that is chosen, or would do as well.
fn the_mode(selection: &Selection) -> Option<&Judged> {
    if selection.chosen.has(MODE.id()) {
        return Some(&selection.chosen);
    }
    selection.rivals.iter().flatten().find(|r| r.id == MODE.id()).map(|r| &r.judged)
}

/// Search for a law that is deferred: the data, the chosen model that it is measured against, and
/// the work that it may spend.
struct KeptBack<'a> {
    data: &'a Data,
    chosen: &'a Judged,
    budget: Budget,
}

impl KeptBack<'_> {
    /// A fit that had not come to rest, taken further as long as what it gained last would bring it
    /// to the chosen model.
    fn rested(&self, mut found: Judged, scales: &Scales) -> Judged {
        let goal = score_without_initial_states(self.chosen) - TIE;
        let mut gained = f64::INFINITY;
        for heat in 1..=HEATS {
            let reach = score_without_initial_states(&found) + gained * (HEATS - heat + 1) as f64;
            if found.fit.converged || reach < goal || self.data.work.is_spent(self.budget) {
                break;
            }
            let fit = &found.fit;
            let Some(further) = fitted(self.data, &fit.structure, &fit.point, scales, HEAT) else { break };
            let further = judge(self.data, further, scales);
            gained = score_without_initial_states(&further) - score_without_initial_states(&found);
            found = further;
        }
        found
    }

    /// A second mass on the first, fitted from the two modes of a model that come nearest to it.
    fn two_masses(&self, modes: &Judged, scales: &Scales) -> Option<Judged> {
        let fit = &modes.fit;
        let index = fit.structure.terms.iter().position(|t| *t == MODE)?;
        let (base, values) = masses(fit, index)?;
        let (structure, mut point) = with_instead(fit, index, TWO_MASSES, &values);
        point[GAIN..GAIN + base.len()].copy_from_slice(&base);
        let found = judge(self.data, fitted(self.data, &structure, &point, scales, ITERATIONS)?, scales);
        Some(self.rested(found, scales))
    }
}

/// Models without any linear term.
struct Reduced {
    /// Models from which a deferred law may begin: the base, and what the chosen model is without
    /// its linear terms.
    starts: Vec<Judged>,
    /// The chosen model fitted without its linear terms, where it has others.
    plain: Option<Judged>,
}

/// The base; the chosen model with everything else where it is, as a base model that is fitted
/// without its linear terms may go where no other finds its place; and the chosen one fitted without
/// them, where it has other terms.
fn reduced(data: &Data, base: &Judged, chosen: &Judged, scales: &Scales) -> Reduced {
    let mut starts = vec![base.clone()];
    let linear = |fit: &Fit| fit.structure.terms.iter().position(is_linear);
    if linear(&chosen.fit).is_none() {
        return Reduced { starts, plain: None };
    }
    let mut there = Some(chosen.fit.clone());
    while let Some((fit, index)) = there.as_ref().and_then(|f| Some((f, linear(f)?))) {
        let (structure, point) = fit.without(index);
        there = fitted(data, &structure, &point, scales, 0);
    }
    starts.extend(there.map(|fit| judge(data, fit, scales)));
    let mut plain = chosen.fit.structure.terms.iter().any(|t| !is_linear(t)).then(|| chosen.clone());
    while let Some(index) = plain.as_ref().and_then(|r| linear(&r.fit)) {
        plain = plain.and_then(|r| without(data, &r, index, scales));
    }
    starts.extend(plain.clone());
    Reduced { starts, plain }
}

/// The chosen model with its mode alone of all linear terms, from where it is.
fn own_mode(data: &Data, chosen: &Judged, scales: &Scales) -> Option<Judged> {
    let mut there = chosen.fit.clone();
    there.structure.terms.iter().position(|t| *t == MODE)?;
    while let Some(index) = there.structure.terms.iter().position(|t| is_linear(t) && *t != MODE) {
        let (structure, point) = there.without(index);
        there = fitted(data, &structure, &point, scales, 0)?;
    }
    Some(judge(data, fitted(data, &there.structure, &there.point, scales, HEAT)?, scales))
}

/// Gain, ω₀ and ζ of the first mass, and μ, ω₂, ζ₂ of a second one on it, whose two modes are
/// nearly these; `None` where no two masses have them. The first mass absorbs a push alone, at the
/// sum of both modes' gains; it stands still where the second one absorbs, between the modes; and
/// the squares of the pair's frequencies sum up to ω₀² + (1 + μ)ω₂² and multiply to ω₀²ω₂².
fn masses(modes: &Fit, index: usize) -> Option<([f64; 3], [f64; 5])> {
    let p = &modes.point;
    let [g2, omega2, zeta2, ..] = *modes.structure.of(index, p) else { return None };
    let (g1, omega1, zeta1) = (p[GAIN], p[OMEGA], p[ZETA]);
    let gain = g1 + g2;
    let share = g1 / gain;
    if !(share > 0.0 && share < 1.0) {
        return None;
    }
    let squares = [omega1 * omega1, omega2 * omega2];
    let dampings = [2.0 * zeta1 * omega1, 2.0 * zeta2 * omega2];
    let own = share * squares[1] + (1.0 - share) * squares[0];
    let first = squares[0] * squares[1] / own;
    let ratio = (squares[0] + squares[1] - first) / own - 1.0;
    let slows = share * dampings[1] + (1.0 - share) * dampings[0];
    let left = dampings[0] + dampings[1] - (1.0 + ratio) * slows;
    let (omega, own) = (first.sqrt(), own.sqrt());
    let zeta = (0.5 * left / omega).max(0.1 * zeta1.min(zeta2));
    (ratio > 0.0).then_some(([gain, omega, zeta], [ratio, own, (0.5 * slows / own).clamp(1e-4, 0.6), 0.0, 0.0]))
}

/// Returns the log-likelihood less the penalty of the parameters, without that of initial values: a
/// second state's fades, so that more samples show no more of it, and Schwarz's penalty is of what
/// they do.
pub(super) fn score_without_initial_states(model: &Judged) -> f64 {
    let fit = &model.fit;
    let beginnings = fit.structure.all_beginnings();
    let parameters = fit.free.iter().filter(|i| !beginnings.contains(i)).count();
    fit.log_likelihood() - 0.5 * parameters as f64 * (fit.linear.residual.len().max(2) as f64).ln()
}

/// Weighs a model with one linear term against the chosen one: it takes its place, is
/// indistinguishable from it, or counts for nothing.
fn weigh(data: &Data, selection: &mut Selection, found: Judged) {
    let chosen = &selection.chosen;
    let terms = &chosen.fit.structure.terms;
    let Some(kept) = found.fit.structure.terms.iter().copied().find(is_linear) else { return };
    let lead = score_without_initial_states(&found) - score_without_initial_states(chosen);
    let is_lean = found.fit.structure.terms.len() < terms.len();
    let is_same = !terms.is_empty() && terms.iter().all(|t| found.has(t.id()));
    let replaces = lead
        > if is_lean {
            -LEAST_LEAD
        } else if is_same {
            LEAST_LEAD
        } else {
            TIE
        };
    let step = |after: String| Step { term: Some(kept.id()), ..Step::of(Gate::KeptBack, chosen.words(), after) };
    if !replaces {
        // Neither is ahead.
        let first = (!terms.is_empty()).then_some(0);
        let place = terms.iter().position(is_linear).or(first).filter(|_| !is_same && lead > -TIE);
        if let Some(place) = place {
            selection.rivals.resize_with(terms.len(), Vec::new);
            if !selection.rivals[place].iter().any(|r| r.id == kept.id()) && !chosen.has(kept.id()) {
                data.trace.acts(step(format!("tied with {}", terms[place].id())).measured(lead, -TIE));
                selection.rivals[place].push(Rival { judged: found, id: kept.id() });
            }
        }
        return;
    }
    data.trace.acts(step(found.words()).measured(lead, 0.0));
    // What stood there, and what does as well alone.
    let before = terms.iter().filter(|t| is_linear(t)).map(|t| Rival { judged: chosen.clone(), id: t.id() });
    let alone = selection.alone.iter().filter(|t| is_linear(&t.term));
    let alone = alone.filter_map(|t| Some(Rival { judged: t.judged.clone()?, id: t.term.id() }));
    let mut tied: Vec<Rival> = Vec::new();
    for rival in before.chain(alone) {
        let is_new = !found.has(rival.id) && tied.iter().all(|r| r.id != rival.id);
        if is_new && score_without_initial_states(&found) - score_without_initial_states(&rival.judged) < TIE {
            tied.push(rival);
        }
    }
    let of_term = |t: &Term| {
        if is_linear(t) {
            return tied.clone();
        }
        let place = terms.iter().position(|c| c.id() == t.id());
        place.and_then(|p| selection.rivals.get(p)).cloned().unwrap_or_default()
    };
    selection.rivals = found.fit.structure.terms.iter().map(of_term).collect();
    selection.chosen = found;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driven::base::BASE;
    use crate::driven::simulation::structure::ModelStructure;
    use crate::numerics::least_squares::Linear;

    fn modes(base: [f64; 3], mode: [f64; 3]) -> Fit {
        let mut point = vec![0.0; BASE];
        point[GAIN..GAIN + 3].copy_from_slice(&base);
        point.extend(mode);
        point.resize(BASE + MODE.values(), 0.0);
        let linear = Linear { residual: Vec::new(), columns: Vec::new() };
        let structure = ModelStructure::new(&[MODE]);
        Fit { structure, point, steps: 2, linear, free: Vec::new(), slopes: Vec::new(), variance: 1.0, converged: true }
    }

    // Tuned alike, ω₂ = ω₀: Ω² = ω₀²(1 + μ/2 ∓ √(μ + μ²/4)) (Den Hartog, § 3.2), and the gain of a
    // mode is the residue (ω₂² − Ω²)/(Ω'² − Ω²) of (ω₂² − Ω²) over both modes.
    #[test]
    fn the_modes_of_a_tuned_pair_lead_back_to_it() {
        let (omega, mu) = (4.0f64, 0.05f64);
        let square = |side: f64| omega * omega * (1.0 + 0.5 * mu + side * (mu + 0.25 * mu * mu).sqrt());
        let (low, high) = (square(-1.0), square(1.0));
        let share = (omega * omega - low) / (high - low);
        let found =
            |share: f64| masses(&modes([3.0 * share, low.sqrt(), 0.01], [3.0 * (1.0 - share), high.sqrt(), 0.01]), 0);
        let ([gain, first, _], [ratio, own, ..]) = found(share).expect("a pair");
        for (got, want) in [(gain, 3.0), (first, omega), (ratio, mu), (own, omega)] {
            assert!((got / want - 1.0).abs() < 1e-9, "{got} {want}");
        }
        assert!(found(1.2).is_none() && found(-0.2).is_none(), "modes against each other have no common mass");
    }
}
