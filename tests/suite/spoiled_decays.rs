//! Free decays as laboratories record them: hit in the middle, on a support that touches on one side only, read
//! through a capacitor.
//!
//! Units are the first amplitude and 1/ω₀, so that every planted number is its own expectation.

use std::f64::consts::TAU;

use libtest_mimic::{Failed, Trial};
use proofmass::diagnosis::verdict::{Outcome, Verdict};

use super::decays::{Made, PER_CYCLE, diagnosed, ids};
use super::world::{check, near, test};

/// Listed by the suite.
pub fn tests() -> Vec<Trial> {
    vec![
        test("spoiled decay: a hit in the middle is said with its second, and is no physics", hit),
        test("spoiled decay: a spring with a corner at rest is named with the stiffness of both sides", corner),
        test("spoiled decay: what a capacitor leaves is not told from an offset that settles", coupled),
    ]
}

fn of_row(reading: Vec<f64>) -> Result<Verdict, Failed> {
    diagnosed(reading, PER_CYCLE as f64 / TAU)
}

fn said(verdict: &Verdict) -> String {
    format!("{:?} {:?} {} {:?}", verdict.verdict, ids(verdict), verdict.sentence, verdict.findings)
}

/// Rows at which it is said to be excited again.
fn excited(verdict: &Verdict) -> Vec<f64> {
    let second = |finding: &String| {
        let rest = finding.strip_prefix("the mass is excited again near ")?;
        rest.split(' ').next()?.parse::<f64>().ok().map(|s| s * PER_CYCLE as f64 / TAU)
    };
    verdict.findings.iter().filter_map(second).collect()
}

/// A decay hit by this speed at the place of a row, within a hundredth of a radian.
fn struck(speed: f64, row: f64, cubic: f64, seed: u64) -> Vec<f64> {
    let at = row * TAU / PER_CYCLE as f64;
    let force = |t: f64, x: f64, _: f64| {
        let strikes = (at..at + 0.01).contains(&t);
        -cubic * x.powi(3) + if strikes { 100.0 * speed } else { 0.0 }
    };
    Made { zeta: 0.004, cycles: 100, noise: 0.003, seed, force: &force }.reading()
}

// A tenth of the first speed at a third of the first amplitude: too small to make a swing grow by half, and
// thirty times the noise.
fn hit() -> Result<(), Failed> {
    for (seed, speed) in [(1, 0.1), (2, -0.1), (3, 0.03)] {
        let verdict = of_row(struck(speed, 1810.3, 0.0, seed))?;
        let found = excited(&verdict);
        let is_there = matches!(found[..], [row] if (row - 1810.3).abs() < 0.25 * PER_CYCLE as f64);
        check(verdict.verdict == Outcome::Adequate && is_there, format!("{speed}: {}", said(&verdict)))?;
    }
    let verdict = of_row(struck(0.1, 1810.3, 0.1, 4))?;
    let is_named = verdict.verdict == Outcome::Explained && ids(&verdict) == ["cubic-stiffness"];
    check(is_named && excited(&verdict).len() == 1, format!("next to a spring: {}", said(&verdict)))?;
    let p = &verdict.effects[0].parameters[0];
    near("beta", p.value, 0.1, p.ci95[1] - p.ci95[0])?;
    for cubic in [0.0, 0.1] {
        let verdict = of_row(struck(0.0, 0.0, cubic, 5))?;
        check(excited(&verdict).is_empty(), format!("control {cubic}: {}", said(&verdict)))?;
    }
    Ok(())
}

// Stiffer by a fifth on one side is ω₀² = 1.1 with ± 0.1.
fn corner() -> Result<(), Failed> {
    for (seed, stiffer) in [(1, 0.2), (2, -0.2)] {
        let force = |_: f64, x: f64, _: f64| -stiffer * x.max(0.0);
        let verdict = of_row(Made { zeta: 0.006, cycles: 80, noise: 0.004, seed, force: &force }.reading())?;
        let is_named = verdict.verdict == Outcome::Explained && ids(&verdict) == ["asymmetric-stiffness"];
        check(is_named, format!("{stiffer}: {}", said(&verdict)))?;
        let of = |name: &str| verdict.effects[0].parameters.iter().find(|p| p.name == name).ok_or("no such number");
        // Twice the 95 % interval: chance leaves it once in ten thousand.
        let [k, n] = [of("k")?, of("n")?];
        near("n", n.value, 1.0, n.ci95[1] - n.ci95[0])?;
        check(n.ci95[1] - n.ci95[0] < 0.3, format!("{:?} says little", n.ci95))?;
        near("k", k.value, 0.5 * stiffer, k.ci95[1] - k.ci95[0])?;
        check(k.ci95[1] - k.ci95[0] < 0.2 * stiffer.abs(), format!("{:?} says little", k.ci95))?;
    }
    // Control: with a square it is the quadratic spring.
    let force = |_: f64, x: f64, _: f64| -0.1 * x * x;
    let verdict = of_row(Made { zeta: 0.006, cycles: 80, noise: 0.004, seed: 3, force: &force }.reading())?;
    check(ids(&verdict) == ["quadratic-stiffness"], said(&verdict))
}

/// A reading behind a capacitor that was charged with the first value: z′ = (x − z)/τ, exact for a straight line
/// between rows.
fn behind_a_capacitor(reading: &[f64], tau: f64) -> Vec<f64> {
    let step = TAU / PER_CYCLE as f64 / tau;
    let (mut z, decay) = (reading[0], (-step).exp());
    let mut out = vec![0.0];
    for pair in reading.windows(2) {
        let slope = (pair[1] - pair[0]) / step;
        z = pair[1] - slope + (z - pair[0] + slope) * decay;
        out.push(pair[1] - z);
    }
    out
}

fn coupled() -> Result<(), Failed> {
    for (seed, tau) in [(1, 20.0), (2, 8.0), (3, 4.0)] {
        let made = Made { zeta: 0.006, cycles: 80, noise: 0.004, seed, force: &|_, _, _| 0.0 }.reading();
        let verdict = of_row(behind_a_capacitor(&made, tau))?;
        let both = ids(&verdict) == ["warm-up", "readout-highpass"];
        check(verdict.verdict == Outcome::Undecidable && both, format!("{tau}: {}", said(&verdict)))?;
        let is_tau = |e: &&proofmass::diagnosis::verdict::Estimate| e.name == "tau";
        let p = verdict.effects[1].parameters.iter().find(is_tau).ok_or("no time constant")?;
        near("tau", p.value, tau, p.ci95[1] - p.ci95[0])?;
        check(p.ci95[1] - p.ci95[0] < 0.2 * tau, format!("{:?} says little", p.ci95))?;
    }
    // Control: three times the motion is no charge of a capacitor.
    let made = Made { zeta: 0.006, cycles: 80, noise: 0.004, seed: 4, force: &|_, _, _| 0.0 }.reading();
    let settling = |(k, y): (usize, f64)| y + 3.0 * (-(k as f64) / 200.0).exp();
    let verdict = of_row(made.into_iter().enumerate().map(settling).collect())?;
    check(!ids(&verdict).contains(&"readout-highpass"), said(&verdict))
}
