//! Dry friction whose force varies with speed, in decays and driven: it is named friction, with the
//! numbers of its curve, and what is no friction is not.
//!
//! Units are the first amplitude and 1/ω₀, so that every planted number is its own expectation.

use std::f64::consts::TAU;

use libtest_mimic::{Failed, Trial};
use proofmass::diagnosis::verdict::{Outcome, Verdict};

use super::decays::{Made, PER_CYCLE, diagnosed, ids};
use super::near_laws::{Force, recording, verdict};
use super::world::{check, test};

/// Listed by the suite.
pub fn tests() -> Vec<Trial> {
    vec![
        test("creeping friction: a smooth sign is named with its velocity, beside a spring too", smooth),
        test("creeping friction: friction that falls with speed is named with all its numbers", falling),
        test("creeping friction: driven, it is told from a damping by a power below one", driven),
        test("creeping friction: a sharp sign has one number, and a root of the velocity is no friction", others),
    ]
}

fn decay(force: &dyn Fn(f64, f64, f64) -> f64, seed: u64) -> Result<Verdict, Failed> {
    let made = Made { zeta: 0.0025, cycles: 60, noise: 5e-4, seed, force };
    diagnosed(made.reading(), PER_CYCLE as f64 / TAU)
}

/// Checks that these laws alone are named, and the numbers of friction: each within twice its 95 % interval,
/// which is no wider than this part of it.
fn named(verdict: &Verdict, laws: &[&str], numbers: &[f64], widest: f64) -> Result<(), Failed> {
    let mut found = ids(verdict);
    found.sort_unstable();
    check(verdict.verdict == Outcome::Explained && found == laws, verdict.sentence.clone())?;
    let friction = verdict.effects.iter().find(|e| e.id == "coulomb-friction").ok_or("no friction")?;
    check(friction.parameters.len() == numbers.len(), format!("{:?}", friction.parameters))?;
    for (parameter, planted) in friction.parameters.iter().zip(numbers) {
        let [low, high] = parameter.ci95;
        let reach = 0.5 * (high - low);
        check(low - reach < *planted && *planted < high + reach, format!("{planted}: {parameter:?}"))?;
        check(reach < widest * planted, format!("{parameter:?}"))?;
    }
    Ok(())
}

fn smooth() -> Result<(), Failed> {
    for seed in [1, 2, 3] {
        let alone = |_: f64, _: f64, v: f64| -0.02 * (v / 0.05).tanh();
        named(&decay(&alone, seed)?, &["coulomb-friction"], &[0.02, 0.05], 0.05)?;
        let beside = |_: f64, x: f64, v: f64| 0.15 * x * x * x - 0.02 * (v / 0.05).tanh();
        named(&decay(&beside, seed)?, &["coulomb-friction", "cubic-stiffness"], &[0.02, 0.05], 0.05)?;
    }
    Ok(())
}

fn falling() -> Result<(), Failed> {
    for seed in [1, 2, 3] {
        let force = |_: f64, _: f64, v: f64| -0.01 * (v / 0.01).tanh() * (1.0 + 0.6 * (-v.abs() / 0.2).exp());
        named(&decay(&force, seed)?, &["coulomb-friction"], &[0.01, 0.01, 0.6, 0.2], 1.0)?;
        let bell = |_: f64, _: f64, v: f64| -0.01 * (v / 0.01).tanh() * (1.0 + 0.6 * (-(v / 0.2).powi(2)).exp());
        named(&decay(&bell, seed)?, &["coulomb-friction"], &[0.01, 0.01, 0.6, 0.2], 1.0)?;
    }
    Ok(())
}

fn others() -> Result<(), Failed> {
    for seed in [1, 2, 3] {
        let sharp = |_: f64, _: f64, v: f64| -0.01 * (v / 1e-3).clamp(-1.0, 1.0);
        let verdict = decay(&sharp, seed)?;
        check(ids(&verdict) == ["coulomb-friction"], verdict.sentence.clone())?;
        check(verdict.effects[0].parameters.len() == 1, format!("{:?}", verdict.effects[0].parameters))?;
        let root = |_: f64, _: f64, v: f64| -0.02 * v.signum() * v.abs().sqrt();
        let verdict = decay(&root, seed)?;
        check(!ids(&verdict).contains(&"coulomb-friction"), verdict.sentence.clone())?;
    }
    Ok(())
}

/// Damping by a power below one has a cusp at standstill. Integrated too coarsely, a friction with four numbers
/// fits it better than the law itself. Each number must lie within twice its 95 % interval, as above, and be
/// known to a fifth: a wrong power, or none, would not be.
fn driven() -> Result<(), Failed> {
    let laws: [(&str, &str, f64, Force); 3] = [
        ("power-law-damping", "n", 0.3, |_, v| 0.12 * v.signum() * v.abs().powf(0.3)),
        ("power-law-damping", "n", 0.5, |_, v| 0.12 * v.signum() * v.abs().sqrt()),
        // The model file makes ω₀ 100 rad/s.
        ("coulomb-friction", "v_s", 20.0, |_, v| 0.15 * (v / 0.2).tanh()),
    ];
    for (seed, (id, name, planted, force)) in laws.into_iter().enumerate() {
        let said = verdict(&recording(force, 31 + seed as u64, 0.0))?;
        let sentence = format!("{planted}: {}", said["sentence"]);
        let effects = said["effects"].as_array().cloned().unwrap_or_default();
        check(said["verdict"] == "explained" && effects.len() == 1 && effects[0]["id"] == id, sentence.clone())?;
        let parameters = effects[0]["parameters"].as_array().cloned().unwrap_or_default();
        let own = parameters.iter().find(|p| p["name"] == name).ok_or(sentence)?;
        let [low, high] = [0, 1].map(|i| own["ci95"][i].as_f64().unwrap_or(f64::NAN));
        let reach = 0.5 * (high - low);
        check(low - reach < planted && planted < high + reach && reach < 0.2 * planted, format!("{planted}: {own}"))?;
    }
    Ok(())
}
