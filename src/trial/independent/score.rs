//! States what a trial of the second generator found: marks by family and sub-family, coverage of
//! each parameter, agreement under other ways of writing, times. The public document of `trial
//! --independent --json`.

use std::collections::BTreeMap;

use serde::Serialize;

use super::case::{Case, Change};
use super::judge::{Covered, Mark, coverage};
use super::run::{Line, Lines};
use super::truth::{Family, Kind};
use crate::interval::Proportion;

/// Marks of some cases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Kind of recording.
    pub kind: Kind,
    /// Family of the cases.
    pub family: Family,
    /// Sub-family; all of them when absent.
    pub sub: Option<String>,
    /// Number of cases per mark.
    pub marks: BTreeMap<Mark, usize>,
    /// Number of cases.
    pub cases: usize,
    /// Right, or honest with the right name, of what a good test sees; for nulls and foreign
    /// physics: right.
    pub right_or_honest: Proportion,
    /// False names, however sure, of all.
    pub false_names: Proportion,
    /// False names called explained, of all.
    pub confidently_wrong: Proportion,
    /// Nulls not left alone.
    pub alarms: Proportion,
}

impl Row {
    /// Number of cases with a mark.
    pub fn count(&self, mark: Mark) -> usize {
        self.marks.get(&mark).copied().unwrap_or(0)
    }
}

/// Intervals of one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Intervals {
    /// Kind of recording.
    pub kind: Kind,
    /// Library id of the effect.
    pub id: String,
    /// Symbol of the parameter.
    pub name: String,
    /// Intervals that contain the true value.
    pub cover: Proportion,
    /// Distance from the truth in half-widths, the largest.
    pub worst: f64,
}

/// States whether the same recording written otherwise gets the same verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    /// States how the copy was rewritten.
    pub change: Change,
    /// Same outcome and same names.
    pub same: Proportion,
    /// Numbers of the cases that do not agree.
    pub apart: Vec<usize>,
}

/// The public document `proofmass.independent-trial/1`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// Always "proofmass.independent-trial/1".
    pub schema: &'static str,
    /// Seed of the trial.
    pub seed: u64,
    /// Cases, without those written otherwise.
    pub cases: usize,
    /// SHA-256 of the sealed truth.
    pub truth_sha256: String,
    /// Marks per kind and family.
    pub families: Vec<Row>,
    /// Kind by family by sub-family.
    pub subs: Vec<Row>,
    /// Each family over all kinds: the figures to reach.
    pub confidently_wrong: Proportion,
    /// False alarms on nulls, `undecidable` counted.
    pub false_alarms: Proportion,
    /// Nulls called undecidable.
    pub undecided_nulls: Proportion,
    /// False names near a law.
    pub near_false_names: Proportion,
    /// Right or honest with the right name near a law, of what a good test sees.
    pub near_right_or_honest: Proportion,
    /// Per candidate and parameter.
    pub intervals: Vec<Intervals>,
    /// Per way of writing.
    pub agreement: Vec<Agreement>,
    /// Median, 90 % and 99 % of the time per verdict, each on one core, s.
    pub seconds: [f64; 3],
}

struct Judged<'a> {
    case: &'a Case,
    line: &'a Line,
}

fn row(kind: Kind, family: Family, sub: Option<String>, of: &[&Judged<'_>]) -> Row {
    let mut marks = BTreeMap::new();
    of.iter().for_each(|j| *marks.entry(j.line.mark).or_insert(0) += 1);
    let over = |hit: &dyn Fn(Mark) -> bool| Proportion::over(of.iter().map(|j| hit(j.line.mark)));
    Row {
        kind,
        family,
        sub,
        cases: of.len(),
        right_or_honest: right_or_honest(of.iter().copied()),
        false_names: over(&Mark::is_false_name),
        confidently_wrong: over(&|m| m == Mark::ConfidentlyWrong),
        alarms: over(&Mark::is_alarm),
        marks,
    }
}

fn right_or_honest<'a>(of: impl Iterator<Item = &'a Judged<'a>>) -> Proportion {
    let seen = of.filter(|j| j.case.family == Family::Null || j.case.truth.is_detectable());
    Proportion::over(seen.map(|j| matches!(j.line.mark, Mark::Right | Mark::HonestNamed)))
}

impl Score {
    /// Scores the lines against the opened truth.
    pub fn of(seed: u64, cases: &[Case], lines: &Lines, truth_sha256: &str) -> Self {
        let all: Vec<Judged<'_>> =
            cases.iter().filter_map(|case| Some(Judged { case, line: lines.get(&case.number)? })).collect();
        let own: Vec<&Judged<'_>> = all.iter().filter(|j| j.case.change.is_none()).collect();
        let (mut families, mut subs) = (Vec::new(), Vec::new());
        for kind in Kind::ALL {
            for family in Family::ALL {
                let of: Vec<&Judged<'_>> =
                    own.iter().filter(|j| j.case.kind == kind && j.case.family == family).copied().collect();
                if of.is_empty() {
                    continue;
                }
                families.push(row(kind, family, None, &of));
                let mut names: Vec<&String> = of.iter().map(|j| &j.case.sub).collect();
                names.sort();
                names.dedup();
                for sub in names {
                    let of: Vec<&Judged<'_>> = of.iter().filter(|j| j.case.sub == *sub).copied().collect();
                    subs.push(row(kind, family, Some(sub.clone()), &of));
                }
            }
        }
        let family = |family: Family| own.iter().filter(move |j| j.case.family == family).copied();
        let over =
            |family_: Family, hit: &dyn Fn(Mark) -> bool| Proportion::over(family(family_).map(|j| hit(j.line.mark)));
        Self {
            schema: "proofmass.independent-trial/1",
            seed,
            cases: own.len(),
            truth_sha256: truth_sha256.into(),
            confidently_wrong: Proportion::over(own.iter().map(|j| j.line.mark == Mark::ConfidentlyWrong)),
            false_alarms: over(Family::Null, &Mark::is_alarm),
            undecided_nulls: over(Family::Null, &|m| m == Mark::Undecided),
            near_false_names: over(Family::Near, &Mark::is_false_name),
            near_right_or_honest: right_or_honest(family(Family::Near)),
            intervals: intervals(&own),
            agreement: agreement(&all),
            seconds: [0.5, 0.9, 0.99].map(|p| quantile(own.iter().map(|j| j.line.said.seconds), p)),
            families,
            subs,
        }
    }
}

fn intervals(own: &[&Judged<'_>]) -> Vec<Intervals> {
    let mut found: BTreeMap<(Kind, String, String), Vec<Covered>> = BTreeMap::new();
    for j in own {
        for covered in coverage(j.case, &j.line.said) {
            found.entry((j.case.kind, covered.id.clone(), covered.name.clone())).or_default().push(covered);
        }
    }
    let away = |c: &Covered| (c.value - c.truth).abs() / (0.5 * (c.ci95[1] - c.ci95[0])).max(1e-300);
    found
        .into_iter()
        .map(|((kind, id, name), of)| Intervals {
            kind,
            id,
            name,
            cover: Proportion::over(of.iter().map(|c| c.covers)),
            worst: of.iter().filter(|c| !c.covers).map(away).fold(0.0, f64::max),
        })
        .collect()
}

fn agreement(all: &[Judged<'_>]) -> Vec<Agreement> {
    let origin = |j: &Judged<'_>| all.iter().find(|o| o.case.number == j.case.origin());
    Change::ALL
        .into_iter()
        .filter_map(|change| {
            let pairs: Vec<(usize, bool)> = all
                .iter()
                .filter(|j| j.case.change == Some(change))
                .filter_map(|j| {
                    let (a, b) = (&origin(j)?.line.said, &j.line.said);
                    Some((j.case.number, a.outcome == b.outcome && a.ids() == b.ids()))
                })
                .collect();
            (!pairs.is_empty()).then(|| Agreement {
                change,
                same: Proportion::over(pairs.iter().map(|p| p.1)),
                apart: pairs.iter().filter(|p| !p.1).map(|p| p.0).collect(),
            })
        })
        .collect()
}

/// The smallest value that a part of the values does not exceed.
fn quantile(values: impl Iterator<Item = f64>, part: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let at = (part * values.len() as f64).ceil() as usize;
    values.get(at.saturating_sub(1)).copied().unwrap_or(0.0)
}
