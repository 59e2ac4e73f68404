//! Driven recordings that are wrong in a way of their own: refused in a sentence, or survived and mentioned; never silent.

use std::f64::consts::TAU;
use std::fs;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("driven: a recording that cannot be judged is refused with attempt, cause and hint", refused),
        test("driven: a damaged recording is survived, and the damage mentioned", survived),
        test("driven: input that does not belong to the output is never called adequate or explained", mismatched),
    ]
}

const RATE_HZ: f64 = 500.0;
const SAMPLES: usize = 3000;
const MODEL: &str = "kind = \"driven\"\nrate_hz = 500.0\n[columns]\ninput = \"u\"\noutput = \"y\"\n";
const CLOCKED: &str = "kind = \"driven\"\n[columns]\ntime = \"t\"\ninput = \"u\"\noutput = \"y\"\n";

/// Rows of t, u, y: a linear oscillator at 40 Hz under a multisine in steady state, by its frequency response; the reading
/// carries 0.5 % of noise from a fixed recurrence.
fn rows() -> Vec<[f64; 3]> {
    let (natural, zeta) = (TAU * 40.0, 0.1);
    let lines: Vec<(f64, f64)> = (12..120).map(|k| (TAU * 0.5 * f64::from(k), f64::from(k * k) * 0.37)).collect();
    let mut state = 1u64;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    (0..SAMPLES)
        .map(|n| {
            let t = n as f64 / RATE_HZ;
            let (mut u, mut y) = (0.0, 0.0);
            for (omega, phase) in &lines {
                let (real, imaginary) = (natural * natural - omega * omega, 2.0 * zeta * natural * omega);
                u += (omega * t + phase).cos();
                y += 1e4 * (omega * t + phase - imaginary.atan2(real)).cos() / real.hypot(imaginary);
            }
            let noise: f64 = (0..12).map(|_| uniform()).sum();
            [t, u, y + 0.01 * noise]
        })
        .collect()
}

fn csv(rows: &[[f64; 3]]) -> String {
    let cell = |v: &f64| if v.is_nan() { String::new() } else { v.to_string() };
    let lines = rows.iter().map(|r| r.iter().map(cell).collect::<Vec<_>>().join(",") + "\n");
    String::from("t,u,y\n") + &lines.collect::<String>()
}

fn edited(edit: impl Fn(usize, &mut [f64; 3])) -> String {
    let mut rows = rows();
    rows.iter_mut().enumerate().for_each(|(n, r)| edit(n, r));
    csv(&rows)
}

fn diagnose(csv: &str, model: &str) -> Result<(Option<i32>, Value, String), Failed> {
    let folder = tempfile::tempdir()?;
    let (log, toml) = (folder.path().join("log.csv"), folder.path().join("model.toml"));
    fs::write(&log, csv)?;
    fs::write(&toml, model)?;
    let output = program().arg("diagnose").arg(&log).arg("--model").arg(&toml).arg("--json").output()?;
    let verdict = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    Ok((output.status.code(), verdict, String::from_utf8_lossy(&output.stderr).into_owned()))
}

fn refused() -> Result<(), Failed> {
    let good = csv(&rows());
    for (what, csv, model, words) in [
        (
            "a long gap",
            edited(|n, r| {
                if (500..1200).contains(&n) {
                    r[2] = f64::NAN
                }
            }),
            MODEL.to_owned(),
            "missing",
        ),
        ("a dead output", edited(|_, r| r[2] = 1.0), MODEL.to_owned(), "never changes"),
        ("fewer samples than parameters", csv(&rows()[..40]), MODEL.to_owned(), "40 samples"),
        (
            "test beyond the end",
            good.clone(),
            format!("{MODEL}[split]\ntrain = [[0, 2000]]\ntest = [[2000, 9000]]\n"),
            "9000",
        ),
        ("one column in two roles", good.clone(), MODEL.replace("\"y\"", "\"u\""), "two roles"),
        ("an unknown column", good.clone(), MODEL.replace("\"y\"", "\"yy\""), "yy"),
        ("no clock", good.clone(), MODEL.replace("rate_hz = 500.0\n", ""), "rate"),
        (
            "a clock that contradicts the rate",
            good.clone(),
            CLOCKED.replace("[columns]", "rate_hz = 50.0\n[columns]"),
            "50",
        ),
        ("an unknown kind", good.clone(), MODEL.replace("driven", "drivn"), "driven"),
    ] {
        let (code, _, stderr) = diagnose(&csv, &model)?;
        check(code == Some(2), format!("{what}: exit {code:?}: {stderr}"))?;
        for part in ["error: ", "cause: ", "hint:  ", words] {
            check(stderr.contains(part), format!("{what}: no \"{part}\" in: {stderr}"))?;
        }
    }
    Ok(())
}

fn survived() -> Result<(), Failed> {
    let duplicated: Vec<[f64; 3]> =
        rows().into_iter().enumerate().flat_map(|(n, r)| vec![r; if n % 700 == 5 { 2 } else { 1 }]).collect();
    let dropped: Vec<[f64; 3]> = rows().into_iter().enumerate().filter(|(n, _)| *n != 1500).map(|r| r.1).collect();
    for (what, csv, model, words) in [
        (
            "missing cells",
            edited(|n, r| {
                if n % 400 == 7 {
                    r[2] = f64::NAN
                }
            }),
            MODEL.to_owned(),
            "missing values",
        ),
        ("clipped rails", edited(|_, r| r[2] = r[2].clamp(-1.0, 1.0)), MODEL.to_owned(), "clipped"),
        ("repeated rows", csv(&duplicated), CLOCKED.to_owned(), "repeat the time stamp"),
        ("a dropped row", csv(&dropped), CLOCKED.to_owned(), "missing"),
        ("an uneven clock", edited(|n, r| r[0] += 4e-4 * (n as f64 * 1.7).sin()), CLOCKED.to_owned(), "uneven"),
        (
            "train and test that overlap",
            csv(&rows()),
            format!("{MODEL}[split]\ntrain = [[0, 2000]]\ntest = [[1500, 3000]]\n"),
            "both train and test",
        ),
    ] {
        let (code, verdict, stderr) = diagnose(&csv, &model)?;
        check(code == Some(0), format!("{what}: exit {code:?}: {stderr}"))?;
        let findings = verdict["findings"].to_string();
        check(findings.contains(words), format!("{what}: no \"{words}\" in {findings}"))?;
    }
    // The unit of a reading is a convention: a thousand times larger numbers change nothing but the numbers.
    let (_, plain, _) = diagnose(&csv(&rows()), MODEL)?;
    let (_, thousand, _) = diagnose(&edited(|_, r| r[2] *= 1000.0), MODEL)?;
    check(plain["verdict"] == "adequate" && thousand["verdict"] == "adequate", "a change of unit changed the verdict")
}

fn mismatched() -> Result<(), Failed> {
    let straight = rows();
    for (what, csv) in [
        ("misaligned by 200 samples", edited(|n, r| r[2] = straight[(n + 200) % SAMPLES][2])),
        ("input and output swapped", edited(|_, r| r.swap(1, 2))),
    ] {
        let (code, verdict, stderr) = diagnose(&csv, MODEL)?;
        let said = verdict["verdict"].as_str().unwrap_or("nothing").to_owned();
        let honest = code == Some(2) || ["unexplained", "undecidable"].contains(&said.as_str());
        check(honest, format!("{what}: exit {code:?}, {said}: {stderr}"))?;
    }
    Ok(())
}
