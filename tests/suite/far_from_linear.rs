//! Driven recordings that follow no linear oscillator, or drown it in noise: none of them is given a
//! false name or a false mismatch, and what has nothing to do with its input is refused.

use libtest_mimic::{Failed, Trial};
use proofmass::trial::independent::case::Case;
use proofmass::trial::independent::oscillator_base::Size;
use serde_json::Value;

use super::bench::Bench;
use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("driven: a mass that jumps between two wells gets a verdict, under noise for a force an error", two_wells),
        test("driven: a resonance that moves to and fro gets a verdict that speaks of time", moving),
        test("driven: a linear oscillator in noise ten times as loud is never a mismatch", in_loud_noise),
        test("driven: a mass that the square of its input moves is driven by it, and by no law of a spring", squared),
        test("driven: a response with next to no linear share gets a verdict where it depends on its input", no_share),
    ]
}

/// What is said of a recording that depends on its input by another law.
const BENT: &str = "y depends on u, but by no linear law";
const RATE_HZ: f64 = 4.0;
const SAMPLES: usize = 1500;
const MODEL: &str = "kind = \"driven\"\nrate_hz = 4.0\n[columns]\ninput = \"u\"\noutput = \"y\"\n";

/// A dozen sines from 0.1 to 1.4 rad/s.
fn force(t: f64) -> f64 {
    (0..12).map(f64::from).map(|i| 0.22 * ((0.1 + 0.12 * i) * t + i * i).cos()).sum()
}

/// Rows of input and reading of x″ + 0.04x′ + pull(x) = push(u), by RK4 in ten steps a sample; 1 % of
/// noise from a fixed recurrence.
fn moved(pull: impl Fn(f64) -> f64, push: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let slope = |t: f64, [x, v]: [f64; 2]| [v, push(force(t)) - 0.04 * v - pull(x)];
    let (h, mut s, mut state) = (0.1 / RATE_HZ, [1.0, 0.0], 1u64);
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let mut rows = Vec::new();
    for k in 0..10 * SAMPLES {
        let t = k as f64 * h;
        if k % 10 == 0 {
            rows.push([force(t), s[0] + 0.01 * (0..12).map(|_| uniform()).sum::<f64>()]);
        }
        let ahead = |r: [f64; 2], h: f64| [s[0] + h * r[0], s[1] + h * r[1]];
        let k1 = slope(t, s);
        let k2 = slope(t + 0.5 * h, ahead(k1, 0.5 * h));
        let k3 = slope(t + 0.5 * h, ahead(k2, 0.5 * h));
        let k4 = slope(t + h, ahead(k3, h));
        s = std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    rows
}

fn csv(rows: &[[f64; 2]]) -> String {
    "u,y\n".to_owned() + &rows.iter().map(|[u, y]| format!("{u},{y}\n")).collect::<String>()
}

/// Numbers of unit size from a fixed recurrence, twelve uniform ones to each.
pub fn normal() -> impl FnMut() -> f64 {
    let mut state = 7u64;
    move || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        (0..12).map(|_| uniform()).sum()
    }
}

/// Ids of the effects named.
pub fn names(verdict: &Value) -> Vec<String> {
    let all = verdict["effects"].as_array().cloned().unwrap_or_default();
    all.iter().map(|e| e["id"].as_str().unwrap_or_default().to_owned()).collect()
}

/// The finding that holds these words.
fn finding(verdict: &Value, words: &str) -> Option<String> {
    let all = verdict["findings"].as_array()?;
    all.iter().filter_map(Value::as_str).find(|f| f.contains(words)).map(str::to_owned)
}

// (x³ − x)/2 pulls towards ±1 and away from 0 (Guckenheimer & Holmes 1983).
fn two_wells() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let rows = moved(|x| 0.5 * (x.powi(3) - x), |u| u);
    let verdict = bench.verdict(&csv(&rows), MODEL)?;
    // Both springs or neither: each alone is another law.
    match names(&verdict).as_slice() {
        [] => check(verdict["verdict"] == "unexplained", format!("{verdict}"))?,
        found => {
            let both = ["cubic-stiffness", "quadratic-stiffness"].iter().all(|id| found.iter().any(|f| f == id));
            check(verdict["verdict"] == "explained" && both && found.len() == 2, format!("{verdict}"))?;
        }
    }
    // The search was a restricted one: what is said must not speak for the whole library.
    let sentence = verdict["sentence"].as_str().unwrap_or_default();
    check(sentence.contains(BENT), sentence)?;
    if names(&verdict).is_empty() {
        check(sentence.contains("follows no linear oscillator"), sentence)?;
        check(!sentence.contains("no candidate in the library"), sentence)?;
    }
    // The pull is zero and rises at ±1; a hundredth is the noise of one sample.
    let said = finding(&verdict, "two wells").unwrap_or_default();
    let wells: Vec<f64> = said
        .split("at readings of ")
        .skip(1)
        .flat_map(|after| after.split([' ', ',']))
        .filter_map(|word| word.replace('−', "-").parse().ok())
        .collect();
    check(wells.len() == 2 && (wells[0] + 1.0).abs() < 0.01 && (wells[1] - 1.0).abs() < 0.01, &said)?;
    // Negative control: the same cube under the same force, about one well.
    let one = bench.verdict(&csv(&moved(|x| 0.5 * (x.powi(3) + x), |u| u)), MODEL)?;
    check(one["verdict"] == "explained" && names(&one) == ["cubic-stiffness"], format!("{one}"))?;
    check(finding(&one, "two wells").is_none(), format!("{one}"))?;
    // Negative control: numbers without order, which moved nothing.
    let other = |(k, row): (usize, &[f64; 2])| [((k * k * 7919 + k * 104_729) % 10_007) as f64 / 5000.0 - 1.0, row[1]];
    let stranger: Vec<[f64; 2]> = rows.iter().enumerate().map(other).collect();
    bench.refused("noise for a force", &csv(&stranger), MODEL, "no oscillator can be identified")
}

// A sensor of the second generator whose resonance moves to and fro by 5 % at a quality factor of 109: an oscillator
// explains a quarter of its output where it was fitted, and nothing elsewhere. What its input did not move is
// refused still.
fn moving() -> Result<(), Failed> {
    let case = Case::make(401, 82, Size { rows: 40_000 }).ok_or("no such case")?;
    check(case.sub == "mass changes" && case.truth.effects.is_empty(), &case.sub)?;
    let [recording, model] = case.texts();
    let bench = Bench::new()?;
    let verdict = bench.verdict(&recording, &model)?;
    let sentence = verdict["sentence"].as_str().unwrap_or_default();
    check(verdict["verdict"] == "unexplained" && names(&verdict).is_empty(), format!("{verdict}"))?;
    check(sentence.contains("depends on time"), sentence)?;
    let mut other = normal();
    let rows: Vec<[f64; 2]> = moved(|x| x, |u| u).into_iter().map(|[_, y]| [other(), y]).collect();
    bench.refused("noise for a force", &csv(&rows), MODEL, "no oscillator can be identified")
}

fn squared() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let verdict = bench.verdict(&csv(&moved(|x| x, |u| u * u)), MODEL)?;
    check(names(&verdict) == ["drive-nonlinearity"], format!("{verdict}"))?;
    // g(u + κu²) with nothing of u itself: g is small and κ large, and gκ is the planted 1, ω₀ too;
    // within 1 %, the noise of one sample.
    let number = |list: &Value, name: &str| {
        let all = list.as_array().and_then(|all| all.iter().find(|p| p["name"] == name)).cloned();
        all.and_then(|p| p["value"].as_f64()).unwrap_or(f64::NAN)
    };
    let kappa = number(&verdict["effects"][0]["parameters"], "kappa");
    let square = kappa * number(&verdict["base"], "gain");
    check((square - 1.0).abs() < 0.01, format!("g·kappa = {square}"))?;
    check((number(&verdict["base"], "omega0") - 1.0).abs() < 0.01, format!("{verdict}"))?;
    // Negative control: the same spring under the input itself lacks nothing.
    let linear = bench.verdict(&csv(&moved(|x| x, |u| u)), MODEL)?;
    check(linear["verdict"] == "adequate" && names(&linear).is_empty(), format!("{linear}"))
}

// From rest, under white noise, a force as its square: the linear share is chance alone. Poles at
// 0.949·exp(±0.567i).
fn no_share() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let mut normal = normal();
    let (mut motion, mut rows) = ([0.0f64; 2], Vec::new());
    for _ in 0..10_000 {
        let u = normal();
        rows.push([u, motion[0] + 0.01 * normal()]);
        motion = [1.6 * motion[0] - 0.9 * motion[1] + 0.03 * u * u, motion[0]];
    }
    let verdict = bench.verdict(&csv(&rows), MODEL)?;
    check(verdict["verdict"] == "unexplained", format!("{verdict}"))?;
    check(names(&verdict).iter().all(|id| id == "drive-nonlinearity"), format!("{verdict}"))?;
    check(finding(&verdict, "by no linear law").is_some(), format!("{verdict}"))?;
    // Negative control: the same input backwards moved nothing.
    let backwards = rows.iter().rev().map(|row| row[0]);
    let stranger: Vec<[f64; 2]> = backwards.zip(&rows).map(|(u, row)| [u, row[1]]).collect();
    bench.refused("the input backwards", &csv(&stranger), MODEL, "no oscillator can be identified")
}

// Discrete oscillator with poles at 0.927·exp(±0.627i): ω₀ = 0.63 rad a sample, ζ = 0.12. White noise
// of unit size is nothing but noise: the linear law is the truth.
fn in_loud_noise() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let mut normal = normal();
    let (mut motion, mut rows) = ([0.0f64; 2], Vec::new());
    for _ in 0..20_000 {
        rows.push([normal(), motion[0]]);
        let last = rows[rows.len() - 1][0];
        motion = [1.50 * motion[0] - 0.859 * motion[1] + last, motion[0]];
    }
    let size = (rows.iter().map(|r| r[1] * r[1]).sum::<f64>() / rows.len() as f64).sqrt();
    let noise: Vec<f64> = rows.iter().map(|_| normal()).collect();
    let model = MODEL.replace("4.0", "1000.0");
    let heard = |times: f64| -> Vec<[f64; 2]> {
        rows.iter().zip(&noise).map(|([u, y], n)| [*u, y + times * size * n]).collect()
    };
    let answer = bench.diagnose(&csv(&heard(9.0)), &model, &["--json"])?;
    if answer.code == Some(0) {
        let verdict = answer.json()?;
        check(verdict["verdict"] != "unexplained", format!("{verdict}"))?;
    } else {
        answer.refuses("loud noise", "no oscillator can be identified")?;
    }
    // Negative control: in noise as loud as its motion it is identified.
    let verdict = bench.verdict(&csv(&heard(1.0)), &model)?;
    check(verdict["base"][0]["name"] == "omega0" && verdict["verdict"] == "adequate", format!("{verdict}"))
}
