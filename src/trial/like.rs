//! A trial in a user's own recording: their excitation, rate, length and noise, with each candidate planted in turn.
//!
//! Answers which effects this recording could have revealed, from what size, and which it cannot tell apart. Not a verdict
//! about the recording itself.

use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;

use super::blind::{self, Subject};
use super::case::{Body, Case, Family};
use super::driven::Driven;
use super::equation::Oscillator;
use super::excitation::Excitation;
use super::judge::{self, Mark};
use super::physics::Physics;
use super::plant::{self, Size};
use super::refit::{self, Window};
use super::said::Said;
use super::standstill::{Slow, Still};
use super::workers::side_by_side;
use crate::diagnosis::candidate::Kind;
use crate::diagnosis::model::{self, Model};
use crate::error::{Error, Result};
use crate::progress;
use crate::recording::Recording;
use crate::rng::{Philox, Stream};

/// Rows used of a longer recording: the diagnosis of each planted copy takes as long as that of the original.
pub const ROWS: usize = 20_000;
/// Sub-steps of the linear fit.
const SUBSTEPS: usize = 8;
/// Sizes planted, visible rms over noise rms: in a driven recording, in one at rest, and the few of a quick answer.
const DRIVEN: [f64; 4] = [0.1, 0.3, 1.0, 4.0];
const STILL: [f64; 6] = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0];
const QUICK: [f64; 2] = [0.3, 3.0];

/// What was tried with one effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// Visible rms over noise rms.
    pub effect_over_noise: f64,
    /// Planted value of the effect's first parameter by the library's symbol, where the law has one.
    pub strength: Option<(&'static str, f64)>,
    /// Whether a mismatch was noticed.
    pub noticed: bool,
    /// Whether the effect was named, alone or with one other.
    pub named: bool,
    /// What was said.
    pub said: String,
    /// Ids said that were not planted.
    pub others: Vec<String>,
}

/// One effect in this recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Revealed {
    /// Library id.
    pub id: String,
    /// Smallest size noticed, and at every larger one; null when none was.
    pub noticed_from: Option<f64>,
    /// Smallest size named, and at every larger one; null when none was.
    pub named_from: Option<f64>,
    /// What it was taken for.
    pub taken_for: Vec<String>,
    /// Every size; those missing could not be planted (the motion would diverge, or no strength shows that much).
    pub tried: Vec<Tried>,
}

/// What a recording could reveal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Power {
    /// Always "proofmass.power/1".
    pub schema: &'static str,
    /// File as given.
    pub file: String,
    /// Kind of recording, as in model.toml.
    pub kind: &'static str,
    /// Rows used.
    pub samples: usize,
    /// Sampling rate.
    pub rate_hz: f64,
    /// Noise per sample that the planted copies have, unit of the output.
    pub noise: f64,
    /// Fitted base in words.
    pub base: String,
    /// Whether the copies with nothing planted were left alone.
    pub alarms: usize,
    /// How many copies with nothing planted there were.
    pub nulls: usize,
    /// Per effect.
    pub effects: Vec<Revealed>,
    /// Pairs that this recording does not tell apart.
    pub inseparable: Vec<[String; 2]>,
}

/// A copy of the recording without physics in it, ready to be planted into.
enum Copy {
    Driven(Box<Driven>),
    Still(Box<Still>),
}

/// Plants every candidate at several sizes, at two where it shall be `quick`, and asks `subject` about each.
///
/// # Errors
/// A recording or model that cannot be read, a base model that does not fit, a tumble recording, or Ctrl-C.
pub fn power(recording: &Path, model_path: &Path, quick: bool, seed: u64, subject: &Subject<'_>) -> Result<Power> {
    let model = model::read(model_path)?;
    let data = model::read_recording(recording, &model)?;
    let attempt = || format!("could not make copies of {}", recording.display());
    let (copy, noise, base) = match &model {
        Model::Driven(m) => driven_copy(&data, m, seed).ok_or_else(|| {
            Error::new(attempt(), "no linear proof mass fits it", "check which column is input and which is output")
        })?,
        Model::Static(m) => still_copy(&data, m, seed),
        Model::Tumble(_) => {
            let cause = "copies of a tumble recording cannot be made";
            return Err(Error::new(attempt(), cause, "use a driven or a static recording"));
        }
    };
    let (kind, samples, sizes) = match &copy {
        Copy::Driven(case) => (Kind::Driven.name(), case.samples, &DRIVEN[..]),
        Copy::Still(case) => (Kind::Static.name(), case.samples, &STILL[..]),
    };
    let cases = planted(&copy, if quick { &QUICK } else { sizes });
    let bar = progress::bar("planted copies", cases.len() as u64);
    let said: Vec<Said> = side_by_side(&cases, |case| {
        if progress::interrupted() {
            return Err(Error::interrupted(attempt(), "run it again, with --quick for fewer copies"));
        }
        let said = blind::ask(case, subject);
        bar.inc(1);
        said
    })?;
    bar.finish_and_clear();
    let nulls = || cases.iter().zip(&said).filter(|(case, _)| case.planted().is_empty());
    let effects = revealed(&cases, &said);
    Ok(Power {
        schema: "proofmass.power/1",
        file: recording.display().to_string(),
        kind,
        samples,
        rate_hz: data.rate_hz,
        noise,
        base,
        alarms: nulls().filter(|(_, said)| judge::is_alarm(said)).count(),
        nulls: nulls().count(),
        inseparable: inseparable(&effects),
        effects,
    })
}

fn driven_copy(data: &Recording, model: &model::Driven, seed: u64) -> Option<(Copy, f64, String)> {
    let output = data.column(&model.columns.output)?;
    // The diagnosis learns from the fitted part only: the copies are of that.
    let longest = model.split.train.iter().max_by_key(|r| r[1].saturating_sub(r[0]));
    let [from, to] = longest.map_or([0, output.len()], |r| r.map(|n| n.min(output.len())));
    let rows = from..to.min(from + ROWS);
    let samples = rows.len();
    let output = &output[rows.clone()];
    let excitation = match &model.columns.input {
        Some(name) => Excitation::Recorded { samples: data.column(name)?[rows].to_vec(), rate_hz: data.rate_hz },
        None => Excitation::None,
    };
    let half_step_s = 0.5 / (data.rate_hz * SUBSTEPS as f64);
    let input = match excitation {
        Excitation::None => Vec::new(),
        _ => excitation.tabulate(0.0, half_step_s, 2 * SUBSTEPS * (samples - 1) + 1),
    };
    let window = Window { input: &input, output, substeps: SUBSTEPS, rate_hz: data.rate_hz };
    let hint = model.start.resonance_hz.map(|f| f * std::f64::consts::TAU).zip(model.start.damping_ratio);
    let fit = refit::search(&window, hint.map(|(omega, zeta)| [omega, zeta]))?;
    let spread = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
    };
    // The noise is what remains at the highest frequencies of the residual, where no resonator reaches: its fourth
    // difference, whose gain on white noise is √(1 + 16 + 36 + 16 + 1).
    let fourth: Vec<f64> =
        fit.residual.windows(5).map(|r| r[0] - 4.0 * r[1] + 6.0 * r[2] - 4.0 * r[3] + r[4]).collect();
    let noise = spread(&fourth) / 70f64.sqrt();
    let oscillator = Oscillator { omega_rad_s: fit.omega_rad_s, zeta: fit.zeta, gain: fit.gain, start: fit.start };
    let mut case = Driven::linear(oscillator, excitation, data.rate_hz, samples, seed);
    case.offset = fit.offset;
    case.noise = noise;
    let base = format!(
        "resonance {:.4} Hz, damping ratio {:.4}, noise {:.3e} of an output of {:.3e} rms",
        fit.omega_rad_s / std::f64::consts::TAU,
        fit.zeta,
        noise,
        case.output_rms
    );
    Some((Copy::Driven(Box::new(case)), noise, base))
}

fn still_copy(data: &Recording, model: &model::Static, seed: u64) -> (Copy, f64, String) {
    let samples = data.samples().min(ROWS);
    let mut white = [0.0; 3];
    let mut bias = [0.0; 3];
    for channel in 0..3 {
        let names = &model.columns.channels;
        let values = data.column(&names[channel % names.len()]).unwrap_or_default();
        let values = &values[..samples.min(values.len())];
        // White noise alone survives a first difference, whose median size is 0.6745 × √2 of its deviation; a few jumps
        // and knocks do not move a median.
        let mut steps: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
        steps.sort_by(f64::total_cmp);
        let median = steps.get(steps.len() / 2).copied().unwrap_or(0.0);
        // Coarse counts that mostly repeat have no median step, but a mean square.
        let square = steps.iter().map(|s| s * s).sum::<f64>() / steps.len().max(1) as f64;
        let step = if median > 0.0 { median / 0.6745 } else { square.sqrt() };
        white[channel] = (step / 2f64.sqrt()).max(f64::MIN_POSITIVE);
        bias[channel] = values.iter().sum::<f64>() / samples as f64;
    }
    let still = Still {
        seed,
        rate_hz: data.rate_hz,
        samples,
        white,
        bias,
        planted: Vec::new(),
        promised: false,
        temperature_given: !model.columns.environment.is_empty(),
    };
    let base = format!("white noise of {:.3e}, {:.3e}, {:.3e} per sample", white[0], white[1], white[2]);
    (Copy::Still(Box::new(still)), white[0], base)
}

/// Copies with nothing planted, then each effect at each size.
fn planted(copy: &Copy, sizes: &[f64]) -> Vec<Case> {
    let jobs: Vec<(usize, f64)> = match copy {
        Copy::Driven(_) => (0..Physics::LIBRARY.len()).flat_map(|e| sizes.iter().map(move |s| (e, *s))).collect(),
        Copy::Still(_) => (0..Slow::LIBRARY.len()).flat_map(|e| sizes.iter().map(move |s| (e, *s))).collect(),
    };
    let nulls = sizes.len();
    let bar = progress::bar("planting effects", (nulls + jobs.len()) as u64);
    let made: Vec<Option<(Family, Body)>> = (0..nulls + jobs.len())
        .into_par_iter()
        .map(|n| {
            let job = n.checked_sub(nulls).map(|k| jobs[k]);
            let made = match copy {
                Copy::Driven(case) => driven_body(case, n as u64, job),
                Copy::Still(case) => Some(still_body(case, n as u64, job)),
            };
            bar.inc(1);
            made
        })
        .collect();
    bar.finish_and_clear();
    let bodies = made.into_iter().flatten().enumerate();
    bodies.map(|(number, (family, body))| Case { number, family, body }).collect()
}

fn driven_body(bare: &Driven, n: u64, job: Option<(usize, f64)>) -> Option<(Family, Body)> {
    let mut case = bare.clone();
    case.seed = bare.seed.wrapping_add(n);
    let Some((effect, size)) = job else {
        return Some((Family::Null, Body::Driven(Box::new(case))));
    };
    let physics = Physics::LIBRARY[effect];
    let needs_input = matches!(physics, Physics::DriveNonlinearity | Physics::Feedthrough | Physics::ParasiticMode);
    if needs_input && case.excitation == Excitation::None {
        return None;
    }
    // A shape may not reach the size; another may.
    (0..4).find_map(|attempt| {
        let mut rng = Philox::new(bare.seed, effect as u64 * 16 + attempt, Stream::Host);
        let shape = plant::shape(&mut rng, physics, &case);
        let mut trial = case.clone();
        let visible = Size::Visible(size * case.noise / case.output_rms);
        plant::plant(&mut trial, physics, shape, visible)
            .then(|| (Family::AroundTheLimit, Body::Driven(Box::new(trial))))
    })
}

fn still_body(bare: &Still, n: u64, job: Option<(usize, f64)>) -> (Family, Body) {
    let mut case = bare.clone();
    case.seed = bare.seed.wrapping_add(n);
    let Some((effect, size)) = job else {
        return (Family::StillNull, Body::Still(Box::new(case)));
    };
    let mut rng = Philox::new(bare.seed, effect as u64, Stream::Host);
    let size = match Slow::LIBRARY[effect] {
        Slow::WhiteNoise => 1.0 + size,
        Slow::QuantisationNoise => size * 12f64.sqrt(),
        _ => size,
    };
    case.plant(&mut rng, Slow::LIBRARY[effect], size);
    (Family::StillPlanted, Body::Still(Box::new(case)))
}

fn revealed(cases: &[Case], said: &[Said]) -> Vec<Revealed> {
    let mut effects: Vec<Revealed> = Vec::new();
    for (case, said) in cases.iter().zip(said) {
        let Some((id, size)) = case.sizes_over_noise().into_iter().next() else { continue };
        let mark = judge::judge(case, said);
        let groups: Vec<String> = said.groups.iter().map(|g| g.join(" | ")).collect();
        let tried = Tried {
            effect_over_noise: size,
            strength: case.strength(),
            noticed: judge::is_detected(said),
            named: mark.is_named(),
            said: format!("{} {}", said.outcome, groups.join(" + ")).trim().to_owned(),
            others: if mark == Mark::Named {
                Vec::new()
            } else {
                said.ids().into_iter().filter(|other| *other != id).collect()
            },
        };
        match effects.iter_mut().find(|e| e.id == id) {
            Some(effect) => effect.tried.push(tried),
            None => effects.push(Revealed {
                id,
                noticed_from: None,
                named_from: None,
                taken_for: Vec::new(),
                tried: vec![tried],
            }),
        }
    }
    for effect in &mut effects {
        effect.tried.sort_by(|a, b| a.effect_over_noise.total_cmp(&b.effect_over_noise));
        let from = |good: fn(&Tried) -> bool| {
            effect.tried.iter().rev().take_while(|t| good(t)).last().map(|t| t.effect_over_noise)
        };
        (effect.noticed_from, effect.named_from) = (from(|t| t.noticed), from(|t| t.named));
        let mut others: Vec<String> = effect.tried.iter().flat_map(|t| t.others.iter().cloned()).collect();
        others.sort();
        others.dedup();
        effect.taken_for = others;
    }
    effects
}

/// Two effects of which one was taken for the other, or tied with it, at the largest size tried.
fn inseparable(effects: &[Revealed]) -> Vec<[String; 2]> {
    let mut pairs: Vec<[String; 2]> = effects
        .iter()
        .filter_map(|e| e.tried.last().map(|t| (e, t)))
        .flat_map(|(e, t)| {
            t.others.iter().map(|other| [e.id.clone().min(other.clone()), e.id.clone().max(other.clone())])
        })
        .collect();
    pairs.sort();
    pairs.dedup();
    pairs
}
