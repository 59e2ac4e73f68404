//! The run: cases are made and sealed, each verdict is asked for and kept, the truth is opened
//! after the last.

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::case::Case;
use super::judge::{Mark, judge};
use super::oscillator_base::Size;
use super::truth::Kind;
use crate::ask::{self, Files, Subject};
use crate::envelope::{self, unsealed};
use crate::said::Said;
use crate::scratch::Scratch;
use crate::workers::side_by_side;
use proofmass_base::control::Control;
use proofmass_base::error::{Error, Result};
use proofmass_diagnosis::verdict::Verdict;

/// Seed, size and number of the cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Seed of all random draws.
    pub seed: u64,
    /// Cases, without those that are others written otherwise.
    pub cases: usize,
    /// Rows of the longest recording.
    pub rows: usize,
    /// The only kind; all but sweeps where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<Kind>,
}

/// Contents of the sealed file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truths {
    /// Always "proofmass.independent-truth/1".
    pub schema: String,
    /// Plan that the cases were drawn by.
    pub plan: Plan,
    /// Every case with its truth.
    pub cases: Vec<Case>,
}

/// One line of verdicts.jsonl.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Number of the case.
    pub number: usize,
    /// Kind of recording.
    pub kind: String,
    /// Family of the case.
    pub family: String,
    /// Sub-family of the case.
    pub sub: String,
    /// States how it is written, where it is another case written otherwise.
    pub change: Option<String>,
    /// Names of what is there.
    pub truth: String,
    /// Evidence of what is there.
    pub evidence: f64,
    /// Rms of what is there next to the noise, one number per effect.
    pub over_noise: Vec<f64>,
    /// Worth of the verdict.
    pub mark: Mark,
    /// Holds what the diagnosis said.
    pub said: Said,
}

/// Verdicts by case.
pub type Lines = BTreeMap<usize, Line>;

const HINT: &str = "run it again with --resume; finished verdicts are kept in --out";

/// A case to be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Order {
    /// Number of the case.
    pub number: usize,
    /// Rows of the longest recording.
    pub rows: usize,
}

impl Plan {
    fn orders(self) -> Vec<Order> {
        let numbers = self.kind.map_or_else(|| Case::numbers(self.cases), |kind| Case::numbers_of(kind, self.cases));
        numbers.into_iter().map(|number| Order { number, rows: self.rows }).collect()
    }
}

/// Makes the cases and seals them; a resumed trial takes those that are sealed. Returns the seal
/// and the cases.
///
/// # Errors
/// When the file cannot be written or read, when it belongs to another plan, or when stopped.
pub fn prepare(plan: Plan, path: &Path, resume: bool, control: &Control) -> Result<(String, Vec<Case>)> {
    if resume {
        let (sealed, truths) = envelope::sealed::<Truths>(path)?;
        if truths.plan != plan {
            let cause = format!("it was started with {:?}; requested is {plan:?}", truths.plan);
            return Err(Error::new("could not resume", cause, "give the options of the interrupted trial"));
        }
        return Ok((sealed, truths.cases));
    }
    seal(plan, &plan.orders(), path, control)
}

/// Makes cases and seals them. Returns the seal and those that can be made, as they were sealed.
///
/// # Errors
/// When the file cannot be written, or when stopped.
pub(crate) fn seal(plan: Plan, orders: &[Order], path: &Path, control: &Control) -> Result<(String, Vec<Case>)> {
    let stage = control.stage("making cases", orders.len() as u64);
    let made = side_by_side(orders, |order| {
        control.go_on().map_err(|stopped| stopped.during("could not make the cases", "run it again"))?;
        let case = Case::make(plan.seed, order.number, Size { rows: order.rows });
        stage.add(1);
        Ok(case)
    })?;
    let cases: Vec<Case> = made.into_iter().flatten().collect();
    let truths = Truths { schema: "proofmass.independent-truth/1".into(), plan, cases };
    let (sealed, truths) = envelope::seal(&truths, path)?;
    Ok((sealed, truths.cases))
}

/// Opens the envelope after the last verdict.
///
/// # Errors
/// When it has changed since it was sealed.
pub fn open(path: &Path, sealed: &str) -> Result<Truths> {
    envelope::open(path, sealed)
}

/// Lines of an interrupted run; one that was cut is left out, and its case asked again.
///
/// # Errors
/// When the file is there and cannot be read.
pub(crate) fn kept<L: DeserializeOwned>(path: &Path) -> Result<Vec<L>> {
    let bytes = match std::fs::read(path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        read => read.map_err(|e| Error::io("read", path, &e))?,
    };
    Ok(bytes.split(|byte| *byte == b'\n').filter_map(|line| serde_json::from_slice(line).ok()).collect())
}

/// Verdicts of an interrupted run.
///
/// # Errors
/// When the file is there and cannot be read.
pub fn earlier(path: &Path) -> Result<Lines> {
    Ok(kept::<Line>(path)?.into_iter().map(|l| (l.number, l)).collect())
}

/// Asks for the verdict on one case: two files in a folder of their own, and nothing else.
///
/// # Errors
/// When the files cannot be written, or when stopped; a diagnosis that fails is a verdict "error".
pub fn ask(case: &Case, subject: &Subject<'_>, scratch: &Scratch) -> Result<(Said, Option<Verdict>)> {
    let folder = scratch.case()?;
    let [recording, model] = ["recording.csv", "model.toml"].map(|name| folder.path().join(name));
    for (path, text) in [&recording, &model].into_iter().zip(case.texts()) {
        std::fs::write(path, text).map_err(|e| Error::io("write", path, &e))?;
    }
    ask::ask(&Files { recording, model, judging: Vec::new() }, subject)
}

/// The line of a case.
pub fn line(case: &Case, said: Said) -> Line {
    Line {
        number: case.number,
        kind: case.kind.name().into(),
        family: case.family.name().into(),
        sub: case.sub.clone(),
        change: case.change.map(|c| c.name().to_owned()),
        truth: case.truth.words(),
        evidence: case.truth.evidence,
        over_noise: case.truth.effects.iter().map(|e| e.over_noise).collect(),
        mark: judge(case, &said),
        said,
    }
}

/// Asks for every verdict that is not there yet and keeps each as a line of a file.
///
/// # Errors
/// When nothing can be written, or when stopped.
pub fn run(cases: &[Case], path: &Path, mut done: Lines, subject: &Subject<'_>, control: &Control) -> Result<Lines> {
    let scratch = Scratch::new(path.parent())?;
    let open: Vec<&Case> = cases.iter().filter(|c| !done.contains_key(&c.number)).collect();
    let fresh = keep(&open, path, control, |case| Ok(line(case, ask(case, subject, &scratch)?.0)))?;
    done.extend(fresh.into_iter().map(|line| (line.number, line)));
    Ok(done)
}

/// Does `work` for every item, side by side, and keeps what it gives as a line of a file at once.
///
/// # Errors
/// When nothing can be written, when stopped, or the first of `work`.
pub(crate) fn keep<T: Sync, L: Serialize + Send>(
    items: &[T],
    path: &Path,
    control: &Control,
    work: impl Fn(&T) -> Result<L> + Sync,
) -> Result<Vec<L>> {
    let file = OpenOptions::new().create(true).append(true).open(path);
    let mut file = file.map_err(|e| Error::io("write", path, &e))?;
    // A line that was cut off must not swallow the next one.
    writeln!(file).map_err(|e| Error::io("write", path, &e))?;
    let file = Mutex::new(file);
    let stage = control.stage("verdicts", items.len() as u64);
    side_by_side(items, |item| {
        control.go_on().map_err(|stopped| stopped.during("could not finish the trial", HINT))?;
        let line = work(item)?;
        let text = serde_json::to_string(&line).map_err(|e| unsealed(&e.to_string()))? + "\n";
        let mut file = file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        // In one piece, so that a stop leaves a line whole or cut off, never without its end.
        file.write_all(text.as_bytes()).map_err(|e| Error::io("write", path, &e))?;
        stage.add(1);
        Ok(line)
    })
}
