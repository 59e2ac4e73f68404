//! From what was selected to a verdict in words and numbers.

use super::channel::{Addition, Channel, Fitted};
use super::check::{self, TOLERANCE};
use super::common::{Common, is_slow};
use super::selection::{ALPHA, Selected};
use super::spectrum::{self, Law, Part};
use super::{Detail, candidate, describe};
use crate::diagnosis::candidate::Kind;
use crate::diagnosis::model;
use crate::diagnosis::repair::{Cost, Repair, Vibration};
use crate::diagnosis::verdict::{
    Effect, Estimate, Evidence, Fit, LogScore, Outcome, SCHEMA, Score, Source, Verdict, Where, Whiteness,
};
use crate::diagnosis::{Detail as AnyDetail, Diagnosis, Ranked};
use crate::numerics::special::chi_squared_above;
use crate::recording::Recording;
use crate::recording::unit::{Quantity, Unit};
use crate::sensor::{Accelerometer, Gyro, Sensor};
use crate::units::DENSITY_TO_RANDOM_WALK;

/// Rounding that makes up this share of the white variance is worth a name.
const COARSE: f64 = 0.1;
/// A datasheet's level is a typical one: nearer than this is as promised.
const LEVEL: f64 = 0.05;

pub(super) struct Material<'a> {
    pub(super) recording: &'a Recording,
    pub(super) model: &'a model::Static,
    pub(super) channels: &'a [Channel],
    /// Step that each channel's numbers are rounded to.
    pub(super) steps: &'a [Option<f64>],
    /// Samples averaged into one.
    pub(super) together: usize,
    pub(super) selected: &'a mut [Selected],
    pub(super) common: Option<Common>,
    pub(super) findings: Vec<String>,
}

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

pub(super) fn conclude(material: Material<'_>) -> Diagnosis {
    let Material { recording, model, channels, steps, together, selected, common, mut findings } = material;
    let unit = if model.unit.is_empty() { "unit" } else { &model.unit };
    let mut effects = Vec::new();
    let mut finals: Vec<Fitted> = selected.iter().map(|s| s.fitted.clone()).collect();
    if let Some(common) = &common {
        effects.push(of_common(common, channels, &mut finals));
    }
    let shared =
        |i: usize| common.as_ref().is_some_and(|c| c.leader == i || c.followers.iter().any(|f| f.channel == i));
    for (i, channel) in channels.iter().enumerate() {
        for (index, (p_value, share, close)) in selected[i].evidence.iter().enumerate() {
            let term = &selected[i].fitted.terms[index];
            if shared(i) && is_slow(term, channel) {
                continue;
            }
            let parameters = describe::parameters(channel, &selected[i].fitted, index, unit);
            let evidence = Evidence { held_out_gain: *share, p_value: *p_value };
            let mut effect = effect(term.id, parameters, vec![channel.name.clone()], evidence);
            effect.confusable_with = close.iter().take(1).map(|c| (*c).to_owned()).collect();
            effects.push(effect);
        }
        effects.extend(of_level(channel, &finals[i], steps[i], together, model, unit));
    }
    let count = channels.len() as f64;
    let before: Vec<Vec<f64>> =
        (0..channels.len()).map(|i| base_variances(&channels[i], &selected[i], model)).collect();
    let remainders: Vec<_> = channels.iter().zip(&finals).map(|(c, f)| check::remainder(c, f, TOLERANCE)).collect();
    let left = remainders.iter().map(|r| r.p_value).fold(1.0, f64::min) * count;
    let strict =
        channels.iter().zip(&finals).map(|(c, f)| check::remainder(c, f, 0.0).p_value).fold(1.0, f64::min) * count;
    let described = left >= ALPHA;
    if described && strict < ALPHA {
        findings.push(format!(
            "what is left differs from noise as modelled by more than chance, but by less than the {:.0} % of its power that \
             count as a mismatch here",
            100.0 * TOLERANCE
        ));
    }
    if !described {
        // What explains a drift by half while something foreign remains is a stand-in. What has a witness of its own stays,
        // and so does a law that holds wherever it rules.
        effects.retain(|e| {
            let at = channels.iter().position(|c| e.channels.contains(&c.name)).unwrap_or(0);
            witnessed(e) || holds_where_it_rules(&e.id, &finals[at], &remainders[at])
        });
    }
    effects.sort_by(|a, b| b.evidence.held_out_gain.total_cmp(&a.evidence.held_out_gain));
    let tied = effects.iter().any(|e| !e.confusable_with.is_empty());
    let outcome = match (described, effects.is_empty(), tied) {
        (false, _, _) => Outcome::Unexplained,
        (true, true, _) => Outcome::Adequate,
        (true, false, true) => Outcome::Undecidable,
        (true, false, false) => Outcome::Explained,
    };
    let location = locate(channels, selected, &remainders, described);
    let ranking = ranking(channels, selected, &effects);
    let names = |i: usize| -> Vec<String> {
        effects.iter().filter(|e| e.channels.contains(&channels[i].name)).map(|e| e.id.clone()).collect()
    };
    let details =
        (0..channels.len()).map(|i| describe::detail(&channels[i], &before[i], &finals[i], names(i))).collect();
    let verdict = Verdict {
        schema: SCHEMA,
        kind: Kind::Static,
        verdict: outcome,
        sentence: sentence(outcome, &effects, &location),
        recording: Source {
            file: recording.path.display().to_string(),
            sha256: recording.sha256.clone(),
            samples: recording.samples(),
            rate_hz: recording.rate_hz,
        },
        fit: fit(channels, selected, &finals, &before, unit),
        residual_after: Whiteness { white: described, p_value: left.min(1.0) },
        next_experiment: next_experiment(outcome, &effects, model),
        location,
        effects,
        findings,
    };
    let repair = repair(channels, &finals, &verdict, unit);
    let detail = Detail { unit: unit.into(), channels: details };
    Diagnosis { verdict, ranking, repair, detail: AnyDetail::Static(Box::new(detail)) }
}

/// Whether an effect rests on more than the shape of a spectrum: a common cause, a line, a grid, a promise.
fn witnessed(effect: &Effect) -> bool {
    match effect.id.as_str() {
        "temperature-sensitivity" | "sinusoid" | "white-noise" => true,
        "quantisation-noise" => effect.parameters.iter().any(|p| p.name == "step"),
        _ => false,
    }
}

/// Whether nothing is amiss in time, and in no band where this law is the larger part of the model.
fn holds_where_it_rules(id: &str, fitted: &Fitted, remainder: &check::Remainder) -> bool {
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
fn of_common(common: &Common, channels: &[Channel], finals: &mut [Fitted]) -> Effect {
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

/// Rounding as coarse as the noise, and a white level other than promised.
fn of_level(
    channel: &Channel,
    fitted: &Fitted,
    step: Option<f64>,
    together: usize,
    model: &model::Static,
    unit: &str,
) -> Vec<Effect> {
    let mut out = Vec::new();
    let (white, error) = (fitted.strengths.values[0], fitted.strengths.errors[0]);
    let rounding = step.map_or(0.0, |q| (q / channel.scale).powi(2) / 12.0 / together as f64);
    let share = rounding / white.max(rounding);
    if let Some(step) = step.filter(|_| share > COARSE) {
        let parameters = vec![Estimate { name: "step".into(), value: step, unit: unit.into(), ci95: [step, step] }];
        // A smooth reading would not fall on a grid once.
        let evidence = Evidence { held_out_gain: share, p_value: f64::MIN_POSITIVE };
        out.push(effect("quantisation-noise", parameters, vec![channel.name.clone()], evidence));
    }
    if let Some(noise) = &model.noise {
        let promised = describe::white_of_density(channel, noise.density);
        let own = white - if share > COARSE { rounding } else { 0.0 };
        let z = (own - promised) / error.max(0.3 * rounding);
        let p_value = chi_squared_above(z * z, 1.0);
        if p_value < ALPHA && ((own.max(0.0) / promised).sqrt() - 1.0).abs() > LEVEL {
            let ci95 = describe::variance_interval(white, error).map(|v| describe::density_of_white(channel, v));
            let value = describe::density_of_white(channel, white);
            let density = Estimate { name: "density".into(), value, unit: format!("{unit}/√Hz"), ci95 };
            let gain = 1.0 - (promised / white).min(white / promised);
            let evidence = Evidence { held_out_gain: gain, p_value };
            out.push(effect("white-noise", vec![density], vec![channel.name.clone()], evidence));
        }
    }
    out
}

/// What the base model says of every bin: the promised noise, else white noise at its best level.
fn base_variances(channel: &Channel, selected: &Selected, model: &model::Static) -> Vec<f64> {
    match &model.noise {
        None => selected.base.variances.clone(),
        Some(noise) => {
            let white = describe::white_of_density(channel, noise.density);
            spectrum::variances(&selected.base.bins, &[Law::White], &[white], &channel.promised)
        }
    }
}

fn locate(channels: &[Channel], selected: &[Selected], remainders: &[check::Remainder], described: bool) -> Where {
    let base: Vec<check::Remainder>;
    let shown: Vec<&check::Remainder> = if described {
        base = channels.iter().zip(selected).map(|(c, s)| check::remainder(c, &s.base, 0.0)).collect();
        base.iter().collect()
    } else {
        remainders.iter().collect()
    };
    let mut out = Where::default();
    let worst = (0..shown.len()).min_by(|a, b| shown[*a].p_value.total_cmp(&shown[*b].p_value)).unwrap_or(0);
    out.time_s = shown[worst].time_s.clone();
    out.frequency_hz = shown[worst].frequency_hz.clone();
    // Averaging times that a band of frequency shows in: a third to a half of its period.
    out.state = out
        .frequency_hz
        .iter()
        .map(|s| crate::diagnosis::verdict::Stretch { from: 0.37 / s.to, to: 0.37 / s.from, excess: s.excess })
        .collect();
    let strongest = out.frequency_hz.iter().max_by(|a, b| a.excess.total_cmp(&b.excess));
    let name = &channels[worst].name;
    out.summary = match strongest {
        None if out.time_s.is_empty() => "Nowhere: no band of frequency and no stretch of time stands out.".into(),
        None => format!(
            "In time: {} stretches of {name} are louder than the rest, the first from {:.4e} to {:.4e} s.",
            out.time_s.len(),
            out.time_s[0].from,
            out.time_s[0].to
        ),
        Some(s) => format!(
            "Most between {:.3e} and {:.3e} Hz (averaging times {:.3e} to {:.3e} s) of {name}, with {:.3} times the power {}.",
            s.from,
            s.to,
            0.37 / s.to,
            0.37 / s.from,
            s.excess,
            if described { "of white noise" } else { "that the best model explains" }
        ),
    };
    out
}

fn fit(channels: &[Channel], selected: &[Selected], finals: &[Fitted], before: &[Vec<f64>], unit: &str) -> Fit {
    let count: f64 = channels.iter().map(|c| c.values.len() as f64).sum();
    let power = |values: &dyn Fn(usize) -> f64| -> f64 {
        ((0..channels.len()).map(|i| values(i) * channels[i].scale.powi(2)).sum::<f64>() / count).sqrt()
    };
    let noise_floor = power(&|i| finals[i].strengths.values[0] * channels[i].values.len() as f64);
    let squares: Vec<[[f64; 2]; 2]> = channels.iter().zip(finals).map(|(c, f)| c.held_out_squares(f)).collect();
    // Each part is half of the recording.
    let part = |part: usize| Score {
        rmse_before: power(&|i| 2.0 * squares[i][part][0]),
        rmse_after: power(&|i| 2.0 * squares[i][part][1]),
        ratio_ci95: None,
    };
    let scale: f64 = channels.iter().map(|c| c.values.len() as f64 * c.scale.ln()).sum();
    let constant = -0.5 * count * std::f64::consts::TAU.ln() - scale;
    let score = |per_channel: f64| (per_channel + constant) / count;
    let before =
        (0..channels.len()).map(|i| spectrum::log_likelihood(&selected[i].base.bins, &before[i], Part::All)).sum();
    let after = (0..channels.len()).map(|i| finals[i].held_out(&channels[i].promised)).sum();
    Fit {
        unit: unit.into(),
        noise_floor,
        train: part(0),
        test: part(1),
        log_score: Some(LogScore { before: score(before), after: score(after) }),
        one_step_rmse: None,
    }
}

fn ranking(channels: &[Channel], selected: &[Selected], effects: &[Effect]) -> Vec<Ranked> {
    let correction = 8.0 * channels.len() as f64;
    let mut out: Vec<Ranked> = Vec::new();
    for (channel, selected) in channels.iter().zip(selected) {
        let best = selected.alone.iter().map(|t| t.gain).fold(f64::MIN_POSITIVE, f64::max);
        for tried in &selected.alone {
            let named = effects.iter().any(|e| e.id == tried.id && e.channels.contains(&channel.name));
            let gain = tried.gain / best;
            out.push(Ranked {
                id: tried.id,
                channels: vec![channel.name.clone()],
                held_out_gain: gain,
                ci95: [f64::NEG_INFINITY, f64::INFINITY],
                p_value: (tried.p_value * correction).min(1.0),
                named,
                note: format!(
                    "alone: log-likelihood + {:.1}, share of the best; held out {}",
                    tried.gain / 2.0,
                    if tried.held_out > 0.0 { "better" } else { "no better" }
                ),
            });
        }
    }
    out.sort_by(|a, b| b.named.cmp(&a.named).then(b.held_out_gain.total_cmp(&a.held_out_gain)));
    out
}

fn sentence(outcome: Outcome, effects: &[Effect], location: &Where) -> String {
    let mut named: Vec<String> = Vec::new();
    for effect in effects {
        named.push(format!("{} ({})", effect.id, effect.channels.join(", ")));
    }
    let named = named.join("; ");
    match outcome {
        Outcome::Adequate => {
            "A constant and white noise describe every channel: nothing is missing that this recording \
                              could show."
                .into()
        }
        Outcome::Explained => format!("The model leaves out {named}. With that, what is left is noise."),
        Outcome::Undecidable => {
            let ties: Vec<String> = effects
                .iter()
                .filter(|e| !e.confusable_with.is_empty())
                .map(|e| format!("{} or {} in {}", e.id, e.confusable_with.join(" or "), e.channels.join(", ")))
                .collect();
            format!("The model leaves something out, and the recording cannot tell which: {}.", ties.join("; "))
        }
        Outcome::Unexplained if effects.is_empty() => {
            format!("The mismatch is real and nothing in the library accounts for it. {}", location.summary)
        }
        Outcome::Unexplained => {
            format!(
                "The model leaves out {named}, and more that nothing in the library accounts for. {}",
                location.summary
            )
        }
    }
}

fn next_experiment(outcome: Outcome, effects: &[Effect], model: &model::Static) -> String {
    let temperature = effects.iter().any(|e| e.id == "temperature-sensitivity");
    match outcome {
        _ if temperature && model.columns.environment.is_empty() => {
            "Log the temperature beside the sensor and name its column under environment: that confirms the cause and gives \
             the slopes."
                .into()
        }
        Outcome::Adequate => "A longer log: slow terms show only at averaging times that it holds several of.".into(),
        Outcome::Explained => "A second log on another day: the same coefficients should come out.".into(),
        Outcome::Undecidable => "A log four times as long: the candidates part at longer averaging times.".into(),
        Outcome::Unexplained => {
            "Log again on a quiet foundation, at another sampling rate and with temperature beside it: what moves with which \
             tells vibration, aliasing and environment apart."
                .into()
        }
    }
}

/// What a study can run of the first channel, where its unit is one of acceleration or rate.
fn repair(channels: &[Channel], finals: &[Fitted], verdict: &Verdict, unit: &str) -> Option<Repair> {
    let unit = Unit::parse(unit, Quantity::Accelerometer).or_else(|_| Unit::parse(unit, Quantity::Gyro)).ok()?;
    // The channel with most to gain stands for the sensor.
    let worst = channels.iter().position(|c| verdict.effects.iter().any(|e| e.channels.contains(&c.name))).unwrap_or(0);
    let (channel, fitted) = (&channels[worst], &finals[worst]);
    let strength = |id: &str| {
        let index = fitted.terms.iter().position(|t| t.id == id)?;
        verdict.effects.iter().any(|e| e.id == id).then(|| fitted.strength_of(index).0.sqrt() * channel.scale * unit.si)
    };
    let white = describe::density_of_white(channel, fitted.strengths.values[0]) * DENSITY_TO_RANDOM_WALK * unit.si;
    let flicker = strength("flicker-noise").unwrap_or(0.0);
    let walk = strength("random-walk").map_or(0.0, |k| k * channel.rate_hz.sqrt());
    let sensor = |flicker: f64, walk: f64| {
        let accelerometer = unit.quantity == Quantity::Accelerometer;
        let of = |is: bool, value: f64| if is { value } else { 0.0 };
        Sensor {
            proof_mass: None,
            accelerometer: Accelerometer {
                bias_m_s2: 0.0,
                scale_factor: 0.0,
                k2_per_m_s2: 0.0,
                velocity_random_walk_m_s_rts: of(accelerometer, white),
                bias_instability_m_s2: of(accelerometer, flicker),
                acceleration_random_walk_m_s2_rts: of(accelerometer, walk),
                quantisation_m_s2: 0.0,
                range_m_s2: f64::INFINITY,
            },
            gyro: Gyro {
                bias_rad_s: 0.0,
                angle_random_walk_rad_rts: of(!accelerometer, white),
                bias_instability_rad_s: of(!accelerometer, flicker),
                rate_random_walk_rad_s_rts: of(!accelerometer, walk),
            },
            excitation_gain: 1.0,
        }
    };
    let outside = |e: &&Effect| !matches!(e.id.as_str(), "flicker-noise" | "random-walk" | "white-noise");
    let own_cost = verdict.effects.iter().filter(|e| e.id == "rate-ramp" && unit.quantity == Quantity::Accelerometer);
    Some(Repair {
        before: sensor(0.0, 0.0),
        after: sensor(flicker, walk),
        relation: format!("one {} of {} is {} in SI", unit.name, channel.name, unit.si),
        not_expressible: verdict.effects.iter().filter(outside).map(|e| format!("{}: {}", e.id, e.statement)).collect(),
        vibration: Vibration { amplitude_m_s2: 0.0, frequency_hz: 1.0 },
        own_cost: own_cost
            .map(|e| {
                let rate = e.parameters[0].value.abs() * unit.si;
                Cost {
                    of: format!("{} ({})", e.id, e.channels.join(", ")),
                    under: "at rest".into(),
                    position_10_s_m: rate * 1e3 / 6.0,
                    position_60_s_m: rate * 216e3 / 6.0,
                    basis: "R t³/6".into(),
                }
            })
            .collect(),
    })
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
