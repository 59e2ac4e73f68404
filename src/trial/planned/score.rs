//! States what the plans were worth: decisions, promises against them, samples. The public document of
//! `trial --plan --json`.

use serde::Serialize;

use super::line::{Line, Planned, Stage, Worth};
use super::pair::Left;
use super::run::Lines;
use crate::interval::{Proportion, median};

/// Promises of about one size and how often they were kept.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bin {
    /// Lowest and highest promise.
    pub promised: [f64; 2],
    /// Mean of the promises.
    pub mean: f64,
    /// Decided rightly.
    pub right: Proportion,
}

/// Decisions of sensors whose first recording was of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Reason for which the first recording left laws tied.
    pub left: Left,
    /// Plans that were recorded.
    pub plans: usize,
    /// Decided rightly.
    pub right: Proportion,
    /// Left open.
    pub open: usize,
    /// Sure of a law that is not there.
    pub wrong: usize,
}

/// The public document `proofmass.planned-trial/1`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// Always "proofmass.planned-trial/1".
    pub schema: &'static str,
    /// Seed of the trial.
    pub seed: u64,
    /// Sensors drawn.
    pub sensors: usize,
    /// SHA-256 of the sealed truth.
    pub truth_sha256: String,
    /// Sensors whose first recording left laws tied.
    pub open: usize,
    /// Those that no plan was made for.
    pub not_planned: usize,
    /// Of all plans: decided rightly.
    pub right: Proportion,
    /// Of plans that promise what was wished: decided rightly.
    pub right_of_reached: Proportion,
    /// Of all plans: sure of a law that is not there.
    pub wrong: Proportion,
    /// Of plans where no rival is the law: decided rightly.
    pub neither: Proportion,
    /// Mean square of promise minus decision (Brier, Monthly Weather Review 78, 1950).
    pub brier: f64,
    /// Mean of p(1 − p): what that would be if the promises held.
    pub brier_expected: f64,
    /// Samples of the experiment over those of the broadband multisine that the plan holds to be as good, the
    /// middle one; of those where there is none within the limits, zero.
    pub samples_ratio: f64,
    /// Of plans decided rightly: decided by a broadband multisine of twice the length too.
    pub by_twice_broadband: Proportion,
    /// Promises against decisions.
    pub promises: Vec<Bin>,
    /// Per first recording.
    pub left: Vec<Row>,
}

const BINS: [[f64; 2]; 5] = [[0.0, 0.2], [0.2, 0.5], [0.5, 0.8], [0.8, 0.95], [0.95, 1.0]];

impl Score {
    /// Counts.
    pub fn of(seed: u64, sensors: usize, lines: &Lines, sealed: &str) -> Self {
        let plans: Vec<(&Line, &Planned)> = lines.values().filter_map(planned).collect();
        let is_right = |p: &Planned| p.decided.worth == Worth::Right;
        let right = |of: &dyn Fn(&Line, &Planned) -> bool| {
            Proportion::over(plans.iter().filter(|(l, p)| of(l, p)).map(|(_, p)| is_right(p)))
        };
        let mean =
            |of: &dyn Fn(&Planned) -> f64| plans.iter().map(|(_, p)| of(p)).sum::<f64>() / plans.len().max(1) as f64;
        let ratio = |p: &Planned| p.broadband.map_or(0.0, |b| p.experiment.samples as f64 / b as f64);
        let within = |[low, high]: [f64; 2], p: &Planned| p.promised >= low && (p.promised < high || high == 1.0);
        Self {
            schema: "proofmass.planned-trial/1",
            seed,
            sensors,
            truth_sha256: sealed.to_owned(),
            open: lines.values().filter(|l| !matches!(l.stage, Stage::NotOpen { .. })).count(),
            not_planned: lines.values().filter(|l| matches!(l.stage, Stage::NotPlanned { .. })).count(),
            right: right(&|_, _| true),
            right_of_reached: right(&|_, p| p.reached),
            wrong: Proportion::over(plans.iter().map(|(_, p)| p.decided.worth == Worth::Wrong)),
            neither: right(&|l, p| !p.rivals.contains(&l.law)),
            brier: mean(&|p| (p.promised - f64::from(u8::from(is_right(p)))).powi(2)),
            brier_expected: mean(&|p| p.promised * (1.0 - p.promised)),
            samples_ratio: median(plans.iter().filter(|(_, p)| p.reached).map(|(_, p)| ratio(p))),
            by_twice_broadband: Proportion::over(
                plans.iter().filter(|(_, p)| is_right(p)).map(|(_, p)| p.twice_broadband.worth == Worth::Right),
            ),
            promises: BINS
                .into_iter()
                .map(|promised| {
                    let of: Vec<&Planned> = plans.iter().map(|(_, p)| *p).filter(|p| within(promised, p)).collect();
                    let mean = of.iter().map(|p| p.promised).sum::<f64>() / of.len().max(1) as f64;
                    Bin { promised, mean, right: Proportion::over(of.iter().map(|p| is_right(p))) }
                })
                .collect(),
            left: Left::ALL
                .into_iter()
                .map(|left| {
                    let count =
                        |worth| plans.iter().filter(|(l, p)| l.left == left && p.decided.worth == worth).count();
                    let right = right(&|l, _| l.left == left);
                    Row { left, plans: right.cases, right, open: count(Worth::Open), wrong: count(Worth::Wrong) }
                })
                .collect(),
        }
    }
}

fn planned(line: &Line) -> Option<(&Line, &Planned)> {
    if let Stage::Planned(planned) = &line.stage { Some((line, planned)) } else { None }
}
