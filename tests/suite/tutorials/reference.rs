//! Makes the reference of the tutorials from what the program says of itself: its commands, the keys of its files, and the
//! physics that it can name.

use std::fmt::Write as _;

use libtest_mimic::Failed;
use serde_json::Value;

use super::super::bench::run;
use super::super::world::{check, program};
use super::source;

/// The sentence that says what to do about a page that is out of date.
pub const HOW: &str = "write it anew with PROOFMASS_WRITE_BOOK=1 cargo test --release --test suite -- tutorials:";

/// States whether pages and figures are to be written rather than compared.
pub fn is_written_anew() -> bool {
    std::env::var_os("PROOFMASS_WRITE_BOOK").is_some()
}

/// Compares every page of the reference, or writes it.
pub fn is_current() -> Result<(), Failed> {
    for (name, text) in [("commands.md", commands()?), ("keys.md", keys()?), ("candidates.md", candidates()?)] {
        let path = source().join("reference").join(name);
        if is_written_anew() {
            std::fs::write(&path, &text)?;
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        if let Some(why) = differing(&kept, &text) {
            return Err(format!("reference/{name} {why}; {HOW}").into());
        }
    }
    // Control: one word more is seen.
    check(differing("a\nb\n", "a\nb c\n").is_some(), "a changed line passes")?;
    check(differing("a\n", "a\nb\n").is_some(), "a missing line passes")
}

fn differing(kept: &str, text: &str) -> Option<String> {
    let (mut kept, mut text) = (kept.lines(), text.lines());
    for line in 1.. {
        match (kept.next(), text.next()) {
            (None, None) => break,
            (a, b) if a == b => {}
            (a, b) => return Some(format!("is out of date: line {line} is {a:?} and should be {b:?}")),
        }
    }
    None
}

fn said(words: &[&str]) -> Result<String, Failed> {
    let answer = run(program().args(words).env_remove("COLUMNS").env_remove("PROOFMASS_DATA"))?;
    check(answer.code == Some(0), format!("{words:?}: {}", answer.stderr))?;
    Ok(answer.stdout)
}

/// The first words of the indented lines between a heading and the next empty line.
fn listed(help: &str, heading: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| line.trim() != heading).skip(1);
    let lines = lines.take_while(|line| !line.trim().is_empty());
    let indent = |line: &str| line.len() - line.trim_start().len();
    let lines: Vec<&str> = lines.collect();
    let least = lines.iter().map(|line| indent(line)).min().unwrap_or(0);
    let first = |line: &&str| line.split_whitespace().find(|w| *w != "-").map(|w| w.trim_end_matches(':').to_owned());
    lines.iter().filter(|line| indent(line) == least).filter_map(first).collect()
}

fn fenced(language: &str, text: &str) -> String {
    let lines: Vec<&str> = text.trim_end().lines().map(str::trim_end).collect();
    format!("```{language}\n{}\n```\n", lines.join("\n"))
}

fn commands() -> Result<String, Failed> {
    let help = said(&["--help"])?;
    let names = listed(&help, "Commands:");
    check(names.len() > 15, format!("only {} commands", names.len()))?;
    let mut page = format!(
        "# Commands\n\nWhat `proofmass --help` and `proofmass COMMAND --help` print.\n\n{}",
        fenced("text", &help)
    );
    for name in names.iter().filter(|name| *name != "help") {
        let help = said(&[name, "--help"])?;
        let _ = write!(page, "\n## {name}\n\n{}", fenced("text", &help));
    }
    Ok(page)
}

fn keys() -> Result<String, Failed> {
    let help = said(&["template", "--help"])?;
    let kinds = listed(&help, "Possible values:");
    check(kinds.len() > 6, format!("only {} kinds: {kinds:?}", kinds.len()))?;
    let mut page = String::from(
        "# Keys of the input files\n\nWhat `proofmass template KIND` prints: a complete, commented file to start from. \
         `proofmass schema KIND` prints its JSON Schema, which names every key with its unit.\n",
    );
    for kind in kinds {
        let _ = write!(page, "\n## {kind}\n\n{}", fenced("toml", &said(&["template", &kind])?));
    }
    Ok(page)
}

/// Text in a cell of a table: a bar would end it.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('*', "\\*").replace('_', "\\_").replace('<', "&lt;")
}

fn candidates() -> Result<String, Failed> {
    let list: Value = serde_json::from_str(&said(&["candidates", "--json"])?)?;
    let list = list.as_array().ok_or("no list of candidates")?;
    check(list.len() > 20, format!("only {} candidates", list.len()))?;
    let word = |of: &Value| of.as_str().unwrap_or_default().to_owned();
    let mut page = String::from(
        "# Physics that a diagnosis can name\n\nWhat `proofmass candidates --json` prints, by kind of recording. In equations \
         u is the input and g its gain; in units y is the unit of the reading.\n",
    );
    let mut kind = String::new();
    for one in list {
        if word(&one["kind"]) != kind {
            kind = word(&one["kind"]);
            let _ = write!(page, "\n## {kind}\n");
        }
        let _ = write!(page, "\n### {}\n\n{}\n\n| | |\n|:--|:--|\n", word(&one["id"]), word(&one["statement"]));
        let parameters: Vec<String> = one["parameters"].as_array().into_iter().flatten().map(parameter).collect();
        let others: Vec<String> = one["confusable_with"].as_array().into_iter().flatten().map(word).collect();
        for (name, text) in [
            ("equation", word(&one["equation"])),
            ("parameters", parameters.join(", ")),
            ("acts in", word(&one["acts"])),
            ("points to it", word(&one["signature"])),
            ("confusable with", others.join(", ")),
            ("reference", word(&one["reference"])),
        ] {
            if !text.is_empty() {
                let _ = writeln!(page, "| {name} | {} |", cell(&text));
            }
        }
    }
    Ok(page)
}

fn parameter(of: &Value) -> String {
    let word = |key: &str| of[key].as_str().unwrap_or_default();
    format!("{} [{}]", word("name"), word("unit"))
}
