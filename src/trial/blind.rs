//! The blind part: truth drawn and sealed, then one verdict per case from the two files alone; what
//! is done survives a stop.

use std::collections::BTreeMap;
use std::io::Write;
use std::ops::Range;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::ask::{self, Subject};
use super::case::Case;
use super::plan::Plan;
use super::said::{Ending, Said};
use super::scratch::Scratch;
use super::seal::{Sealed, Truth};
use super::workers::side_by_side;
use proofmass_base::control::{Control, Stopped};
use proofmass_base::error::{Error, Result};
use proofmass_base::parallel;

/// Verdicts by case number.
pub type Verdicts = BTreeMap<usize, Said>;

/// Draws the cases of a plan and seals them in `folder/truth.json`; to `resume`, the truth that
/// lies there is kept.
///
/// # Errors
/// When the folder cannot be written, when the truth to resume is that of another plan, or on
/// Ctrl-C.
pub fn prepare(plan: Plan, folder: &Path, resume: bool, control: &Control) -> Result<(Sealed, Vec<Case>)> {
    prepare_some(plan, 0..plan.families().len(), folder, resume, control)
}

/// The same for the cases of these numbers.
///
/// # Errors
/// As [`prepare`].
pub fn prepare_some(
    plan: Plan,
    numbers: Range<usize>,
    folder: &Path,
    resume: bool,
    control: &Control,
) -> Result<(Sealed, Vec<Case>)> {
    let path = folder.join("truth.json");
    if resume && path.is_file() {
        let sealed = Sealed::of(&path)?;
        let truth = sealed.open()?;
        if truth.plan != plan || !truth.cases.iter().map(|case| case.number).eq(numbers) {
            return Err(Error::new(
                format!("could not resume the trial in {}", folder.display()),
                "its seed, cases, samples or campaign differ",
                "use the options of that trial, or leave --resume out to start over",
            ));
        }
        return Ok((sealed, truth.cases));
    }
    let families = plan.families();
    let progress = control.stage("planting effects", numbers.len() as u64);
    let cases: Vec<Option<Case>> = parallel::map_indices(numbers.len(), |n| {
        let number = numbers.start + n;
        let (family, nth) = families[number];
        let case = (!control.cancelled()).then(|| plan.draw(number, family, nth));
        progress.step();
        case
    });
    drop(progress);
    control.go_on().map_err(|s| stopped(s, "nothing is lost; run it again"))?;
    let cases: Vec<Case> = cases.into_iter().flatten().collect();
    let sealed = Truth::new(plan, cases).seal(&path)?;
    // What is recorded is what was sealed, to the last digit that the document holds.
    let cases = sealed.open()?.cases;
    Ok((sealed, cases))
}

fn stopped(stopped: Stopped, hint: &str) -> Error {
    stopped.during("could not finish the trial", hint)
}

/// A line of the state file.
#[derive(Serialize, Deserialize)]
struct Done {
    /// Seal of the truth that the verdict belongs to.
    seal: String,
    number: usize,
    said: Said,
}

fn to_json_line(done: &Done) -> Result<String> {
    let text = serde_json::to_string(done)
        .map_err(|e| Error::new("could not note a verdict", e.to_string(), "report this as a defect"))?;
    Ok(text + "\n")
}

/// Verdicts of an earlier run on the same sealed truth, and how many lines could not be read: one
/// that a full disk or a power failure has cut off is not a verdict, and its case is asked again.
///
/// # Errors
/// The file is there and cannot be read.
pub fn earlier(state: &Path, sealed: &Sealed) -> Result<(Verdicts, usize)> {
    let bytes = match std::fs::read(state) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        read => read.map_err(|e| Error::io("read", state, &e))?,
    };
    Ok(verdicts(&bytes, sealed))
}

/// Lines are read apart: what is no text in one of them spoils no other.
pub(super) fn verdicts(bytes: &[u8], sealed: &Sealed) -> (Verdicts, usize) {
    let lines = bytes.split(|byte| *byte == b'\n').filter(|line| !line.trim_ascii().is_empty());
    let (mut verdicts, mut unread) = (Verdicts::new(), 0);
    for line in lines {
        match serde_json::from_slice::<Done>(line) {
            Ok(done) if done.seal == sealed.sha256 => {
                verdicts.insert(done.number, done.said);
            }
            Ok(_) => {}
            Err(_) => unread += 1,
        }
    }
    (verdicts, unread)
}

/// One verdict from files in a folder that exists for this case only.
///
/// # Errors
/// When the files cannot be written. A diagnosis that fails is a verdict too: "error".
pub fn ask(case: &Case, subject: &Subject<'_>, scratch: &Scratch) -> Result<Said> {
    let folder = scratch.case()?;
    Ok(ask::ask(&case.write(folder.path())?, subject)?.0)
}

/// Asks for every verdict that is not in `done` yet, cases in parallel, and notes each in the state
/// file.
///
/// # Errors
/// When files cannot be written, or on Ctrl-C; what is done then stands in the state file.
pub fn run(
    cases: &[Case],
    sealed: &Sealed,
    state: &Path,
    mut done: Verdicts,
    subject: &Subject<'_>,
    control: &Control,
) -> Result<Verdicts> {
    let mut file =
        std::fs::OpenOptions::new().create(true).append(true).open(state).map_err(|e| Error::io("open", state, &e))?;
    // A line that was cut off must not swallow the next one.
    writeln!(file).map_err(|e| Error::io("write", state, &e))?;
    let file = Mutex::new(file);
    let scratch = Scratch::new(Some(state.parent().unwrap_or(Path::new("."))))?;
    let open: Vec<&Case> = cases.iter().filter(|c| !done.contains_key(&c.number)).collect();
    let progress = control.stage("blind verdicts", open.len() as u64);
    let fresh: Vec<Option<(usize, Said)>> = side_by_side(&open, |case| {
        if control.cancelled() {
            return Ok(None);
        }
        let said = ask(case, subject, &scratch)?;
        // A diagnosis that stopped because of Ctrl-C is no verdict.
        if control.cancelled() && said.outcome == Ending::Error {
            return Ok(None);
        }
        let line = Done { seal: sealed.sha256.clone(), number: case.number, said };
        let text = to_json_line(&line)?;
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        // In one piece, so that a stop leaves a line whole or cut off, never without its end.
        file.write_all(text.as_bytes()).map_err(|e| Error::io("write", state, &e))?;
        drop(file);
        progress.step();
        Ok(Some((line.number, line.said)))
    })?;
    drop(progress);
    done.extend(fresh.into_iter().flatten());
    if done.len() < cases.len() {
        control.go_on().map_err(|s| stopped(s, "run the same command with --resume: finished verdicts are kept"))?;
    }
    Ok(done)
}
