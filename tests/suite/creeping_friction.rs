//! Free decays under dry friction whose force has a shape of its own over the velocity: it is named as
//! friction with the numbers of that shape, and what is no friction is not.
//!
//! Units are the first amplitude and 1/ω₀, so that every planted number is its own expectation.

use std::f64::consts::TAU;

use libtest_mimic::{Failed, Trial};
use proofmass::diagnosis::verdict::{Outcome, Verdict};

use super::decays::{Made, PER_CYCLE, diagnosed, ids};
use super::world::{check, test};

/// Listed by the suite.
pub fn tests() -> Vec<Trial> {
    vec![
        test("creeping friction: a smooth sign is named with its velocity, beside a spring too", smooth),
        test("creeping friction: friction that falls with speed is named with all its numbers", falling),
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
