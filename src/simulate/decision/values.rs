//! The errors of the members themselves, at one time: what an ensemble's sums do not keep.
//!
//! Members are the study's own, so that the same ones come at every value of a key. On the CPU, in
//! f32, batch by batch.

use std::ops::Range;

use super::statistic::Limit;
use super::watched::{IN_MOTION, Watched};
use crate::backend::{cpu, flight};
use crate::control::{Control, Progress};
use crate::error::{Error, Result};
use crate::kernel::flight::Flight;
use crate::kernel::job::Job;
use crate::strapdown::aiding;
use crate::study::Study;

/// Members of the first look at a study.
pub const FIRST: u64 = 1024;
/// Most integration steps of one study along one axis, and along a trajectory: some minutes on two
/// cores.
pub(super) const MOST_STEPS: [u64; 2] = [20_000_000_000, 4_000_000_000];
/// Between these lies the most members of one study.
const MOST_MEMBERS: [u64; 2] = [1 << 18, 1 << 24];
/// Members that are integrated together.
const BATCH: u64 = 8192;

/// Quantity that is looked at, after this many samples from the end of the still start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// The error that is evaluated.
    pub quantity: Watched,
    /// Samples from the end of the still start.
    pub samples: u64,
}

impl Place {
    /// Returns where a requirement looks in a study.
    ///
    /// # Errors
    /// An error that the study does not have, a time outside the run.
    pub fn of(limit: &Limit, study: &Study) -> Result<Self> {
        limit.quantity.check(study)?;
        Ok(Self { quantity: limit.quantity, samples: Self::at(limit.time_s, study)? })
    }

    /// Most members of a study that is integrated up to here: those asked for, else some minutes'
    /// work.
    pub fn most_members(self, study: &Study, asked: Option<u64>) -> u64 {
        if let Some(most) = asked {
            return most.clamp(4 * FIRST, u64::from(u32::MAX)).next_multiple_of(256);
        }
        let steps = self.samples.saturating_mul(u64::from(study.clock.steps_per_sample));
        let [fewest, most] = MOST_MEMBERS;
        let [one_axis, in_motion] = MOST_STEPS;
        let most_steps = if study.in_motion.is_some() { in_motion } else { one_axis };
        (most_steps / steps.max(1)).clamp(fewest, most).next_multiple_of(256)
    }

    /// The sample at a time of a study.
    ///
    /// # Errors
    /// A time outside the run.
    pub fn at(time_s: f64, study: &Study) -> Result<u64> {
        let samples = (time_s / study.sample_s()).round();
        if samples < 1.0 || samples > study.clock.samples as f64 {
            return Err(Error::new(
                format!("could not evaluate at {time_s} s"),
                format!("{time_s} s lies outside the run of {} s", study.duration_s()),
                "give a time within the run, or a longer duration_s (--set duration_s=…)",
            ));
        }
        Ok(samples as u64)
    }
}

/// A study's ensemble up to one time, ready to integrate.
pub enum Run {
    /// Along one axis, with the samples of its still start counted.
    OneAxis(Job, u64),
    /// Along a trajectory.
    InMotion(Box<Flight>),
}

impl Run {
    /// Up to `samples` from the end of the still start.
    ///
    /// # Errors
    /// A member that cannot be stepped; an error that the study does not have.
    pub fn of(study: &Study, samples: u64, quantities: impl IntoIterator<Item = Watched>) -> Result<Self> {
        quantities.into_iter().try_for_each(|quantity| quantity.check(study))?;
        Ok(match &study.in_motion {
            Some(motion) => Self::InMotion(Box::new(aiding::flight(study, motion, vec![samples])?)),
            None => {
                let job = study.job(study.integrator()?.integrator, vec![samples]);
                let samples = samples + job.clock.still_samples;
                Self::OneAxis(job, samples)
            }
        })
    }

    /// Errors of members that begin at a multiple of 256 and fit the memory together, NaN of those
    /// that have failed.
    ///
    /// # Errors
    /// A member that cannot be stepped; stopped.
    pub fn several<const N: usize>(
        &self,
        quantities: [Watched; N],
        members: Range<u64>,
        control: &Control,
    ) -> Result<Vec<[f64; N]>> {
        match self {
            Self::InMotion(flight) => {
                let places = quantities.map(|quantity| IN_MOTION[quantity.place()].1.place());
                let rows = flight::outcomes(flight, members, control, &|_| {})?.pop().unwrap_or_default();
                Ok(rows.into_iter().map(|row| places.map(|at| row[at])).collect())
            }
            Self::OneAxis(job, samples) => {
                let rows = cpu::outcomes_at::<f32>(job, members, *samples, control)?;
                Ok(rows.into_iter().map(|row| quantities.map(|quantity| row[quantity.place()])).collect())
            }
        }
    }
}

/// Who watches, and the count of members that were integrated.
pub struct Work<'a> {
    control: &'a Control,
    progress: Progress,
    members: u64,
}

impl<'a> Work<'a> {
    /// Starts without any simulated values.
    pub fn new(control: &'a Control, name: &str) -> Self {
        Self { control, progress: control.stage(name, 0), members: 0 }
    }

    /// Members integrated so far, each as often as it was.
    pub fn members(&self) -> u64 {
        self.members
    }

    /// One error of each of these members, NaN of those that have failed. The range begins at a
    /// multiple of 256.
    ///
    /// # Errors
    /// A member that cannot be stepped; stopped.
    pub fn values(&mut self, study: &Study, place: Place, members: Range<u64>) -> Result<Vec<f64>> {
        let rows = self.several(study, place.samples, [place.quantity], members)?;
        Ok(rows.into_iter().map(|[value]| value).collect())
    }

    /// Returns several errors of each member at once, where [`Work::values`] returns one; `samples`
    /// counts from the end of the still start.
    ///
    /// # Errors
    /// As [`Work::values`]; an error that the study does not have.
    pub fn several<const N: usize>(
        &mut self,
        study: &Study,
        samples: u64,
        quantities: [Watched; N],
        members: Range<u64>,
    ) -> Result<Vec<[f64; N]>> {
        let run = Run::of(study, samples, quantities)?;
        self.batches(members, |batch, control| run.several(quantities, batch, control))
    }

    /// Returns what `integrate` gives for one batch after the other.
    fn batches<T>(
        &mut self,
        members: Range<u64>,
        mut integrate: impl FnMut(Range<u64>, &Control) -> Result<Vec<T>>,
    ) -> Result<Vec<T>> {
        let mut values = Vec::with_capacity((members.end - members.start) as usize);
        let mut from = members.start;
        while from < members.end {
            let until = members.end.min(from + BATCH);
            values.extend(integrate(from..until, self.control)?);
            self.members += until - from;
            self.progress.add(until - from);
            from = until;
        }
        Ok(values)
    }
}
