//! What belongs to the readout or to the input and is no missing physics: noise whose neighbours
//! are correlated, an oscillation at a harmonic of the input, a lightly damped mass that rings for
//! longer than its input's lines are apart. Each with a control in which there is something to
//! name.
//!
//! Motion is the closed form of a linear mass from rest under sines, not that of the solver.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use libtest_mimic::{Failed, Trial};
use proofmass::rng::{Philox, Stream};
use rand_distr::{Distribution, StandardNormal};

use super::bench::{Bench, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("own noise: neighbours that are correlated are said of the noise of an adequate model", coloured),
        test("own noise: an oscillation at a harmonic of the input has no name", harmonic),
        test("own noise: a trace says which rule kept an oscillation out, and without that rule it is named", traced),
        test("own noise: a mass that rings for long is not out of step with its input", ringing),
        test("own noise: an input that is held is known where there are four samples to a cycle", held),
        test("own noise: a delay of more samples than a file is out of step by is a delay", delayed),
    ]
}

const RATE_HZ: f64 = 400.0;
const ROWS: usize = 6000;
const OMEGA: f64 = TAU * 20.0;

/// Sines, each with its frequency in Hz and its phase.
type Lines<'a> = &'a [(f64, f64)];

/// Input at a time.
fn force(lines: Lines<'_>, t: f64) -> f64 {
    lines.iter().map(|(hz, phase)| (TAU * hz * t + phase).sin()).sum()
}

/// x″ + 2ζωx′ + ω²x = ω²u from rest: the answer to each line, and the free oscillation that makes
/// displacement and velocity zero at t = 0.
fn motion(lines: Lines<'_>, zeta: f64, t: f64) -> f64 {
    let (damped, mut x, mut v, mut sum) = (OMEGA * (1.0 - zeta * zeta).sqrt(), 0.0, 0.0, 0.0);
    for (hz, phase) in lines {
        let w = TAU * hz;
        let (re, im) = (OMEGA * OMEGA - w * w, 2.0 * zeta * OMEGA * w);
        let (size, late) = (OMEGA * OMEGA / re.hypot(im), im.atan2(re));
        sum += size * (w * t + phase - late).sin();
        x -= size * (phase - late).sin();
        v -= size * w * (phase - late).cos();
    }
    let decay = (-zeta * OMEGA * t).exp();
    sum + decay * (x * (damped * t).cos() + (v + zeta * OMEGA * x) / damped * (damped * t).sin())
}

/// Thirty lines about the resonance, with phases that keep the sum low (Schroeder 1970).
fn band() -> Vec<(f64, f64)> {
    (0..30).map(|k| (3.1 + 1.37 * f64::from(k), -std::f64::consts::PI * f64::from(k * k) / 30.0)).collect()
}

/// A verdict with its names and findings.
struct Said {
    verdict: String,
    names: Vec<String>,
    findings: String,
    first: f64,
    /// Rules that acted with the candidate of each; none where nobody asked.
    trace: Option<Vec<[String; 2]>>,
}

/// Diagnoses u against y at each sample.
fn diagnosed(row: impl Fn(usize, f64) -> [f64; 2]) -> Result<Said, Failed> {
    diagnosed_with(ROWS, row, &[])
}

/// Diagnoses the first `rows` samples, with further options.
fn diagnosed_with(rows: usize, row: impl Fn(usize, f64) -> [f64; 2], more: &[&str]) -> Result<Said, Failed> {
    let mut csv = String::from("u,y\n");
    for k in 0..rows {
        let [u, y] = row(k, k as f64 / RATE_HZ);
        let _ = writeln!(csv, "{u},{y}");
    }
    let bench = Bench::new()?;
    let file = bench.file("log.csv", &csv)?;
    let columns = "[columns]\ninput = \"u\"\noutput = \"y\"\n";
    let model = bench.file("model.toml", &format!("kind = \"driven\"\nrate_hz = {RATE_HZ}\n{columns}"))?;
    let answer = run(program().arg("diagnose").arg(file).arg("--model").arg(model).arg("--json").args(more))?;
    let verdict: serde_json::Value = serde_json::from_str(&answer.stdout)?;
    let effects = verdict["effects"].as_array().cloned().unwrap_or_default();
    let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let trace = verdict["trace"].as_array();
    Ok(Said {
        verdict: verdict["verdict"].as_str().unwrap_or_default().to_owned(),
        names: effects.iter().filter_map(|e| e["id"].as_str().map(str::to_owned)).collect(),
        findings: format!("{} {}", verdict["sentence"], verdict["findings"]),
        trace: trace.map(|steps| steps.iter().map(|s| [text(&s["gate"]), text(&s["term"])]).collect()),
        first: effects.first().and_then(|e| e["parameters"][0]["value"].as_f64()).unwrap_or(f64::NAN),
    })
}

impl Said {
    fn check(&self, what: &str, is: bool) -> Result<(), Failed> {
        check(is, format!("{what}: {} {:?} {} {}", self.verdict, self.names, self.first, self.findings))
    }
}

/// Noise of unit size whose neighbours have this correlation (autoregressive, of first order).
fn noise(correlation: f64, seed: u64) -> Vec<f64> {
    let mut rng = Philox::new(seed, 0, Stream::Host);
    let mut last: f64 = StandardNormal.sample(&mut rng);
    let fresh = (1.0 - correlation * correlation).sqrt();
    let mut next = || {
        let value: f64 = StandardNormal.sample(&mut rng);
        last = correlation * last + fresh * value;
        last
    };
    (0..ROWS).map(|_| next()).collect()
}

fn coloured() -> Result<(), Failed> {
    let lines = band();
    let with = |correlation: f64, seed: u64| {
        let noise = noise(correlation, seed);
        diagnosed(|k, t| [force(&lines, t), motion(&lines, 0.05, t) + 0.05 * noise[k]])
    };
    for (seed, correlation) in [(1, 0.25), (2, -0.25), (3, 0.5)] {
        let said = with(correlation, seed)?;
        let is_said = said.findings.contains("the noise is coloured");
        said.check(&format!("{correlation}"), said.verdict == "adequate" && said.names.is_empty() && is_said)?;
    }
    let plain = with(0.0, 4)?;
    plain.check("white", plain.verdict == "adequate" && !plain.findings.contains("coloured"))?;
    // A memory of fifty samples, two and a half cycles of the resonance, is not the readout's.
    let long = with(0.98, 5)?;
    long.check("0.98", long.verdict != "adequate")
}

fn harmonic() -> Result<(), Failed> {
    let lines = [(7.3, 0.4), (26.9, 2.0)];
    let with = |hz: f64| {
        let noise = noise(0.0, 11);
        diagnosed(|k, t| {
            [force(&lines, t), motion(&lines, 0.05, t) + 0.05 * (TAU * hz * t + 1.0).sin() + 0.01 * noise[k]]
        })
    };
    // Three times the first line, and the second less the first.
    for hz in [21.9, 19.6] {
        let said = with(hz)?;
        let named = said.names.iter().any(|n| n == "periodic-disturbance");
        let is_said = said.findings.contains("the input may cause it");
        said.check(&format!("{hz} Hz"), !named && is_said && said.verdict != "adequate")?;
    }
    let said = with(50.0)?;
    let is_said = said.findings.contains("the input may cause it");
    said.check("50 Hz", said.verdict == "explained" && said.names == ["periodic-disturbance"] && !is_said)
}

// The oscillation lies at three times the first line, and is no harmonic of a linear mass.
fn traced() -> Result<(), Failed> {
    let lines = [(7.3, 0.4), (26.9, 2.0)];
    let noise = noise(0.0, 11);
    let row = |k: usize, t: f64| {
        [force(&lines, t), motion(&lines, 0.05, t) + 0.05 * (TAU * 21.9 * t + 1.0).sin() + 0.01 * noise[k]]
    };
    let acted = |said: &Said| {
        let of_line = ["input-line", "periodic-disturbance"].map(str::to_owned);
        said.trace.as_ref().is_some_and(|steps| steps.contains(&of_line))
    };
    // Of half as many samples the oscillation still is a hundred times its standard error.
    let of_half = |more: &[&str]| diagnosed_with(ROWS / 2, row, more);
    let plain = of_half(&[])?;
    plain.check("without --trace", plain.trace.is_none())?;
    let said = of_half(&["--trace"])?;
    said.check("the rule that acted", acted(&said) && said.names == plain.names)?;
    let said = of_half(&["--trace", "--without", "input-line"])?;
    said.check("switched off", !acted(&said) && said.names == ["periodic-disturbance"])
}

fn ringing() -> Result<(), Failed> {
    let (lines, noise) = (band(), noise(0.0, 21));
    // 1/(ζω) = 40 s, of 15 s that were recorded; the lines lie 1.37 Hz apart and the resonance is
    // 8 mHz wide.
    let row = |late: f64| {
        let (lines, noise) = (&lines, &noise);
        move |k: usize, t: f64| {
            let t = t + 60.0 / RATE_HZ;
            [force(lines, t), motion(lines, 2e-4, t - late / RATE_HZ) + 0.01 * noise[k]]
        }
    };
    let said = diagnosed(row(0.0))?;
    said.check("in step", said.verdict == "adequate" && !said.findings.contains("misaligned"))?;
    let said = diagnosed(row(37.0))?;
    said.check("37 samples late", said.findings.contains("37 samples late"))
}

/// Motion from rest with the force held over each sample, at 100 Hz with ζ = 0.001: exact, as the
/// free oscillation about each held value.
fn stepped(u: &[f64]) -> Vec<f64> {
    let (zeta, omega) = (1e-3f64, TAU * 100.0);
    let (damped, h) = (omega * (1.0 - zeta * zeta).sqrt(), 1.0 / RATE_HZ);
    let (c, s, e) = ((damped * h).cos(), (damped * h).sin(), (-zeta * omega * h).exp());
    let (mut x, mut v) = (0.0, 0.0);
    let mut next = |force: &f64| {
        let (reading, from, rate) = (x, x - force, v);
        x = force + e * (from * c + (rate + zeta * omega * from) / damped * s);
        v = e * (rate * c - (zeta * omega * rate + omega * omega * from) / damped * s);
        reading
    };
    u.iter().map(&mut next).collect()
}

fn held() -> Result<(), Failed> {
    let lines: Vec<(f64, f64)> = band().iter().map(|(hz, phase)| (4.0 * hz, *phase)).collect();
    let u: Vec<f64> = (0..ROWS).map(|k| force(&lines, k as f64 / RATE_HZ)).collect();
    let (y, noise) = (stepped(&u), noise(0.0, 41));
    let said = diagnosed(|k, _| [u[k], y[k] + 0.02 * noise[k]])?;
    said.check("held", said.verdict == "adequate" && said.findings.contains("steps (held)"))?;
    // The control: an input without steps is not taken for one with them.
    let lines = band();
    let said = diagnosed(|k, t| [force(&lines, t), motion(&lines, 2e-4, t) + 0.02 * noise[k]])?;
    said.check("smooth", said.verdict == "adequate" && !said.findings.contains("steps (held)"))
}

fn delayed() -> Result<(), Failed> {
    let (lines, noise) = (band(), noise(0.0, 31));
    let row = |late: f64| {
        let (lines, noise) = (&lines, &noise);
        move |k: usize, t: f64| {
            let t = t + 60.0 / RATE_HZ;
            [force(lines, t), motion(lines, 0.05, t - late / RATE_HZ) + 0.003 * noise[k]]
        }
    };
    let said = diagnosed(row(11.4))?;
    let is_right = said.names == ["readout-delay"] && (said.first * RATE_HZ - 11.4).abs() < 0.1;
    said.check("11.4 samples", said.verdict == "explained" && is_right)?;
    // Whole samples are what two columns of a file are out of step by.
    let said = diagnosed(row(12.0))?;
    said.check("12 samples", said.verdict == "adequate" && said.findings.contains("12 samples late"))
}
