//! Maps and blind trials divided as studies are: the same files, the same merge, the same answer.

use std::path::Path;
use std::process::Command;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::bench::run;
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("shards: rows and diagrams of a map, computed apart, are the files of one run", map),
        test("shards: cases of a blind trial, asked apart, have one run's seal and outcome", trial),
    ]
}

/// Noise in every orbit, rows that differ in their steps, two diagrams.
const MAP: &str = "name = \"m\"\nseed = 3\n[oscillator]\nmass_kg = 1.0\ndamping_kg_s = 0.1\nstiffness_n_m = 1.0\n\
                   cubic_n_m3 = 0.3\n[drive]\namplitude_n = 66.75\nomega_rad_s = 1.5\n[[map]]\ntitle = \"a\"\n\
                   x = { quantity = \"amplitude_n\", from = 0.0, to = 100.0, points = 24 }\n\
                   y = { quantity = \"omega_rad_s\", from = 0.5, to = 3.0, points = 13 }\n\
                   transient_periods = 5\nperiods = 8\nnoise_n_rts = 0.1\n[[map]]\ntitle = \"b\"\n\
                   x = { quantity = \"damping_kg_s\", from = 0.1, to = 1.0, points = 10 }\n\
                   y = { quantity = \"cubic_n_m3\", from = 0.1, to = 1.0, points = 5 }\n\
                   transient_periods = 5\nperiods = 8\n[[bifurcation]]\ntitle = \"c\"\nfrom_n = 1.0\nto_n = 60.0\n\
                   points = 6\ntransient_periods = 5\nstrobes = 4\nnoise_n_rts = 0.1\n";

/// Files of a folder and of those in it that are not hidden, by name.
fn files(folder: &Path) -> Result<Vec<(String, Vec<u8>)>, Failed> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            found.extend(files(&entry.path())?.into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else if !name.starts_with('.') {
            found.push((name, std::fs::read(entry.path())?));
        }
    }
    found.sort();
    Ok(found)
}

fn map() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("map.toml"), MAP)?;
    let map = |out: &str, more: &[&str]| -> Command {
        let mut command = program();
        command.args(["--json", "map"]).arg(path("map.toml")).arg("--out").arg(path(out)).args(["--backend", "cpu"]);
        command.args(more);
        command
    };
    let whole = run(&mut map("whole", &[]))?.json()?;
    for of in [1, 4, 30] {
        let out = format!("of-{of}");
        for k in (1..=of).rev() {
            let said = run(&mut map(&out, &["--shard", &format!("{k}/{of}")]))?.json()?;
            check(said["shard"] == k, said.to_string())?;
        }
        let merged =
            run(program().args(["--json", "merge"]).arg(path(&out)).arg("--out").arg(path(&format!("m-{of}"))))?;
        check(merged.json()? == whole, format!("{of} shards: another summary"))?;
        check(files(&path(&format!("m-{of}")))? == files(&path("whole"))?, format!("{of} shards: other files"))?;
    }
    std::fs::remove_file(path("of-4/shard-3-of-4.state"))?;
    run(program().arg("merge").arg(path("of-4")))?.refuses("a gap", "shard-3-of-4.state")?;
    // Control: another seed, another noise; and it is foreign.
    std::fs::write(path("map.toml"), MAP.replace("seed = 3", "seed = 4"))?;
    check(run(&mut map("of-4", &["--shard", "3/4"]))?.code == Some(0), "a shard of another map")?;
    run(program().arg("merge").arg(path("of-4")))?.refuses("another seed", "belongs to another run")?;
    check(run(&mut map("other", &[]))?.json()? != whole, "the comparison is blind")
}

/// Everything but how long the verdicts took.
fn timeless(mut outcome: Value) -> Value {
    outcome.as_object_mut().and_then(|fields| fields.remove("seconds_per_case"));
    outcome
}

fn trial() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = |name: &str| folder.path().join(name);
    let trial = |out: &str, more: &[&str]| -> Command {
        let mut command = program();
        command.args(["--json", "trial", "--cases", "3", "--samples", "600", "--out"]).arg(path(out)).args(more);
        command
    };
    let whole = timeless(run(&mut trial("whole", &[]))?.json()?);
    for k in [2, 3, 1] {
        let said = run(&mut trial("shards", &["--shard", &format!("{k}/3")]))?.json()?;
        check(said["cases"].as_u64().is_some_and(|n| n > 4) && said["of"] == 3, said.to_string())?;
    }
    let merged = run(program().args(["--json", "merge"]).arg(path("shards")).arg("--out").arg(path("merged")))?;
    let merged = timeless(merged.json()?);
    check(merged == whole, format!("another outcome\n{merged}\n{whole}"))?;
    let same = |name: &str| -> Result<bool, Failed> {
        Ok(std::fs::read(path("merged").join(name))? == std::fs::read(path("whole").join(name))?)
    };
    check(same("truth.json")? && path("merged/report.html").exists(), "another truth")?;
    // A finished shard says so when it is resumed; one that was never begun cannot be.
    check(run(&mut trial("shards", &["--shard", "2/3", "--resume"]))?.code == Some(0), "a finished shard")?;
    run(&mut trial("none", &["--shard", "2/3", "--resume"]))?.refuses("nothing to resume", "no interrupted shard")?;
    // A flipped bit.
    let state = path("shards/shard-2-of-3.state");
    let good = std::fs::read(&state)?;
    let mut bad = good.clone();
    let at = good.len() / 2;
    bad[at] ^= 1;
    std::fs::write(&state, bad)?;
    run(program().arg("merge").arg(path("shards")))?.refuses("a flipped bit", "shard-2-of-3.state")?;
    std::fs::write(&state, good)?;
    let other = run(&mut trial("shards", &["--shard", "2/3", "--seed", "2"]))?;
    check(other.code == Some(0), other.stderr)?;
    run(program().arg("merge").arg(path("shards")))?.refuses("another seed", "belongs to another run")
}
