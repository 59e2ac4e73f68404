//! Planted physics is found and nothing is found where nothing was planted: a very small blind trial with stated bounds.
//!
//! The seed was chosen before any verdict was seen. Bounds are binomial: a tool that just reaches its targets fails each
//! check with the probability stated there. The full trial is `proofmass trial`.

use libtest_mimic::{Failed, Trial};
use proofmass::trial::blind;
use proofmass::trial::campaign::Campaign;
use proofmass::trial::case::{Case, Family};
use proofmass::trial::judge::{self, Mark};
use proofmass::trial::plan::Plan;
use proofmass::trial::said::Said;
use rayon::prelude::*;

use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("planted: nothing planted, nothing found", nulls),
        test("planted: effects at 5 % of the output are named", singles),
        test("planted: foreign physics is given no name", foreign),
    ]
}

const PLAN: Plan = Plan { seed: 20, cases: 603, samples: 4000, campaign: Campaign::Concealed };

/// The first `count` cases of a family with their verdicts.
fn verdicts(family: Family, count: usize) -> Result<Vec<(Case, Said)>, Failed> {
    let slots: Vec<_> =
        PLAN.families().into_iter().enumerate().filter(|(_, (f, _))| *f == family).take(count).collect();
    let asked: Result<Vec<(Case, Said)>, proofmass::error::Error> = slots
        .into_par_iter()
        .map(|(number, (family, nth))| {
            let case = PLAN.draw(number, family, nth);
            let said = blind::ask(&case, &blind::tool)?;
            Ok((case, said))
        })
        .collect();
    asked.map_err(|e| e.to_string().into())
}

fn listed(of: &[&(Case, Said)]) -> String {
    let lines = of.iter().map(|(case, said)| {
        format!("case {}: planted {:?}, said {} {:?}", case.number, case.planted(), said.outcome, said.groups)
    });
    lines.collect::<Vec<_>>().join("; ")
}

// Target: at most 1 % false alarms. Two or more in 8 then happen with probability 0.3 %.
fn nulls() -> Result<(), Failed> {
    let all = verdicts(Family::Null, 8)?;
    check(all.iter().all(|(_, said)| said.outcome != "error"), "a diagnosis stopped with an error")?;
    let alarms: Vec<_> = all.iter().filter(|(_, said)| judge::is_alarm(said)).collect();
    check(alarms.len() <= 1, listed(&alarms))
}

// Target: 97 % named. Three or more misses in 8 then happen with probability 0.1 %.
fn singles() -> Result<(), Failed> {
    let all = verdicts(Family::SingleFivePercent, 8)?;
    let missed: Vec<_> = all.iter().filter(|(case, said)| !judge::judge(case, said).is_named()).collect();
    check(missed.len() <= 2, listed(&missed))
}

// Target: nine of ten flagged. Three or more confident names in 4 then happen with probability 0.4 %.
fn foreign() -> Result<(), Failed> {
    let all = verdicts(Family::UnknownPhysics, 4)?;
    let named: Vec<_> = all
        .iter()
        .filter(|(case, said)| matches!(judge::judge(case, said), Mark::Wrong | Mark::Silent | Mark::Error))
        .collect();
    check(named.len() <= 2, listed(&named))
}
