//! Planted physics is found and nothing is found where nothing was planted: the quick blind trial
//! with stated bounds.
//!
//! The seed was chosen before any verdict was seen. A bound is the number of misses that a tool
//! which just reaches its target exceeds with a probability of one in a thousand. The full trial is
//! `proofmass trial`.

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::diagnosis::verdict::Verdict;
use proofmass::diagnosis::{self, model};
use proofmass::report::diagnosis::worded;
use proofmass::trial::ask::Files;
use proofmass::trial::blind::{self, Verdicts};
use proofmass::trial::interval::Proportion;
use proofmass::trial::outcome::Outcome;
use proofmass::trial::plan::Plan;
use proofmass::trial::said::Said;
use statrs::distribution::{Binomial, DiscreteCDF};

use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![test("planted: the quick blind trial keeps within the bounds of its targets", quick)]
}

/// Most misses of `cases` at this rate, but for one time in a thousand.
fn most(cases: usize, rate: f64) -> Result<usize, Failed> {
    Ok(Binomial::new(rate, cases as u64)?.inverse_cdf(0.999) as usize)
}

fn within(outcome: &Outcome) -> Result<(), Failed> {
    let alarms = outcome.false_alarm_rate;
    let bound = most(alarms.cases, 0.01)?;
    check(alarms.hits <= bound, format!("{} false alarms in {} nulls, bound {bound}", alarms.hits, alarms.cases))?;
    let shares: [(&str, &Proportion, f64); 3] = [
        ("effects above their limit not named", &outcome.named, 0.03),
        ("unknown physics not flagged", &outcome.flagged, 0.10),
        ("intervals without the truth", &outcome.coverage, 0.08),
    ];
    for (what, share, rate) in shares {
        let (misses, bound) = (share.cases - share.hits, most(share.cases, rate)?);
        check(misses <= bound, format!("{what}: {misses} of {}, bound {bound}", share.cases))?;
    }
    check(outcome.errors == 0.0, format!("{} of the diagnoses stopped with an error", outcome.errors))
}

/// By the way that `proofmass diagnose` goes.
fn tool(files: &Files) -> proofmass::error::Result<Verdict> {
    let model = model::read(&files.model)?;
    let recording = model::read_recording(&files.recording, &model, &Control::silent())?;
    Ok(worded(diagnosis::diagnose(&recording, &model, &Control::silent())?).verdict)
}

fn quick() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let (sealed, cases) = blind::prepare(Plan::quick(20), folder.path(), false, &Control::silent())?;
    let state = folder.path().join("verdicts.jsonl");
    let verdicts = blind::run(&cases, &sealed, &state, Verdicts::new(), &tool, &Control::silent())?;
    let outcome = Outcome::of(&sealed.open()?.cases, &verdicts, &sealed.sha256);
    within(&outcome).map_err(|failed| {
        let said = outcome.confusion.iter().filter(|c| c.planted != c.said);
        let lines: Vec<String> = said.map(|c| format!("{} → {} {}×", c.planted, c.said, c.cases)).collect();
        format!("{}\n{}", failed.message().unwrap_or_default(), lines.join("\n"))
    })?;

    // Negative control: verdicts dealt out to the wrong cases break the bounds.
    let dealt: Vec<&Said> = verdicts.values().cycle().skip(1).take(verdicts.len()).collect();
    let dealt: Verdicts = verdicts.keys().copied().zip(dealt.into_iter().cloned()).collect();
    check(within(&Outcome::of(&cases, &dealt, "seal")).is_err(), "shuffled verdicts keep within the bounds")
}
