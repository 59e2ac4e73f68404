//! `proofmass trial --plan`: how often what `plan` proposes decides, and as promised.

use std::path::{Path, PathBuf};

use super::independent::keep;
use crate::output::{remark, say, sayln};
use proofmass_base::control::Control;
use proofmass_base::document::to_json;
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_trial::ask::Subject;
use proofmass_trial::page::planned as report;
use proofmass_trial::planned::ask::{self, FILES as FILES_OF_ONE};
use proofmass_trial::planned::pair::Pair;
use proofmass_trial::planned::run::{self, Plan};
use proofmass_trial::planned::score::Score;
use proofmass_trial::scratch::Scratch;

const STATES: [&str; 2] = ["truth.json", "verdicts.jsonl"];
const FILES: [&str; 3] = ["report.html", "summary.md", "trial.json"];
/// Sensors of a usual and of a quick trial; of about a third the first recording leaves laws tied.
const SENSORS: [usize; 2] = [400, 24];

/// Request to `trial`, as far as it concerns plans.
#[derive(Debug, Clone)]
pub(super) struct Request {
    /// Folder of the results.
    pub out: Option<PathBuf>,
    /// Replace what is not ours.
    pub force: bool,
    /// Fewer sensors.
    pub quick: bool,
    /// Says whether to continue an interrupted trial.
    pub resume: bool,
    /// Number of sensors.
    pub cases: Option<usize>,
    /// Seed of all random draws.
    pub seed: u64,
    /// Number of the only sensor to run.
    pub case: Option<usize>,
}

/// Runs it.
///
/// # Errors
/// When the folder cannot be written, on Ctrl-C, or when the sealed truth was changed.
pub(super) fn run(request: &Request, subject: &Subject<'_>, json: bool, control: &Control) -> Result<()> {
    let plan = Plan { seed: request.seed, sensors: request.cases.unwrap_or(SENSORS[usize::from(request.quick)]) };
    if !(1..1_000_000).contains(&plan.sensors) {
        let cause = format!("{} sensors", plan.sensors);
        return Err(Error::new("could not plan the trial", cause, "use at least one, and fewer than a million"));
    }
    if let (Some(number), Some(path)) = (request.case, &request.out) {
        let pair = Pair::make(plan.seed, number).ok_or_else(|| {
            let cause = "no draw shows its law";
            Error::new(format!("could not make sensor {number}"), cause, "take a number from verdicts.jsonl")
        })?;
        return one(&pair, path, request.force, json, subject, control);
    }
    let command = "trial --plan";
    let open = |path| keep(path, command, &FILES, [request.resume, request.force]);
    let mut kept = request.out.as_deref().map(open).transpose()?;
    if let Some(kept) = &mut kept {
        STATES.iter().try_for_each(|name| kept.state(name, request.resume))?;
    }
    let scratch = Scratch::new(request.out.as_deref())?;
    let folder = request.out.as_deref().unwrap_or(scratch.path());
    let [truth, state] = STATES.map(|name| folder.join(name));
    let (sealed, pairs) = run::prepare(plan, &truth, request.resume, control)?;
    remark!("sealed truth of {} sensors, SHA-256 {sealed}", pairs.len());
    let done = if request.resume { run::earlier(&state)? } else { run::Lines::new() };
    if !request.resume && state.exists() {
        std::fs::remove_file(&state).map_err(|e| Error::io("replace", &state, &e))?;
    }
    let lines = run::run(&pairs, &state, done, subject, control)?;
    let truths = run::open(&truth, &sealed)?;
    let score = Score::of(plan.seed, truths.pairs.len(), &lines, &sealed);
    let document = to_json(&score)?;
    let written = kept.map_or(Ok(()), |mut folder| {
        let made = format!("proofmass {command} --seed {} --cases {}", plan.seed, plan.sensors);
        let texts = [report::page(&score, &lines), report::summary(&score, &made), document.clone()];
        FILES.iter().zip(texts).try_for_each(|(name, text)| folder.write(name, text.as_bytes()))?;
        STATES.iter().for_each(|name| folder.record(name));
        folder.finish()
    });
    if json {
        sayln!("{document}")?;
    } else {
        sayln!("sealed truth, SHA-256 {sealed} (opened after the last verdict)\n")?;
        say(format_args!("{}", report::terminal(&score)))?;
        if let (Some(folder), Ok(())) = (&request.out, &written) {
            sayln!("\nreport: {}", folder.join(FILES[0]).display())?;
        }
    }
    written
}

/// Goes the way of one sensor again and keeps its files.
fn one(pair: &Pair, path: &Path, force: bool, json: bool, subject: &Subject<'_>, control: &Control) -> Result<()> {
    let writes = FILES_OF_ONE.iter().map(|name| (*name).to_owned()).collect();
    let request = output::Request { command: "trial --plan --case", writes, force, ..output::Request::default() };
    let mut folder = Folder::open(path, request)?;
    let scratch = Scratch::new(None)?;
    let line = ask::line(pair, scratch.path(), subject, control)?;
    for name in FILES_OF_ONE {
        if let Ok(bytes) = std::fs::read(scratch.path().join(name)) {
            folder.write(name, &bytes)?;
        }
    }
    folder.finish()?;
    let document = to_json(&line)?;
    if json { sayln!("{document}") } else { say(format_args!("{document}\n")) }
}
