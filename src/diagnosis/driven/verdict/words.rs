//! What a conclusion says in words and public numbers: effects with intervals, the sentence, the next experiment.

use crate::diagnosis::driven::identification::fit::Fit;
use crate::diagnosis::driven::identification::interval;
use crate::diagnosis::driven::intake::data::Data;
use crate::diagnosis::driven::selection::judged::{Selection, Trial};
use crate::diagnosis::driven::selection::term_worth::Named;
use crate::diagnosis::driven::verdict::dropped::{Dropped, LeftOut};
use crate::diagnosis::standing::{Gain, Note, Ranked};
use crate::diagnosis::verdict::{Effect, Estimate, Evidence, Outcome};
use crate::number::{short, with_uncertainty};
use crate::physics::law::Noise;
use crate::physics::readout_quantisation;
use crate::physics::scales::{Coordinate, Scales};

use super::conclude::{Conclusion, WHITE};

/// Names of the columns and their units.
#[derive(Debug, Clone, PartialEq)]
pub struct Channels {
    /// Output column.
    pub output: String,
    /// Its unit.
    pub output_unit: String,
    /// Unit of the input.
    pub input_unit: String,
}

/// The unit that a heading ends in, "V2_V" → "V"; `otherwise` where it does not end in one.
pub fn unit_of(heading: &str, otherwise: &str) -> String {
    match heading.rsplit_once('_') {
        Some((_, unit)) if !unit.is_empty() && unit.len() <= 5 => unit.to_owned(),
        _ => otherwise.to_owned(),
    }
}

/// A candidate's unit with the recording's own units in place of `y` and `u`.
pub fn unit(pattern: &str, channels: &Channels) -> String {
    let mut out = String::new();
    let letters: Vec<char> = pattern.chars().collect();
    for (i, c) in letters.iter().enumerate() {
        let alone = |j: Option<usize>| j.and_then(|j| letters.get(j)).is_none_or(|c| !c.is_alphabetic());
        let single = alone(i.checked_sub(1)) && alone(Some(i + 1));
        match c {
            'y' if single => out += &channels.output_unit,
            'u' if single => out += &channels.input_unit,
            c => out.push(*c),
        }
    }
    out
}

/// Standard deviation of the readout noise of a fit.
pub fn readout_noise(data: &Data, fit: &Fit) -> f64 {
    (fit.variance / fit.shape.gain(&fit.point, data.interval_s()).innovation_variance).sqrt()
}

/// What noise alone leaves in free simulation.
pub fn noise_floor(data: &Data, fit: &Fit) -> f64 {
    let r = readout_noise(data, fit);
    let mut variance = r * r;
    for (i, term) in fit.shape.terms.iter().enumerate() {
        if term.noise() == Some(Noise::Force) {
            variance += (fit.shape.of(i, &fit.point)[0] * r).powi(2);
        }
    }
    variance.sqrt()
}

/// The parameters of one term with their intervals.
pub fn estimates(data: &Data, c: &Conclusion, scales: &Scales, index: usize, channels: &Channels) -> Vec<Estimate> {
    let fit = &c.model.fit;
    let term = fit.shape.terms[index];
    let coordinates = term.coordinates(scales);
    let reach = interval::reach();
    if let Some(noise) = term.noise() {
        return vec![strength(data, c, index, noise, reach, channels)];
    }
    term.candidate()
        .parameters
        .iter()
        .enumerate()
        .map(|(j, parameter)| {
            let place = fit.shape.first[index] + j;
            let value = fit.point[place];
            let reach = fit.free.iter().position(|f| *f == place).map_or([0.0; 2], |f| c.spread.reach[f]);
            let [down, up] = reach.map(|r| r.min(1e3));
            let ci95 = match coordinates[j] {
                Coordinate::Linear(scale) => [value - down * scale, value + up * scale],
                Coordinate::Bounded(scale, low, high) => {
                    [(value - down * scale).max(low), (value + up * scale).min(high)]
                }
                Coordinate::Log(low, high) => [(value.ln() - down).exp().max(low), (value.ln() + up).exp().min(high)],
            };
            Estimate { name: parameter.name.to_owned(), value, unit: unit(parameter.unit, channels), ci95 }
        })
        .collect()
}

/// The strength of a noise term in the recording's unit. The filter knows it relative to the readout noise; where readout
/// noise is negligible that ratio is only bounded below, while the strength itself is well known.
fn strength(data: &Data, c: &Conclusion, index: usize, noise: Noise, reach: f64, channels: &Channels) -> Estimate {
    let fit = &c.model.fit;
    let place = fit.shape.first[index];
    let factor = if noise == Noise::Walk { data.rate_hz.sqrt() } else { 1.0 };
    let value = fit.point[place] * readout_noise(data, fit);
    // By the delta method over every noise ratio: all of them are relative to the same readout noise.
    let noises: Vec<(usize, f64)> = fit
        .shape
        .terms
        .iter()
        .zip(&fit.shape.first)
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
    let parameter = fit.shape.terms[index].candidate().parameters[0];
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
) -> Vec<Effect> {
    let floor = noise_floor(data, &c.model.fit).powi(2);
    let mut effects: Vec<Effect> = Vec::new();
    for named in &c.named {
        let term = c.model.fit.shape.terms[named.index];
        let words = term.candidate();
        effects.push(Effect {
            id: words.id.to_owned(),
            statement: words.statement.to_owned(),
            equation: words.equation.to_owned(),
            parameters: estimates(data, c, scales, named.index, channels),
            channels: vec![channels.output.clone()],
            evidence: Evidence { held_out_gain: gain(c, named, floor), p_value: named.comparison.p_value },
            confusable_with: named.rivals.iter().map(|r| r.id.to_owned()).collect(),
        });
    }
    // A rival stands beside the term it is tied with, with its own parameters.
    for named in &c.named {
        let id = c.model.fit.shape.terms[named.index].id();
        for rival in &named.rivals {
            if effects.iter().any(|e| e.id == rival.id) {
                continue;
            }
            let Some(index) = rival.judged.fit.shape.terms.iter().position(|t| t.id() == rival.id) else { continue };
            let words = rival.judged.fit.shape.terms[index].candidate();
            let there =
                Conclusion { model: rival.judged.clone(), spread: interval::spread(&rival.judged.fit), ..c.clone() };
            effects.push(Effect {
                id: words.id.to_owned(),
                statement: words.statement.to_owned(),
                equation: words.equation.to_owned(),
                parameters: estimates(data, &there, scales, index, channels),
                channels: vec![channels.output.clone()],
                evidence: Evidence { held_out_gain: gain(c, named, floor), p_value: named.comparison.p_value },
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
            evidence: Evidence {
                held_out_gain: lattice.gain,
                p_value: (-(lattice.gain * c.model.fit.linear.residual.len() as f64).min(600.0)).exp()
                    * selection.tried as f64,
            },
            confusable_with: Vec::new(),
        });
    }
    for effect in &mut effects {
        effect.evidence.p_value = effect.evidence.p_value.clamp(0.0, 1.0);
    }
    effects
}

/// Share of the held-out error beyond the noise that a term removes; for a noise term, what it adds to the log-score.
fn gain(c: &Conclusion, named: &Named, floor: f64) -> f64 {
    if c.model.fit.shape.terms[named.index].noise().is_some() {
        return c.model.held_out.log_score(c.model.fit.variance) - named.log_score_without;
    }
    let beyond = named.free_without - floor.min(c.model.held_out.free());
    ((named.free_without - c.model.held_out.free()) / beyond.max(1e-300)).clamp(-1.0, 1.0)
}

/// Every candidate's standing.
pub fn ranking(c: &Conclusion, selection: &Selection, channels: &Channels) -> Vec<Ranked> {
    let mut ranked: Vec<Ranked> = Vec::new();
    for named in &c.named {
        ranked.push(Ranked {
            id: c.model.fit.shape.terms[named.index].id(),
            channels: vec![channels.output.clone()],
            gain: Gain::held_out(named.comparison.gain, named.comparison.ci95),
            p_value: named.comparison.p_value,
            named: true,
            note: Note::BesideNamed,
        });
    }
    for trial in &selection.alone {
        let id = trial.term.id();
        if ranked.iter().any(|r| r.id == id) {
            continue;
        }
        let dropped = c.dropped.iter().find(|(t, _)| t.id() == id).map(|(_, reason)| *reason);
        ranked.push(alone(trial, selection.tried, dropped, channels));
    }
    ranked
}

fn alone(trial: &Trial, tried: usize, dropped: Option<Dropped>, channels: &Channels) -> Ranked {
    let note = match (dropped, &trial.judged) {
        (Some(reason), _) => Note::Dropped(reason),
        (None, Some(_)) => Note::Alone,
        (None, None) => Note::Screened,
    };
    let promised = if trial.promised.is_finite() { (1.0 - trial.promised).clamp(0.0, 1.0) } else { 0.0 };
    let c = &trial.comparison;
    Ranked {
        id: trial.term.id(),
        channels: vec![channels.output.clone()],
        gain: if trial.judged.is_some() { Gain::held_out(c.gain, c.ci95) } else { Gain::InSample { value: promised } },
        p_value: (c.p_value * tried as f64).min(1.0),
        named: false,
        note,
    }
}

/// One or two plain sentences.
pub fn sentence(c: &Conclusion, effects: &[Effect], channels: &Channels) -> String {
    let (before, after) = (c.base.held_out.free().sqrt(), c.model.held_out.free().sqrt());
    let unit = &channels.output_unit;
    let fall = format!("the error on held-out samples goes from {} to {} {unit}", short(before), short(after));
    let named: Vec<String> = effects
        .iter()
        .map(|e| {
            let p = e.parameters.first();
            let number = p.map_or(String::new(), |p| {
                let half = 0.5 * (p.ci95[1] - p.ci95[0]);
                let unit = p.unit.replace("^2", "²").replace("^3", "³");
                format!(" ({} = {} {unit})", p.name, with_uncertainty(p.value, half))
            });
            format!("{}{number}", e.id)
        })
        .collect();
    match c.outcome {
        Outcome::Explained => format!("The model left out {}; with it, {fall}.", listed(&named, "and")),
        Outcome::Undecidable if effects.is_empty() => format!(
            "Something faint is left ({} % of the variance can be foreseen), too weak in this recording to be named.",
            short(100.0 * c.after.share)
        ),
        Outcome::Undecidable => {
            let also: Vec<String> =
                effects.iter().filter(|e| !e.confusable_with.is_empty()).map(|e| e.id.clone()).collect();
            format!(
                "Something is missing, and this recording cannot tell {} apart; with either, {fall}.",
                listed(&also, "and")
            )
        }
        Outcome::Unexplained if named.is_empty() && (c.series.is_some() || c.after.share < WHITE) => format!(
            "The mismatch is real, and the library has only a series of stand-ins for it{}, none of which holds by itself.",
            c.series.map_or(String::new(), |s| format!(" ({})", s.words()))
        ),
        Outcome::Unexplained if named.is_empty() => format!(
            "The mismatch is real, and nothing in the library accounts for it: {} % of what is left can be foreseen from the \
             past, the input or the state.",
            short(100.0 * c.after.share)
        ),
        Outcome::Unexplained => {
            let holding = holding(effects, &named);
            format!(
                "{} hold{}, but do not account for everything: {fall}, and {} % of the variance of what is left can be \
                 foreseen.",
                listed(&holding, "and"),
                if holding.len() == 1 { "s" } else { "" },
                short(100.0 * c.after.share)
            )
        }
        Outcome::Adequate => format!(
            "Nothing is missing that this recording could show: the base model's error of {} {unit} is white, and an effect \
             that moved {} % of its variance would have been seen.",
            short(before),
            short(100.0 * c.after.detectable_share)
        ),
    }
}

/// Effects with their numbers, tied ones once: "a or b".
fn holding(effects: &[Effect], named: &[String]) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut said: Vec<&str> = Vec::new();
    for (effect, words) in effects.iter().zip(named) {
        if said.contains(&effect.id.as_str()) {
            continue;
        }
        said.push(&effect.id);
        said.extend(effect.confusable_with.iter().map(String::as_str));
        let tied = std::iter::once(&effect.id).chain(&effect.confusable_with).cloned().collect::<Vec<_>>();
        out.push(if effect.confusable_with.is_empty() { words.clone() } else { tied.join(" or ") });
    }
    out
}

/// What else a reader of the verdict must know of the recording, as a sentence.
pub fn doubts(clauses: &[String]) -> String {
    if clauses.is_empty() { String::new() } else { format!(" But mind: {}.", clauses.join("; ")) }
}

/// What would decide or confirm.
pub fn next_experiment(c: &Conclusion, effects: &[Effect], input: bool) -> String {
    let source = if input { "drive" } else { "release" };
    match c.outcome {
        Outcome::Undecidable if effects.is_empty() => {
            "Record longer, or harder: what is left must rise well above the noise before it can be named.".to_owned()
        }
        Outcome::Undecidable => {
            let tied: Vec<&str> =
                effects.iter().filter(|e| !e.confusable_with.is_empty()).map(|e| e.id.as_str()).collect();
            format!(
                "Record again with another amplitude and band ({source} at a third and at three times this level, with power \
                 well above the resonance too): {} then part, because they grow differently with amplitude and frequency.",
                listed(&tied.iter().map(|t| (*t).to_owned()).collect::<Vec<_>>(), "and")
            )
        }
        Outcome::Explained => format!(
            "Confirm on a recording at a different level ({source} at twice the amplitude): the parameters stated must stay \
             within their intervals."
        ),
        Outcome::Unexplained => format!(
            "{} at one frequency and a ladder of amplitudes, up and down: what depends on history shows as a difference \
             between both ways, what depends on amplitude as a bend, what does neither is noise.",
            if input { "Drive" } else { "Release" }
        ),
        Outcome::Adequate => format!(
            "{} harder or longer: smaller effects then rise above the noise. `proofmass trial --like RECORDING --model \
             MODEL.toml` plants each candidate into copies of this recording and says from which size on it would have been \
             named.",
            if input { "Drive" } else { "Release" }
        ),
    }
}

fn listed(items: &[String], last: &str) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [head @ .., tail] => format!("{} {last} {tail}", head.join(", ")),
    }
}

/// Why a term has no name, as a clause.
pub fn dropped(reason: Dropped) -> String {
    match reason {
        Dropped::Indispensable => "the model breaks down without it, so that nothing says what it adds".into(),
        Dropped::Worsens => "made the prediction of the test samples worse".into(),
        Dropped::FollowsRounding => "follows only the rounding of the readings; carried along, not named".into(),
        Dropped::SmallerThanTheRest => "smaller than what is still unexplained; carried along, not named".into(),
        Dropped::WithinInexactness => {
            "too small beside what the other terms explain to be told from their inexactness; carried along, not named"
                .into()
        }
        Dropped::Twin => "only together with another that it can be mistaken for".into(),
        Dropped::Series(series) => format!("only in a series: {}", series.words()),
        Dropped::StandIn => "a stand-in: does not bring the residual to the noise".into(),
    }
}

/// What was left undone, as a clause.
pub fn left_out(what: LeftOut) -> &'static str {
    match what {
        LeftOut::Profiles => {
            "the intervals of laws with a corner are those of a parabola: their profiles were not finished"
        }
        LeftOut::WeighingAgain => "terms were not weighed again without one that made the prediction worse",
    }
}
