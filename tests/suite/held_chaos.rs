//! A chaotic response to an input that is held between its samples: half a sample is no late reading.
//!
//! Units are 1/ω₀ = 1 s and the displacement that one unit of input holds, so that every planted number is its
//! own expectation.

use std::f64::consts::TAU;

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::diagnosis::driven;
use proofmass::diagnosis::gate::Gate;
use proofmass::diagnosis::model::{Driven, DrivenColumns, Output, Split, Start};
use proofmass::diagnosis::verdict::{Outcome, Verdict};
use proofmass::recording::{Column, Recording};
use proofmass::report::diagnosis::worded;
use proofmass::rng::{Philox, Stream};

use super::world::{check, near, test};

/// Listed by the suite.
pub fn tests() -> Vec<Trial> {
    vec![test("held chaos: a spring under a held input is a spring, and no reading that is late", spring)]
}

const PER_CYCLE: usize = 25;
const ROWS: usize = 2500;
const BETA: f64 = 0.1;

/// A hardening spring under a sign that may turn every fourth sample: input and reading.
fn recorded(seed: u64) -> Recording {
    let mut rng = Philox::new(seed, 0, Stream::Host);
    let rate_hz = PER_CYCLE as f64 / TAU;
    let (steps, mut x, mut v, mut u) = (20, 0.0f64, 0.0f64, 1.0);
    let h = 1.0 / rate_hz / steps as f64;
    let (mut inputs, mut readings) = (Vec::new(), Vec::new());
    for row in 0..ROWS {
        if row % 4 == 0 {
            u = f64::signum(rng.normal());
        }
        inputs.push(u);
        readings.push(x + 2e-3 * rng.normal());
        let rate = |x: f64, v: f64| u - x - 0.05 * v - BETA * x * x * x;
        for _ in 0..steps {
            let a1 = rate(x, v);
            let a2 = rate(x + 0.5 * h * v, v + 0.5 * h * a1);
            let a3 = rate(x + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2);
            let a4 = rate(x + h * v + 0.5 * h * h * a2, v + h * a3);
            x += h * v + h * h / 6.0 * (a1 + a2 + a3);
            v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
    }
    Recording {
        path: "held.csv".into(),
        rows: ROWS,
        rate_hz,
        columns: vec![Column { name: "u".into(), values: inputs }, Column { name: "y".into(), values: readings }],
        ..Recording::default()
    }
}

fn verdict(recording: &Recording, without: Vec<Gate>) -> Result<Verdict, Failed> {
    let model = Driven {
        topic: None,
        unit: None,
        output_is: Output::Displacement,
        rate_hz: Some(recording.rate_hz),
        force_rate: false,
        rows: Vec::new(),
        columns: DrivenColumns { time: None, input: Some("u".into()), output: "y".into(), environment: Vec::new() },
        start: Start::default(),
        split: Split::default(),
        without,
    };
    let answer = driven::diagnose(recording, &model, &Control::silent()).map_err(|e| e.to_string())?;
    Ok(worded(answer).verdict)
}

fn spring() -> Result<(), Failed> {
    let recording = recorded(1);
    let verdict = verdict(&recording, Vec::new())?;
    let ids: Vec<&str> = verdict.effects.iter().map(|e| e.id.as_str()).collect();
    check(verdict.verdict == Outcome::Explained && ids == ["cubic-stiffness"], verdict.sentence.clone())?;
    let beta = verdict.effects[0].parameters[0].value;
    near("beta", beta, BETA, 1e-3 * BETA)?;
    // Control: with an input that is smooth between its samples the spring does not bring it to the noise.
    let smooth = self::verdict(&recording, vec![Gate::OtherInput])?;
    check(smooth.verdict != Outcome::Explained || smooth.effects.len() > 1, smooth.sentence.clone())
}
