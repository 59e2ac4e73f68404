//! Which source owns how much of the position error: the same members, the same random numbers, one
//! source at a time.
//!
//! Sources that act by themselves are simulated alone; those that need the others (rounding,
//! saturation) are switched off, and own what the variance loses. Independent sources add up to the
//! whole; `rest` is what they do not.

use std::sync::Arc;

use crate::error::Result;
use crate::kernel::integrator::Integrator;
use crate::kernel::job::Job;
use crate::numerics::order;
use crate::sensor::source::ErrorSource;
use crate::statistics::{Statistics, quantity};
use crate::study::Study;

/// Members that are enough for a budget: the variance of each source to 2.2 %.
const ENOUGH_MEMBERS: u64 = 4096;

/// Contribution of one error source.
#[derive(Debug, Clone, PartialEq)]
pub struct Contribution {
    /// The source that contributes.
    pub source: ErrorSource,
    /// Position variance it owns, per time, m².
    pub variance_m2: Vec<f64>,
    /// Mean position error it makes alone, per time, m.
    pub mean_m: Vec<f64>,
}

/// Error budget: the contribution of each source to the position variance over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// Times from the end of the still start, s.
    pub time_s: Vec<f64>,
    /// Contributions, the largest at the last time first.
    pub contributions: Vec<Contribution>,
    /// Members it was made with.
    pub members: u64,
}

impl Budget {
    /// Fraction of the summed variance of all sources that this contribution makes at time `k`, 0
    /// to 1.
    pub fn fraction(&self, contribution: &Contribution, k: usize) -> f64 {
        let sum: f64 = self.contributions.iter().map(|s| s.variance_m2[k]).sum();
        if sum > 0.0 { contribution.variance_m2[k] / sum } else { 0.0 }
    }
}

/// The ensembles of a budget: the sensor whole, where a source needs the others, and each source by
/// itself.
struct Ensembles {
    whole: Option<Job>,
    sources: Vec<(ErrorSource, Job)>,
    members: u64,
}

impl Ensembles {
    fn of(study: &Study, integrator: Integrator, samples: &[u64]) -> Self {
        let members = study.members.min(ENOUGH_MEMBERS);
        let whole = Job { members, ..study.job(integrator, samples.to_vec()) };
        let is_present = |s: &ErrorSource| (0..members.min(256)).any(|m| s.is_on(&study.member(m).sensor));
        let sources: Vec<(ErrorSource, Job)> = ErrorSource::ALL
            .into_iter()
            .filter(is_present)
            .map(|source| {
                let change =
                    move |sensor: &_| if source.needs_the_others() { source.off(sensor) } else { source.alone(sensor) };
                let draw = whole.draw.clone();
                let draw = Arc::new(move |member| {
                    let mut member = draw(member);
                    member.sensor = change(&member.sensor);
                    member
                });
                let integrator = match source {
                    ErrorSource::Mechanics | ErrorSource::ForceNoise => integrator,
                    _ if source.needs_the_others() => integrator,
                    _ => Integrator::Ideal,
                };
                (source, Job { draw, integrator, ..whole.clone() })
            })
            .collect();
        let needed = sources.iter().any(|(source, _)| source.needs_the_others());
        Self { whole: needed.then_some(whole), sources, members }
    }
}

/// The ensembles that `make` asks for, in its order.
pub fn jobs(study: &Study, integrator: Integrator, samples: &[u64]) -> Vec<Job> {
    let Ensembles { whole, sources, .. } = Ensembles::of(study, integrator, samples);
    whole.into_iter().chain(sources.into_iter().map(|(_, job)| job)).collect()
}

/// Makes the budget. `run` integrates a job; `integrator` is the study's own.
///
/// # Errors
/// Whatever stops a run.
pub(crate) fn make(
    study: &Study,
    integrator: Integrator,
    samples: &[u64],
    mut run: impl FnMut(&Job, &str) -> Result<Statistics>,
) -> Result<Budget> {
    let Ensembles { whole, sources, members } = Ensembles::of(study, integrator, samples);
    let all_on = whole.map(|job| run(&job, "error budget: all")).transpose()?.map(|s| moments(&s));
    let mut contributions = Vec::new();
    let mut time_s = Vec::new();
    for (source, job) in sources {
        let statistics = run(&job, source.name())?;
        time_s.clone_from(&statistics.time_s);
        let (mean_m, mut variance_m2) = moments(&statistics);
        let mut mean_m = mean_m;
        if let (true, Some((all_mean, all_variance))) = (source.needs_the_others(), &all_on) {
            mean_m = all_mean.iter().zip(&mean_m).map(|(all, off)| all - off).collect();
            variance_m2 = all_variance.iter().zip(&variance_m2).map(|(all, off)| (all - off).max(0.0)).collect();
        }
        contributions.push(Contribution { source, variance_m2, mean_m });
    }
    // Force noise acts through the mechanics: take their own part out.
    let mechanics = contributions.iter().find(|s| s.source == ErrorSource::Mechanics).map(|s| s.variance_m2.clone());
    if let (Some(mechanics), Some(force)) =
        (mechanics, contributions.iter_mut().find(|s| s.source == ErrorSource::ForceNoise))
    {
        force.variance_m2.iter_mut().zip(mechanics).for_each(|(v, m)| *v = (*v - m).max(0.0));
    }
    order::sort_by_key(&mut contributions, |s| -s.variance_m2.last().unwrap_or(&0.0));
    Ok(Budget { time_s, contributions, members })
}

fn moments(statistics: &Statistics) -> (Vec<f64>, Vec<f64>) {
    let mean = statistics.series(quantity::POSITION, |s| s.mean);
    (mean, statistics.series(quantity::POSITION, |s| s.sd * s.sd))
}
