//! Logs at rest of which one row in twenty is lost: their noise is that of the readings.

use libtest_mimic::{Failed, Trial};
use proofmass::rng::{Philox, Stream};
use serde_json::Value;

use super::bench::{Bench, run};
use super::diagnosis_rest::plant::white;
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![test("lost rows: white noise keeps its level and gets no filter", white_noise)]
}

const ROWS: usize = 100_000;
const RATE_HZ: f64 = 100.0;
const CHANNELS: [&str; 3] = ["gx_rad_s", "gy_rad_s", "gz_rad_s"];

fn white_noise() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let mut rng = Philox::new(29, 0, Stream::Host);
    let noise: Vec<Vec<f64>> = CHANNELS.iter().map(|_| white(ROWS, &mut rng)).collect();
    let mut text = format!("t_s,{}\n", CHANNELS.join(","));
    for n in 0..ROWS {
        // Of normal numbers 4.6 % lie beyond two deviations.
        if n > 0 && n + 1 < ROWS && rng.normal().abs() > 2.0 {
            continue;
        }
        let cells: Vec<String> = noise.iter().map(|values| format!("{:.6}", 0.01 * values[n])).collect();
        text += &format!("{:.3},{}\n", n as f64 / RATE_HZ, cells.join(","));
    }
    let log = bench.file("log.csv", &text)?;
    let said = run(program().arg("allan").arg(&log).arg("--json"))?.json()?;
    for channel in said["channels"].as_array().into_iter().flatten() {
        let level = channel["terms"][1]["value"].as_f64().unwrap_or(0.0);
        // N of 0.01 rad/s at 100 Hz, in °/√h. A fit to the curve knows it to about 0.4 %; lines between the neighbours of
        // lost rows would make it √1.068 of what it is.
        let planted = (0.01 / RATE_HZ.sqrt()).to_degrees() * 60.0;
        check((level / planted - 1.0).abs() < 0.02, format!("{level} where {planted} was planted: {channel}"))?;
    }
    let said = run(program().arg("diagnose").arg(&log).arg("--json"))?.json()?;
    let findings = said["findings"].as_array().cloned().unwrap_or_default();
    let holds = |words: &str| findings.iter().filter_map(Value::as_str).any(|f| f.contains(words));
    check(said["verdict"] == "adequate" && holds("drawn from the noise") && !holds("filter"), said.to_string())
}
