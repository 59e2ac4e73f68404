//! Readings that went through a low-pass, beside clocks that are late.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use proofmass::diagnosis::answer::Answer;
use proofmass::diagnosis::verdict::Outcome;
use proofmass::report::diagnosis::worded;

use super::super::world::{check, data_test, near, test};
use super::flight::{Flight, base, effect, ids, made_up, real};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("trajectory: a low-pass is named with its time constant, and its lag is no clock", alone),
        test("trajectory: a clock offset is named in addition to a low-pass", with_clock),
        test("trajectory: a filter that is no low-pass of one pole is not explained by one", moving_average),
        test("trajectory: a low-pass shows beside attitudes alone", attitude_alone),
        test("trajectory: a low-pass of quick motion is named alike", quick),
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

/// The low-pass that a filter of straight lines between samples is: they are one of a sixth of the
/// square of their interval themselves.
fn with_lines(tau_s: f64) -> f64 {
    (tau_s * tau_s + STEP_S * STEP_S / 6.0).sqrt()
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
            check(ids(&answer).len() == 1, &what)?;
            // Twice the time between readings may be too short to be told from a clock.
            if tau_s < 3.0 * STEP_S && answer.outcome == Outcome::Undecidable {
                let lag = effect(&answer, "time-offset")?;
                check(lag.confusable_with == ["readout-lowpass"], format!("{what}: {:?}", lag.confusable_with))?;
                continue;
            }
            check(answer.outcome == Outcome::Explained, &what)?;
            holds(&answer, "readout-lowpass", with_lines(tau_s), 1e-3)?;
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
    holds(&answer, "readout-lowpass", with_lines(0.02), 1e-3)?;
    holds(&answer, "time-offset", -0.03, 1e-3)?;
    // What is later than its low-pass may be a low-pass of more poles.
    let late = lowpassed(&made_up(6)?, 0.02).shifted(0.03).diagnosed()?;
    holds(&late, "time-offset", 0.03, 1e-3)?;
    check(late.outcome == Outcome::Undecidable, format!("{:?}", late.outcome))?;
    check(effect(&late, "time-offset")?.confusable_with == ["readout-lowpass"], "its lag may be a second pole's")
}

/// The mean of 21 readings is late by ten of them, and as much smaller as a pole of 30 ms makes it.
fn moving_average() -> Result<(), Failed> {
    let mean = |values: &[[f64; 3]]| -> Vec<[f64; 3]> {
        let last = |k: usize, i: usize| (0..21).map(|n| values[k.saturating_sub(n)][i]).sum::<f64>() / 21.0;
        (0..values.len()).map(|k| std::array::from_fn(|i| last(k, i))).collect()
    };
    let answer = through(&made_up(6)?, mean).diagnosed()?;
    check(answer.outcome == Outcome::Undecidable, "a mean is explained by a pole")?;
    let names: Vec<String> = ids(&answer).into_iter().collect();
    check(names == ["readout-lowpass", "time-offset"], format!("{names:?}"))?;
    near("tau", effect(&answer, "readout-lowpass")?.parameters[0].value, (440.0f64 / 12.0).sqrt() * STEP_S, 2e-3)
}

fn attitude_alone() -> Result<(), Failed> {
    let answer = lowpassed(&made_up(6)?, 0.02).files().with_columns(&["timestamp", "q_RS"]).diagnosed()?;
    check(ids(&answer).len() == 1, format!("{:?}", ids(&answer)))?;
    holds(&answer, "readout-lowpass", with_lines(0.02), 1e-3)
}

/// The same flight by a body that rolls to and fro by 40 mrad, five times a second.
fn rolling(flight: &Flight) -> Flight {
    const TURN_RAD: f64 = 0.04;
    const RATE: f64 = std::f64::consts::TAU * 5.0;
    let angle = |time_s: f64| TURN_RAD * (RATE * time_s).sin();
    let back = |time_s: f64, v: [f64; 3]| {
        let (sin, cos) = angle(time_s).sin_cos();
        [v[0], cos * v[1] + sin * v[2], cos * v[2] - sin * v[1]]
    };
    let time_s = |k: usize| k as f64 * STEP_S;
    let rolls = |time_s: f64| TURN_RAD * RATE * (RATE * time_s).cos();
    flight
        .with_rate_at(|k, w| {
            let [x, y, z] = back(time_s(k), w);
            [x + rolls(time_s(k)), y, z]
        })
        .with_force_at(|k, f| back(time_s(k), f))
        // Every second sample has a pose.
        .with_pose_at(|k, p, [w, x, y, z]| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle(time_s(2 * k)));
            let q = (UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)) * turn).into_inner();
            (p, [q.w, q.i, q.j, q.k])
        })
}

fn quick() -> Result<(), Failed> {
    let flight = rolling(&made_up(6)?);
    let none = flight.diagnosed()?;
    check(!ids(&none).contains("readout-lowpass"), format!("without one: {:?}", ids(&none)))?;
    let answer = lowpassed(&flight, 0.01).diagnosed()?;
    let more: Vec<String> = ids(&answer).into_iter().filter(|id| !ids(&none).contains(id)).collect();
    check(more == ["readout-lowpass"], format!("{more:?}: {}", worded(answer.clone()).verdict.sentence))?;
    holds(&answer, "readout-lowpass", with_lines(0.01), 5e-4)
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
    holds(&answer, "readout-lowpass", with_lines(0.02), 1e-3)
}
