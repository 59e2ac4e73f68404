//! States what a trial found: rates, families, confusion, detection limits, coverage; the public
//! document of `trial --json`.

use std::collections::BTreeMap;

use serde::Serialize;

use super::blind::Verdicts;
use super::case::{Case, Family};
use super::interval::{Power, Proportion, median};
use super::judge::{self, Covered, Mark};
use super::said::Said;
use proofmass_diagnosis::candidate::Kind;

/// If the limit of an effect was never found, cases of at least this size over the noise
/// count as above it.
pub(crate) const FALLBACK_LIMIT: f64 = 3.0;

/// Rates of one family.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Name of the family.
    pub name: String,
    /// Number of cases.
    pub cases: usize,
    /// Proportion with the planted effects named, alone or in a tie of two; for nulls, silent; for
    /// unknown physics, flagged.
    pub named_correctly: f64,
    /// Proportion in which a false name was given with confidence.
    pub confidently_wrong: f64,
    /// Proportion that said nothing was missing.
    pub silent: f64,
    /// Proportion that saw a mismatch and gave it no full explanation: unexplained, or undecided.
    pub unnamed: f64,
}

/// A combination of planted effects and verdict, with its count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Confusion {
    /// Kind of recording.
    pub kind: Kind,
    /// Planted effects, joined by " + "; "nothing" for a null.
    pub planted: String,
    /// Named effects, a tie joined by " | ", or the outcome where nothing was named.
    pub said: String,
    /// Number of such cases.
    pub cases: usize,
}

/// An effect planted alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Planted {
    /// Visible rms over noise rms.
    pub size: f64,
    /// States whether a mismatch was noticed.
    pub noticed: bool,
    /// States whether it was named, alone or with one other.
    pub named: bool,
}

/// Holds what became of one kind of physics that the library does not know.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unknown {
    /// Description of the planted physics.
    pub what: String,
    /// Number of recordings with it.
    pub cases: usize,
    /// Recordings called unexplained.
    pub flagged: usize,
    /// Of those, with the name of a candidate that carries part of it.
    pub partly_named: usize,
    /// Given a name as if that explained it.
    pub named: usize,
}

/// Detection limit of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Limit {
    /// Kind of recording: an id may stand in several.
    pub kind: Kind,
    /// Library id of the effect.
    pub id: String,
    /// Visible rms over noise rms that is noticed in nine of ten recordings; null where it was
    /// never, or always, noticed.
    pub effect_over_noise: Option<f64>,
    /// 95 % interval of that size.
    pub ci95: Option<[f64; 2]>,
    /// Smallest and largest size tried.
    pub tried: [f64; 2],
    /// Proportion noticed over all sizes tried.
    pub noticed: f64,
    /// Every case in which it was planted alone, with its size.
    #[serde(skip)]
    pub cases: Vec<Planted>,
}

/// The public document of `trial --json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// Number of cases.
    pub cases: usize,
    /// Proportion of library effects named correctly, of the cases above their detection limit.
    pub named_correctly: f64,
    /// Recordings with nothing planted in which something was found.
    pub false_alarm_rate: Proportion,
    /// Proportion of foreign physics that was called unexplained.
    pub unknown_flagged: f64,
    /// Proportion of 95 % intervals that hold the planted value.
    pub interval_coverage: f64,
    /// One row per family.
    pub families: Vec<Row>,
    /// Every combination that occurred.
    pub confusion: Vec<Confusion>,
    /// Detection limits, one per effect.
    pub detection_limit: Vec<Limit>,
    /// Per kind of physics foreign to the library.
    pub unknown: Vec<Unknown>,
    /// Median share of the removable held-out error that the named physics removed, where it was
    /// named correctly.
    pub held_out_gain: f64,
    /// Median and largest time per verdict.
    pub seconds_per_case: [f64; 2],
    /// Verdicts that gave a false name with confidence, as a share of all cases.
    pub confidently_wrong: f64,
    /// Diagnoses that stopped with an error, as a share of all cases.
    pub errors: f64,
    /// Foreign physics given a library name with confidence.
    pub unknown_named: f64,
    /// SHA-256 of the sealed truth.
    pub truth_sha256: String,
    /// The share behind `named_correctly`.
    #[serde(skip)]
    pub named: Proportion,
    /// The share behind `unknown_flagged`.
    #[serde(skip)]
    pub flagged: Proportion,
    /// The share behind `interval_coverage`.
    #[serde(skip)]
    pub coverage: Proportion,
    /// Intervals compared with planted values.
    #[serde(skip)]
    pub covered: Vec<Covered>,
}

/// Sizes below this, over the noise, are none: a stop that is never touched.
const SMALLEST_SIZE: f64 = 1e-3;

struct Judged<'a> {
    case: &'a Case,
    said: &'a Said,
    mark: Mark,
    /// Planted by the library's own kind of physics.
    library: bool,
}

impl Outcome {
    /// Scores the verdicts against the opened truth.
    pub fn of(cases: &[Case], verdicts: &Verdicts, truth_sha256: &str) -> Self {
        let judged: Vec<Judged<'_>> = cases
            .iter()
            .filter_map(|case| {
                let said = verdicts.get(&case.number)?;
                Some(Judged { case, said, mark: judge::judge(case, said), library: case.in_library() })
            })
            .collect();
        let nulls = || judged.iter().filter(|j| j.case.planted().is_empty());
        let foreign = || judged.iter().filter(|j| !j.library);
        let planted = || judged.iter().filter(|j| j.library && !j.case.planted().is_empty());
        let limits = limits(&judged);
        let limit_of = |kind: Kind, id: &str| {
            limits.iter().find(|l| l.kind == kind && l.id == id).map_or(FALLBACK_LIMIT, Limit::threshold)
        };
        let above = |j: &Judged<'_>| {
            let sizes = j.case.sizes_over_noise();
            sizes.iter().all(|(id, size)| *size >= limit_of(j.case.kind(), id))
        };
        let covered: Vec<Covered> = planted().flat_map(|j| judge::coverage(j.case, j.said)).collect();
        let gain = |j: &Judged<'_>| {
            let [before, after, floor] = j.said.rmse;
            let removable = before * before - floor * floor;
            // Noise terms change no simulation; where nothing is removable there is no gain to
            // speak of.
            (removable > 0.1 * floor * floor).then(|| (before * before - after * after) / removable)
        };
        let named = Proportion::over(planted().filter(|j| above(j)).map(|j| j.mark.is_named()));
        let flagged = Proportion::over(foreign().map(|j| j.mark == Mark::Unexplained));
        let coverage = Proportion::over(covered.iter().map(|c| c.covers));
        Self {
            cases: judged.len(),
            named_correctly: named.value,
            false_alarm_rate: Proportion::over(nulls().map(|j| judge::is_alarm(j.said))),
            unknown_flagged: flagged.value,
            interval_coverage: coverage.value,
            families: rows(&judged),
            confusion: confusion(&judged),
            held_out_gain: median(planted().filter(|j| j.mark == Mark::Named).filter_map(gain)),
            seconds_per_case: [
                median(judged.iter().map(|j| j.said.seconds)),
                judged.iter().map(|j| j.said.seconds).fold(0.0, f64::max),
            ],
            confidently_wrong: Proportion::over(judged.iter().map(|j| j.mark.is_confidently_wrong())).value,
            errors: Proportion::over(judged.iter().map(|j| j.mark == Mark::Error)).value,
            unknown_named: Proportion::over(foreign().map(|j| j.mark.is_confidently_wrong())).value,
            truth_sha256: truth_sha256.into(),
            detection_limit: limits,
            unknown: unknown(&judged),
            named,
            flagged,
            coverage,
            covered,
        }
    }
}

impl Limit {
    /// Size from which a case counts as above the limit.
    pub fn threshold(&self) -> f64 {
        match self.effect_over_noise {
            Some(limit) => limit,
            // Always noticed: every size tried is above the limit.
            None if self.noticed == 1.0 => self.tried[0],
            None => FALLBACK_LIMIT,
        }
    }
}

fn rows(judged: &[Judged<'_>]) -> Vec<Row> {
    Family::ALL
        .into_iter()
        .filter_map(|family| {
            let of: Vec<&Judged<'_>> = judged.iter().filter(|j| j.case.family == family).collect();
            let proportion = |right: &dyn Fn(&Judged<'_>) -> bool| Proportion::over(of.iter().map(|j| right(j))).value;
            let right = |j: &Judged<'_>| match (j.library, j.case.planted().is_empty()) {
                (_, true) => j.mark == Mark::Silent,
                (true, _) => j.mark.is_named(),
                (false, _) => j.mark == Mark::Unexplained,
            };
            (!of.is_empty()).then(|| Row {
                name: family.name().into(),
                cases: of.len(),
                named_correctly: proportion(&right),
                confidently_wrong: proportion(&|j| j.mark.is_confidently_wrong()),
                silent: proportion(&|j| j.mark == Mark::Silent),
                unnamed: proportion(&|j| matches!(j.mark, Mark::Unexplained | Mark::Undecided)),
            })
        })
        .collect()
}

fn confusion(judged: &[Judged<'_>]) -> Vec<Confusion> {
    let mut counts: BTreeMap<(&str, String, String), (Kind, usize)> = BTreeMap::new();
    for j in judged {
        let planted = j.case.planted();
        let planted = if planted.is_empty() { "nothing".into() } else { planted.join(" + ") };
        let groups: Vec<String> = j.said.groups.iter().map(|g| g.join(" | ")).collect();
        let said = if groups.is_empty() { j.said.outcome.name().to_owned() } else { groups.join(" + ") };
        let kind = j.case.kind();
        counts.entry((kind.name(), planted, said)).or_insert((kind, 0)).1 += 1;
    }
    counts.into_iter().map(|((_, planted, said), (kind, cases))| Confusion { kind, planted, said, cases }).collect()
}

fn limits(judged: &[Judged<'_>]) -> Vec<Limit> {
    let single = |j: &&Judged<'_>| j.library && j.case.planted().len() == 1;
    let of = |j: &Judged<'_>| (j.case.kind().name(), j.case.planted().swap_remove(0));
    let kinds: BTreeMap<(&str, String), Kind> = judged.iter().filter(single).map(|j| (of(j), j.case.kind())).collect();
    kinds
        .into_iter()
        .map(|(key, kind)| {
            let cases: Vec<Planted> = judged
                .iter()
                .filter(single)
                .filter(|j| of(j) == key)
                .map(|j| Planted {
                    size: j.case.sizes_over_noise()[0].1,
                    noticed: judge::is_detected(j.said),
                    named: j.mark.is_named(),
                })
                // What a recording does not show at all has no size to be noticed at.
                .filter(|case| case.size > SMALLEST_SIZE)
                .collect();
            let power = Power::fit(&cases.iter().map(|c| (c.size, c.noticed)).collect::<Vec<_>>());
            let sizes = || cases.iter().map(|c| c.size);
            Limit {
                kind,
                id: key.1,
                effect_over_noise: power.as_ref().map(|p| p.best.size_at(0.9)),
                ci95: power.as_ref().map(|p| p.size_ci95(0.9)),
                tried: [sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max)],
                noticed: Proportion::over(cases.iter().map(|c| c.noticed)).value,
                cases,
            }
        })
        .filter(|limit| !limit.cases.is_empty())
        .collect()
}

fn unknown(judged: &[Judged<'_>]) -> Vec<Unknown> {
    let mut kinds: BTreeMap<String, Unknown> = BTreeMap::new();
    for j in judged.iter().filter(|j| !j.library) {
        let what = j.case.foreign_words().join("; ");
        let none = Unknown { what: what.clone(), cases: 0, flagged: 0, partly_named: 0, named: 0 };
        let kind = kinds.entry(what).or_insert(none);
        kind.cases += 1;
        kind.flagged += usize::from(j.mark == Mark::Unexplained);
        kind.partly_named += usize::from(j.mark == Mark::Unexplained && !j.said.groups.is_empty());
        kind.named += usize::from(j.mark.is_confidently_wrong());
    }
    kinds.into_values().collect()
}
