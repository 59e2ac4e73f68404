//! `check` of proof masses and resonators: the same physics is named in both halves with the same numbers, and a
//! sensor that changes in between, or from run to run, is found.

use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};

use super::bench::{Bench, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("check: a proof mass has the same physics and numbers in both halves, and another gain is seen", driven),
        test("check: sweeps of a resonator are checked by their halves", sweeps),
    ]
}

/// A blind case written as files, and its model.
fn case(bench: &Bench, asked: &[&str]) -> Result<[PathBuf; 2], Failed> {
    let folder = bench.path("case");
    let answer = run(program().arg("trial").args(asked).arg("--out").arg(&folder))?;
    check(answer.code == Some(0), &answer.stderr)?;
    Ok([folder.join("recording.csv"), folder.join("model.toml")])
}

/// A log whose readings, in the last column, are so many times as large from a row on.
fn with_gain(log: &Path, from: usize, times: f64) -> Result<String, Failed> {
    let text = std::fs::read_to_string(log)?;
    let mut lines = text.lines();
    let mut out = lines.next().unwrap_or_default().to_owned();
    for (row, line) in lines.enumerate() {
        let (before, last) = line.rsplit_once(',').ok_or("a row of one column")?;
        let value: f64 = last.trim().parse().map_err(|_| format!("no number: {last}"))?;
        out += &format!("\n{before},{:e}", if row >= from { times * value } else { value });
    }
    Ok(out)
}

fn driven() -> Result<(), Failed> {
    let bench = Bench::new()?;
    // Squeeze-film damping and a quadratic spring.
    let [log, model] = case(&bench, &["--planted", "--samples", "3000", "--case", "33"])?;
    let of = |logs: &[&Path]| run(program().arg("check").args(logs).arg("--model").arg(&model).arg("--json"))?.json();
    let said = of(&[&log])?;
    check(said["agreement"]["joint"]["agrees"] == true, said["answer"].to_string())?;
    let names: Vec<&str> = said["agreement"]["parameters"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|line| line["name"].as_str())
        .collect();
    for name in ["omega0", "gain", "squeeze-film-damping c", "quadratic-stiffness alpha"] {
        check(names.contains(&name), format!("no {name} in {names:?}"))?;
    }
    let rows = std::fs::read_to_string(&log)?.lines().count() - 1;
    let louder = bench.file("louder.csv", &with_gain(&log, rows / 2, 1.05)?)?;
    let said = of(&[&louder])?;
    check(said["agreement"]["joint"]["agrees"] == false, said["answer"].to_string())?;
    let other = bench.file("other.csv", &with_gain(&log, 0, 1.05)?)?;
    let said = of(&[&log, &other])?;
    let lines = said["agreement"]["parameters"].as_array().cloned().unwrap_or_default();
    let differs = |name: &str| lines.iter().any(|l| l["name"] == name && l["agrees"] == false);
    check(differs("gain") && !differs("omega0"), said["answer"].to_string())
}

fn sweeps() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let [log, model] = case(&bench, &["--independent", "--seed", "5", "--case", "200000001"])?;
    let said = run(program().arg("check").arg(&log).arg("--model").arg(&model).arg("--json"))?.json()?;
    check(said["recordings"][0]["parameters"].as_array().is_some_and(|p| p.len() >= 4), said.to_string())?;
    let statements = said["recordings"][0]["statements"].to_string();
    check(statements.contains("the whole of it: "), statements)
}
