//! A gyro on a turntable: the table's rate is the input, a steady turn is no rest, and nothing is said
//! of a resonance that does not show.
//!
//! The table steps from rate to rate in ramps of a second; the reading is a law of the rate at the same
//! moment, with white noise. Controls: a mass that rings inside the band, and a bias that drifts.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use libtest_mimic::{Failed, Trial};
use proofmass::rng::{Philox, Stream};
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;

use super::bench::{Answer, Bench, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("turntable: the table's rate is the input, and the scale factor lies in its interval", linear),
        test("turntable: a cubic reading is named with its size, a drift of the scale too", laws),
        test("turntable: a mass that rings inside the band keeps its resonance (control)", rings),
        test("turntable: no gyro that is turned at steady rates is one at rest, one that drifts is", at_rest),
    ]
}

const RATE_HZ: f64 = 100.0;
/// Rates of the table, °/s, each for this many seconds.
const LEVELS: [f64; 10] = [0.0, 20.0, -20.0, 50.0, -50.0, 100.0, -100.0, 200.0, -200.0, 0.0];
const LEVEL_S: f64 = 8.0;
/// White noise of the reading, °/s.
const NOISE: f64 = 0.05;
const SCALE: f64 = 1.004;
const OFFSET: f64 = 0.5;

/// Rate of the table at a time, °/s.
fn table(t: f64) -> f64 {
    let level = |k: f64| LEVELS.get(k as usize).copied().unwrap_or(0.0);
    let (k, within) = ((t / LEVEL_S).floor(), t % LEVEL_S);
    let ramp = within.min(1.0);
    level((k - 1.0).max(0.0)) * (1.0 - ramp) + level(k) * ramp
}

/// Lines of a log whose reading is this law of time and rate.
fn log(seed: u64, mut read: impl FnMut(f64, f64) -> f64) -> String {
    let (mut rng, mut csv) = (Philox::new(seed, 0, Stream::Host), String::from("time_s,gyro_z_dps,table_rate_dps\n"));
    for k in 0..(LEVELS.len() as f64 * LEVEL_S * RATE_HZ) as usize {
        let t = k as f64 / RATE_HZ;
        let noise: f64 = StandardNormal.sample(&mut rng);
        let _ = writeln!(csv, "{t:.2},{:.6},{:.6}", read(t, table(t)) + NOISE * noise, table(t));
    }
    csv
}

/// Its verdict without a model.
fn verdict(csv: &str) -> Result<Value, Failed> {
    let bench = Bench::new()?;
    let log = bench.file("log.csv", csv)?;
    run(program().arg("diagnose").arg(log).arg("--json"))?.json()
}

/// Value and half the 95 % interval of a number of the base model.
fn number(verdict: &Value, name: &str) -> Option<(f64, f64)> {
    let found = verdict["base"].as_array()?.iter().find(|p| p["name"] == name)?;
    Some((found["value"].as_f64()?, 0.5 * (found["ci95"][1].as_f64()? - found["ci95"][0].as_f64()?)))
}

/// Names of a verdict with value and half the interval of one parameter.
fn named(verdict: &Value, id: &str, parameter: &str) -> Option<(f64, f64)> {
    let [effect] = verdict["effects"].as_array()?.as_slice() else { return None };
    let of = |p: &&Value| p["name"] == parameter;
    let found = effect["parameters"].as_array()?.iter().find(of).filter(|_| effect["id"] == id)?;
    Some((found["value"].as_f64()?, 0.5 * (found["ci95"][1].as_f64()? - found["ci95"][0].as_f64()?)))
}

fn linear() -> Result<(), Failed> {
    for seed in 1..=3 {
        let csv = log(seed, |_, rate| SCALE * rate + OFFSET);
        let said = verdict(&csv)?;
        let what = format!("{seed}: {} {}", said["sentence"], said["base"]);
        let (scale, half) = number(&said, "sensitivity").ok_or_else(|| what.clone())?;
        let (offset, around) = number(&said, "offset").ok_or_else(|| what.clone())?;
        // Twice the half-width: about four standard errors.
        check((scale - SCALE).abs() < 2.0 * half && (offset - OFFSET).abs() < 2.0 * around, what.clone())?;
        // White noise over 8000 rows of this power: 0.05/(√8000·80) = 7·10⁻⁶, times two, and blocks differ.
        check(said["verdict"] == "adequate" && half < 1e-4, what.clone())?;
        check(number(&said, "omega0").is_none(), what)?;
    }
    Ok(())
}

fn laws() -> Result<(), Failed> {
    let cubic = verdict(&log(11, |_, rate| rate * (1.0 - 2e-7 * rate * rate) + OFFSET))?;
    let found = named(&cubic, "readout-nonlinearity", "k3").ok_or_else(|| cubic["sentence"].to_string())?;
    check((found.0 + 2e-7).abs() < 2.0 * found.1 && found.1 < 1e-8, format!("{found:?}"))?;
    // The spring that grows softer by κ reads more by −κ.
    let drift = verdict(&log(12, |t, rate| rate * (1.0 + 4e-5 * t) + OFFSET))?;
    let found = named(&drift, "stiffness-drift", "kappa").ok_or_else(|| drift["sentence"].to_string())?;
    check((found.0 + 4e-5).abs() < 2.0 * found.1 && found.1 < 1e-5, format!("{found:?}"))
}

/// Reading of a mass of 15 Hz, which the table's rate drives: velocity Verlet in 20 steps a sample.
fn mass() -> impl FnMut(f64, f64) -> f64 {
    let (omega, zeta, parts) = (TAU * 15.0, 0.05, 20);
    let h = 1.0 / (RATE_HZ * f64::from(parts));
    let (mut x, mut v) = (0.0, 0.0);
    move |t, _| {
        let read = x;
        for n in 0..parts {
            let push = |x: f64, v: f64, t: f64| omega * omega * (table(t) - x) - 2.0 * zeta * omega * v;
            let a = push(x, v, t + f64::from(n) * h);
            x += h * v + 0.5 * h * h * a;
            v += 0.5 * h * (a + push(x, v + h * a, t + f64::from(n + 1) * h));
        }
        read
    }
}

fn rings() -> Result<(), Failed> {
    let said = verdict(&log(21, mass()))?;
    let what = format!("{} {}", said["sentence"], said["base"]);
    let (omega, _) = number(&said, "omega0").ok_or_else(|| what.clone())?;
    check((omega / (TAU * 15.0) - 1.0).abs() < 0.01 && number(&said, "sensitivity").is_none(), what)
}

fn at_rest() -> Result<(), Failed> {
    let of = |csv: &str| -> Result<Answer, Failed> {
        let bench = Bench::new()?;
        bench.diagnose(csv, "kind = \"static\"\n[columns]\nchannels = [\"gyro_z_dps\"]\n", &["--json"])
    };
    of(&log(31, |_, rate| rate))?.refuses("turned", "turned at steady rates")?;
    of(&log(32, |t, _| 0.05 * t))?.json().map(drop)
}
