//! The effects of a still sensor, from what was selected: each channel's own, the drift that they share, their levels.

use super::channel::{Addition, BAND_LIMIT, Channel, Fitted};
use super::check::Remainder;
use super::common::{Common, is_slow};
use super::rounding::Counts;
use super::selection::{ALPHA, Selected};
use super::spectrum::Law;
use super::{candidate, describe};
use crate::diagnosis::model;
use crate::diagnosis::verdict::{Effect, Estimate, Evidence};
use crate::numerics::special::chi_squared_above;

/// Rounding that makes up this share of the white variance is worth a name.
const COARSE: f64 = 0.1;
/// A datasheet's level is a typical one: nearer than this is as promised.
const LEVEL: f64 = 0.05;

fn effect(id: &str, parameters: Vec<Estimate>, channels: Vec<String>, evidence: Evidence) -> Effect {
    let entry = candidate::entry(id);
    Effect {
        id: id.into(),
        statement: entry.statement.into(),
        equation: entry.equation.into(),
        parameters,
        channels,
        evidence,
        confusable_with: Vec::new(),
    }
}

/// What a channel's own terms amount to; slow ones are left to the common cause where it has one.
pub(super) fn of_terms(channel: &Channel, selected: &Selected, shared: bool, unit: &str) -> Vec<Effect> {
    let terms = selected.fitted.terms.iter().zip(&selected.evidence).enumerate();
    terms
        .filter(|(_, (term, _))| term.id != BAND_LIMIT && !(shared && is_slow(term, channel)))
        .map(|(index, (term, (p_value, share, close)))| {
            let parameters = describe::parameters(channel, &selected.fitted, index, unit);
            let evidence = Evidence { held_out_gain: *share, p_value: *p_value };
            let mut effect = effect(term.id, parameters, vec![channel.name.clone()], evidence);
            effect.confusable_with = close.iter().take(1).map(|c| (*c).to_owned()).collect();
            effect
        })
        .collect()
}

/// Whether an effect moves the bias slowly.
pub(super) fn is_drift(id: &str) -> bool {
    !matches!(id, "white-noise" | "quantisation-noise" | "sinusoid")
}

/// Whether an effect stands though more is left: it has a witness of its own, or it holds wherever it rules.
pub(super) fn stands(effect: &Effect, channel: &Channel, fitted: &Fitted, remainder: &Remainder) -> bool {
    match effect.id.as_str() {
        "sinusoid" => is_a_line(effect, channel, remainder),
        id => witnessed(effect) || holds_where_it_rules(id, fitted, remainder),
    }
}

/// Whether nothing is amiss around a sine: a hump wider than a line takes several of them and is still not described.
fn is_a_line(effect: &Effect, channel: &Channel, remainder: &Remainder) -> bool {
    let frequency_hz = effect.parameters.iter().find(|p| p.name == "frequency").map_or(0.0, |p| p.value);
    let theta = std::f64::consts::PI * frequency_hz / channel.rate_hz;
    // Bands are a third wide: this one and its neighbours.
    !remainder.failing.iter().any(|centre| (theta / centre).ln().abs() < 0.5)
}

/// Whether an effect rests on more than the shape of a spectrum: a common cause, a grid, a promise.
fn witnessed(effect: &Effect) -> bool {
    match effect.id.as_str() {
        "temperature-sensitivity" | "white-noise" => true,
        "quantisation-noise" => effect.parameters.iter().any(|p| p.name == "step"),
        _ => false,
    }
}

/// Whether nothing is amiss in time, and in no band where this law is the larger part of the model.
fn holds_where_it_rules(id: &str, fitted: &Fitted, remainder: &Remainder) -> bool {
    let Some(index) = fitted.terms.iter().position(|t| t.id == id) else { return false };
    // Laws of finite reach (a memory, differences) fit any hump; only those that rise to the lowest frequency count.
    let Addition::Law(law @ (Law::Walk | Law::Flicker)) = fitted.terms[index].addition else { return false };
    let strength = fitted.strength_of(index).0;
    let all = |theta: f64| -> f64 {
        fitted.laws().iter().zip(&fitted.strengths.values).map(|(l, s)| s * l.variance(theta)).sum()
    };
    let rules = |theta: &f64| strength * law.variance(*theta) > 0.5 * all(*theta);
    remainder.p_value_in_time >= ALPHA && !remainder.failing.iter().any(rules)
}

/// The drift that channels share, as one effect; their models become the ones with it.
pub(super) fn of_common(common: &Common, channels: &[Channel], finals: &mut [Fitted]) -> Effect {
    finals[common.leader] = common.leader_fit.clone();
    let mut names = vec![channels[common.leader].name.clone()];
    let (mut p_value, mut share) = (0.0f64, f64::INFINITY);
    let mut parameters = Vec::new();
    for follower in &common.followers {
        let channel = &channels[follower.channel];
        names.push(channel.name.clone());
        p_value = p_value.max(follower.p_value);
        share = share.min(follower.share);
        let last = follower.fitted.terms.len() - 1;
        let slope = describe::parameters(channel, &follower.fitted, last, "");
        let leader = &channels[common.leader];
        parameters.extend(slope.into_iter().map(|e| Estimate {
            name: format!("{} over {}", channel.name, leader.name),
            value: e.value / leader.scale,
            unit: "1".into(),
            ci95: e.ci95.map(|v| v / leader.scale),
        }));
        finals[follower.channel] = follower.fitted.clone();
    }
    effect("temperature-sensitivity", parameters, names, Evidence { held_out_gain: share, p_value })
}

/// Variance by which the white level beside flicker depends on what the sensor does above half the sampling rate: 1/f goes
/// on there, and whether it folds back or is averaged away is no part of the law. Its variance at that frequency.
fn folded(fitted: &Fitted) -> f64 {
    let flicker = fitted.terms.iter().position(|t| matches!(t.addition, Addition::Law(Law::Flicker)));
    flicker.map_or(0.0, |i| fitted.strength_of(i).0 * Law::Flicker.variance(std::f64::consts::FRAC_PI_2))
}

/// Rounding as coarse as the noise, and a white level other than promised.
pub(super) fn of_level(channel: &Channel, fitted: &Fitted, noise: Option<&model::Noise>, unit: &str) -> Vec<Effect> {
    let mut out = Vec::new();
    let (white, error) = fitted.white();
    let rounding = channel.rounding();
    let share = rounding / white.max(rounding);
    let coarse = channel.step.filter(|_| share > COARSE);
    let of = |id, parameter, evidence| effect(id, vec![parameter], vec![channel.name.clone()], evidence);
    if let Some(step) = coarse.map(|q| q * channel.scale) {
        let parameter = Estimate { name: "step".into(), value: step, unit: unit.into(), ci95: [step, step] };
        // A smooth reading would not fall on a grid once.
        out.push(of("quantisation-noise", parameter, Evidence { held_out_gain: share, p_value: f64::MIN_POSITIVE }));
    }
    let Some(noise) = noise else { return out };
    let promised = describe::white_of_density(channel, noise.density);
    // Variance before rounding, its interval, and the probability of so large a difference from the promise by chance.
    let (own, interval, p_value) = match coarse {
        // Rounded that coarsely, the variance depends on where between two steps the value lies; the counts know.
        Some(step) if fitted.terms.is_empty() && channel.together == 1 => {
            let counts = Counts::of(&channel.values, step);
            let (sigma, interval, gain) = counts.noise(promised.sqrt() / step);
            let variance = |s: f64| (s * step).powi(2);
            (variance(sigma), interval.map(variance), chi_squared_above(gain, 1.0))
        }
        _ => {
            let own = white - if coarse.is_some() { rounding } else { 0.0 };
            let folded = folded(fitted);
            let z = ((own - promised).abs() - folded).max(0.0) / error.max(0.3 * rounding);
            let [low, high] = describe::variance_interval(white, error).map(|v| v - white + own);
            let interval = [(low - folded).max(0.0), high + folded];
            (own, interval, chi_squared_above(z * z, 1.0))
        }
    };
    if p_value < ALPHA && ((own.max(0.0) / promised).sqrt() - 1.0).abs() > LEVEL {
        let density = |v: f64| describe::density_of_white(channel, v);
        let (value, ci95) = (density(own.max(0.0)), interval.map(density));
        let parameter = Estimate { name: "density".into(), value, unit: format!("{unit}/√Hz"), ci95 };
        let gain = 1.0 - (promised / own).min(own.max(0.0) / promised);
        out.push(of("white-noise", parameter, Evidence { held_out_gain: gain, p_value }));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_has_an_entry_of_its_own() {
        for entry in candidate::CANDIDATES {
            assert_eq!(candidate::entry(entry.id).id, entry.id);
        }
    }
}
