//! A conclusion in public numbers: named effects with their intervals in the recording's own units,
//! and every candidate's standing.

use crate::driven::base::{GAIN, OFFSET, OMEGA, ZETA};
use crate::driven::identification::fit::Fit;
use crate::driven::identification::interval;
use crate::driven::intake::data::Data;
use crate::driven::selection::held_out::{HeldOut, ratio_interval};
use crate::driven::selection::judged::{Selection, Trial};
use crate::driven::selection::term_worth::Named;
use crate::driven::simulation::structure::coordinates;
use crate::numerics::order;
use crate::physics::law::Noise;
use crate::physics::library::Term;
use crate::physics::readout_quantisation;
use crate::physics::scales::{Coordinate, Scales};
use crate::recording::Recording;
use crate::standing::{Gain, Note, Ranked};
use crate::verdict::{Effect, Estimate, Evidence, Form};

use super::conclude::Conclusion;
use super::product;

/// Names of the base model's public numbers, their places among its parameters, and their units.
pub(in crate::driven) const BASE_NUMBERS: [(&str, usize, &str); 4] =
    [("omega0", OMEGA, "rad/s"), ("zeta", ZETA, "1"), ("gain", GAIN, "y/(u s^2)"), ("offset", OFFSET, "y")];
/// Unit of a parameter that is a force on the mass.
const FORCE: &str = "y/s^2";

/// Names of the columns and their units.
#[derive(Debug, Clone, PartialEq)]
pub struct Channels {
    /// Heading of the output column.
    pub output: String,
    /// Unit of the output.
    pub output_unit: String,
    /// Unit of the input.
    pub input_unit: String,
    /// Units of the environment columns that laws may follow.
    pub environment_units: Vec<String>,
}

/// Unit of a column as file or heading state it, "V2_V" → "V"; `otherwise` where they do not. With
/// `^2` for a square, as all units of a verdict.
pub(crate) fn unit_of(recording: &Recording, heading: &str, otherwise: &str) -> String {
    recording.unit_words(heading).map_or_else(|| otherwise.to_owned(), |unit| unit.replace('²', "^2"))
}

/// Unit of a term's parameter: a share per unit of the environment column where the term follows one.
pub(in crate::driven) fn parameter_unit(term: &Term, parameter: usize, channels: &Channels) -> String {
    match term.environment().and_then(|column| channels.environment_units.get(column)) {
        Some(own) => format!("1/{own}"),
        None => unit(term.candidate().parameters[parameter].unit, channels),
    }
}

/// A candidate's unit with the recording's own units in place of `y` and `u`, reduced where they are
/// products of units: m over m/s² and s² is 1.
pub fn unit(pattern: &str, channels: &Channels) -> String {
    // A unit that is not known is called `output unit`: in products `output`, as it is no product of two.
    match pattern {
        "y" => return channels.output_unit.clone(),
        "u" => return channels.input_unit.clone(),
        _ => {}
    }
    let units = [&channels.output_unit, &channels.input_unit].map(|unit| unit.strip_suffix(" unit").unwrap_or(unit));
    if units.iter().any(|unit| unit.contains(['/', ' ', '^'])) {
        let replaced = substituted(pattern, units.map(|unit| format!("({unit})")).each_ref().map(String::as_str));
        return product::reduced(&replaced).unwrap_or(replaced);
    }
    substituted(pattern, units)
}

/// The pattern with units in place of `y` and `u`.
fn substituted(pattern: &str, [output, input]: [&str; 2]) -> String {
    let mut out = String::new();
    let letters: Vec<char> = pattern.chars().collect();
    for (i, c) in letters.iter().enumerate() {
        let alone = |j: Option<usize>| j.and_then(|j| letters.get(j)).is_none_or(|c| !c.is_alphabetic());
        let single = alone(i.checked_sub(1)) && alone(Some(i + 1));
        match c {
            'y' if single => out += output,
            'u' if single => out += input,
            c => out.push(*c),
        }
    }
    out
}

/// Standard deviation of the readout noise of a fit.
fn readout_noise(data: &Data, fit: &Fit) -> f64 {
    (fit.variance / fit.structure.gain(&fit.point, data.interval_s()).innovation_variance).sqrt()
}

/// Returns the deviation that noise alone leaves in free simulation.
pub(crate) fn noise_floor(data: &Data, fit: &Fit) -> f64 {
    let r = readout_noise(data, fit);
    let mut variance = r * r;
    for (i, term) in fit.structure.terms.iter().enumerate() {
        if term.noise() == Some(Noise::Force) {
            variance += (fit.structure.of(i, &fit.point)[0] * r).powi(2);
        }
    }
    variance.sqrt()
}

/// The base model's own numbers, as fitted together with the terms: ω₀, ζ, the gain of a driven
/// recording, the offset.
pub fn base(c: &Conclusion, scales: &Scales, channels: &Channels) -> Vec<Estimate> {
    let fit = &c.model.fit;
    let coordinates = coordinates(&fit.structure, scales);
    let known = |(name, place, pattern): (&str, usize, &str)| {
        let index = fit.free.iter().position(|f| *f == place)?;
        let reach = c.spread.reach.get(index).copied().filter(|_| !(scales.at_once && place == GAIN))?;
        let value = fit.point[place];
        Some(Estimate {
            name: name.to_owned(),
            value,
            unit: unit(pattern, channels),
            ci95: interval_about(value, coordinates[place], reach),
        })
    };
    BASE_NUMBERS.into_iter().filter_map(known).collect()
}

/// The 95 % interval about a value that moves in this coordinate.
pub(in crate::driven) fn interval_about(value: f64, coordinate: Coordinate, reach: [f64; 2]) -> [f64; 2] {
    let [down, up] = reach.map(|r| r.min(1e3));
    match coordinate {
        Coordinate::Linear(scale) => [value - down * scale, value + up * scale],
        Coordinate::Bounded(scale, low, high) => [(value - down * scale).max(low), (value + up * scale).min(high)],
        Coordinate::Log(low, high) => [(value.ln() - down).exp().max(low), (value.ln() + up).exp().min(high)],
        Coordinate::Held => [value; 2],
    }
}

/// The parameters of one term with their intervals.
pub(crate) fn estimates(
    data: &Data,
    c: &Conclusion,
    scales: &Scales,
    index: usize,
    channels: &Channels,
) -> Vec<Estimate> {
    let fit = &c.model.fit;
    let term = fit.structure.terms[index];
    let coordinates = term.coordinates(scales);
    let reach = interval::reach();
    if let Some(noise) = term.noise() {
        return vec![strength(data, c, index, noise, reach, channels)];
    }
    let all: Vec<Estimate> = term
        .candidate()
        .parameters
        .iter()
        .enumerate()
        .map(|(j, parameter)| {
            let place = fit.structure.first[index] + j;
            let value = fit.point[place];
            let reach = fit.free.iter().position(|f| *f == place).map_or([0.0; 2], |f| c.spread.reach[f]);
            let ci95 = interval_about(value, coordinates[j], reach);
            Estimate { name: parameter.name.to_owned(), value, unit: parameter_unit(&term, j, channels), ci95 }
        })
        .collect();
    let forces: Vec<Estimate> = term
        .candidate()
        .parameters
        .iter()
        .zip(&all)
        .filter(|(p, _)| p.unit == FORCE && data.input.is_some())
        .map(|(_, e)| in_input(e, c, channels))
        .collect();
    all.into_iter().chain(forces).collect()
}

/// A force in the unit of the input: over the gain, whose own uncertainty counts as independent.
fn in_input(force: &Estimate, c: &Conclusion, channels: &Channels) -> Estimate {
    let fit = &c.model.fit;
    let gain = fit.point[GAIN].abs();
    let place = fit.free.iter().position(|f| *f == GAIN);
    let of_gain = place.map_or(0.0, |k| interval::reach() * (c.spread.deviation[k] * fit.slopes[k] / gain).abs());
    let value = force.value / gain;
    let side = |end: f64| ((end - force.value) / gain).hypot(value * of_gain.min(1e3));
    let ci95 = [value - side(force.ci95[0]), value + side(force.ci95[1])];
    Estimate { name: format!("{}/g", force.name), value, unit: channels.input_unit.clone(), ci95 }
}

/// The strength of a noise term in the recording's unit. The filter knows it relative to the
/// readout noise; where readout noise is negligible that ratio is only bounded below, while the
/// strength itself is well known.
fn strength(data: &Data, c: &Conclusion, index: usize, noise: Noise, reach: f64, channels: &Channels) -> Estimate {
    let fit = &c.model.fit;
    let place = fit.structure.first[index];
    let factor = if noise == Noise::Walk { data.rate_hz.sqrt() } else { 1.0 };
    let value = fit.point[place] * readout_noise(data, fit);
    // By the delta method over every noise ratio: all of them are relative to the same readout
    // noise.
    let noises: Vec<(usize, f64)> = fit
        .structure
        .terms
        .iter()
        .zip(&fit.structure.first)
        .filter(|(t, _)| t.noise().is_some())
        .filter_map(|(_, first)| {
            let mut moved = fit.clone();
            moved.point[*first] *= 1.05;
            let there = moved.point[place] * readout_noise(data, &moved);
            Some((fit.free.iter().position(|f| f == first)?, (there / value).ln() / 1.05f64.ln()))
        })
        .collect();
    let mut variance = 0.0;
    for (i, a) in &noises {
        for (j, b) in &noises {
            let d = |k: usize| c.spread.deviation[k].min(1e3);
            variance += a * b * c.spread.correlation[(*i, *j)] * d(*i) * d(*j);
        }
    }
    let deviation = variance.max(0.0).sqrt().min(10.0);
    let of_variance = (0.5 / fit.linear.residual.len().max(1) as f64).sqrt();
    let reach = reach * deviation.hypot(of_variance);
    let parameter = fit.structure.terms[index].candidate().parameters[0];
    Estimate {
        name: parameter.name.to_owned(),
        value: value * factor,
        unit: unit(parameter.unit, channels),
        ci95: [value * factor * (-reach).exp(), value * factor * reach.exp()],
    }
}

/// The named terms as public effects.
pub fn effects(
    data: &Data,
    c: &Conclusion,
    selection: &Selection,
    scales: &Scales,
    channels: &Channels,
    forms: &[(usize, Form)],
) -> Vec<Effect> {
    let floor = noise_floor(data, &c.model.fit).powi(2);
    let class = selection.reach.class(&c.model.fit.structure.terms);
    let alike = |named: &Named| -> Vec<String> {
        let id = c.model.fit.structure.terms[named.index].id();
        let rivals: Vec<&str> = named.rivals.iter().map(|r| r.id).collect();
        let of_class = if class.contains(&id) { class.as_slice() } else { &[] };
        let others = of_class.iter().filter(|other| **other != id && !rivals.contains(other));
        rivals.iter().chain(others).map(|id| (*id).to_owned()).collect()
    };
    let mut effects: Vec<Effect> = Vec::new();
    for named in &c.named {
        let term = c.model.fit.structure.terms[named.index];
        let words = term.candidate();
        effects.push(Effect {
            id: words.id.to_owned(),
            statement: words.statement.to_owned(),
            equation: words.equation.to_owned(),
            parameters: estimates(data, c, scales, named.index, channels),
            channels: vec![channels.output.clone()],
            form: forms.iter().find(|(index, _)| *index == named.index).map(|(_, form)| form.clone()),
            evidence: Evidence { held_out_gain: gain(c, named, floor).value(), p_value: named.comparison.p_value },
            share: None,
            base: Vec::new(),
            confusable_with: alike(named),
        });
    }
    // A rival stands next to the term that it is indistinguishable from, with its own parameters.
    for named in &c.named {
        let id = c.model.fit.structure.terms[named.index].id();
        for rival in &named.rivals {
            if effects.iter().any(|e| e.id == rival.id) {
                continue;
            }
            let Some(index) = rival.judged.fit.structure.terms.iter().position(|t| t.id() == rival.id) else {
                continue;
            };
            let words = rival.judged.fit.structure.terms[index].candidate();
            let there =
                Conclusion { model: rival.judged.clone(), spread: interval::spread(&rival.judged.fit), ..c.clone() };
            effects.push(Effect {
                id: words.id.to_owned(),
                statement: words.statement.to_owned(),
                equation: words.equation.to_owned(),
                parameters: estimates(data, &there, scales, index, channels),
                channels: vec![channels.output.clone()],
                form: None,
                evidence: Evidence { held_out_gain: gain(c, named, floor).value(), p_value: named.comparison.p_value },
                share: None,
                base: base(&there, scales, channels),
                confusable_with: vec![id.to_owned()],
            });
        }
    }
    if let Some(lattice) = &c.lattice {
        let words = &readout_quantisation::CANDIDATE;
        let step = lattice.step;
        effects.push(Effect {
            id: words.id.to_owned(),
            statement: words.statement.to_owned(),
            equation: words.equation.to_owned(),
            parameters: vec![Estimate {
                name: "step".into(),
                value: step,
                unit: channels.output_unit.clone(),
                ci95: [step * (1.0 - 1e-6), step * (1.0 + 1e-6)],
            }],
            channels: vec![channels.output.clone()],
            form: None,
            evidence: Evidence {
                held_out_gain: lattice.gain,
                p_value: (-(lattice.gain * c.model.fit.linear.residual.len() as f64).min(600.0)).exp()
                    * selection.tried as f64,
            },
            share: None,
            base: Vec::new(),
            confusable_with: Vec::new(),
        });
    }
    for effect in &mut effects {
        effect.evidence.p_value = effect.evidence.p_value.clamp(0.0, 1.0);
    }
    effects
}

/// Returns what a named term adds to the others on held-out samples.
fn gain(c: &Conclusion, named: &Named, floor: f64) -> Gain {
    let term = c.model.fit.structure.terms[named.index];
    if term.noise().is_some() {
        let with = c.model.held_out.log_score(c.model.fit.variance);
        return Gain::LogScore { value: with - named.log_score_without };
    }
    removed(&named.without, &c.model.held_out, floor)
}

/// Part of the error of free simulation beyond the noise that goes away, with its interval from the
/// scatter between blocks.
fn removed(without: &HeldOut, with: &HeldOut, floor: f64) -> Gain {
    let whole = without.free().max(1e-300);
    let beyond = (1.0 - floor.min(with.free()) / whole).max(1e-12);
    let part = |ratio: f64| ((1.0 - ratio * ratio) / beyond).clamp(-1.0, 1.0);
    let [low, high] = ratio_interval(without, with);
    Gain::held_out(part((with.free() / whole).sqrt()), [part(high), part(low)])
}

/// Every candidate: named terms by what each adds to the others, then the others alone on the base
/// model, best first.
pub(crate) fn ranking(data: &Data, c: &Conclusion, selection: &Selection, channels: &Channels) -> Vec<Ranked> {
    let floor = noise_floor(data, &c.model.fit).powi(2);
    let mut ranked: Vec<Ranked> = Vec::new();
    for named in &c.named {
        ranked.push(Ranked {
            id: c.model.fit.structure.terms[named.index].id(),
            channels: vec![channels.output.clone()],
            gain: gain(c, named, floor),
            p_value: named.comparison.p_value,
            named: true,
            note: Note::BesideNamed,
        });
    }
    let mut others: Vec<Ranked> = Vec::new();
    for trial in &selection.alone {
        let id = trial.term.id();
        if ranked.iter().chain(&others).any(|r| r.id == id) {
            continue;
        }
        let dropped = c.dropped.iter().find(|(t, _)| t.id() == id).map(|(_, reason)| *reason);
        let fate = match dropped {
            Some(reason) if c.model.has(id) => Note::Unnamed(reason),
            Some(reason) => Note::Dropped(reason),
            None if trial.judged.is_some() => Note::Alone,
            None => Note::Screened,
        };
        others.push(alone(data, trial, selection, fate, channels));
    }
    order::sort_by_key(&mut others, |r| -r.gain.value());
    order::sort_by_key(&mut others, |r| r.gain.rank());
    ranked.extend(others);
    ranked
}

/// A candidate alone on the base model.
fn alone(data: &Data, trial: &Trial, selection: &Selection, note: Note, channels: &Channels) -> Ranked {
    let base = &selection.base;
    let gain = match &trial.judged {
        Some(with) if trial.term.noise().is_some() => Gain::LogScore {
            value: with.held_out.log_score(with.fit.variance) - base.held_out.log_score(base.fit.variance),
        },
        Some(with) => removed(&base.held_out, &with.held_out, noise_floor(data, &with.fit).powi(2)),
        None if trial.promised.is_finite() => Gain::InSample { value: (1.0 - trial.promised).clamp(0.0, 1.0) },
        None => Gain::InSample { value: 0.0 },
    };
    Ranked {
        id: trial.term.id(),
        channels: vec![channels.output.clone()],
        gain,
        p_value: (trial.comparison.p_value * selection.tried as f64).min(1.0),
        named: false,
        note,
    }
}
