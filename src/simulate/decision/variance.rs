//! `study --variance`: whose variance the last position error has, source by source: alone, with its
//! interactions, and in the mean over the orders in which sources are added.
//!
//! Where the error budget has one source at a time, which of sources that act on each other leaves
//! out what they do together, here the whole sensor is simulated with one source's draws, or
//! several's, from a second sample (`statistics::sensitivity`). Along a trajectory it is the variance
//! of the north error plus that of the east error.

use std::sync::Arc;

use serde::Serialize;

use super::values::Work;
use super::watched::Watched;
use crate::control::Control;
use crate::error::{Error, Result};
use crate::numerics::order;
use crate::statistics::quantity;
use crate::statistics::sensitivity::{Design, Groups, Share};
use crate::study::Study;
use crate::study::groups::Group;
use crate::study::second::{Second, Slots};

/// Most members that it is found with: a share of a half is then known to ±0.011 (two standard
/// errors of a correlation, (1 − ρ²)/√n), and the ensembles are some dozens.
const ENOUGH_MEMBERS: u64 = 16_384;

/// The variance of the last position error, shared among the sources.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Variance {
    /// Error that varies: `position_error_m`, or `position_error_ned_m` in the horizontal plane.
    pub quantity: &'static str,
    /// Time of it, s.
    pub time_s: f64,
    /// Members it was found with.
    pub members: u64,
    /// Standard deviation whose square is shared, m.
    pub sd_m: f64,
    /// Sources, the largest Shapley share first.
    pub sources: Vec<Source>,
}

/// The shares of one source.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Source {
    /// Name as in the error budget.
    pub source: &'static str,
    /// Sources that it holds, where their random numbers cannot be told apart.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub holds: Vec<&'static str>,
    /// Shares of the variance.
    #[serde(flatten)]
    pub share: Share,
}

/// Refuses a study whose members are all alike.
///
/// # Errors
/// It is one.
pub fn check(study: &Study) -> Result<()> {
    match study.groups().is_empty() {
        true => Err(alike(study)),
        false => Ok(()),
    }
}

fn alike(study: &Study) -> Error {
    Error::new(
        format!("could not share the variance of {}", study.name),
        "all members have the same position error: nothing that reaches it is drawn, and there is no noise",
        "give a number a spread, e.g. --set 'accelerometer.bias_mg={ mean = 0.0, sd = 1.0 }'",
    )
}

/// Shares the variance of the study's last position error among its sources.
///
/// # Errors
/// As [`check`], also of what is drawn and has no effect; a member that cannot be stepped; stopped.
pub fn variance(study: &Study, control: &Control) -> Result<Variance> {
    match &study.in_motion {
        None => of([Watched::OneAxis(quantity::POSITION)], "position_error_m", study, control),
        Some(_) => of([Watched::InMotion(0), Watched::InMotion(1)], "position_error_ned_m", study, control),
    }
}

fn of<const N: usize>(
    watched: [Watched; N],
    quantity: &'static str,
    study: &Study,
    control: &Control,
) -> Result<Variance> {
    check(study)?;
    let groups = study.groups();
    let design = Design { groups: groups.len(), seed: study.seed };
    let samples = study.clock.report_samples.last().copied().unwrap_or(study.clock.samples);
    let mut ensembles =
        Ensembles { study, groups: &groups, design, watched, samples, work: Work::new(control, "variance") };
    let results: Vec<Vec<[f64; N]>> =
        (0..design.ensembles()).map(|ensemble| ensembles.results(ensemble)).collect::<Result<_>>()?;
    let shares = design.shares(&results).ok_or_else(|| alike(study))?;
    let source = |(group, share): (Group, Share)| Source { source: group.name, holds: group.holds, share };
    let mut sources: Vec<Source> = groups.iter().cloned().zip(shares.groups).map(source).collect();
    order::sort_by_key(&mut sources, |source| -source.share.shapley.value);
    Ok(Variance {
        quantity,
        time_s: samples as f64 * study.sample_s(),
        members: shares.members,
        sd_m: shares.variance.sqrt(),
        sources,
    })
}

/// The ensembles of a design, as a study simulates them.
struct Ensembles<'a, const N: usize> {
    study: &'a Study,
    groups: &'a [Group],
    design: Design,
    watched: [Watched; N],
    samples: u64,
    work: Work<'a>,
}

impl<const N: usize> Ensembles<'_, N> {
    fn results(&mut self, ensemble: usize) -> Result<Vec<[f64; N]>> {
        let (members, design) = (self.study.members.min(ENOUGH_MEMBERS), self.design);
        let in_run = self.groups.iter().position(|group| group.in_run);
        let has_second_noise = move |member| in_run.is_some_and(|noise| holds(design.taken(ensemble, member), noise));
        let with = (0..members).filter(|member| has_second_noise(*member)).count() as u64;
        // Members of an ensemble have one seed for all their noise. Where each has an order of its
        // own, some of them are due both.
        Ok(match with {
            0 => self.simulated(ensemble, members, false)?,
            all if all == members => self.simulated(ensemble, members, true)?,
            _ => {
                let first = self.simulated(ensemble, members, false)?;
                let second = self.simulated(ensemble, members, true)?;
                let pairs = (0..members).zip(first.into_iter().zip(second));
                pairs.map(|(member, (first, second))| if has_second_noise(member) { second } else { first }).collect()
            }
        })
    }

    fn simulated(&mut self, ensemble: usize, members: u64, in_run: bool) -> Result<Vec<[f64; N]>> {
        let (design, slots) = (self.design, self.groups.iter().map(|group| group.slots).collect::<Vec<Slots>>());
        let taken = move |member: u64| {
            let groups = design.taken(ensemble, member);
            let held = slots.iter().enumerate().filter(|(group, _)| holds(groups, *group));
            held.fold(0, |taken, (_, slots)| taken | slots)
        };
        let study = self.study.with_second(Second { taken: Arc::new(taken), in_run });
        self.work.several(&study, self.samples, self.watched, 0..members)
    }
}

fn holds(groups: Groups, group: usize) -> bool {
    (groups >> group) & 1 == 1
}
