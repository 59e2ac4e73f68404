//! `proofmass trial --book`: the verdicts on a fixed corpus, and what changed since another book.

use std::path::{Path, PathBuf};

use crate::output::{remark, say, sayln};
use proofmass_base::control::Control;
use proofmass_base::document::to_json;
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::shard::Shard;
use proofmass_diagnosis::gate::Gate;
use proofmass_diagnosis::verdict::Verdict;
use proofmass_trial::ask::{Files, Subject};
use proofmass_trial::book::ablation;
use proofmass_trial::book::against::Against;
use proofmass_trial::book::corpus::Choice;
use proofmass_trial::book::entry::Entry;
use proofmass_trial::book::run::{self, Places};
use proofmass_trial::page::book as report;
use proofmass_trial::real::{self, Real};

/// The sealed truth, and the lines as they are given; the same of the verdicts without a rule.
const STATES: [&str; 4] = ["truth.json", "verdicts.jsonl", "truth-gates.json", "gates.jsonl"];
const BOOK: &str = "book.jsonl";
/// Table of the worth of each rule.
const GATES: &str = "gates.md";

/// Turns files into a verdict, without these rules.
pub(super) type Asked<'a> = dyn Fn(&Files, &[Gate]) -> Result<Verdict> + Sync + 'a;

/// Request to the book.
#[derive(Debug, Clone)]
pub(super) struct Request {
    /// Folder of the book.
    pub folder: PathBuf,
    /// Folder of another one, to compare with.
    pub against: Option<PathBuf>,
    /// Part of the cases of each kind, family and sub-family.
    pub sample: f64,
    /// Names of the only cases wanted.
    pub only: Vec<String>,
    /// One part of several.
    pub shard: Option<Shard>,
    /// Recipe of real recordings.
    pub recordings: Option<PathBuf>,
    /// Seed of all random draws.
    pub seed: u64,
    /// Replace what is not ours.
    pub force: bool,
    /// Go on with what is there.
    pub resume: bool,
    /// Ask again without each rule that acted.
    pub ablate: bool,
    /// Rules that never act.
    pub without: Vec<Gate>,
}

/// Writes the book, prints what it says, and compares it. Returns the exit code: 1 where it is worse
/// than the other one beyond chance.
///
/// # Errors
/// Nothing can be written, a case or recipe is not there, or on Ctrl-C.
pub(super) fn run(request: &Request, subject: &Asked<'_>, control: &Control, json: bool) -> Result<u8> {
    if !(request.sample > 0.0 && request.sample <= 1.0) {
        let cause = format!("need a part above 0 and at most 1, got {}", request.sample);
        return Err(Error::new("could not choose a sample", cause, "a tenth is --sample 0.1"));
    }
    // The other book first: an hour of verdicts is a long way to a wrong path.
    let other = request.against.as_deref().map(other).transpose()?;
    let (recorded, data) = recordings(request.recordings.as_deref())?;
    let Request { seed, sample, shard, .. } = *request;
    let items = Choice { seed, sample, only: &request.only, shard }.items(&recorded)?;
    let below = shard.map(|s| request.folder.join(format!("shard-{}-of-{}", s.number, s.of)));
    let path = below.as_deref().unwrap_or(&request.folder);
    let mut folder = keep(path, request)?;
    let done = if request.resume { earlier(path)? } else { Vec::new() };
    if request.resume && done.is_empty() {
        return Err(Error::new(
            "could not resume",
            format!("no verdict in {}", path.display()),
            "leave --resume out to begin a book there",
        ));
    }
    STATES.iter().try_for_each(|name| folder.state(name, request.resume))?;
    let [truth, lines, truth_of_gates, lines_of_gates] = STATES.map(|name| path.join(name));
    for lines in [&lines, &lines_of_gates].into_iter().filter(|lines| !request.resume && lines.exists()) {
        std::fs::remove_file(lines).map_err(|e| Error::io("replace", lines, &e))?;
    }
    let places = Places { truth: &truth, lines: &lines, data: &data };
    let with: &Subject<'_> = &|files| subject(files, &request.without);
    let book = run::run(&items, seed, done, &places, with, control)?;
    folder.write(BOOK, run::text(&book)?.as_bytes())?;
    let worth = if request.ablate {
        let places = Places { truth: &truth_of_gates, lines: &lines_of_gates, data: &data };
        let without: &ablation::Subject<'_> =
            &|files, gate| subject(files, &[request.without.as_slice(), &[gate]].concat());
        let worth = ablation::worth(&book, &ablation::run(&book, &items, seed, &places, without, control)?);
        folder.write(GATES, report::gates(&worth, book.len()).as_bytes())?;
        Some(worth)
    } else {
        None
    };
    STATES.iter().filter(|name| path.join(name).exists()).for_each(|name| folder.record(name));
    folder.finish()?;
    let against = other.map(|other| Against::of(&other, &book));
    if json {
        let document = serde_json::json!({
            "schema": "proofmass.book/1",
            "seed": seed,
            "cases": book.len(),
            "cpu": report::Cost::of(book.iter()),
            "against": against,
            "gates": worth,
        });
        sayln!("{}", to_json(&document)?)?;
    } else {
        say(format_args!("{}", report::terminal(&book)))?;
        if let Some(against) = &against {
            say(format_args!("\n{}", report::against(against)))?;
        }
        sayln!("\nbook: {}", path.join(BOOK).display())?;
        if worth.is_some() {
            sayln!("what each rule is worth: {}", path.join(GATES).display())?;
        }
    }
    Ok(u8::from(against.is_some_and(|against| against.is_worse())))
}

fn keep(path: &Path, request: &Request) -> Result<Folder> {
    let files = output::Request {
        command: "trial --book",
        reads: request.recordings.iter().cloned().collect(),
        writes: vec![BOOK.into(), GATES.into()],
        force: request.force,
        ..output::Request::default()
    };
    Folder::open(path, files)
}

/// The lines of a book in a folder, and of its shards in the folders below.
fn earlier(path: &Path) -> Result<Vec<Entry>> {
    let below = std::fs::read_dir(path).into_iter().flatten().flatten();
    let shards = below.filter(|e| e.file_name().to_string_lossy().starts_with("shard-")).map(|e| e.path());
    let mut found = Vec::new();
    for folder in shards.chain([path.to_path_buf()]) {
        found.extend(run::read(&folder.join(STATES[1]))?);
    }
    Ok(found)
}

fn other(path: &Path) -> Result<Vec<Entry>> {
    let book = run::read(&path.join(BOOK))?;
    if book.is_empty() {
        let cause = format!("there is no {BOOK} with verdicts in {}", path.display());
        return Err(Error::new("could not compare with another book", cause, "give the folder of a finished --book"));
    }
    Ok(book)
}

/// The real recordings of a recipe, and the folder where they lie.
fn recordings(recipe: Option<&Path>) -> Result<(Vec<Real>, PathBuf)> {
    let Some(recipe) = recipe else { return Ok((Vec::new(), PathBuf::new())) };
    let read = real::read(recipe)?;
    let Some(data) = real::folder() else {
        remark!("no folder of recordings (set PROOFMASS_DATA): the real recordings are left out");
        return Ok((Vec::new(), PathBuf::new()));
    };
    let (there, missing): (Vec<Real>, Vec<Real>) =
        read.recording.into_iter().partition(|real| data.join(&real.file).is_file());
    for real in missing {
        remark!("left out: {}, as {} is not there", real.name, data.join(&real.file).display());
    }
    Ok((there, data))
}
