//! What `diagnose` names of a readout, a study of `repaired.toml` runs: gain and phase of a sine are
//! those of what was planted in the recording.
//!
//! Expected: ω₀²/(ω₀² − ω² + 2iζω₀ω) of the mass, times e^(−iωτ) of a delay or 1/(1 + iωτ) of a
//! low-pass (Ljung, System Identification, 1999, ch. 2). The force is a straight line within a step:
//! (ωh)²/12, half a per cent at 40 Hz and 1 kHz.

use std::f64::consts::TAU;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu;
use proofmass::control::Control;
use proofmass::study;
use proofmass::trial::physics::Physics;
use proofmass::trial::plant::Size;
use serde_json::Value;

use super::bench::Bench;
use super::diagnosis_driven::plant::{Plan, plant};
use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("carried over: a named delay of the readout is one in a study", || {
            carried(Physics::ReadoutDelay, "readout_delay_s", |omega, tau| (1.0, omega * tau))
        }),
        test("carried over: a named low-pass of the readout is one in a study", || {
            carried(Physics::ReadoutLowpass, "readout_lowpass_s", |omega, tau| {
                (1.0 / (omega * tau).hypot(1.0), (omega * tau).atan())
            })
        }),
        test("carried over: a named parasitic mode moves a study as the diagnosed model moves", || {
            moved_alike(Physics::ParasiticMode, 0.3, "parasitic_mode_")
        }),
        test("carried over: a named hysteresis moves a study as the diagnosed model moves", || {
            moved_alike(Physics::Hysteresis, 0.3, "hysteresis_")
        }),
    ]
}

const RESONANCE_HZ: f64 = 60.0;
const ZETA: f64 = 0.05;
const ASKED_HZ: f64 = 40.0;

/// Gain and lag of the readout at ω for a time τ.
type Law = fn(f64, f64) -> (f64, f64);

/// What is named of a recording, and the study that is written of it.
struct Named {
    /// Value planted of the effect's first parameter.
    strength: f64,
    verdict: Value,
    text: String,
}

/// Plants physics of this raw size and has it named.
fn named(physics: Physics, size: f64) -> Result<Named, Failed> {
    let plan = Plan {
        physics: Some(physics),
        size: Size::Raw(size),
        samples: 8000,
        rate_hz: 1000.0,
        resonance_hz: RESONANCE_HZ,
        zeta: ZETA,
        noise: 0.002,
        seed: 11,
        driven: true,
    };
    let planted = plant(&plan)?;
    let rows = planted.input.iter().zip(&planted.reading).map(|(u, y)| format!("{u:.9e},{y:.9e}\n"));
    let log = format!("u,y\n{}", rows.collect::<String>());
    let model = "kind = \"driven\"\nrate_hz = 1000.0\n[columns]\ninput = \"u\"\noutput = \"y\"\n";
    let bench = Bench::new()?;
    let out = bench.path("out");
    let verdict = bench.diagnose(&log, model, &["--json", "--out", &out.display().to_string()])?.json()?;
    let named: Vec<&str> =
        verdict["effects"].as_array().into_iter().flatten().filter_map(|e| e["id"].as_str()).collect();
    check(named == [physics.id()], format!("named {named:?}: {}", verdict["sentence"]))?;
    let text = std::fs::read_to_string(out.join("repaired.toml"))?;
    let lost = format!("Not in this study: {}", physics.id());
    check(!text.contains(&lost), format!("a study is said not to run it:\n{text}"))?;
    Ok(Named { strength: planted.strength, verdict, text })
}

fn carried(physics: Physics, key: &str, law: Law) -> Result<(), Failed> {
    let Named { strength, text, .. } = named(physics, 0.3)?;
    let line = format!("\n{key} = ");
    check(text.contains(&line), format!("no {key}:\n{text}"))?;
    let omega = TAU * ASKED_HZ;
    let expected = |tau: f64| {
        let w0 = TAU * RESONANCE_HZ;
        let (real, imaginary) = (w0 * w0 - omega * omega, 2.0 * ZETA * w0 * omega);
        let (gain, lag) = law(omega, tau);
        (gain * w0 * w0 / real.hypot(imaginary), lag + imaginary.atan2(real))
    };
    let (gain, lag) = response(&text)?;
    let (wanted_gain, wanted_lag) = expected(strength);
    near("gain over the planted one", gain / wanted_gain, 1.0, 0.02)?;
    near("lag less the planted one", lag - wanted_lag, 0.0, 0.02)?;
    // Controls: the sensor without what was named, and another time.
    let bare: String = text.lines().filter(|l| !l.starts_with(key)).map(|l| format!("{l}\n")).collect();
    let (_, without) = response(&bare)?;
    check((without - wanted_lag).abs() > 0.1, format!("without it the lag is {without}"))?;
    check((lag - expected(1.3 * strength).1).abs() > 0.02, "another time has the same lag")
}

/// Gain and lag of the noiseless sensor at the frequency asked for.
fn response(repaired: &str) -> Result<(f64, f64), Failed> {
    let (mut sine, mut cosine) = (0.0, 0.0);
    // The last second: 40 periods, after 2 s of ringing down.
    for (n, reading) in readings(repaired, 1.0)?.into_iter().enumerate().skip(2000) {
        let angle = TAU * ASKED_HZ * (n + 1) as f64 * STEP_S;
        sine += reading * angle.sin() / 500.0;
        cosine += reading * angle.cos() / 500.0;
    }
    Ok((sine.hypot(cosine), -cosine.atan2(sine)))
}

/// One sample, and one step, of the study.
const STEP_S: f64 = 1e-3;

/// Readings of the noiseless sensor over 3 s of a sine at the frequency asked for, m/s².
fn readings(repaired: &str, amplitude_m_s2: f64) -> Result<Vec<f64>, Failed> {
    let line = |line: &str| match line.split_once(" = ") {
        Some(("duration_s", _)) => "duration_s = 3.0\n".to_owned(),
        Some(("times_s", _)) => "times_s = [3.0]\n".to_owned(),
        Some(("amplitude_m_s2", _)) => format!("amplitude_m_s2 = {amplitude_m_s2:?}\n"),
        Some(("frequency_hz", _)) => format!("frequency_hz = {ASKED_HZ:?}\n"),
        Some((key, _)) if key.contains("noise") || key.contains("random_walk") => String::new(),
        _ => format!("{line}\n"),
    };
    let text: String = repaired.lines().map(line).collect();
    let study = study::parse("repaired.toml", &text, Path::new(""))?;
    near("step of the study", study.sample_s(), STEP_S, 0.0)?;
    let job = study.job(study.integrator()?.integrator, vec![study.clock.samples]);
    let mut all = Vec::new();
    cpu::readings::<f64>(&job, 0, &Control::silent(), |seen| all.push(seen.felt[0] + seen.accelerometer[0]))?;
    Ok(all)
}

/// The readings of a study of what is named are those of the model as the verdict states it,
/// integrated here, in the recording's own units.
fn moved_alike(physics: Physics, size: f64, keys: &str) -> Result<(), Failed> {
    let Named { verdict, text, .. } = named(physics, size)?;
    let of = |list: &Value, name: &str| -> Result<f64, Failed> {
        let found = list.as_array().into_iter().flatten().find(|p| p["name"] == name);
        found.and_then(|p| p["value"].as_f64()).ok_or_else(|| format!("no {name} in {list}").into())
    };
    let base = |name: &str| of(&verdict["base"], name);
    let (omega, zeta, gain) = (base("omega0")?, base("zeta")?, base("gain")?);
    let own = |name: &str| of(&verdict["effects"][0]["parameters"], name);
    let law: Box<dyn Fn(f64, [f64; 4]) -> [f64; 3]> = match physics {
        // What it adds to the acceleration, and the rates of its states.
        Physics::Hysteresis => {
            let (k, beta, gamma) = (own("k_h")?, own("beta")?, own("gamma")?);
            Box::new(move |_, [_, v, z, _]| [-k * z, v - beta * v.abs() * z - gamma * v * z.abs(), 0.0])
        }
        _ => {
            let (g2, omega2, zeta2) = (own("g2")?, own("omega2")?, own("zeta2")?);
            Box::new(move |u, [_, _, z, w]| [0.0, w, g2 * u - 2.0 * zeta2 * omega2 * w - omega2 * omega2 * z])
        }
    };
    let read_too = if physics == Physics::ParasiticMode { 1.0 } else { 0.0 };
    let push = |t: f64| 1.5 * (TAU * ASKED_HZ * t).sin();
    let slope = |t: f64, s: [f64; 4]| {
        let [added, z, w] = law(push(t), s);
        [s[1], gain * push(t) - omega * omega * s[0] - 2.0 * zeta * omega * s[1] + added, z, w]
    };
    let add = |s: [f64; 4], d: [f64; 4], by: f64| std::array::from_fn(|i| s[i] + by * d[i]);
    let (h, mut s, mut expected) = (STEP_S / 20.0, [0.0; 4], Vec::new());
    for n in 0..60_000 {
        let t = f64::from(n) * h;
        let d1 = slope(t, s);
        let d2 = slope(t + 0.5 * h, add(s, d1, 0.5 * h));
        let d3 = slope(t + 0.5 * h, add(s, d2, 0.5 * h));
        let d4 = slope(t + h, add(s, d3, h));
        s = std::array::from_fn(|i| s[i] + h / 6.0 * (d1[i] + 2.0 * d2[i] + 2.0 * d3[i] + d4[i]));
        if n % 20 == 19 {
            expected.push(omega * omega / gain * (s[0] + read_too * s[2]));
        }
    }
    let rms =
        |a: &[f64], b: &[f64]| (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt();
    let size = rms(&expected, &vec![0.0; expected.len()]);
    let apart = rms(&readings(&text, 1.5)?, &expected) / size;
    check(apart < 2e-3, format!("the study reads {apart} of its size apart from the model"))?;
    // Control: without what is named it reads otherwise.
    let bare: String = text.lines().filter(|l| !l.starts_with(keys)).map(|l| format!("{l}\n")).collect();
    check(bare != text, format!("no {keys}… in:\n{text}"))?;
    let apart = rms(&readings(&bare, 1.5)?, &expected) / size;
    check(apart > 2e-2, format!("without it the study reads only {apart} apart"))
}
