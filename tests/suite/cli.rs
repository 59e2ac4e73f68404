//! The commands answer as the contract says: help with examples, exit 2 and a sentence for what
//! cannot be, JSON when asked.

use libtest_mimic::{Failed, Trial};

use super::bench::{Bench, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("cli: help shows examples and every command", help),
        test("cli: every command that reads refuses a file that is not there", absent_files),
        test("cli: a command line that means nothing ends with 2", nonsense),
        test("cli: candidates and adapters answer in one JSON document", documents),
    ]
}

const COMMANDS: [&str; 13] = [
    "study",
    "merge",
    "require",
    "allan",
    "diagnose",
    "plan",
    "candidates",
    "paper",
    "map",
    "trial",
    "validate",
    "adapters",
    "bench",
];

fn help() -> Result<(), Failed> {
    let answer = run(program().arg("--help"))?;
    check(answer.code == Some(0) && answer.stdout.contains("Examples:"), "no examples in --help")?;
    check(answer.stdout.starts_with("How far will this inertial sensor drift"), "--help does not say what it is for")?;
    for command in COMMANDS {
        check(answer.stdout.contains(&format!("\n  {command} ")), format!("--help is silent on {command}"))?;
        let own = run(program().args([command, "--help"]))?;
        check(own.code == Some(0) && own.stdout.contains("Usage: proofmass"), format!("{command} --help"))?;
    }
    Ok(())
}

fn absent_files() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let log = bench.file("log.csv", "t,x\n0,1\n1,2\n")?.display().to_string();
    let absent = bench.path("nowhere.file").display().to_string();
    let lines: [&[&str]; 7] = [
        &["study", &absent],
        &["diagnose", &absent],
        &["allan", &absent, "--rate-hz", "100"],
        &["diagnose", &log, "--model", &absent],
        &["diagnose", &absent, "--model", &absent],
        &["map", &absent],
        &["trial", "--like", &absent, "--model", &absent],
    ];
    for line in lines {
        let out = bench.path("out");
        let answer = run(program().args(line).arg("--out").arg(&out))?;
        answer.refuses(&line.join(" "), "nowhere.file")?;
        check(answer.stdout.is_empty(), format!("{line:?} printed {}", answer.stdout))?;
        check(!out.exists(), format!("{line:?} left a folder behind"))?;
    }
    Ok(())
}

fn nonsense() -> Result<(), Failed> {
    let lines: [(&[&str], &str); 5] = [
        (&["studdy"], "'studdy'"),
        (&["study", "--members", "many"], "'many'"),
        (&["study", "--members", "0"], "`members` = 0"),
        (&["adapters", "--jsn"], "'--json'"),
        (&["diagnose"], "<RECORDING>"),
    ];
    for (line, words) in lines {
        run(program().args(line))?.refuses(&line.join(" "), words)?;
    }
    Ok(())
}

fn documents() -> Result<(), Failed> {
    let candidates = run(program().args(["candidates", "--json"]))?.json()?;
    check(candidates.as_array().is_some_and(|list| list.len() > 10), "candidates")?;
    let adapters = run(program().args(["adapters", "--json"]))?.json()?;
    let threads = adapters["cpu"]["threads"].as_u64().unwrap_or(0);
    check(threads >= 1 && adapters["gpu"].is_array(), format!("{adapters}"))
}
