//! Columns that are written in a few rows only, as a temperature once a second among readings: the
//! rows without them are rows, and what follows them is found.

use std::fmt::Write as _;

use libtest_mimic::{Failed, Trial};
use proofmass::rng::{Philox, Stream};
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;

use super::bench::{Bench, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("slow columns: a temperature written once a second leaves every reading in use", used),
        test("slow columns: what follows such a temperature is named with its slope", followed),
    ]
}

const RATE_HZ: usize = 50;
const ROWS: usize = 400 * RATE_HZ;
/// Bias over temperature, rad/s/°C.
const SLOPE: f64 = 2e-4;

/// A gyro that warms up, its temperature written in every `every`th row; other cells hold `blank`.
fn log(every: usize, blank: &str, heading: &str) -> String {
    let mut rng = Philox::new(8, 0, Stream::Host);
    let mut csv = format!("t_s,gx_rad_s,gy_rad_s,gz_rad_s,{heading}\n");
    for k in 0..ROWS {
        let t = k as f64 / RATE_HZ as f64;
        // Up and down, so that no course in time does as well.
        let temperature = 25.0 + 4.0 * (t / 30.0).sin() + 2.0 * (t / 11.0).cos();
        let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
        let cell = if k % every == 0 { format!("{temperature:.3}") } else { blank.to_owned() };
        let [x, y, z] = [SLOPE * (temperature - 25.0), 0.0, 0.0].map(|bias| bias + 1e-3 * noise());
        let _ = writeln!(csv, "{t},{x:.7},{y:.7},{z:.7},{cell}");
    }
    csv
}

fn told(command: &str, csv: &str) -> Result<Value, Failed> {
    let bench = Bench::new()?;
    let file = bench.file("log.csv", csv)?;
    let answer = run(program().arg(command).arg(file).arg("--json"))?;
    Ok(serde_json::from_str(&answer.stdout)?)
}

fn used() -> Result<(), Failed> {
    for blank in ["", "NaN"] {
        let seen = told("inspect", &log(RATE_HZ, blank, "temp_C"))?;
        let said = seen.to_string();
        check(seen["samples"] == ROWS, format!("{blank:?}: {said}"))?;
        check(said.contains("`temp_C` is written in 400 of 20000 rows"), &said)?;
        check(!said.contains("clipped") && !said.contains("stuck"), &said)?;
    }
    // One that holds nothing is none of the columns.
    let written = log(RATE_HZ, "", "temp_C");
    let without = |line: &str| line.rsplit_once(',').map_or(String::new(), |(kept, _)| format!("{kept},\n"));
    let empty: String = written.lines().skip(1).map(without).collect();
    let seen = told("inspect", &format!("t_s,gx_rad_s,gy_rad_s,gz_rad_s,temp_C\n{empty}"))?;
    let columns = seen["columns"].as_array().map_or(0, Vec::len);
    check(columns == 3 && seen.to_string().contains("`temp_C` holds no value"), seen.to_string())?;
    // Control: of columns that may all be readings, one that is written in few rows lost the others.
    let lost = told("inspect", &log(RATE_HZ, "", "y").replace("gx_rad_s,gy_rad_s,gz_rad_s", "u,v,w"))?;
    check(lost["samples"] != ROWS, lost.to_string())
}

fn followed() -> Result<(), Failed> {
    for every in [1, RATE_HZ] {
        let verdict = told("diagnose", &log(every, "", "temp_C"))?;
        let effects = verdict["effects"].as_array().cloned().unwrap_or_default();
        let said = format!("every {every}: {} {}", verdict["verdict"], verdict["sentence"]);
        let [effect] = &effects[..] else { return Err(said.into()) };
        let [low, high] = [0, 1].map(|end| effect["parameters"][0]["ci95"][end].as_f64().unwrap_or(f64::NAN));
        check(effect["id"] == "temperature-sensitivity" && (low..=high).contains(&SLOPE), said)?;
    }
    Ok(())
}
