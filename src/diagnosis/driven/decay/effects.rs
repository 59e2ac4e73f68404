//! States in public numbers the findings of a decay: effects, base model, every candidate's
//! standing.

use crate::driven::base::OFFSET;
use crate::driven::verdict::effects::{BASE_NUMBERS, Channels, interval_about, parameter_unit, unit};
use crate::engine::evidence::Gain;
use crate::engine::fit::Fitted;
use crate::engine::kind::Kind;
use crate::engine::names::Named;
use crate::numerics::special;
use crate::physics::law::Role;
use crate::physics::library::Term;
use crate::physics::readout_highpass;
use crate::standing::{self, Note, Ranked};
use crate::verdict::{Effect, Estimate, Evidence, Form, Share};

use super::form::form;
use super::read::Read;
use super::rows::in_samples;
use super::searched::Decay;

/// 95 % of a normal distribution lie within this many standard deviations.
const REACH: f64 = 1.96;

/// A gain as the public document states it.
pub(super) fn share(gain: Gain) -> Share {
    Share { value: gain.share, ci95: gain.ci95() }
}

/// Probability of a gain by chance, among as many laws as were tried.
pub(super) fn p_value(decay: &Decay, gain: Gain) -> f64 {
    let degrees = (decay.system.layout().blocks.len() as f64 - 1.0).max(1.0);
    let chance = 0.5 * special::f_survival(gain.deviations().max(0.0).powi(2), 1.0, degrees);
    (chance * decay.system.laws() as f64).clamp(0.0, 1.0)
}

/// Named laws, strongest first, each followed by the laws that do as well in its place.
pub(super) fn effects(decay: &Decay, read: &Read) -> Vec<Effect> {
    let mut all: Vec<Effect> = Vec::new();
    for (named, rivals) in decay.found.named.iter().zip(&decay.numbers.rivals) {
        let model = &decay.numbers.model;
        let id = decay.system.members[model.set[named.place]].term.id();
        let others = rivals.iter().map(|(law, _)| decay.system.members[*law].term.id().to_owned());
        let mut others: Vec<String> = others.collect();
        others.dedup();
        all.push(Effect { confusable_with: others, ..effect(decay, named, model, named.place, read) });
        if may_be_coupled(decay, model, named.place) {
            let coupled = all.last_mut().map(|own| {
                own.confusable_with.push(readout_highpass::CANDIDATE.id.to_owned());
                coupled(own)
            });
            all.extend(coupled);
        }
        for (law, rival) in rivals {
            let place = rival.set.iter().position(|l| l == law);
            let other = place.map(|place| effect(decay, named, rival, place, read));
            if let Some(other) = other.filter(|o| all.iter().all(|known| known.id != o.id)) {
                all.push(Effect { confusable_with: vec![id.to_owned()], form: None, ..other });
            }
        }
    }
    all
}

/// Returns whether an offset that settles is what an AC-coupled readout shows: of a mass that is let go at x₀, the
/// charge that its capacitor holds, −x₀·exp(−t/τ), which is no larger than the motion.
fn may_be_coupled(decay: &Decay, model: &Fitted, place: usize) -> bool {
    let (system, law) = (&decay.numbers.system, model.set[place]);
    let is_transient = matches!(decay.system.members[law].term, Term::WarmUp(_)) && decay.data.input.is_none();
    let values = system.shared_values(&model.set, &model.point);
    let offset = system.own(OFFSET, &values);
    let largest = system.rows.readings().iter().fold(0.0f64, |most, y| most.max((y - offset).abs()));
    is_transient && values[system.coordinates(&model.set, place)][0].abs() <= largest
}

/// An AC-coupled readout with the time constant and the standing of an offset that settles.
fn coupled(settles: &Effect) -> Effect {
    let words = &readout_highpass::CANDIDATE;
    let is_its = |e: &&Estimate| words.parameters.iter().any(|p| p.name == e.name);
    Effect {
        id: words.id.to_owned(),
        statement: words.statement.to_owned(),
        equation: words.equation.to_owned(),
        parameters: settles.parameters.iter().filter(is_its).cloned().collect(),
        confusable_with: vec![settles.id.clone()],
        form: None,
        ..settles.clone()
    }
}

fn effect(decay: &Decay, named: &Named, model: &Fitted, place: usize, read: &Read) -> Effect {
    let term = decay.system.members[model.set[place]].term;
    let words = term.candidate();
    Effect {
        id: words.id.to_owned(),
        statement: words.statement.to_owned(),
        equation: words.equation.to_owned(),
        parameters: estimates(decay, model, place, read),
        channels: vec![read.channels.output.clone()],
        form: effect_form(decay, named),
        evidence: Evidence { held_out_gain: named.gain.share, p_value: p_value(decay, named.gain) },
        share: Some(share(named.gain)),
        base: Vec::new(),
        confusable_with: Vec::new(),
    }
}

fn effect_form(decay: &Decay, named: &Named) -> Option<Form> {
    let (freed, gain) = named.departs.as_ref()?;
    form(decay, freed, *gain)
}

/// The parameters of the law at a place of a set.
fn estimates(decay: &Decay, model: &Fitted, place: usize, read: &Read) -> Vec<Estimate> {
    let term = decay.system.members[model.set[place]].term;
    let own = decay.system.coordinates(&model.set, place);
    let parameters = term.candidate().parameters;
    // What changes the reading is measured by it, what moves the mass by its displacement.
    let is_readout = matches!(term.role(), Role::Readout(_));
    let channels = if is_readout { read.channels.clone() } else { read.of_displacement() };
    let values = &decay.system.shared_values(&model.set, &model.point)[own.clone()];
    let one = |(j, i): (usize, usize)| {
        let power = if is_readout { power_of_reading(parameters[j].unit) } else { 0 };
        let factor = read.observed.per_displacement().powi(power) * in_samples(&decay.system.rows, &term, values, j);
        let (value, ci95) = scaled(interval(decay, model, i), factor);
        Estimate { name: parameters[j].name.to_owned(), value, unit: parameter_unit(&term, j, &channels), ci95 }
    };
    let mut all: Vec<Estimate> = own.enumerate().take(parameters.len()).map(one).collect();
    // Of a reading with its sign turned the lower rail is the upper one.
    if let (Term::ReadoutSaturation(_), [low, high]) = (term, all.as_mut_slice())
        && low.value > high.value
    {
        std::mem::swap(&mut low.value, &mut high.value);
        std::mem::swap(&mut low.ci95, &mut high.ci95);
    }
    all
}

/// Power of the reading, `y`, in a parameter's unit.
fn power_of_reading(pattern: &str) -> i32 {
    let of = |part: &str| match part.find('y') {
        None => 0,
        Some(at) => {
            part[at + 1..].strip_prefix('^').and_then(|p| p.chars().next()?.to_digit(10)).map_or(1, |p| p as i32)
        }
    };
    let (over, under) = pattern.split_once('/').unwrap_or((pattern, ""));
    of(over) - of(under)
}

/// A value and its interval, multiplied by a factor of either sign.
fn scaled((value, [low, high]): (f64, [f64; 2]), factor: f64) -> (f64, [f64; 2]) {
    let (a, b) = (low * factor, high * factor);
    (value * factor, [a.min(b), a.max(b)])
}

/// A shared value with its interval.
fn interval(decay: &Decay, model: &Fitted, i: usize) -> (f64, [f64; 2]) {
    let coordinate = decay.system.shared_coordinates(&model.set)[i];
    let value = decay.system.shared_values(&model.set, &model.point)[i];
    (value, interval_about(value, coordinate, [REACH * model.deviations[i]; 2]))
}

/// ω₀, ζ, the gain under an input and the offset, as fitted together with the named laws.
pub(super) fn base(decay: &Decay, read: &Read) -> Vec<Estimate> {
    let displacement = read.of_displacement();
    let places = decay.system.oscillator();
    let known = |(name, place, pattern): (&str, usize, &str)| {
        let found = interval(decay, &decay.numbers.model, places.iter().position(|p| *p == place)?);
        let (channels, factor) = match place {
            OFFSET => (&read.channels, read.observed.per_displacement()),
            _ => (&displacement, 1.0),
        };
        let (value, ci95) = scaled(found, factor);
        Some(Estimate { name: name.to_owned(), value, unit: unit(pattern, channels), ci95 })
    };
    BASE_NUMBERS.into_iter().filter_map(known).collect()
}

/// Named laws first, then each law alone.
pub(super) fn ranking(decay: &Decay, channels: &Channels) -> Vec<Ranked> {
    let of = |law: usize, gain: Gain, named: bool| Ranked {
        id: decay.system.members[law].term.id(),
        channels: vec![channels.output.clone()],
        gain: standing::Gain::held_out(gain.share, gain.ci95()),
        p_value: p_value(decay, gain),
        named,
        note: if named { Note::BesideNamed } else { Note::Alone },
    };
    let found = &decay.found;
    let mut all: Vec<Ranked> = found.named.iter().map(|n| of(found.model.set[n.place], n.gain, true)).collect();
    for (law, gain) in &found.alone {
        let id = decay.system.members[*law].term.id();
        if all.iter().all(|r| r.id != id) {
            all.push(of(*law, *gain, false));
        }
    }
    all
}
