//! Readings that went through a low-pass, beside clocks that are late.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::diagnosis::answer::Answer;
use proofmass::diagnosis::verdict::Outcome;

use super::super::world::{check, data_test, near, test};
use super::flight::{Flight, base, effect, ids, made_up, real};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("trajectory: a low-pass is named with its time constant, and its lag is no clock", alone),
        test("trajectory: a clock beside a low-pass is an effect of its own", with_clock),
        test("trajectory: a filter that is no low-pass of one pole is not explained by one", moving_average),
        test("trajectory: a low-pass shows beside attitudes alone", attitude_alone),
        data_test("trajectory: a low-pass is found in the readings of a real flight", recorded),
    ]
}

/// From one reading to the next, s.
const STEP_S: f64 = 0.005;

/// Columns through τ y' = v − y, v going straight from sample to sample: the exact response to each
/// ramp.
fn filtered(values: &[[f64; 3]], tau_s: f64) -> Vec<[f64; 3]> {
    let keeps = (-STEP_S / tau_s).exp();
    let mut y = values[0];
    let mut all = vec![y];
    for pair in values.windows(2) {
        y = std::array::from_fn(|i| {
            let behind = (pair[1][i] - pair[0][i]) / STEP_S * tau_s;
            pair[1][i] - behind + (y[i] - pair[0][i] + behind) * keeps
        });
        all.push(y);
    }
    all
}

/// Both sensors through the same filter.
fn through(flight: &Flight, filter: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]>) -> Flight {
    let (rate, force) = (filter(&flight.rate), filter(&flight.force));
    flight.with_rate_at(|k, _| rate[k]).with_force_at(|k, _| force[k])
}

fn lowpassed(flight: &Flight, tau_s: f64) -> Flight {
    through(flight, |values| filtered(values, tau_s))
}

/// What holds a number, and how far it is off.
fn holds(answer: &Answer, id: &str, expected: f64, off: f64) -> Result<(), Failed> {
    let found = &effect(answer, id)?.parameters[0];
    check(found.ci95[0] < expected && expected < found.ci95[1], format!("{id}: {:?}, planted {expected}", found.ci95))?;
    near(id, found.value, expected, off)
}

fn alone() -> Result<(), Failed> {
    for seed in [1, 3, 6] {
        for tau_s in [0.01, 0.02, 0.04] {
            let answer = lowpassed(&made_up(seed)?, tau_s).diagnosed()?;
            let what = format!("seed {seed}, {tau_s} s: {:?}, {:?}", ids(&answer), answer.outcome);
            check(ids(&answer).len() == 1 && answer.outcome == Outcome::Explained, what)?;
            holds(&answer, "readout-lowpass", tau_s, 1e-3)?;
            let clock = base(&answer, "time_offset")?;
            check(clock.ci95[0] < 0.0 && 0.0 < clock.ci95[1], format!("the clock: {:?}", clock.ci95))?;
        }
        // Control: as late, and not filtered.
        let late = made_up(seed)?.shifted(0.02).diagnosed()?;
        check(ids(&late).len() == 1, format!("seed {seed}, late: {:?}", ids(&late)))?;
        holds(&late, "time-offset", 0.02, 1e-4)?;
    }
    Ok(())
}

fn with_clock() -> Result<(), Failed> {
    let answer = lowpassed(&made_up(6)?, 0.02).shifted(-0.03).diagnosed()?;
    check(ids(&answer).len() == 2, format!("{:?}", ids(&answer)))?;
    holds(&answer, "readout-lowpass", 0.02, 1e-3)?;
    holds(&answer, "time-offset", -0.03, 1e-3)?;
    // What is later than its low-pass may be a low-pass of more poles.
    let late = lowpassed(&made_up(6)?, 0.02).shifted(0.03).diagnosed()?;
    holds(&late, "time-offset", 0.03, 1e-3)?;
    check(late.outcome == Outcome::Undecidable, format!("{:?}", late.outcome))?;
    check(effect(&late, "time-offset")?.confusable_with == ["readout-lowpass"], "it is said to be no pole")
}

/// The mean of 21 readings is late by ten of them, and as much smaller as a pole of 29 ms makes it.
fn moving_average() -> Result<(), Failed> {
    let mean = |values: &[[f64; 3]]| -> Vec<[f64; 3]> {
        let last = |k: usize, i: usize| (0..21).map(|n| values[k.saturating_sub(n)][i]).sum::<f64>() / 21.0;
        (0..values.len()).map(|k| std::array::from_fn(|i| last(k, i))).collect()
    };
    let answer = through(&made_up(6)?, mean).diagnosed()?;
    check(answer.outcome != Outcome::Explained, "a mean is explained by a pole")?;
    let known = |id: &String| id == "readout-lowpass" || id == "time-offset";
    check(ids(&answer).iter().all(known), format!("{:?}", ids(&answer)))
}

fn attitude_alone() -> Result<(), Failed> {
    let answer = lowpassed(&made_up(6)?, 0.02).files().with_columns(&["timestamp", "q_RS"]).diagnosed()?;
    check(ids(&answer).len() == 1, format!("{:?}", ids(&answer)))?;
    holds(&answer, "readout-lowpass", 0.02, 1e-3)
}

/// In addition to what its reference already smooths: the square of the time constants is what adds
/// up.
fn recorded(data: &Path) -> Result<(), Failed> {
    let flight = real(data, "euroc_mh04")?;
    let plain = flight.diagnosed()?;
    check(!ids(&plain).contains("readout-lowpass"), "a low-pass where none is planted")?;
    let answer = lowpassed(&flight, 0.02).diagnosed()?;
    let more: Vec<String> = ids(&answer).into_iter().filter(|id| !ids(&plain).contains(id)).collect();
    check(more == ["readout-lowpass"], format!("{more:?}"))?;
    holds(&answer, "readout-lowpass", 0.02, 1e-3)
}
