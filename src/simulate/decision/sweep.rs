//! Follows the drift of a study along one key, or over two: every value with the same members and
//! random numbers, and where a requirement is just met.

use super::require::{self, Crossed};
use super::statistic::{Limit, Statistic};
use super::values::Place;
use super::watched::Watched;
use crate::control::Control;
use crate::error::Result;
use crate::kernel::flight::Flight;
use crate::kernel::job::Job;
use crate::statistics::Estimate;
use crate::statistics::Summary;
use crate::strapdown::aiding;
use crate::study::{Assignment, Axis, Study, StudyText};

/// Axes of a sweep and an optional limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// One axis for a curve, two for a map.
    pub axes: Vec<Axis>,
    /// The requirement whose crossing is looked for.
    pub limit: Option<Limit>,
}

/// The study at one value of each key.
#[derive(Debug, Clone)]
pub struct Point {
    /// The values, in the order of the axes.
    pub values: Vec<f64>,
    /// Per report time, the errors in the order of [`Sweep::quantities`].
    pub at: Vec<Vec<Summary>>,
    /// The statistic that is followed.
    pub statistic: Estimate,
    /// Members excluded from the statistics because they failed.
    pub failed: u64,
}

/// Crossing along the first key at which the requirement is just met.
#[derive(Debug, Clone, PartialEq)]
pub struct Crossing {
    /// Value of the second key, on a map.
    pub other: Option<f64>,
    /// Value of the first, its interval, and on which side of it the requirement is met.
    pub crossed: Crossed,
}

/// A finished sweep: the errors at each point and where they cross the limit.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// Plan of the sweep.
    pub plan: Plan,
    /// Report times from the end of the still start, s.
    pub time_s: Vec<f64>,
    /// Statistic that is followed: the limit's, else how far the study has drifted at the last
    /// report time.
    pub followed: Followed,
    /// The errors of each point.
    pub quantities: Vec<Watched>,
    /// The values of the first key run fastest.
    pub points: Vec<Point>,
    /// Crossings of the limit, in the order of the second key.
    pub crossings: Vec<Crossing>,
    /// Members at every point.
    pub members: u64,
}

/// A statistic of a quantity at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Followed {
    /// Statistic that is swept.
    pub statistic: Statistic,
    /// The error that the statistic is taken of.
    pub quantity: Watched,
    /// Time at which it is taken, from the end of the still start, s.
    pub time_s: f64,
}

impl Followed {
    /// Returns what is followed where no limit is given: the standard deviation of position, along
    /// a trajectory the circle that holds half of the members.
    fn usual(study: &Study, time_s: f64) -> Self {
        let statistic = if study.in_motion.is_some() { Statistic::Circular(0.50) } else { Statistic::Sd };
        Self { statistic, quantity: Watched::drift(study), time_s }
    }
}

/// An ensemble at one point.
pub enum Work<'a> {
    /// A study along one axis.
    OneAxis(&'a Job),
    /// A study in six axes along a trajectory.
    InMotion(&'a Flight),
}

/// An ensemble reduced to summaries.
pub struct Summed {
    /// Per report time, the errors in the order of [`Watched::all`].
    pub at: Vec<Vec<Summary>>,
    /// Members excluded from the summaries because they failed.
    pub failed: u64,
}

/// Sweeps. `run` integrates the ensemble of a point.
///
/// # Errors
/// A key that the study does not have, a value that it refuses, a time outside the run; whatever
/// stops a run.
pub fn run(
    source: &StudyText,
    plan: &Plan,
    control: &Control,
    mut run: impl FnMut(Work<'_>) -> Result<Summed>,
) -> Result<Sweep> {
    let study = source.study()?;
    let last_s = study.clock.report_samples.last().map_or(study.duration_s(), |n| *n as f64 * study.sample_s());
    let followed = match &plan.limit {
        Some(Limit { statistic, quantity, time_s, .. }) => {
            quantity.check(&study)?;
            Followed { statistic: *statistic, quantity: *quantity, time_s: *time_s }
        }
        None => Followed::usual(&study, last_s),
    };
    let quantities = Watched::all(&study);
    let mut points = Vec::new();
    for values in grid(&plan.axes) {
        let set: Vec<Assignment> =
            plan.axes.iter().zip(&values).map(|(axis, value)| Assignment::number(&axis.key, *value)).collect();
        let here = source.with(&set)?;
        let followed_at = Place::at(followed.time_s, &here)?;
        let mut samples = here.clock.report_samples.clone();
        samples.push(followed_at);
        samples.sort_unstable();
        samples.dedup();
        let summed = match &here.in_motion {
            Some(motion) => run(Work::InMotion(&aiding::flight(&here, motion, samples.clone())?))?,
            None => run(Work::OneAxis(&here.job(here.integrator()?.integrator, samples.clone())))?,
        };
        let summaries = |sample: &u64| samples.binary_search(sample).ok().and_then(|k| summed.at.get(k).cloned());
        let Some(there) = summaries(&followed_at) else { continue };
        points.push(Point {
            statistic: followed.statistic.summarised(&there[followed.quantity.place()]),
            at: here.clock.report_samples.iter().filter_map(summaries).collect(),
            values,
            failed: summed.failed,
        });
    }
    let crossings = match &plan.limit {
        Some(limit) => crossings(source, plan, limit, &points, control)?,
        None => Vec::new(),
    };
    let time_s = study.clock.report_samples.iter().map(|sample| *sample as f64 * study.sample_s()).collect();
    Ok(Sweep { plan: plan.clone(), time_s, followed, quantities, points, crossings, members: study.members })
}

/// The values of all keys at every point, those of the first key fastest.
fn grid(axes: &[Axis]) -> Vec<Vec<f64>> {
    axes.iter().rev().fold(vec![Vec::new()], |points: Vec<Vec<f64>>, axis| {
        let values = axis.values();
        points.iter().flat_map(|point| values.iter().map(|v| [&[*v], &point[..]].concat())).collect()
    })
}

/// Between neighbouring values of the first key of which one meets the limit, the crossing.
fn crossings(
    source: &StudyText,
    plan: &Plan,
    limit: &Limit,
    points: &[Point],
    control: &Control,
) -> Result<Vec<Crossing>> {
    let Some(first) = plan.axes.first() else { return Ok(Vec::new()) };
    let mut found = Vec::new();
    for row in points.chunks(first.points) {
        let meets = |point: &Point| point.statistic.value < limit.below;
        for pair in row.windows(2).filter(|pair| meets(&pair[0]) != meets(&pair[1])) {
            let other = pair[0].values.get(1).copied();
            let fixed: Vec<Assignment> = plan
                .axes
                .get(1)
                .zip(other)
                .map(|(axis, value)| Assignment::number(&axis.key, value))
                .into_iter()
                .collect();
            let ends = [pair[0].values[0], pair[1].values[0]];
            let between = require::Between { source, fixed, key: &first.key, limit, ends };
            found.push(Crossing { other, crossed: between.crossing(meets(&pair[0]), control)? });
        }
    }
    Ok(found)
}
