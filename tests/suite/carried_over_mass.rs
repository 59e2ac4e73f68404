//! What `diagnose` names of a proof mass that an input drives stands in `repaired.toml` under its
//! key, with the value that was planted.
//!
//! Expected: the planted value. The planted gain is ω₀², so that one unit of the output is one m/s²
//! at the readout and 1/ω₀² m of displacement.

use std::f64::consts::TAU;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::study::{self, tolerances};
use proofmass::trial::physics::Physics;
use proofmass::trial::plant::Size;
use serde_json::Value;

use super::bench::Bench;
use super::diagnosis_driven::plant::{Plan, plant_as};
use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let carries = |name: &str, case: Case| test(&format!("carried over: {name}"), move || carried(&case));
    vec![
        carries("an end stop on both sides", stop(0.0, ["sensor.end_stop_gap_m", "sensor.end_stop_per_s2"], 1.0)),
        carries("an end stop above", stop(1.0, ONE_SIDED, 1.0)),
        carries("an end stop below", stop(-1.0, ONE_SIDED, -1.0)),
        carries("a cubic nonlinearity of the readout", single(Physics::ReadoutNonlinearity, [0.0, 1.0], K3)),
        carries("feedthrough", single(Physics::Feedthrough, [-1.0, 0.0], FEEDTHROUGH)),
        carries("a nonlinearity of the drive", single(Physics::DriveNonlinearity, [1.0, 0.0], DRIVE)),
        carries("a spring that drifts with time", single(Physics::StiffnessDrift, [-1.0, 0.0], SPRING)),
        carries(
            "a spring that follows a recorded temperature",
            single(Physics::StiffnessDrift, [-1.0, 1.0], ("kappa", "sensor.stiffness_per_k")),
        ),
        carries("a bias that drifts", single(Physics::BiasDrift, [1.0, 0.0], RAMP)),
    ]
}

const RESONANCE_HZ: f64 = 60.0;
const ONE_SIDED: [&str; 2] = ["sensor.one_sided_stop_at_m", "sensor.one_sided_stop_per_s2"];
/// Stiffness of the stop over that of the spring.
const STOP: f64 = 20.0;
const K3: (&str, &str) = ("k3", "accelerometer.k3_ug_per_g3");
const FEEDTHROUGH: (&str, &str) = ("d", "accelerometer.feedthrough_ppm");
const DRIVE: (&str, &str) = ("kappa", "sensor.drive_nonlinearity_s2_per_m");
const SPRING: (&str, &str) = ("kappa", "sensor.stiffness_drift_per_s");
const RAMP: (&str, &str) = ("c", "accelerometer.acceleration_ramp_mg_h");

/// What is planted, and where it must stand.
struct Case {
    physics: Physics,
    shape: [f64; 2],
    /// By the symbols of the library: the key, and its SI value over that of the symbol.
    keys: Vec<(&'static str, &'static str, f64)>,
}

fn stop(side: f64, [gap, stiffness]: [&'static str; 2], sign: f64) -> Case {
    let keys = vec![("gap", gap, sign / (TAU * RESONANCE_HZ).powi(2)), ("k_c", stiffness, 1.0)];
    Case { physics: Physics::EndStop, shape: [STOP, side], keys }
}

fn single(physics: Physics, shape: [f64; 2], (symbol, key): (&'static str, &'static str)) -> Case {
    Case { physics, shape, keys: vec![(symbol, key, 1.0)] }
}

fn carried(case: &Case) -> Result<(), Failed> {
    let plan = Plan {
        physics: Some(case.physics),
        size: Size::Raw(0.3),
        // Where a stop stands is searched for at length.
        samples: if case.physics == Physics::EndStop { 4000 } else { 8000 },
        rate_hz: 1000.0,
        resonance_hz: RESONANCE_HZ,
        zeta: 0.05,
        noise: 0.002,
        seed: 11,
        driven: true,
    };
    let planted = plant_as(&plan, Some(case.shape))?;
    // Where nothing follows it, the temperature stays.
    let warm = |n: usize| planted.temperature.as_ref().map_or(20.0, |all| all[n]);
    let rows = planted.input.iter().zip(&planted.reading).enumerate();
    // A column that never changes stands before it, at a value whose mean is rounded.
    let rows = rows.map(|(n, (u, y))| format!("{u:.9e},{y:.9e},101.3,{:.9e}\n", warm(n)));
    let log = format!("u,y,air_kPa,temp_C\n{}", rows.collect::<String>());
    let environment = if planted.temperature.is_some() { "environment = [\"air_kPa\", \"temp_C\"]\n" } else { "" };
    let columns = format!("[columns]\ninput = \"u\"\noutput = \"y\"\n{environment}");
    let model = &format!("kind = \"driven\"\nrate_hz = 1000.0\n{columns}");
    let bench = Bench::new()?;
    let out = bench.path("out");
    let verdict = bench.diagnose(&log, model, &["--json", "--out", &out.display().to_string()])?.json()?;
    let named: Vec<&str> =
        verdict["effects"].as_array().into_iter().flatten().filter_map(|e| e["id"].as_str()).collect();
    check(named == [case.physics.id()], format!("named {named:?}: {}", verdict["sentence"]))?;
    let text = std::fs::read_to_string(out.join("repaired.toml"))?;
    check(!text.contains("Not in this study"), format!("a study is said not to run it:\n{text}"))?;
    let study = study::parse("repaired.toml", &text, Path::new(""))?;
    if let Some(planted) = &planted.temperature {
        // The reference is the mean, about which κ was fitted.
        let mean = planted.iter().sum::<f64>() / planted.len() as f64;
        near("reference temperature", study.temperature.reference_deg_c, mean, 0.01)?;
        // Controls: the same log with a heading of another quantity is run by no study.
        let volts = (log.replace("temp_C", "supply_V"), model.replace("temp_C", "supply_V"));
        let out = bench.path("volts");
        bench.diagnose(&volts.0, &volts.1, &["--json", "--out", &out.display().to_string()])?;
        let text = std::fs::read_to_string(out.join("repaired.toml"))?;
        check(
            !text.contains("\nstiffness_per_k") && text.contains("one temperature in °C"),
            format!("volts as °C:\n{text}"),
        )?;
    }
    for (symbol, path, si) in &case.keys {
        let key = tolerances::keys().find(|key| key.path == *path).ok_or("no such key")?;
        check(study.tolerances[key].is_some(), format!("no {path}:\n{text}"))?;
        let got = study.tolerances.moments(key).0;
        let expected = si * planted.values.iter().find(|(name, _)| name == symbol).ok_or("it was not planted")?.1;
        // Of a spring that follows a column, κ is per unit of it.
        if planted.temperature.is_some() {
            let unit = &verdict["effects"][0]["parameters"][0]["unit"];
            check(unit == "1/C", format!("κ over temperature in {unit}"))?;
        }
        let half = half_width(&verdict["effects"][0], symbol)? * si.abs();
        // The interval is one of 95 %: three half widths are missed once in 10⁸. The gain that makes
        // metres of it is known to a thousandth.
        let tolerance = 3.0 * half + 2e-3 * expected.abs();
        let says = |value: f64| (got - value).abs() <= tolerance;
        check(says(expected), format!("{path}: {got:e}, planted {expected:e} ± {tolerance:e}"))?;
        // Controls: a value off by a third, and the other sign.
        check(!says(1.33 * expected) && !says(-expected), format!("{path}: any value fits within {tolerance:e}"))?;
    }
    Ok(())
}

/// Half the width of the 95 % interval of a named effect's parameter.
fn half_width(effect: &Value, symbol: &str) -> Result<f64, Failed> {
    let mut parameters = effect["parameters"].as_array().into_iter().flatten();
    let found = parameters.find(|p| p["name"] == symbol).ok_or_else(|| format!("no {symbol} in {effect}"))?;
    let end = |k: usize| found["ci95"][k].as_f64().ok_or_else(|| format!("no interval in {found}"));
    Ok(0.5 * (end(1)? - end(0)?))
}
