//! Laws with an exponent of their own, which are looked for only where the stated law departs: named
//! with an interval that holds the exponent; and what is near a power and none never comes out
//! explained by one. Motion is integrated here, as for the laws that are near others (`near_laws`).

use libtest_mimic::{Failed, Trial};

use super::near_laws::{Force, recording, verdict};
use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("near laws: a spring and a drag of one power are named with their exponent", powers),
        test("near laws: a sine, a smoothed friction and a dead zone are explained by no power", no_powers),
    ]
}

/// The verdict, its names, and the exponent of the first with its interval.
fn told(csv: &str) -> Result<(String, Vec<String>, [f64; 3]), Failed> {
    let verdict = verdict(csv)?;
    let effects = verdict["effects"].as_array().cloned().unwrap_or_default();
    let names = effects.iter().filter_map(|e| e["id"].as_str().map(str::to_owned)).collect();
    let numbers = effects.first().and_then(|e| e["parameters"].as_array().cloned()).unwrap_or_default();
    let exponent = numbers.iter().find(|p| p["name"] == "n");
    let of = |v: &serde_json::Value| v.as_f64().unwrap_or(f64::NAN);
    let exponent = exponent.map_or([f64::NAN; 3], |n| [of(&n["value"]), of(&n["ci95"][0]), of(&n["ci95"][1])]);
    Ok((verdict["verdict"].as_str().unwrap_or_default().to_owned(), names, exponent))
}

fn powers() -> Result<(), Failed> {
    let laws: [(&str, f64, Force); 2] = [
        ("power-law-stiffness", 1.7, |x, _| 0.3 * x.signum() * x.abs().powf(1.7)),
        ("power-law-damping", 2.5, |_, v| 0.05 * v.signum() * v.abs().powf(2.5)),
    ];
    for (seed, (id, n, force)) in laws.into_iter().enumerate() {
        let (verdict, names, [value, low, high]) = told(&recording(force, 61 + seed as u64, 0.0))?;
        let said = format!("{id} {n}: {verdict} {names:?} {value} ({low} to {high})");
        // Within twice the interval: three of them hold what 95 % do.
        let half = 0.5 * (high - low);
        check(verdict == "explained" && names == [id] && (value - n).abs() < 2.0 * half && half < 0.3, said)?;
    }
    Ok(())
}

fn no_powers() -> Result<(), Failed> {
    let laws: [(&str, Force); 3] = [
        ("sine", |x, _| (0.8 * x).sin() / 0.8 - x),
        ("smoothed friction", |_, v| 0.06 * (v / 0.3).tanh()),
        ("dead zone", |x, _| 0.4 * (x - x.clamp(-0.4, 0.4))),
    ];
    for (seed, (what, force)) in laws.into_iter().enumerate() {
        let (verdict, names, exponent) = told(&recording(force, 71 + seed as u64, 0.0))?;
        let power = names.iter().any(|n| n.starts_with("power-law"));
        check(!power, format!("{what}: {verdict} {names:?} {exponent:?}"))?;
    }
    Ok(())
}
