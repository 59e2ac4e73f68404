//! `proofmass trial --plan`: how often what `plan` proposes decides, and as promised.

use std::path::Path;

use super::kept::{Found, Kept, Place};
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

/// Sensors of a usual and of a quick trial; the first recording of a quarter to a half of them leaves laws tied.
const SENSORS: [usize; 2] = [400, 24];

/// Request to `trial`, as far as it concerns plans.
#[derive(Debug, Clone)]
pub(super) struct Request {
    /// Folder of the results.
    pub place: Place,
    /// Fewer sensors.
    pub quick: bool,
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
    if let (Some(number), Some(path)) = (request.case, &request.place.out) {
        let pair = Pair::make(plan.seed, number).ok_or_else(|| {
            let cause = "no draw shows its law";
            Error::new(format!("could not make sensor {number}"), cause, "take a number from verdicts.jsonl")
        })?;
        return one(&pair, path, request.place.force, json, subject, control);
    }
    let command = "trial --plan";
    let kept = Kept::open(command, &request.place)?;
    let (sealed, pairs) = run::prepare(plan, &kept.truth(), request.place.resume, control)?;
    remark!("sealed truth of {} sensors, SHA-256 {sealed}", pairs.len());
    let state = kept.verdicts()?;
    let lines = run::run(&pairs, &state, run::earlier(&state)?, subject, control)?;
    let truths = run::open(&kept.truth(), &sealed)?;
    let score = Score::of(plan.seed, truths.pairs.len(), &lines, &sealed);
    let made = format!("proofmass {command} --seed {} --cases {}", plan.seed, plan.sensors);
    let found = Found {
        document: to_json(&score)?,
        page: report::page(&score, &lines),
        summary: report::summary(&score, &made),
        words: report::terminal(&score),
        sealed,
    };
    kept.finish(&found, json)
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
