//! `study --samples N FILE`: what the simulated sensors write is a recording that the other
//! commands read, and its noise is the noise that was asked for.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::recording::{self, Request};
use serde_json::Value;

use super::bench::{Answer, Bench, diagnose, run};
use super::world::{check, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("samples: allan finds the noise that was asked for, and twice that is seen", noise),
        test("samples: a noiseless sensor writes the truth and its bias", truth),
        test("samples: CSV, Parquet and NPY hold the same readings", formats),
        test("samples: diagnose reads them, and finds the model adequate that made them", diagnosed),
        test("samples: what cannot be written is refused in a sentence", refused),
    ]
}

/// N of the accelerometer, m/s/√h, and of the gyro, °/√h.
const WHITE: [f64; 2] = [0.3, 0.6];
const HEAD: &str = "name = \"s\"\nseed = 11\nmembers = 64\nduration_s = 1000.0\n[sensor]\nsample_rate_hz = 100.0\n";

fn noisy(factor: f64) -> String {
    let [a, g] = WHITE.map(|n| n * factor);
    format!("{HEAD}[accelerometer]\nvelocity_random_walk_m_s_rth = {a:?}\n[gyro]\nangle_random_walk_deg_rth = {g:?}\n")
}

fn samples(bench: &Bench, study: &str, count: &str, file: &Path) -> Result<Answer, Failed> {
    let study = bench.file("study.toml", study)?;
    let out = bench.path("out");
    run(program().arg("study").arg(study).args(["--samples", count]).arg(file).arg("--out").arg(out))
}

fn written(bench: &Bench, study: &str, count: &str, name: &str) -> Result<std::path::PathBuf, Failed> {
    let file = bench.path(name);
    let answer = samples(bench, study, count, &file)?;
    check(answer.code == Some(0), format!("exit {:?} {}", answer.code, answer.stderr))?;
    Ok(file)
}

/// Value and half the 95 % interval of each channel's white noise, in the units of [`WHITE`].
fn white(file: &Path) -> Result<Vec<(String, f64, f64)>, Failed> {
    let document = run(program().args(["allan", "--json"]).arg(file))?.json()?;
    let channels = document["channels"].as_array().cloned().unwrap_or_default();
    let of = |c: &Value| {
        let term = &c["terms"][1];
        let end = |n: usize| term["ci95"][n].as_f64().unwrap_or(f64::NAN);
        let quantity = c["quantity"].as_str().unwrap_or_default().to_owned();
        (quantity, term["value"].as_f64().unwrap_or(f64::NAN), 0.5 * (end(1) - end(0)))
    };
    Ok(channels.iter().map(of).collect())
}

/// Twice the half-width is four standard errors: of four channels one is outside once in four
/// thousand seeds.
fn agree(found: &[(String, f64, f64)]) -> Result<(), Failed> {
    let quantities: Vec<&str> = found.iter().map(|c| c.0.as_str()).collect();
    check(quantities == ["gyro", "gyro", "accelerometer", "accelerometer"], format!("{quantities:?}"))?;
    for (quantity, value, half) in found {
        let asked = if quantity == "gyro" { WHITE[1] } else { WHITE[0] };
        near(quantity, *value, asked, 2.0 * half)?;
    }
    Ok(())
}

fn noise() -> Result<(), Failed> {
    let bench = Bench::new()?;
    agree(&white(&written(&bench, &noisy(1.0), "2", "log.csv")?)?)?;
    let twice = white(&written(&bench, &noisy(2.0), "2", "twice.csv")?)?;
    check(agree(&twice).is_err(), "twice the noise passes")
}

fn truth() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let study = "name = \"s\"\nmembers = 64\nduration_s = 10.0\n[accelerometer]\nbias_mg = 2.0\n[gyro]\nbias_deg_h = 36.0\n\
                 [excitation]\nkind = \"sine\"\namplitude_m_s2 = 3.0\nfrequency_hz = 1.0\nphase_rad = 0.0\n";
    let file = written(&bench, study, "1", "log.csv")?;
    let text = std::fs::read_to_string(&file)?;
    let mut lines = text.lines();
    check(lines.next() == Some("t_s,gyro_rad_s,accelerometer_m_s2"), "headings")?;
    let mut rows = 0;
    for line in lines {
        let cells: Vec<f64> = line.split(',').filter_map(|c| c.parse().ok()).collect();
        // a = A sin 2πft and its bias; the rate is zero and its bias 36 °/h.
        let force = 3.0 * (std::f64::consts::TAU * cells[0]).sin();
        near("the specific force", cells[2], force + 2e-3 * 9.80665, 1e-9)?;
        near("the rate", cells[1], 36.0 / 3600.0 * std::f64::consts::PI / 180.0, 1e-15)?;
        rows += 1;
    }
    check(rows == 1000, format!("{rows} rows of 10 s at 100 Hz"))
}

fn formats() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let study = noisy(1.0).replace("1000.0", "20.0").replace("members = 64", "members = 128");
    let read = |name: &str, column: &str| -> Result<Vec<f64>, Failed> {
        let request = Request { columns: vec![column.to_owned()], rate_hz: Some(100.0), ..Request::default() };
        Ok(recording::read(&bench.path(name), &request)?.columns[0].values.clone())
    };
    for name in ["log.csv", "log.parquet", "log.npy"] {
        written(&bench, &study, "70", name)?;
    }
    // The last of seventy is of the second group of lanes.
    let csv = read("log.csv", "accelerometer_70_m_s2")?;
    check(csv.len() == 2000, format!("{} rows", csv.len()))?;
    check(csv == read("log.parquet", "accelerometer_70_m_s2")?, "CSV and Parquet differ")?;
    check(csv == read("log.npy", "141")?, "CSV and NPY differ")?;
    check(csv != read("log.csv", "accelerometer_69_m_s2")?, "two members are alike")
}

fn diagnosed() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let file = written(&bench, &noisy(1.0).replace("1000.0", "300.0"), "1", "log.csv")?;
    // n = √2 N in m/s²/√Hz.
    let density = 2f64.sqrt() * WHITE[0] / 60.0;
    let verdict = |density: f64| -> Result<Value, Failed> {
        let model = bench.file(
            "model.toml",
            &format!(
                "kind = \"static\"\nrate_hz = 100.0\nunit = \"m/s2\"\n[columns]\nchannels = [\"accelerometer_m_s2\"]\n\
                 [noise]\ndensity = {density:?}\n"
            ),
        )?;
        diagnose(&file, &model, &["--json"])?.json()
    };
    let good = verdict(density)?;
    check(good["verdict"] == "adequate", good["verdict"].to_string())?;
    let wrong = verdict(0.5 * density)?;
    check(wrong["verdict"] != "adequate", "half the density is adequate too")
}

fn refused() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let study = noisy(1.0);
    for (count, name, words) in [
        ("65", "log.csv", "need members of the study, which has 64; got 65"),
        ("0", "log.csv", "got 0"),
        ("-1", "log.csv", "need a number of members, got `-1`"),
        ("some", "log.csv", "need a number of members, got `some`"),
        ("1", "log.xyz", "names no format by its ending"),
    ] {
        samples(&bench, &study, count, &bench.path(name))?.refuses(name, words)?;
        check(!bench.path(name).exists() && !bench.path("out").exists(), "a refused run left something behind")?;
    }
    samples(&bench, &study.replace("1000.0", "100000.0"), "64", &bench.path("log.csv"))?
        .refuses("a recording too long", "at most 30000000")?;
    bench.file("log.csv", "precious")?;
    samples(&bench, &study, "1", &bench.path("log.csv"))?.refuses("the user's file", "not written by proofmass")
}
