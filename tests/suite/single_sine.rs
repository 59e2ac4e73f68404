//! One sine as the input: the frequency response says nothing of the resonance, the transient rings
//! at it. The base model is found there and is adequate; a second mode that rings beside it is not
//! described by it.
//!
//! Motion is the textbook's closed form of an oscillator that is switched on at rest.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use libtest_mimic::{Failed, Trial};
use proofmass::rng::{Philox, Stream};
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;

use super::bench::{Bench, diagnose};
use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("single sine: the resonance is found in the transient, and the base model is adequate", found),
        test("single sine: a second mode that rings as well is not described by the base model (control)", second),
    ]
}

const RATE_HZ: f64 = 100.0;
const ROWS: usize = 4000;

/// Damping ratio, and the line beside the resonance of 5 Hz.
const CASES: [(f64, f64); 5] = [(0.0034, 0.34), (0.01, 2.3), (0.03, 0.6), (0.003, 1.7), (0.015, 0.15)];

/// Displacement per unit force of an oscillator at rest until t = 0, then driven by sin(w t).
fn switched_on(omega: f64, zeta: f64, w: f64, t: f64) -> f64 {
    let size = (omega * omega - w * w).powi(2) + (2.0 * zeta * omega * w).powi(2);
    let (sine, cosine) = ((omega * omega - w * w) / size, -2.0 * zeta * omega * w / size);
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    let (a, b) = (-cosine, -(sine * w - zeta * omega * -cosine) / damped);
    let decay = (-zeta * omega * t).exp();
    sine * (w * t).sin() + cosine * (w * t).cos() + decay * (a * (damped * t).cos() + b * (damped * t).sin())
}

/// Its verdict on a log of one sine, with another mode at 1.9 times the resonance of so many times
/// the size.
fn verdict((zeta, line): (f64, f64), another: f64, seed: u64) -> Result<Value, Failed> {
    let (omega, mut rng, mut csv) = (TAU * 5.0, Philox::new(seed, 0, Stream::Host), String::from("u,y\n"));
    let motion: Vec<f64> = (0..ROWS)
        .map(|k| {
            let (t, w) = (k as f64 / RATE_HZ, line * omega);
            switched_on(omega, zeta, w, t) + another * switched_on(1.9 * omega, zeta, w, t)
        })
        .collect();
    let largest = motion.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    for (k, x) in motion.iter().enumerate() {
        let noise: f64 = StandardNormal.sample(&mut rng);
        let _ = writeln!(csv, "{},{}", (line * omega * k as f64 / RATE_HZ).sin(), x / largest + 0.01 * noise);
    }
    let bench = Bench::new()?;
    let log = bench.file("log.csv", &csv)?;
    let columns = "[columns]\ninput = \"u\"\noutput = \"y\"\n";
    let model = bench.file("model.toml", &format!("kind = \"driven\"\nrate_hz = {RATE_HZ:?}\n{columns}"))?;
    diagnose(&log, &model, &["--json"])?.json()
}

fn found() -> Result<(), Failed> {
    for (seed, case) in CASES.into_iter().enumerate() {
        let said = verdict(case, 0.0, 11 + seed as u64)?;
        let of = |name: &str| said["base"].as_array().and_then(|b| b.iter().find(|p| p["name"] == name)).cloned();
        let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN) / TAU;
        let omega = of("omega0").unwrap_or_default();
        let (hz, half_hz) = (number(&omega["value"]), 0.5 * (number(&omega["ci95"][1]) - number(&omega["ci95"][0])));
        let what = format!("{case:?}: {} {}, {hz} ± {half_hz} Hz", said["verdict"], said["sentence"]);
        // Twice the half-width: about four standard errors.
        check(said["verdict"] == "adequate" && (hz - 5.0).abs() < 2.0 * half_hz && half_hz < 0.1, what)?;
    }
    Ok(())
}

fn second() -> Result<(), Failed> {
    let said = verdict(CASES[0], 4.0, 31)?;
    check(said["verdict"] != "adequate", format!("{}", said["sentence"]))
}
