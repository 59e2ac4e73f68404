//! What `diagnose` names of a sensor at rest, a study of `repaired.toml` runs: its readings have the
//! Allan deviation, or the course in time, that was planted in the recording.
//!
//! 200 s at 100 Hz hold a process with a memory of 1 s some hundred times: its deviation is found to
//! 7 %, its memory to 14 %. A quarter is more than three standard errors of the curve they make.

use std::cell::Cell;
use std::f64::consts::{PI, TAU};
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu;
use proofmass::control::Control;
use proofmass::kernel::cpu::lanes::LANES;
use proofmass::kernel::integrator::Integrator;
use proofmass::numerics::allan::Accumulator;
use proofmass::rng::{Philox, Stream};
use proofmass::study;

use super::bench::Bench;
use super::world::{check, near, test};

const RATE_HZ: f64 = 100.0;
const ROWS: usize = 20_000;
/// White noise per sample and 1 mg, m/s².
const WHITE_MG: f64 = 1.0;
const MG: f64 = 9.80665e-3;
const TOLERANCE: f64 = 0.25;

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("carried over: a named Gauss–Markov process has the planted Allan deviation in a study", markov),
        test("carried over: a named sinusoid has the planted Allan deviation in a study", sinusoid),
        test("carried over: a named temperature sensitivity follows the recorded temperature in a study", temperature),
        test("carried over: a sensitivity with a bend follows the recorded temperature in a study", curved),
        test("carried over: a sensitivity with a lag follows the recorded temperature as late in a study", late),
        test("carried over: a sensitivity that no study can run is said, with the reason", not_carried),
        test("carried over: a named warm-up takes the planted course in a study", warm_up),
    ]
}

/// White noise, and what else a reading at rest has at each sample, mg.
fn recording(seed: u64, mut more: impl FnMut(usize, f64) -> f64) -> String {
    let mut rng = Philox::new(seed, 0, Stream::Host);
    let mut row = |n: usize| {
        let (white, number) = (rng.normal(), rng.normal());
        format!("{:.6}\n", 20.0 + WHITE_MG * white + more(n, number))
    };
    format!("x\n{}", (0..ROWS).map(&mut row).collect::<String>())
}

/// The repaired sensor of a recording in which this effect alone must be named, with all of it.
fn repaired(recording: &str, id: &str) -> Result<String, Failed> {
    let text = diagnosed(recording, id)?;
    check(!text.contains("Not in this study"), format!("a study is said not to run it:\n{text}"))?;
    Ok(text)
}

/// The repaired sensor of a recording in which this effect alone must be named.
fn diagnosed(recording: &str, id: &str) -> Result<String, Failed> {
    let bench = Bench::new()?;
    let out = bench.path("out");
    let mut model = "kind = \"static\"\nrate_hz = 100.0\nunit = \"mg\"\n[columns]\nchannels = [\"x\"]\n".to_owned();
    if recording.starts_with("x,temp") {
        model += "environment = [\"temp\"]\n";
    }
    let verdict = bench.diagnose(recording, &model, &["--json", "--out", &out.display().to_string()])?.json()?;
    let named: Vec<&str> =
        verdict["effects"].as_array().into_iter().flatten().filter_map(|e| e["id"].as_str()).collect();
    check(named == [id], format!("named {named:?}: {}", verdict["sentence"]))?;
    Ok(std::fs::read_to_string(out.join("repaired.toml"))?)
}

/// Its comments, unbroken.
fn said(text: &str) -> String {
    text.replace("\n#   ", " ")
}

/// As long as the recording: without a temperature a repaired sensor is run for a minute.
fn for_as_long(repaired: &str) -> String {
    repaired.replace("duration_s = 60.0", "duration_s = 200.0")
}

/// Readings of 64 sensors at rest for as long as the recording, member by member, m/s².
fn readings(repaired: &str) -> Result<Vec<Vec<f64>>, Failed> {
    let study = study::parse("repaired.toml", repaired, Path::new(""))?;
    check(study.clock.samples == ROWS as u64, format!("{} samples", study.clock.samples))?;
    let job = study.job(Integrator::Ideal, vec![study.clock.samples]);
    let mut members = vec![Vec::new(); LANES];
    cpu::readings::<f64>(&job, 0, &Control::silent(), |seen| {
        members.iter_mut().zip(&seen.accelerometer.0).for_each(|(member, value)| member.push(*value));
    })?;
    Ok(members)
}

/// Compares the root mean of the members' Allan variances with a law, m/s², from 0.01 to 20 s.
fn obeys(members: &[Vec<f64>], law: impl Fn(f64) -> f64) -> Result<(), Failed> {
    let curve = |member: &Vec<f64>| {
        let mut accumulator = Accumulator::new();
        member.iter().for_each(|v| accumulator.push(*v));
        accumulator.points(RATE_HZ)
    };
    let curves: Vec<_> = members.iter().map(curve).collect();
    for (k, point) in curves[0].iter().enumerate().filter(|(_, point)| point.on_octave() && point.tau_s < 20.0) {
        let variance = curves.iter().map(|c| c[k].variance).sum::<f64>() / members.len() as f64;
        let what = format!("Allan deviation at {} s over its law", point.tau_s);
        near(&what, variance.sqrt() / law(point.tau_s), 1.0, TOLERANCE)?;
    }
    Ok(())
}

/// The repaired sensor without what was named: its white noise alone.
fn without(repaired: &str, term: &str) -> String {
    repaired.lines().filter(|line| !line.starts_with(term)).map(|line| format!("{line}\n")).collect()
}

/// White noise and another law, mg.
fn with_white(law: impl Fn(f64) -> f64) -> impl Fn(f64) -> f64 {
    move |tau_s| MG * (WHITE_MG / (tau_s * RATE_HZ).sqrt()).hypot(law(tau_s))
}

/// IEEE 952: σ² 2T/τ (1 − T/2τ (3 − 4e^(−τ/T) + e^(−2τ/T))).
fn of_markov(sigma: f64, memory_s: f64, tau_s: f64) -> f64 {
    let x = tau_s / memory_s;
    sigma * (2.0 / x * (1.0 - (3.0 - 4.0 * (-x).exp() + (-2.0 * x).exp()) / (2.0 * x))).sqrt()
}

fn markov() -> Result<(), Failed> {
    let (sigma, memory_s) = (2.0, 1.0);
    let kept = (-1.0 / (memory_s * RATE_HZ)).exp();
    let mut state = sigma;
    let text = repaired(
        &recording(41, |_, number| {
            state = kept * state + sigma * (1.0 - kept * kept).sqrt() * number;
            state
        }),
        "gauss-markov",
    )?;
    let text = for_as_long(&text);
    let members = readings(&text)?;
    obeys(&members, with_white(|t| of_markov(sigma, memory_s, t)))?;
    // Controls: three times the memory, and the sensor without the process.
    let slower = obeys(&members, with_white(|t| of_markov(sigma, 3.0 * memory_s, t)));
    check(slower.is_err(), "another memory passes")?;
    let bare = readings(&without(&text, "gauss_markov"))?;
    check(obeys(&bare, with_white(|t| of_markov(sigma, memory_s, t))).is_err(), "white noise alone passes")
}

fn sinusoid() -> Result<(), Failed> {
    let (amplitude, frequency_hz) = (2.0, 0.35);
    let sine = |n: usize, _: f64| amplitude * (TAU * frequency_hz * n as f64 / RATE_HZ + 1.0).sin();
    let text = repaired(&recording(42, sine), "sinusoid")?;
    // IEEE 952: A sin²(πfτ)/(πfτ).
    let law = |f: f64| with_white(move |t: f64| amplitude * (PI * f * t).sin().powi(2) / (PI * f * t));
    let text = for_as_long(&text);
    let members = readings(&text)?;
    obeys(&members, law(frequency_hz))?;
    check(obeys(&members, law(1.3 * frequency_hz)).is_err(), "another frequency passes")?;
    check(obeys(&readings(&without(&text, "sinusoid"))?, law(frequency_hz)).is_err(), "white noise alone passes")
}

/// How warm the sensor was, °C: it warms by 12 K and back by 3, and the room swings by 1 K.
fn deg_c(second: f64) -> f64 {
    24.0 + 12.0 * (PI * second / 200.0 * 1.2).sin() + (second / 17.0).sin()
}

/// White noise of 1 mg, what follows the temperature, and a column that holds it.
fn warmed(seed: u64, follows: impl Fn(f64) -> f64, column: impl Fn(f64) -> f64) -> String {
    let mut rng = Philox::new(seed, 0, Stream::Host);
    let mut row = |n: usize| {
        let second = n as f64 / RATE_HZ;
        format!("{:.6},{:.5}\n", WHITE_MG * rng.normal() + follows(deg_c(second)), column(deg_c(second)))
    };
    format!("x,temp\n{}", (0..ROWS).map(&mut row).collect::<String>())
}

fn temperature() -> Result<(), Failed> {
    let slope = 0.4;
    let text = repaired(&warmed(44, |deg_c| slope * deg_c, |deg_c| deg_c), "temperature-sensitivity")?;
    check(said(&text).contains("the column `temp`"), format!("the column is not named:\n{text}"))?;
    // b = s (θ − θ̄), θ̄ the mean over the recording; straight lines between sixty points miss 0.03 K,
    // the slope is known to a fiftieth of itself.
    let mean = (0..ROWS).map(|n| deg_c(n as f64 / RATE_HZ)).sum::<f64>() / ROWS as f64;
    let follows = |members: &[Vec<f64>], slope: f64| -> Result<(), Failed> {
        for second in [0, 20, 50, 90, 140, 199] {
            let part = 100 * second..100 * (second + 1);
            let reading = members.iter().flat_map(|m| &m[part.clone()]).sum::<f64>() / (100 * members.len()) as f64;
            let law = slope * (deg_c(second as f64 + 0.5) - mean);
            near(&format!("mean reading in second {second}, mg"), reading / MG, law, 0.2)?;
        }
        Ok(())
    };
    // The study lasts as long as the temperature is known, as it is written.
    let members = readings(&text)?;
    follows(&members, slope)?;
    check(follows(&members, 1.3 * slope).is_err(), "another slope passes")?;
    check(follows(&readings(&without(&text, "bias_temperature"))?, slope).is_err(), "white noise alone passes")
}

/// b = c (θ − 22)² is a straight line and a square about the mean θ̄: b(θ) − b(θ̄).
fn curved() -> Result<(), Failed> {
    let law = |deg_c: f64| 0.05 * (deg_c - 22.0).powi(2);
    let text = repaired(&warmed(45, law, |deg_c| deg_c), "temperature-sensitivity")?;
    let mean = (0..ROWS).map(|n| deg_c(n as f64 / RATE_HZ)).sum::<f64>() / ROWS as f64;
    let follows = |members: &[Vec<f64>]| -> Result<(), Failed> {
        for second in [0, 20, 50, 90, 140, 199] {
            let part = 100 * second..100 * (second + 1);
            let reading = members.iter().flat_map(|m| &m[part.clone()]).sum::<f64>() / (100 * members.len()) as f64;
            let expected = law(deg_c(second as f64 + 0.5)) - law(mean);
            near(&format!("mean reading in second {second}, mg"), reading / MG, expected, 0.25)?;
        }
        Ok(())
    };
    follows(&readings(&text)?)?;
    // Controls: the line without its bend, and the bend without its line.
    for key in ["bias_temperature_ug_k2 ", "bias_temperature_ug_k "] {
        check(text.contains(&format!("\n{key}=")), format!("no {key}:\n{text}"))?;
        check(follows(&readings(&without(&text, key))?).is_err(), format!("it passes without {key}"))?;
    }
    Ok(())
}

/// b = s (θ_l − θ̄_l), θ_l the temperature after a first-order lag, which begins where it is.
fn late() -> Result<(), Failed> {
    let (slope, lag_s) = (0.4, 20.0);
    let kept = (-1.0 / (lag_s * RATE_HZ)).exp();
    let course: Vec<f64> = (0..ROWS)
        .scan(deg_c(0.0), |state, n| {
            *state = kept * *state + (1.0 - kept) * deg_c(n as f64 / RATE_HZ);
            Some(*state)
        })
        .collect();
    let row = Cell::new(0);
    let follows = |_: f64| slope * course[row.replace(row.get() + 1)];
    let text = repaired(&warmed(47, follows, |deg_c| deg_c), "temperature-sensitivity")?;
    let table: toml::Table = text.parse()?;
    let found = table["temperature"].get("lag_s").and_then(toml::Value::as_float).ok_or("no lag_s")?;
    near("lag, s", found, lag_s, 0.05 * lag_s)?;
    let mean = course.iter().sum::<f64>() / ROWS as f64;
    let follows = |members: &[Vec<f64>]| -> Result<(), Failed> {
        for second in [0, 20, 50, 90, 140, 199] {
            let part = 100 * second..100 * (second + 1);
            let reading = members.iter().flat_map(|m| &m[part.clone()]).sum::<f64>() / (100 * members.len()) as f64;
            let expected = slope * (course[100 * second + 50] - mean);
            near(&format!("mean reading in second {second}, mg"), reading / MG, expected, 0.2)?;
        }
        Ok(())
    };
    follows(&readings(&text)?)?;
    // Controls: the same without its lag, and with half of it.
    check(follows(&readings(&without(&text, "lag_s"))?).is_err(), "it passes without the lag")?;
    let half = text.replace(&format!("lag_s = {found:?}"), &format!("lag_s = {:?}", 0.5 * found));
    check(follows(&readings(&half)?).is_err(), "half the lag passes")
}

fn not_carried() -> Result<(), Failed> {
    // A column of counts that no thermometer shows as °C.
    let counts = warmed(46, |deg_c| 0.4 * deg_c, |deg_c| 20_000.0 + 300.0 * deg_c);
    let text = diagnosed(&counts, "temperature-sensitivity")?;
    check(
        said(&text).contains("no temperature in °C") && !text.contains("\n[temperature]"),
        format!("counts as °C:\n{text}"),
    )
}

fn warm_up() -> Result<(), Failed> {
    let (amplitude, time_s) = (-6.0, 15.0);
    let text = repaired(&recording(43, |n, _| amplitude * (-(n as f64) / RATE_HZ / time_s).exp()), "warm-up")?;
    // The mean of 64 sensors over a second: white noise of 1 mg leaves 0.013 mg, the amplitude of the
    // recording is known to 0.06 mg and its time to a hundredth.
    let follows = |members: &[Vec<f64>], time_s: f64| -> Result<(), Failed> {
        for second in [0, 5, 15, 30, 60, 120] {
            let part = 100 * second..100 * (second + 1);
            let mean = members.iter().flat_map(|m| &m[part.clone()]).sum::<f64>() / (100 * members.len()) as f64;
            let law = amplitude * (-(second as f64 + 0.5) / time_s).exp();
            near(&format!("mean reading in second {second}, mg"), mean / MG, law, 0.25)?;
        }
        Ok(())
    };
    let text = for_as_long(&text);
    let members = readings(&text)?;
    follows(&members, time_s)?;
    check(follows(&members, 1.5 * time_s).is_err(), "another time constant passes")?;
    check(follows(&readings(&without(&text, "warm_up"))?, time_s).is_err(), "white noise alone passes")
}
