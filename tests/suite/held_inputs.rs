//! Inputs that are held between their samples: what the reading does behind them keeps its name and
//! its value. A smooth input is the control.
//!
//! Motion is integrated here, by the classic Runge–Kutta method, not by the solver that is judged.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use libtest_mimic::{Failed, Trial};
use proofmass::rng::{Philox, Stream};
use rand_distr::{Distribution, StandardNormal, Uniform};

use super::bench::{Bench, run};
use super::near_laws::told;
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("held inputs: a low-pass next to a cubic spring has its value, as behind a smooth input", low_pass),
        test("held inputs: a velocity read behind a low-pass has its time constant alone", velocity),
        test("held inputs: a second resonance is no delay, low-pass and feedthrough next to it", mode),
        test("held inputs: a blow in a long silence shows what its ringing shows", blow),
    ]
}

const INTERVAL_S: f64 = 0.002;
const ROWS: usize = 4000;
const STEPS: usize = 16;
/// Time constant of the reading, s, and cubic stiffness, 1/(m² s²).
const LOW_PASS_S: f64 = 0.0012;
const CUBIC: f64 = 4e6;

/// A Duffing oscillator of 12 Hz, Q 20, under 40 lines, and how it is read.
#[derive(Clone, Copy)]
struct Made {
    is_held: bool,
    /// Cubic stiffness, 1/(m² s²).
    cubic: f64,
    /// Velocity is read, not displacement.
    is_velocity: bool,
    seed: u64,
}

/// Force and noisy, smoothed reading.
fn recording(made: Made) -> String {
    let Made { is_held, cubic, is_velocity, seed } = made;
    let mut rng = Philox::new(seed, 0, Stream::Host);
    let mut line = |from: f64, to: f64| Uniform::new(from, to).expect("from below to").sample(&mut rng);
    let lines: Vec<[f64; 3]> = (0..40).map(|_| [line(-12.0, 12.0), line(1.0, 60.0), line(0.0, TAU)]).collect();
    let force = |t: f64| lines.iter().map(|[a, hz, phase]| a * (TAU * hz * t + phase).sin()).sum::<f64>();
    let (omega, h) = (TAU * 12.0, INTERVAL_S / STEPS as f64);
    let slope = |u: f64, [x, v, y]: [f64; 3]| {
        let seen = if is_velocity { v } else { x };
        [v, u - omega / 20.0 * v - omega * omega * x - cubic * x.powi(3), (seen - y) / LOW_PASS_S]
    };
    // Some 14 mm, or 1 m/s, are read (root mean square).
    let noise_sd = if is_velocity { 2e-3 } else { 2e-6 };
    let add = |s: [f64; 3], k: [f64; 3], by: f64| -> [f64; 3] { std::array::from_fn(|i| s[i] + by * k[i]) };
    let (mut state, mut csv) = ([0.0; 3], String::from("t_s,force_m_s2,displacement_m\n"));
    for k in 0..ROWS {
        let t = k as f64 * INTERVAL_S;
        let noise: f64 = StandardNormal.sample(&mut rng);
        let _ = writeln!(csv, "{t:.3},{:.7},{:.9}", force(t), state[2] + noise_sd * noise);
        for n in 0..STEPS {
            let at = |part: f64| force(if is_held { t } else { t + (n as f64 + part) * h });
            let k1 = slope(at(0.0), state);
            let k2 = slope(at(0.5), add(state, k1, 0.5 * h));
            let k3 = slope(at(0.5), add(state, k2, 0.5 * h));
            let k4 = slope(at(1.0), add(state, k3, h));
            state = std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
    }
    csv
}

fn low_pass() -> Result<(), Failed> {
    let bench = Bench::new()?;
    for is_held in [true, false] {
        let made = Made { is_held, cubic: CUBIC, is_velocity: false, seed: 3 };
        let file = bench.file("log.csv", &recording(made))?;
        let answer = run(program().arg("diagnose").arg(file).arg("--json"))?;
        let verdict: serde_json::Value = serde_json::from_str(&answer.stdout)?;
        let effects = verdict["effects"].as_array().cloned().unwrap_or_default();
        // Twice the 95 % interval: chance leaves it once in ten thousand.
        let near = |id: &str, truth: f64| {
            let own = effects.iter().find(|e| e["id"] == id).map(|e| e["parameters"][0]["ci95"].clone());
            let end = |i: usize| own.as_ref().and_then(|ci95| ci95[i].as_f64()).unwrap_or(f64::NAN);
            (0.5 * (end(0) + end(1)) - truth).abs() < end(1) - end(0)
        };
        let said = format!("held {is_held}: {} {}", verdict["verdict"], verdict["sentence"]);
        let both = near("readout-lowpass", LOW_PASS_S) && near("cubic-stiffness", CUBIC);
        check(verdict["verdict"] == "explained" && effects.len() == 2 && both, said)?;
    }
    Ok(())
}

/// A velocity of a linear mass is read behind a low-pass. Steps taken for a smooth input make it late by half a
/// sample: a delay beside a low-pass of another time constant.
fn velocity() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let model = "kind = \"driven\"\noutput_is = \"velocity\"\n[columns]\ntime = \"t_s\"\ninput = \"force_m_s2\"\noutput = \"displacement_m\"\n";
    for (is_held, seed) in [(true, 3), (true, 4), (true, 5), (true, 6), (false, 3)] {
        let file = bench.file("log.csv", &recording(Made { is_held, cubic: 0.0, is_velocity: true, seed }))?;
        let model = bench.file("model.toml", model)?;
        let answer = run(program().arg("diagnose").arg(file).arg("--model").arg(model).arg("--json"))?;
        let verdict: serde_json::Value = serde_json::from_str(&answer.stdout)?;
        let said = format!("held {is_held}, {seed}: {} {}", verdict["verdict"], verdict["sentence"]);
        let effects = verdict["effects"].as_array().cloned().unwrap_or_default();
        let own = effects.first().map(|e| e["parameters"][0].clone()).unwrap_or_default();
        let [low, high] = [0, 1].map(|i| own["ci95"][i].as_f64().unwrap_or(f64::NAN));
        // Twice the 95 % interval: chance leaves it once in ten thousand.
        let is_near = (0.5 * (low + high) - LOW_PASS_S).abs() < high - low;
        let is_alone = effects.len() == 1 && effects[0]["id"] == "readout-lowpass";
        check(verdict["verdict"] == "explained" && is_alone && is_near, said)?;
    }
    Ok(())
}

/// The mode is found on a smooth input too, next to three stand-ins, and with another frequency.
fn mode() -> Result<(), Failed> {
    let (verdict, groups, mass) = told(1, 465)?;
    let is_meant = mass["held"] == true && mass["laws"][0]["law"] == "beside";
    check(is_meant, format!("another case stands under this number: {mass}"))?;
    check(verdict == "explained" && groups == [["parasitic-mode"]], format!("{verdict} {groups:?}"))
}

/// A twelfth of the recording moves; the peaks of its ringing are no stray readings.
fn blow() -> Result<(), Failed> {
    let (verdict, groups, mass) = told(1, 530)?;
    let lag_s = mass["input_lag_s"].as_f64().unwrap_or_default();
    check(lag_s < 0.0, format!("another case stands under this number: {mass}"))?;
    check(verdict == "explained" && groups == [["readout-delay"]], format!("{verdict} {groups:?}"))
}
