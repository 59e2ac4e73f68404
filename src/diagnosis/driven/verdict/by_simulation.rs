//! Adds to a conclusion what free simulation shows: the names that hold in it where the stepwise
//! search ended without any, and the part of the error that each name removes.

use crate::answer::Answer;
use crate::driven::identification::fit::fit;
use crate::driven::identification::interval;
use crate::driven::intake::data::Data;
use crate::driven::selection::held_out::{held_out, ratio_interval};
use crate::driven::selection::judged::{Departing, Judged, Rival, Selection};
use crate::driven::selection::residual_structure::residual_structure_of_noise;
use crate::driven::selection::term_worth::weighed;
use crate::driven::simulated::search::{Simulated, Worth};
use crate::engine::evidence::Gain;
use crate::engine::fit::Fitted;
use crate::engine::levels::{AT_NOISE, FAINT};
use crate::engine::names::Found;
use crate::gate::Gate;
use crate::physics::scales::Scales;
use crate::remainder::{Remainder, Size, Test};
use crate::ruling::{self, rule};
use crate::trace::Step;
use crate::verdict::{DependsOn, Outcome, Share};

use super::conclude::Conclusion;
use super::dropped::Dropped;
use super::residual_tests;

/// Results of free simulation that add to a conclusion.
#[derive(Debug, Clone, Default)]
pub(crate) struct Simulation {
    /// Part of the error that its names remove.
    worth: Worth,
    /// Laws that would remove part of the error, and not enough of it to be named.
    imitations: Vec<&'static str>,
    /// Standard deviation of the noise, as it was measured; `None` where nothing is held against it.
    noise: Option<f64>,
}

/// The conclusion with the names that hold in free simulation where it had none, and what all its
/// names are worth.
pub(crate) fn simulated(
    data: &Data,
    selection: Selection,
    mut c: Conclusion,
    scales: &Scales,
) -> (Selection, Conclusion, Simulation) {
    let says_something = !c.named.is_empty() || c.outcome == Outcome::Unexplained;
    let base = &selection.base.fit;
    let terms: Vec<_> = c.named.iter().map(|n| c.model.fit.structure.terms[n.index]).collect();
    let known = (says_something && selection.base_follows && !scales.at_once)
        .then(|| Simulated::of(data, base, &terms, scales))
        .flatten();
    let Some(simulated) = known else { return (selection, c, Simulation::default()) };
    let noise = (c.outcome == Outcome::Unexplained).then(|| simulated.variance.sqrt());
    let silent = Simulation { noise, ..Simulation::default() };
    if !c.named.is_empty() {
        let places: Vec<usize> = c.named.iter().map(|n| n.index).collect();
        let worth = simulated.worth(data, &c.model.fit, &places, c.outcome == Outcome::Unexplained);
        let mut worth = worth.unwrap_or_default();
        drop_what_adds_error(data, &mut c, &mut worth);
        return (selection, c, Simulation { worth, ..silent });
    }
    let Some(found) = simulated.search() else { return (selection, c, silent) };
    let id = |law: usize| simulated.system.members[law].term.id();
    match named(data, &selection, &c, scales, &simulated, &found) {
        Some((selection, conclusion)) => {
            let each = found.named.iter().map(|n| (n.place, n.gain)).collect();
            let worth = Worth { each, together: found.together, rest: found.rest };
            (selection, conclusion, Simulation { worth, ..silent })
        }
        None => {
            let laws = found.imitations.iter().copied().chain(found.named.iter().map(|n| found.model.set[n.place]));
            let imitations = laws.map(id).collect();
            let rest = if found.named.is_empty() { found.rest } else { Vec::new() };
            (selection, c, Simulation { worth: Worth { rest, ..Worth::default() }, imitations, ..silent })
        }
    }
}

/// Takes the name from a law that adds to the error of free simulation where something is left anyway.
fn drop_what_adds_error(data: &Data, c: &mut Conclusion, worth: &mut Worth) {
    let adds = |(_, gain): &&(usize, Gain)| c.outcome == Outcome::Unexplained && gain.removed < 0.0;
    let adding: Vec<(usize, Gain)> = worth.each.iter().filter(adds).copied().collect();
    for (index, gain) in adding {
        let term = c.model.fit.structure.terms[index];
        let step = Step { term: Some(term.id()), ..Step::of(Gate::Worsens, "named", "dropped") };
        if !data.trace.acts(step.measured(1.0 - gain.share, 1.0)) {
            continue;
        }
        c.dropped.push((term, Dropped::Worsens));
        c.named.retain(|n| n.index != index);
        worth.each.retain(|(other, _)| *other != index);
        worth.together = None;
    }
}

/// The conclusion with the names that were found, fitted and weighed as those of the stepwise search
/// are; `None` where they do not hold so.
fn named(
    data: &Data,
    selection: &Selection,
    c: &Conclusion,
    scales: &Scales,
    simulated: &Simulated,
    found: &Found,
) -> Option<(Selection, Conclusion)> {
    let scales = &Scales { fineness: c.fineness, ..scales.clone() };
    let set = &found.model.set;
    let excess = found.model.variance / simulated.variance - 1.0;
    if found.named.is_empty() || selection.reach.few_cycles.is_some() {
        return None;
    }
    let judged = |fitted: &Fitted| {
        let (structure, point) = simulated.model(fitted, &selection.base.fit);
        let fit = fit(data, &structure, &point, scales, 20)?;
        Some(Judged { held_out: held_out(data, &fit, scales, &data.test), fit })
    };
    let model = judged(&found.model)?;
    if ratio_interval(&c.base.held_out, &model.held_out)[1] >= 1.0 || model.fit.at_bound(scales) {
        return None;
    }
    let rivals = |place: usize| -> Vec<Rival> {
        let own = found.named.iter().filter(|n| n.place == place).flat_map(|n| &n.rivals);
        let rival = |(law, fitted): &(usize, std::sync::Arc<Fitted>)| {
            Some(Rival { judged: judged(fitted)?, id: simulated.system.members[*law].term.id() })
        };
        own.filter_map(rival).collect()
    };
    let rivals: Vec<Vec<Rival>> = (0..set.len()).map(rivals).collect();
    let departing = found.named.iter().find_map(|n| {
        let (freed, _) = n.departs.as_ref()?;
        let index = freed.set.iter().position(|law| !set.contains(law))?;
        Some(Departing { judged: judged(freed)?, index })
    });
    let selection = Selection {
        chosen: model.clone(),
        rivals: rivals.clone(),
        stand_ins: Vec::new(),
        departing: departing.clone(),
        ..selection.clone()
    };
    let named = weighed(data, &selection, &model, scales, &rivals, &c.base);
    if named.iter().any(|n| n.worsens(&model)) {
        return None;
    }
    let left = departing.as_ref().map_or(&model.fit, |d| &d.judged.fit);
    let elsewhere = residual_tests::of_what_was_not(data, left, scales);
    let at_noise = Test { p_value: 0.0, size: Size::of(excess, AT_NOISE, FAINT) };
    let outcome = rule(&ruling::Evidence {
        named: named.len(),
        departs: departing.is_some(),
        tied: rivals.iter().filter(|r| !r.is_empty()).count(),
        remainder: Remainder::of([at_noise]).and(elsewhere).size,
        ..ruling::Evidence::default()
    });
    let after = residual_structure_of_noise(data, left).structure;
    let conclusion = Conclusion {
        outcome,
        elsewhere: elsewhere.size,
        spread: interval::spread(&model.fit),
        model,
        named,
        dropped: Vec::new(),
        departing,
        after,
        lattice: None,
        ..c.clone()
    };
    Some((selection, conclusion))
}

impl Simulation {
    /// Writes the shares into an answer.
    pub(crate) fn told(self, answer: &mut Answer, c: &Conclusion, own_test: bool) {
        let Self { worth, imitations, noise } = self;
        // What a model leaves that does not explain everything is no noise.
        answer.fit.noise_floor = noise.unwrap_or(answer.fit.noise_floor);
        let share = |gain: Gain| Share { value: gain.share, ci95: gain.ci95() };
        for (index, gain) in &worth.each {
            // Effects begin with the named terms, in their order; several may have one id.
            let place = c.named.iter().position(|n| n.index == *index);
            if let Some(effect) = place.and_then(|place| answer.effects.get_mut(place)) {
                effect.share = Some(share(*gain));
            }
        }
        // Noise removes nothing of an error of free simulation.
        if worth.each.len() == c.named.len() {
            // A share of the recording that was fitted is none of another's error.
            answer.fit.test.share =
                if own_test { answer.fit.test.share_over(answer.fit.noise_floor) } else { worth.together.map(share) };
        }
        let argument = worth.rest.first();
        answer.places.argument =
            argument.map(|rest| DependsOn { name: rest.argument.word().to_owned(), share: share(rest.gain) });
        if !imitations.is_empty() {
            let said = "would remove part of the error, and not enough of it to be named";
            answer.findings.push(format!("{} {said}", imitations.join(" and ")));
        }
    }
}
