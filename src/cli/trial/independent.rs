//! `proofmass trial --independent`: the diagnosis on cases of the second generator.

use std::path::Path;

use super::kept::{Found, Kept, Place};
use crate::output::{remark, sayln};
use proofmass_base::control::Control;
use proofmass_base::document::to_json;
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_trial::ask::Subject;
use proofmass_trial::independent::case::Case;
use proofmass_trial::independent::judge::coverage;
use proofmass_trial::independent::oscillator_base::Size;
use proofmass_trial::independent::run::{self, Plan};
use proofmass_trial::independent::score::Score;
use proofmass_trial::independent::truth::Kind;
use proofmass_trial::page::independent as report;
use proofmass_trial::scratch::Scratch;

/// Request to `trial`, as far as it concerns the second generator.
#[derive(Debug, Clone)]
pub(super) struct Request {
    /// Folder of the results.
    pub place: Place,
    /// Fewer and shorter recordings.
    pub quick: bool,
    /// Cases, without those written otherwise.
    pub cases: Option<usize>,
    /// Seed of all random draws.
    pub seed: u64,
    /// Rows of the longest recording.
    pub rows: Option<usize>,
    /// Number of the only case to run.
    pub case: Option<usize>,
    /// The only kind.
    pub kind: Option<Kind>,
}

fn plan(request: &Request) -> Result<Plan> {
    let (cases, rows) = if request.quick { (100, 5000) } else { (2000, 40_000) };
    let Request { seed, kind, .. } = *request;
    let plan = Plan { seed, cases: request.cases.unwrap_or(cases), rows: request.rows.unwrap_or(rows), kind };
    if !(1..1_000_000).contains(&plan.cases) || !(2000..=1_000_000).contains(&plan.rows) {
        let cause = format!("{} cases of at most {} rows", plan.cases, plan.rows);
        return Err(Error::new("could not plan the trial", cause, "use at least one case and 2000 rows"));
    }
    Ok(plan)
}

fn command(request: &Request) -> String {
    let mut command = format!("proofmass trial --independent --seed {}", request.seed);
    if let Some(kind) = request.kind {
        command += &format!(" --kind {}", kind.name());
    }
    if request.quick {
        command += " --quick";
    }
    for (name, value) in [("cases", request.cases), ("samples", request.rows)] {
        if let Some(value) = value {
            command += &format!(" --{name} {value}");
        }
    }
    command
}

/// Runs it.
///
/// # Errors
/// When the folder cannot be written, on Ctrl-C, or when the sealed truth was changed.
pub(super) fn run(request: &Request, subject: &Subject<'_>, json: bool, control: &Control) -> Result<()> {
    let plan = plan(request)?;
    if let (Some(number), Some(path)) = (request.case, &request.place.out) {
        return one(plan, number, path, request.place.force, json, subject);
    }
    let kept = Kept::open("trial --independent", &request.place)?;
    let (sealed, cases) = run::prepare(plan, &kept.truth(), request.place.resume, control)?;
    remark!("sealed truth of {} cases, SHA-256 {sealed}", cases.len());
    let state = kept.verdicts()?;
    let lines = run::run(&cases, &state, run::earlier(&state)?, subject, control)?;
    let truths = run::open(&kept.truth(), &sealed)?;
    let score = Score::of(plan.seed, &truths.cases, &lines, &sealed);
    let found = Found {
        document: to_json(&score)?,
        page: report::page(&score, &lines),
        summary: report::summary(&score, &command(request)),
        words: report::terminal(&score),
        sealed,
    };
    kept.finish(&found, json)
}

/// Makes one case again and asks for its verdict.
fn one(plan: Plan, number: usize, path: &Path, force: bool, json: bool, subject: &Subject<'_>) -> Result<()> {
    let Some(case) = Case::make(plan.seed, number, Size { rows: plan.rows }) else {
        return Err(Error::new(
            format!("could not make case {number}"),
            "there is no case of that number, or it cannot be rewritten that way",
            "take a number from verdicts.jsonl; rewritten copies of a recording have numbers above 1000000",
        ));
    };
    let names = ["recording.csv", "model.toml", "truth.json"];
    let request = output::Request {
        command: "trial --independent --case",
        writes: names.map(str::to_owned).into(),
        force,
        ..output::Request::default()
    };
    let mut folder = Folder::open(path, request)?;
    let [recording, model] = case.texts();
    for (name, text) in names.into_iter().zip([recording, model, to_json(&case)?]) {
        folder.write(name, text.as_bytes())?;
    }
    folder.finish()?;
    drop(folder);
    let (said, _) = run::ask(&case, subject, &Scratch::new(None)?)?;
    let line = run::line(&case, said.clone());
    if json {
        sayln!("{}", to_json(&serde_json::json!({ "case": case, "verdict": line }))?)?;
        return Ok(());
    }
    sayln!("case {number}: {}, {}, {}", line.kind, line.family, line.sub)?;
    for effect in &case.truth.effects {
        let name = effect.right.join(" or ");
        sayln!("present: {name}, {:.3} × noise, evidence {:.3e}", effect.over_noise, effect.evidence)?;
    }
    sayln!("evidence of a mismatch: {:.3e}", case.truth.evidence)?;
    sayln!("files: {} and {}", path.join(names[0]).display(), path.join(names[1]).display())?;
    sayln!("said: {} {:?} in {:.1} s\n{}", said.outcome.name(), said.groups, said.seconds, said.words)?;
    sayln!("held out: rmse {:.4e} → {:.4e}, noise floor {:.4e}", said.rmse[0], said.rmse[1], said.rmse[2])?;
    for n in &said.numbers {
        let of = |p: &&proofmass_trial::independent::truth::Parameter| {
            p.id == n.id && p.name == n.name && p.channel.as_ref().is_none_or(|c| *c == n.channel)
        };
        let truth =
            case.truth.parameters.iter().find(of).map_or(String::new(), |p| format!("  (true {:.5e})", p.value));
        let at = if n.channel.is_empty() { String::new() } else { format!(" of {}", n.channel) };
        sayln!("  {} {}{at} = {:.5e} [{:.5e}, {:.5e}]{truth}", n.id, n.name, n.value, n.ci95[0], n.ci95[1])?;
    }
    let held = coverage(&case, &said);
    if !held.is_empty() {
        sayln!("{} of {} intervals hold the truth", held.iter().filter(|c| c.covers).count(), held.len())?;
    }
    sayln!("mark: {}", line.mark.word())?;
    Ok(())
}
