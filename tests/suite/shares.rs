//! Under an input each name comes with the part of the error that it removes in free simulation, and
//! where nothing can be named the argument of what is left is said with its share.
//!
//! Motion comes from a plain Runge–Kutta integrator of the test's own under a sum of sines that is known
//! at every time, in units of 1/ω₀.

use std::f64::consts::TAU;

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::diagnosis::driven;
use proofmass::diagnosis::model::{Driven, DrivenColumns, Output, Split, Start};
use proofmass::diagnosis::verdict::{Outcome, Verdict};
use proofmass::recording::{Column, Recording};
use proofmass::report::diagnosis::worded;
use proofmass::rng::{Philox, Stream};

use super::world::{check, near, test};

/// Listed by the suite.
pub fn tests() -> Vec<Trial> {
    vec![
        test("shares: under an input each name removes its part of the error, and noise none", named),
        test("shares: what no name takes has an argument", unnamed),
    ]
}

/// Rows of a recording.
const ROWS: usize = 3000;
/// Time from one row to the next: 31 rows a cycle.
const INTERVAL: f64 = 0.2;
/// Integration steps from one row to the next.
const STEPS: usize = 10;

/// Input and reading of a mass with ω₀ = 1 and ζ = 0.05, beside whose spring and damper `force` of
/// (time, x, v) acts, read with this noise.
fn recorded(noise: f64, force: impl Fn(f64, f64, f64) -> f64) -> Vec<[f64; 2]> {
    let mut rng = Philox::new(11, 0, Stream::Host);
    // Phases that rise with the square of the frequency keep the crest low (Schroeder, 1970).
    let line = |i: i32| [0.21 + 0.083 * f64::from(i), TAU * f64::from(i * i) / 48.0];
    let lines: Vec<[f64; 2]> = (0..24).map(line).collect();
    let input = |t: f64| lines.iter().map(|[w, phase]| 0.08 * (w * t + phase).sin()).sum::<f64>();
    let rate = |t: f64, x: f64, v: f64| input(t) - x - 0.1 * v + force(t, x, v);
    let h = INTERVAL / STEPS as f64;
    let (mut x, mut v, mut rows) = (0.0, 0.0, Vec::new());
    for row in 0..ROWS {
        rows.push([input(row as f64 * INTERVAL), x + noise * rng.normal()]);
        for step in 0..STEPS {
            let t = (row * STEPS + step) as f64 * h;
            let a1 = rate(t, x, v);
            let a2 = rate(t + 0.5 * h, x + 0.5 * h * v, v + 0.5 * h * a1);
            let a3 = rate(t + 0.5 * h, x + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2);
            let a4 = rate(t + h, x + h * v + 0.5 * h * h * a2, v + h * a3);
            x += h * v + h * h / 6.0 * (a1 + a2 + a3);
            v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
    }
    rows
}

fn diagnosed(rows: &[[f64; 2]]) -> Result<Verdict, Failed> {
    let column = |i: usize, name: &str| Column { name: name.into(), values: rows.iter().map(|r| r[i]).collect() };
    let rate_hz = 1.0 / INTERVAL;
    let recording = Recording {
        path: "driven.csv".into(),
        rows: rows.len(),
        rate_hz,
        columns: vec![column(0, "u"), column(1, "y")],
        ..Recording::default()
    };
    let model = Driven {
        topic: None,
        output_is: Output::Displacement,
        unit: None,
        rate_hz: Some(rate_hz),
        force_rate: false,
        rows: Vec::new(),
        columns: DrivenColumns { time: None, input: Some("u".into()), output: "y".into(), environment: Vec::new() },
        start: Start::default(),
        split: Split::default(),
        without: Vec::new(),
    };
    let answer = driven::diagnose(&recording, &model, &Control::silent()).map_err(|e| e.to_string())?;
    Ok(worded(answer).verdict)
}

fn ids(verdict: &Verdict) -> Vec<&str> {
    verdict.effects.iter().map(|e| e.id.as_str()).collect()
}

// Both laws are exact: either takes all that the model without it leaves above the noise, within a
// hundredth for the noise's own measurement.
fn named() -> Result<(), Failed> {
    let verdict = diagnosed(&recorded(0.002, |_, x, v| -0.3 * x.powi(3) - 0.1 * v.abs() * v))?;
    let mut found = ids(&verdict);
    found.sort_unstable();
    check(found == ["cubic-stiffness", "quadratic-damping"], format!("{found:?} {}", verdict.sentence))?;
    check(verdict.verdict == Outcome::Explained, verdict.sentence.clone())?;
    let all = verdict.effects.iter().map(|e| e.share).chain([verdict.fit.test.share]);
    for share in all {
        let share = share.ok_or("no share")?;
        near("share", share.value, 1.0, 0.01)?;
        check(share.ci95[0] > 0.0 && share.ci95[0] <= share.value, format!("{share:?}"))?;
    }
    check(verdict.location.argument.is_none(), "an argument of noise")?;
    // Control: where nothing is missing nothing is removed.
    let linear = diagnosed(&recorded(0.002, |_, _, _| 0.0))?;
    check(ids(&linear).is_empty() && linear.fit.test.share.is_none(), linear.sentence.clone())?;
    check(linear.location.argument.is_none(), format!("{:?}", linear.location.argument))
}

// A spring that stiffens for a while and comes back is no law of the library, and goes with time alone.
// Friction that falls with speed is one of it. A spring that follows a sine is near one, and departs: the
// name keeps its share, and what it leaves is said to depend on displacement and is held against the noise
// that was read.
fn unnamed() -> Result<(), Failed> {
    let passing = |t: f64, x: f64, _: f64| 0.1 * (-((t - 200.0) / 120.0).powi(2)).exp() * x;
    let verdict = diagnosed(&recorded(0.002, passing))?;
    check(verdict.verdict == Outcome::Unexplained && ids(&verdict).is_empty(), verdict.sentence.clone())?;
    let argument = verdict.location.argument.as_ref().ok_or_else(|| format!("no argument: {}", verdict.sentence))?;
    check(argument.name == "time" && argument.share.ci95[0] > 0.0, format!("{argument:?}"))?;
    let falling = |_: f64, _: f64, v: f64| -0.05 * (v / 0.002).tanh() * (1.0 + 1.5 * (-v.abs() / 0.05).exp());
    let verdict = diagnosed(&recorded(0.002, falling))?;
    check(verdict.verdict == Outcome::Explained && ids(&verdict) == ["coulomb-friction"], verdict.sentence.clone())?;
    for (parameter, planted) in verdict.effects[0].parameters.iter().zip([0.05, 0.002, 1.5, 0.05]) {
        let [low, high] = parameter.ci95;
        let width = high - low;
        check(low - width < planted && planted < high + width, format!("{planted}: {parameter:?}"))?;
    }
    let sine = |_: f64, x: f64, _: f64| x - (0.6 * x).sin() / 0.6;
    let verdict = diagnosed(&recorded(0.002, sine))?;
    check(ids(&verdict) == ["cubic-stiffness"], format!("{:?} {}", ids(&verdict), verdict.sentence))?;
    let share = verdict.effects[0].share.ok_or("no share")?;
    check(share.value > 0.9 && share.ci95[0] > 0.0, format!("{share:?}"))?;
    let argument = verdict.location.argument.as_ref().ok_or_else(|| format!("no argument: {}", verdict.sentence))?;
    check(argument.name == "displacement", format!("{argument:?}"))?;
    let (after, floor) = (verdict.fit.test.rmse_after.unwrap_or(0.0), verdict.fit.noise_floor);
    near("noise", floor, 0.002, 0.0004)?;
    check(verdict.verdict == Outcome::Unexplained && after > 2.0 * floor, verdict.sentence.clone())
}
