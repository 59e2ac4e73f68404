//! A trial in a user's own recording: their excitation, rate, length and noise, with each candidate
//! planted in turn.
//!
//! Answers which effects this recording could have revealed, from what size, and which it cannot
//! tell apart. Not a verdict about the recording itself.

use std::path::Path;

use serde::Serialize;

use super::ask::Subject;
use super::blind;
use super::case::{Body, Case, Family};
use super::copy;
use super::judge::{self, Mark};
use super::physics::Physics;
use super::said::{Ending, Said};
use super::scratch::Scratch;
use super::standstill::Slow;
use super::workers::side_by_side;
use proofmass_base::control::Control;
use proofmass_base::error::{Error, Result};
use proofmass_base::parallel;
use proofmass_diagnosis::candidate::Kind;
use proofmass_diagnosis::model::{self, Model};

/// Sizes planted, visible rms over noise rms: in a driven recording, in one at rest, and the few of
/// a quick answer.
const DRIVEN: [f64; 4] = [0.1, 0.3, 1.0, 4.0];
const STILL: [f64; 6] = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0];
const QUICK: [f64; 2] = [0.3, 3.0];

/// Holds what was tried with one effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// Visible rms over noise rms.
    pub effect_over_noise: f64,
    /// Planted value of the effect's first parameter by the library's symbol, where the law has
    /// one.
    pub strength: Option<(&'static str, f64)>,
    /// States whether a mismatch was noticed.
    pub noticed: bool,
    /// States whether the effect was named, alone or with one other.
    pub named: bool,
    /// Planted physics, in words.
    pub said: String,
    /// Ids said that were not planted.
    pub others: Vec<String>,
}

/// One effect in this recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Revealed {
    /// Id of the effect.
    pub id: String,
    /// Smallest size noticed, and at every larger one; null when none was.
    pub noticed_from: Option<f64>,
    /// Smallest size named, and at every larger one; null when none was.
    pub named_from: Option<f64>,
    /// Ids that it was taken for.
    pub taken_for: Vec<String>,
    /// Every size; those missing could not be planted (the motion would diverge, or no strength
    /// shows that much).
    pub tried: Vec<Tried>,
}

/// Holds what a recording could reveal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Power {
    /// Name and version of the document.
    pub schema: &'static str,
    /// File of the recording.
    pub file: String,
    /// Kind of recording, as in model.toml.
    pub kind: &'static str,
    /// Number of samples.
    pub samples: usize,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Noise per sample that the planted copies have, unit of the output.
    pub noise: f64,
    /// Fitted base in words.
    pub base: String,
    /// States whether the copies with nothing planted were left alone.
    pub alarms: usize,
    /// Number of copies with nothing planted.
    pub nulls: usize,
    /// Planted effects.
    pub effects: Vec<Revealed>,
    /// Pairs that this recording does not tell apart.
    pub inseparable: Vec<[String; 2]>,
}

/// Plants every candidate at several sizes, at two where it shall be `quick`, and asks `subject`
/// about each.
///
/// # Errors
/// A recording or model that cannot be read, a base model that does not fit, a tumble recording, or
/// Ctrl-C.
pub fn power(
    recording: &Path,
    model_path: &Path,
    quick: bool,
    seed: u64,
    subject: &Subject<'_>,
    control: &Control,
) -> Result<Power> {
    let model = model::read(model_path)?;
    let data = model::read_recording(recording, &model, control)?;
    let attempt = || format!("could not make copies of {}", recording.display());
    let (kind, cases, samples, noise, base) = match &model {
        Model::Driven(m) => {
            let (bare, base) = copy::driven(&data, m, copy::rows(&data, m)?, seed).ok_or_else(|| {
                Error::new(attempt(), "no linear proof mass fits it", "check which column is input and which is output")
            })?;
            let plant = |n, job| copy::plant_driven(&bare, n, job);
            let cases = planted(Physics::LIBRARY, if quick { &QUICK } else { &DRIVEN }, plant, control);
            (Kind::Driven, cases, bare.samples, bare.noise, base)
        }
        Model::Static(m) => {
            let (bare, base) = copy::still(&data, m, seed);
            let plant = |n, job| Some(copy::plant_still(&bare, n, job));
            let cases = planted(Slow::LIBRARY, if quick { &QUICK } else { &STILL }, plant, control);
            (Kind::Static, cases, bare.samples, bare.white[0], base)
        }
        Model::Tumble(_) | Model::Trajectory(_) | Model::Response(_) => {
            let cause = "copies of an IMU's recording, and of sweeps, cannot be made";
            return Err(Error::new(attempt(), cause, "use a driven or a static recording"));
        }
    };
    let scratch = Scratch::new(None)?;
    let progress = control.stage("planted copies", cases.len() as u64);
    let said: Vec<Said> = side_by_side(&cases, |case| {
        control.go_on().map_err(|s| s.during(attempt(), "run it again, with --quick for fewer copies"))?;
        let said = blind::ask(case, subject, &scratch);
        progress.step();
        said
    })?;
    drop(progress);
    let (nulls, rest): (Vec<_>, Vec<_>) = cases.iter().zip(&said).partition(|(case, _)| is_null(case));
    let background = nulls.first().map_or_else(Vec::new, |(case, _)| case.planted());
    let alarms = nulls.iter().filter(|(case, said)| judge::is_alarm(said) && said.ids() != case.planted()).count();
    let effects = revealed(&rest, &background);
    Ok(Power {
        schema: "proofmass.power/1",
        file: recording.display().to_string(),
        kind: kind.name(),
        samples,
        rate_hz: data.rate_hz,
        noise,
        base,
        alarms,
        nulls: nulls.len(),
        inseparable: inseparable(&effects),
        effects,
    })
}

/// Copies with nothing planted, then each effect at each size.
fn planted<P: Copy + Sync>(
    library: &[P],
    sizes: &[f64],
    plant: impl Fn(u64, Option<(P, f64)>) -> Option<(Family, Body)> + Sync,
    control: &Control,
) -> Vec<Case> {
    let effects = library.iter().flat_map(|physics| sizes.iter().map(|size| Some((*physics, *size))));
    let jobs: Vec<Option<(P, f64)>> = sizes.iter().map(|_| None).chain(effects).collect();
    let progress = control.stage("planting effects", jobs.len() as u64);
    let made: Vec<Option<(Family, Body)>> = parallel::map_indices(jobs.len(), |n| {
        let made = if control.cancelled() { None } else { plant(n as u64, jobs[n]) };
        progress.step();
        made
    });
    drop(progress);
    let bodies = made.into_iter().flatten().enumerate();
    bodies.map(|(number, (family, body))| Case { number, family, body }).collect()
}

fn is_null(case: &Case) -> bool {
    matches!(case.family, Family::Null | Family::StillNull)
}

/// Per effect what was said; `background` is what every copy has.
fn revealed(rest: &[(&Case, &Said)], background: &[String]) -> Vec<Revealed> {
    let mut effects: Vec<Revealed> = Vec::new();
    for (case, said) in rest {
        let Some((id, size)) = case.sizes_over_noise().into_iter().next_back() else { continue };
        let mark = judge::judge(case, said);
        let groups: Vec<String> = said.groups.iter().map(|g| g.join(" | ")).collect();
        let tried = Tried {
            effect_over_noise: size,
            strength: case.strength(),
            noticed: judge::is_detected(said) && (said.outcome != Ending::Explained || said.ids() != background),
            named: mark.is_named(),
            said: format!("{} {}", said.outcome.name(), groups.join(" + ")).trim().to_owned(),
            others: if mark == Mark::Named {
                Vec::new()
            } else {
                said.ids().into_iter().filter(|other| !case.planted().contains(other)).collect()
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

/// Two effects of which one was taken for the other, or indistinguishable from it, at the largest
/// size tried.
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
