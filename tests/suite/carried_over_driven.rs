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
    ]
}

const RESONANCE_HZ: f64 = 60.0;
const ZETA: f64 = 0.05;
const ASKED_HZ: f64 = 40.0;

/// Gain and lag of the readout at ω for a time τ.
type Law = fn(f64, f64) -> (f64, f64);

fn carried(physics: Physics, key: &str, law: Law) -> Result<(), Failed> {
    let plan = Plan {
        physics: Some(physics),
        size: Size::Raw(0.3),
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
    let (wanted_gain, wanted_lag) = expected(planted.strength);
    near("gain over the planted one", gain / wanted_gain, 1.0, 0.02)?;
    near("lag less the planted one", lag - wanted_lag, 0.0, 0.02)?;
    // Controls: the sensor without what was named, and another time.
    let bare: String = text.lines().filter(|l| !l.starts_with(key)).map(|l| format!("{l}\n")).collect();
    let (_, without) = response(&bare)?;
    check((without - wanted_lag).abs() > 0.1, format!("without it the lag is {without}"))?;
    check((lag - expected(1.3 * planted.strength).1).abs() > 0.02, "another time has the same lag")
}

/// Gain and lag of the noiseless sensor at the frequency asked for.
fn response(repaired: &str) -> Result<(f64, f64), Failed> {
    let line = |line: &str| match line.split_once(" = ") {
        Some(("duration_s", _)) => "duration_s = 3.0\n".to_owned(),
        Some(("times_s", _)) => "times_s = [3.0]\n".to_owned(),
        Some(("amplitude_m_s2", _)) => "amplitude_m_s2 = 1.0\n".to_owned(),
        Some(("frequency_hz", _)) => format!("frequency_hz = {ASKED_HZ:?}\n"),
        Some((key, _)) if key.contains("noise") || key.contains("random_walk") => String::new(),
        _ => format!("{line}\n"),
    };
    let text: String = repaired.lines().map(line).collect();
    let study = study::parse("repaired.toml", &text, Path::new(""))?;
    let job = study.job(study.integrator()?.integrator, vec![study.clock.samples]);
    let (mut sine, mut cosine, mut n) = (0.0, 0.0, 0);
    cpu::readings::<f64>(&job, 0, &Control::silent(), |seen| {
        n += 1;
        // The last second: 40 periods, after 2 s of ringing down.
        if n > 2000 {
            let angle = TAU * ASKED_HZ * f64::from(n) * study.sample_s();
            let reading = seen.felt[0] + seen.accelerometer[0];
            sine += reading * angle.sin() / 500.0;
            cosine += reading * angle.cos() / 500.0;
        }
    })?;
    Ok((sine.hypot(cosine), -cosine.atan2(sine)))
}
