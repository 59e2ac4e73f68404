//! Scripts for batch systems: a shell reads them, their shards run by a plain shell, and their
//! merge is one run's answer.
//!
//! `tests/cluster/slurm.sh` submits one to a Slurm of one node.

use std::path::Path;
use std::process::Command;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::bench::{Answer, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test("emit: a Kubernetes manifest holds the study, an indexed Job and a merge", kubernetes),
        test("emit: what cannot be a script is refused in a sentence", nonsense),
    ];
    if Command::new("bash").arg("--version").output().is_ok_and(|o| o.status.success()) {
        all.push(test(
            "emit: the shards of a Slurm script run by a plain shell, and its merge is one run's answer",
            slurm,
        ));
    }
    all
}

const STUDY: &str =
    "name = \"My 1.\"\nmembers = 1100\nduration_s = 1.0\n\n[accelerometer]\nnoise_density_ug_rthz = 100.0\n";

/// The command on a study whose path is hard on shells.
fn study(folder: &Path, more: &[&str]) -> Result<Command, Failed> {
    let home = folder.join("my $study's");
    std::fs::create_dir_all(&home)?;
    std::fs::write(home.join("study.toml"), STUDY)?;
    let mut command = program();
    command.current_dir(folder).arg("study").arg(home.join("study.toml")).args(more);
    Ok(command)
}

/// Changes that hold a blank, quotes and braces.
const CHANGES: [&str; 8] = [
    "--seed",
    "5",
    "--set",
    "accelerometer.bias_mg={ mean = 0.0, sd = 2.0 }",
    "--set",
    "name=\"changed\"",
    "--backend",
    "cpu",
];

fn fields(answer: Answer) -> Result<Value, Failed> {
    let mut document = answer.json()?;
    for field in ["seconds", "backend", "out", "shards"] {
        document.as_object_mut().and_then(|fields| fields.remove(field));
    }
    Ok(document)
}

fn slurm() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let whole = fields(run(study(folder.path(), &["--json", "--out", "whole"])?.args(CHANGES))?)?;
    // To stdout without --out, into the folder with it: the same but for the folder that results go
    // to.
    let printed = run(study(folder.path(), &["--emit", "slurm", "--shards", "3"])?.args(CHANGES))?;
    check(printed.stdout.starts_with("#!/bin/bash\n") && printed.stdout.contains("sbatch"), printed.stdout)?;
    let told = run(study(folder.path(), &["--emit", "slurm", "--shards", "3", "--out", "o'ut"])?.args(CHANGES))?;
    check(told.code == Some(0), told.stderr)?;
    let script = folder.path().join(told.stdout.trim());
    let syntax = Command::new("bash").arg("-n").arg(&script).output()?;
    check(syntax.status.success(), String::from_utf8_lossy(&syntax.stderr))?;
    let step = |task: &str, more: &[(&str, &str)]| -> Result<Answer, Failed> {
        let mut command = Command::new("bash");
        command.arg(&script).arg(task).env("PROOFMASS", env!("CARGO_BIN_EXE_proofmass")).envs(more.iter().copied());
        run(command.current_dir("/"))
    };
    let number = "SLURM_ARRAY_TASK_ID";
    for k in ["3", "1"] {
        let answer = step("shard", &[(number, k)])?;
        check(answer.code == Some(0), answer.stderr)?;
    }
    step("merge", &[])?.refuses("a merge before its shards", "shard-2-of-3.state")?;
    // A task that was put back into the queue goes on, whether it had begun or not.
    for k in ["2", "3"] {
        let answer = step("shard", &[(number, k), ("SLURM_RESTART_COUNT", "1")])?;
        check(answer.code == Some(0), answer.stderr)?;
    }
    let merged = step("merge", &[])?;
    let out = folder.path().join("o'ut");
    check(merged.code == Some(0) && out.join("report.html").exists(), merged.stderr)?;
    let merged = fields(run(program().args(["--json", "merge"]).arg(&out))?)?;
    check(merged == whole, format!("another answer\n{merged}\n{whole}"))?;
    // Control: without the changes it would have been another one.
    let plain = fields(run(&mut study(folder.path(), &["--json", "--out", "plain", "--backend", "cpu"])?)?)?;
    check(plain != whole, "the comparison is blind")
}

fn kubernetes() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let text = run(study(folder.path(), &["--emit", "kubernetes", "--shards", "64"])?.args(CHANGES))?.stdout;
    let wanted = [
        "kind: ConfigMap",
        "completions: 64",
        "parallelism: 64",
        "completionMode: Indexed",
        "--shard \"$shard/64\"",
        "JOB_COMPLETION_INDEX + 1",
        "proofmass merge /data/changed --out /data/changed",
        "--backend cpu --members 1100 --seed 5",
    ];
    for part in wanted {
        check(text.contains(part), format!("no {part} in\n{text}"))?;
    }
    check(!text.contains('\t'), "a tab, which YAML does not take")?;
    // The study that it holds, taken out again, is the study with its changes.
    let held = text.split("  study.toml: |2\n").nth(1).and_then(|rest| rest.split("---\n").next()).ok_or("no study")?;
    let held: String = held.lines().map(|line| format!("{}\n", line.strip_prefix("    ").unwrap_or(line))).collect();
    std::fs::write(folder.path().join("held.toml"), held)?;
    let mut command = program();
    command.current_dir(folder.path()).args(["--json", "study", "held.toml", "--seed", "5", "--backend", "cpu"]);
    let held = fields(run(command.args(["--out", "held"]))?)?;
    let whole = fields(run(study(folder.path(), &["--json", "--out", "whole"])?.args(CHANGES))?)?;
    check(held == whole, "the manifest holds another study")
}

fn nonsense() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let lines: [(&[&str], &str); 5] = [
        (&["--emit", "slurm"], "--shards"),
        (&["--shards", "4"], "--emit"),
        (&["--emit", "slurm", "--shards", "0"], "0"),
        (&["--emit", "pbs", "--shards", "4"], "pbs"),
        (&["--emit", "slurm", "--shards", "4", "--shard", "1/4"], "--shard"),
    ];
    for (line, words) in lines {
        run(study(folder.path(), line)?.args(["--out", "out"]))?.refuses(&line.join(" "), words)?;
    }
    check(!folder.path().join("out").exists(), "a refused script left a folder behind")
}
