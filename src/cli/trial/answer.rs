//! The outcome of a trial, whoever ran it: on stdout, and as files.

use crate::numbers;
use crate::output::{say, sayln};
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_base::output::Folder;
use proofmass_trial::blind::Verdicts;
use proofmass_trial::case::Case;
use proofmass_trial::outcome::Outcome;
use proofmass_trial::page as report;
use proofmass_trial::plan::Plan;
use proofmass_trial::real::Found;

/// The sealed truth, and a line for each verdict: what a stopped trial goes on from.
pub(super) const STATES: [&str; 2] = ["truth.json", "verdicts.jsonl"];
/// Every file that the outcome is written as.
pub(super) const FILES: [&str; 5] = ["report.html", "summary.md", "power.svg", "limits.svg", "trial.json"];

/// Everything that a report is made from.
pub(super) struct Run<'a> {
    /// Plan by which it was drawn.
    pub plan: &'a Plan,
    /// Rates, limits and coverage found.
    pub outcome: &'a Outcome,
    /// The cases with their truth.
    pub cases: &'a [Case],
    /// The verdict on each case.
    pub verdicts: &'a Verdicts,
    /// Real recordings next to it.
    pub real: &'a [Found],
}

/// Writes the outcome with `more` files and prints it. The `command` stands in the summary, for
/// whoever wants to repeat it.
///
/// # Errors
/// When stdout or the folder cannot be written.
pub(super) fn give(
    run: &Run<'_>,
    command: &str,
    folder: Option<Folder>,
    more: &[(&str, Vec<u8>)],
    json: bool,
) -> Result<()> {
    let Run { outcome, real, .. } = run;
    let document = to_json(outcome)?;
    let page = folder.as_ref().map(|folder| folder.path().join(FILES[0]));
    let written = folder.map_or(Ok(()), |mut folder| {
        more.iter().try_for_each(|(name, bytes)| folder.write(name, bytes))?;
        write(folder, run, command, &document)
    });
    if json {
        sayln!("{document}")?;
    } else {
        sayln!("sealed truth, SHA-256 {} (opened after the last verdict)\n", outcome.truth_sha256)?;
        say(format_args!("{}", report::terminal(outcome)))?;
        if !real.is_empty() {
            say(format_args!("\n{}\n{}", report::recordings(real), report::scores(real)))?;
        }
        if let (Some(page), Ok(())) = (page, &written) {
            sayln!("\nreport: {}", page.display())?;
        }
    }
    written
}

fn write(mut folder: Folder, run: &Run<'_>, command: &str, document: &str) -> Result<()> {
    let Run { plan, outcome, cases, verdicts, real } = run;
    let texts = [
        report::summary(plan, outcome, command, real),
        report::figures::power(outcome).file_svg(),
        report::figures::limits(outcome).file_svg(),
        document.to_owned(),
    ];
    numbers::write(&mut folder, FILES[0], report::page(plan, outcome, cases, verdicts, real))?;
    FILES.iter().skip(1).zip(texts).try_for_each(|(name, text)| folder.write(name, text.as_bytes()))?;
    STATES.iter().for_each(|name| folder.record(name));
    folder.finish()
}
