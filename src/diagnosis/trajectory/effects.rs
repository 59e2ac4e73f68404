//! Named effects as the public document states them.

use super::candidate::{AXIS_SWAP, CLOCK, LOWPASS, REFERENCE_NOISE, SATURATION, TIME_OFFSET, Term, VIBRATION};
use super::clipping::Limit;
use super::fitted::Fitted;
use super::judgement::Standing;
use super::log::Halves;
use super::parameters::{self, OFFSET};
use super::permutation::Permutation;
use super::scatter::Excess;
use super::selection::{Named, Selection};
use super::vibration::Vibration;
use crate::candidate::Candidate;
use crate::number::short;
use crate::sensor::Sense;
use crate::verdict::{Effect, Estimate, Evidence};

/// Difference between the lag of a real filter and that of one pole, as a fraction of the time
/// constant, that is still put down to the filter: the difference that higher poles at twenty times
/// its frequency would make.
const ONE_POLE: f64 = 0.05;

/// Unit of a sensor's readings.
pub(super) fn unit(sensor: Sense) -> &'static str {
    match sensor {
        Sense::Gyro => "rad/s",
        Sense::Accelerometer => "m/s^2",
    }
}

/// An effect without form, share or rivals.
pub(super) fn effect(
    candidate: &Candidate,
    parameters: Vec<Estimate>,
    channels: Vec<String>,
    evidence: Evidence,
) -> Effect {
    Effect {
        id: candidate.id.into(),
        statement: candidate.statement.into(),
        equation: candidate.equation.into(),
        parameters,
        channels,
        form: None,
        evidence,
        share: None,
        base: Vec::new(),
        confusable_with: Vec::new(),
    }
}

/// Clock offset in addition to the lag of a low-pass, s; none where that lag explains the total to
/// within [`ONE_POLE`].
fn clock_beside_lowpass(fit: &Fitted) -> Option<Estimate> {
    let clock = fit.estimate(OFFSET, "offset", "s", 1.0);
    let nearly = ONE_POLE * fit.estimate(parameters::LOWPASS, "tau", "s", 1.0).value;
    (clock.ci95[0] > nearly || clock.ci95[1] < -nearly).then_some(clock)
}

/// Effects of the named terms, in the library's units.
pub(super) fn of_fit(selection: &Selection, fit: &Fitted, channels: impl Fn(&Term) -> Vec<String>) -> Vec<Effect> {
    let each = selection.named.iter().map(|n| fitted(n, fit, channels(n.standing.term)));
    let Some(lowpass) = selection.term(LOWPASS.id) else { return each.collect() };
    let mut all: Vec<Effect> = each.filter(|e| e.id != TIME_OFFSET.id).collect();
    if let Some(clock) = clock_beside_lowpass(fit) {
        let known = selection.term(TIME_OFFSET.id);
        let Standing { gain, p_value, .. } = &known.unwrap_or(lowpass).standing;
        let evidence = Evidence { held_out_gain: *gain, p_value: *p_value };
        // A second pole makes readings later too, and hardly smaller.
        let pole = (clock.value > 0.0).then_some(LOWPASS.id);
        let others = known.into_iter().flat_map(|n| &n.rivals).map(|t| t.id());
        let rivals = pole.into_iter().chain(others).map(str::to_owned).collect();
        let effect = effect(&TIME_OFFSET, vec![clock], channels(&CLOCK), evidence);
        all.push(Effect { confusable_with: rivals, ..effect });
    }
    all
}

/// A fitted term, with its parameters in the library's units.
fn fitted(named: &Named, fit: &Fitted, channels: Vec<String>) -> Effect {
    let Standing { term, gain, p_value, .. } = &named.standing;
    let parameters = term.parameters.clone().zip(term.names).filter(|(p, _)| fit.has(*p));
    let parameters = parameters.map(|(p, name)| fit.estimate(p, name, term.unit.name, term.unit.per_si)).collect();
    let evidence = Evidence { held_out_gain: *gain, p_value: *p_value };
    let mut effect = effect(term.candidate, parameters, channels, evidence);
    effect.confusable_with = named.rivals.iter().map(|t| t.id().to_owned()).collect();
    effect
}

/// Readings at a limit; `gain` is the fraction of the error that lies in the time when they stand
/// there.
pub(super) fn saturation(limits: &[Limit], sensor: Sense, names: &[String; 3], gain: f64) -> Option<Effect> {
    let parameters: Vec<Estimate> = limits
        .iter()
        .map(|limit| Estimate {
            name: format!("{}_{}", sensor.name(), ["x", "y", "z"][limit.axis]),
            value: limit.value,
            unit: unit(sensor).into(),
            // The limit lies above all readings but those that stand at it.
            ci95: [limit.value - limit.gap, limit.value + limit.gap],
        })
        .collect();
    let channels = limits.iter().map(|limit| names[limit.axis].clone()).collect();
    let p_value = limits.iter().map(|limit| limit.p_value).fold(1.0, f64::min);
    let evidence = Evidence { held_out_gain: gain, p_value };
    (!limits.is_empty()).then(|| effect(&SATURATION, parameters, channels, evidence))
}

/// Exchanged columns of one sensor; none where each reads its own axis.
pub(super) fn swapped(swap: Permutation, sensor: Sense, names: &[String; 3], evidence: Evidence) -> Option<Effect> {
    (swap != Permutation::NONE).then(|| {
        let mut effect = effect(&AXIS_SWAP, Vec::new(), names.to_vec(), evidence);
        effect.equation = format!("columns of the {} read {}", sensor.name(), swap.map());
        effect
    })
}

/// Vibration of a sensor.
pub(super) fn vibration(found: &Vibration, sensor: Sense, names: &[String; 3]) -> Effect {
    let density_unit = format!("{}/√Hz", unit(sensor));
    let mut parameters =
        vec![Estimate { name: "density".into(), value: found.density, unit: density_unit, ci95: found.ci95 }];
    for (n, (hz, amplitude)) in found.lines.iter().enumerate() {
        let estimate = |name: &str, value: f64, unit: &str, half: f64| Estimate {
            name: format!("{name}_{}", n + 1),
            value,
            unit: unit.into(),
            ci95: [value - half, value + half],
        };
        parameters.push(estimate("frequency", *hz, "Hz", found.step_hz));
        parameters.push(estimate("amplitude", *amplitude, unit(sensor), 0.5 * amplitude));
    }
    let excess = found.stated.map_or(0.0, |stated| 1.0 - (stated / found.density).powi(2));
    let evidence = Evidence { held_out_gain: excess.max(0.0), p_value: found.p_value };
    effect(&VIBRATION, parameters, names.to_vec(), evidence)
}

/// Returns what the reference errs by.
pub(super) fn reference(attitude: Option<Excess>, position_m: Option<Excess>, halves: Halves) -> Option<Effect> {
    let estimate = |name: &str, excess: Excess, unit: &str, per_si: f64| Estimate {
        name: name.into(),
        value: excess.deviation * per_si,
        unit: unit.into(),
        ci95: excess.ci95.map(|v| v * per_si),
    };
    let parameters: Vec<Estimate> = attitude
        .map(|e| estimate("attitude", e, "mrad", 1e3))
        .into_iter()
        .chain(position_m.map(|e| estimate("position", e, "mm", 1e3)))
        .collect();
    let times = [attitude, position_m].into_iter().flatten().map(|e| e.times).fold(1.0, f64::max);
    let least = [attitude, position_m].into_iter().flatten().map(|e| e.p_value).fold(1.0, f64::min);
    // To the sides it cannot be told from an attitude that wanders.
    let where_it_is = if halves.attitude { "position" } else { "position up and down" };
    let means: Vec<String> = [(attitude, "attitude"), (position_m, where_it_is)]
        .into_iter()
        .filter_map(|(found, what)| Some(format!("{what} over {} s", short(found?.mean_s))))
        .collect();
    // Of attitude and position.
    let evidence = Evidence { held_out_gain: 1.0 - 1.0 / times, p_value: (2.0 * least).min(1.0) };
    (!parameters.is_empty()).then(|| {
        let mut effect = effect(&REFERENCE_NOISE, parameters, vec!["reference".into()], evidence);
        let means = format!("standard deviations of means: {}", means.join(", "));
        effect.equation += &format!("; {means}");
        effect.statement += &format!(" Stated are {means}; single poses err by more.");
        effect
    })
}
