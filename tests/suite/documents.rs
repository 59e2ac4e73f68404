//! Schemas of the documents that `--json` prints: each describes what its command prints, and refuses
//! a document that is something else.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use serde_json::{Value, json};

use super::bench::{Bench, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("documents: studies, sweeps and requirements are as their schemas say", studies),
        test("documents: noise, its check and the verdict on it are as their schemas say", at_rest),
        test("documents: a driven verdict and the plan after it are as their schemas say", driven),
        test("documents: a schema refuses a missing field, another word and another version (control)", control),
    ]
}

const STUDY: &str = "name = \"rest\"\nmembers = 256\nduration_s = 600.0\n[sensor]\nsample_rate_hz = 10.0\n[gyro]\n\
                     bias_deg_h = 12.0\nangle_random_walk_deg_rth = 0.3\nbias_instability_deg_h = 8.0\n[accelerometer]\n\
                     velocity_random_walk_m_s_rth = 0.04\n";

/// What the command prints with `--json`.
fn printed(folder: &Path, arguments: &str) -> Result<Value, Failed> {
    run(program().current_dir(folder).args(arguments.split(' ')).arg("--json"))?.json()
}

/// Returns where a document breaks the schema that it names.
fn wrong(document: &Value) -> Result<Vec<String>, Failed> {
    let name = document["schema"].as_str().and_then(|name| name.strip_prefix("proofmass.")).unwrap_or_default();
    against(name, document)
}

fn against(name: &str, document: &Value) -> Result<Vec<String>, Failed> {
    let schema = run(program().args(["schema", name]))?.json()?;
    let (mut schemas, mut compiler) = (boon::Schemas::new(), boon::Compiler::new());
    let place = format!("http://proofmass/{name}");
    compiler.add_resource(&place, schema)?;
    let index = compiler.compile(&place, &mut schemas).map_err(|e| format!("{name} is no JSON Schema: {e:#}"))?;
    Ok(schemas.validate(document, index).err().map(|e| format!("{name}: {e:#}")).into_iter().collect())
}

fn all_right(folder: &Path, commands: &[&str]) -> Result<(), Failed> {
    for command in commands {
        let wrong = wrong(&printed(folder, command)?)?;
        check(wrong.is_empty(), format!("`{command}`: {}", wrong.join("\n")))?;
    }
    Ok(())
}

fn studies() -> Result<(), Failed> {
    let bench = Bench::new()?;
    bench.file("study.toml", STUDY)?;
    let template = run(program().args(["template", "trajectory-study"]))?.stdout;
    bench.file("flight.toml", &template)?;
    let limit = "require study.toml --limit p95(position_error_m,60)<100 --vary gyro.bias_deg_h --tolerance 0.2";
    all_right(
        bench.path("").as_path(),
        &[
            "study study.toml --out a",
            "study study.toml --digits 1 --out b",
            "study flight.toml --members 64 --out c",
            "study study.toml --sweep gyro.bias_deg_h=1:20:3 --out d",
            "study flight.toml --members 64 --sweep gyro.bias_deg_h=1:20:2 --out e",
            limit,
        ],
    )
}

fn at_rest() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let folder = bench.path("");
    bench.file("study.toml", STUDY)?;
    printed(&folder, "study study.toml --samples 1 log.csv --out a")?;
    printed(&folder, "study study.toml --set seed=2 --samples 1 next.csv --out a")?;
    all_right(
        &folder,
        &[
            "allan log.csv",
            "check log.csv",
            "check log.csv next.csv",
            "diagnose log.csv --trace",
            "inspect log.csv",
            "report log.csv --out all",
        ],
    )
}

/// A recording with a law in it, its model and its verdict.
fn spring(folder: &Path) -> Result<Value, Failed> {
    run(program().current_dir(folder).args("trial --planted --samples 2000 --case 33 --out shaker".split(' ')))?;
    printed(folder, "diagnose shaker/recording.csv --model shaker/model.toml --out why")
}

fn driven() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let folder = bench.path("");
    let verdict = spring(&folder)?;
    check(verdict["effects"].as_array().is_some_and(|effects| !effects.is_empty()), "nothing is named")?;
    let wrong = wrong(&verdict)?;
    check(wrong.is_empty(), wrong.join("\n"))?;
    bench
        .file("limits.toml", "largest_input_m_s2 = 2.0\nrate_hz = 1000.0\nlongest_s = 4.0\nvary = [\"multisine\"]\n")?;
    bench.file("words.csv", "a,b\n1,x\n2,y\n")?;
    all_right(
        &folder,
        &[
            "plan why/verdict.json --limits limits.toml",
            "report shaker/recording.csv --model shaker/model.toml --out all",
            "inspect words.csv",
        ],
    )
}

fn control() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let good = spring(&bench.path(""))?;
    let changed = |change: fn(&mut Value)| {
        let mut document = good.clone();
        change(&mut document);
        against("verdict/1", &document)
    };
    check(changed(|_| {})?.is_empty(), "the verdict itself is refused")?;
    check(changed(|v| v["further"] = json!(1))?.is_empty(), "a field that was added is refused")?;
    for (what, change) in [
        ("another word", (|v| v["verdict"] = json!("certain")) as fn(&mut Value)),
        ("another kind", |v| v["kind"] = json!("telepathy")),
        ("another version", |v| v["schema"] = json!("proofmass.verdict/2")),
        ("a text for a number", |v| v["fit"]["noise_floor"] = json!("small")),
        ("no sentence", |v| drop(v.as_object_mut().map(|fields| fields.remove("sentence")))),
        ("half an interval", |v| v["effects"][0]["parameters"][0]["ci95"] = json!([0.0])),
    ] {
        check(!changed(change)?.is_empty(), format!("{what} passes"))?;
    }
    check(!against("allan/1", &good)?.is_empty(), "a verdict passes as noise")
}
