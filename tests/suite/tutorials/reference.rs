//! Makes the reference of the tutorials from what the program says of itself: its commands, the keys of its files, and the
//! physics that it can name.

use std::fmt::Write as _;
use std::path::Path;

use libtest_mimic::Failed;
use serde_json::Value;

use super::super::bench::{Bench, run};
use super::super::world::{check, program};
use super::{compare, examples, source};

/// The sentence that says what to do about a page that is out of date.
pub const HOW: &str = "write it anew with PROOFMASS_WRITE_BOOK=1 cargo test --release --test suite -- tutorials:";

/// States whether pages and figures are to be written rather than compared.
pub fn is_written_anew() -> bool {
    std::env::var_os("PROOFMASS_WRITE_BOOK").is_some()
}

/// Compares every page of the reference, or writes it.
pub fn is_current() -> Result<(), Failed> {
    let drawn = tempfile::tempdir()?;
    said(&["candidates", "--figures", &drawn.path().to_string_lossy()])?;
    pictures_are_current(drawn.path())?;
    let candidates = candidates(drawn.path())?;
    for (name, text) in [("commands.md", commands()?), ("keys.md", keys()?), ("candidates.md", candidates)] {
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

/// Most bytes of a picture of a candidate: a page has dozens.
const MOST_BYTES: usize = 8 * 1024;

/// The names of the pictures in a folder.
fn pictures(folder: &Path) -> Result<Vec<String>, Failed> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        names.push(entry?.file_name().to_string_lossy().into_owned());
    }
    names.retain(|name| name.ends_with(".svg"));
    names.sort();
    Ok(names)
}

/// Compares the pictures of the candidates with those that the program has drawn, or keeps these.
fn pictures_are_current(drawn: &Path) -> Result<(), Failed> {
    let kept = source().join("reference/candidates");
    std::fs::create_dir_all(&kept)?;
    let names = pictures(drawn)?;
    check(names.len() > 40, format!("only {} candidates have a picture", names.len()))?;
    for name in pictures(&kept)?.iter().filter(|name| !names.contains(name)) {
        if is_written_anew() {
            std::fs::remove_file(kept.join(name))?;
        }
        check(is_written_anew(), format!("candidates/{name} is the picture of no candidate; {HOW}"))?;
    }
    for name in names {
        let written = std::fs::read_to_string(drawn.join(&name))?;
        check(written.len() <= MOST_BYTES, format!("candidates/{name} has {} bytes", written.len()))?;
        if is_written_anew() {
            std::fs::write(kept.join(&name), &written)?;
        }
        if let Some(why) = compare::figures(&std::fs::read_to_string(kept.join(&name)).unwrap_or_default(), &written) {
            return Err(format!("candidates/{name} is another picture: {why}; {HOW}").into());
        }
    }
    Ok(())
}

/// A picture that the user has changed stays, unless the run is forced; one of the program's own is drawn again.
pub fn changed_pictures_stay() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let name = "static-white-noise.svg";
    let (folder, picture) = (bench.path("pictures"), bench.path("pictures").join(name));
    let draw =
        |more: &[&str]| run(program().args(["candidates", "--kind", "static", "--figures"]).arg(&folder).args(more));
    check(draw(&[])?.code == Some(0) && draw(&[])?.code == Some(0), "its own pictures are in its way")?;
    let drawn = std::fs::read_to_string(&picture)?;
    std::fs::write(&picture, "mine")?;
    draw(&[])?.refuses("a changed picture", name)?;
    check(std::fs::read_to_string(&picture)? == "mine", "a picture of the user's is gone")?;
    check(draw(&["--force"])?.code == Some(0), "it cannot be forced")?;
    check(std::fs::read_to_string(&picture)? == drawn, "it is not drawn again")
}

/// What a picture shows, in the words that it has for those who cannot see it.
fn alternative(picture: &str) -> &str {
    picture.split_once("aria-label=\"").and_then(|(_, rest)| rest.split_once('"')).map_or("", |(words, _)| words)
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

fn candidates(drawn: &Path) -> Result<String, Failed> {
    let list: Value = serde_json::from_str(&said(&["candidates", "--json"])?)?;
    let list = list.as_array().ok_or("no list of candidates")?;
    check(list.len() > 20, format!("only {} candidates", list.len()))?;
    let word = |of: &Value| of.as_str().unwrap_or_default().to_owned();
    let mut page = String::from(
        "# Physics that a diagnosis can name\n\nWhat `proofmass candidates --json` prints, by kind of recording. In equations \
         u is the input and g its gain; in units y is the unit of the reading.\n\nA picture shows what is seen of a candidate: \
         of a law as the program computes it, on a mass whose resonance has a quality factor of ten, and of clocks and \
         mountings by their equations, with sizes over the largest, so that shapes alone count. The command under it writes a recording in which this candidate is planted, \
         with its model and the truth, into a folder, and prints the verdict on it. A candidate has no picture where it is \
         a single number, and no command where no trial plants it on its own and finds it.\n",
    );
    let mut kind = String::new();
    for one in list {
        if word(&one["kind"]) != kind {
            kind = word(&one["kind"]);
            let _ = write!(page, "\n## {kind}\n");
        }
        let id = word(&one["id"]);
        let _ = writeln!(page, "\n### {id}\n\n{}", word(&one["statement"]));
        let picture = format!("{kind}-{id}.svg");
        if let Ok(drawn) = std::fs::read_to_string(drawn.join(&picture)) {
            let _ = writeln!(page, "\n![{}](candidates/{picture})", alternative(&drawn));
        }
        let _ = write!(page, "\n| | |\n|:--|:--|\n");
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
        if let Some(command) = examples::command(&kind, &id) {
            let _ = write!(page, "\nAn example:\n\n{}", fenced("sh", &command));
        }
    }
    Ok(page)
}

fn parameter(of: &Value) -> String {
    let word = |key: &str| of[key].as_str().unwrap_or_default();
    format!("{} [{}]", word("name"), word("unit"))
}
