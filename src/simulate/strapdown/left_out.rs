//! Computes what the causes do that the linear model has no place for: by how much the errors of the same members
//! change, with the same random numbers, once one of these is taken away.

use std::sync::Arc;

use super::covariance::{Cause, Part};
use crate::backend::flight::{QUANTITIES, outcomes};
use crate::control::Control;
use crate::error::Result;
use crate::kernel::flight::Flight;
use crate::kernel::job::Integrator;
use crate::kernel::truth_step::Along;
use crate::sensor::coupling;
use crate::sensor::source::ErrorSource;

/// Members that are enough: a standard deviation is then known to 4 %.
const ENOUGH_MEMBERS: u64 = 256;

/// Their parts of the error at the report samples of a flight, in the order of `causes`.
///
/// # Errors
/// A member that cannot be stepped; stopped.
pub fn parts(flight: &Flight, causes: &[Cause], control: &Control) -> Result<Vec<Part>> {
    if causes.is_empty() {
        return Ok(Vec::new());
    }
    let members = flight.members().min(ENOUGH_MEMBERS);
    let runs = members.saturating_mul(flight.clock().samples);
    let progress = control.stage("error budget", runs.saturating_mul(causes.len() as u64 + 1));
    let run = |flight: &Flight| outcomes(flight, 0..members, control, &|samples| progress.add(samples));
    let all = run(flight)?;
    let part = |cause: &Cause| {
        let rest = run(&without(*cause, flight))?;
        let (mean, variance) = all.iter().zip(&rest).map(|(all, rest)| moments(all, rest)).unzip();
        Ok(Part { cause: *cause, mean, variance })
    };
    causes.iter().map(part).collect()
}

/// Mean and variance, per quantity of the linear model, of what members err more in the first than in the second; of
/// those that failed in neither.
fn moments(all: &[[f64; QUANTITIES]], rest: &[[f64; QUANTITIES]]) -> ([f64; 9], [f64; 9]) {
    let more = |place: usize| {
        let more = all.iter().zip(rest).map(move |(all, rest)| all[place] - rest[place]);
        more.filter(|more| more.is_finite())
    };
    let mean = |place: usize| more(place).sum::<f64>() / more(place).count().max(1) as f64;
    let variance = |place: usize| {
        let mean = mean(place);
        more(place).map(|more| (more - mean).powi(2)).sum::<f64>() / (more(place).count().max(2) - 1) as f64
    };
    (std::array::from_fn(mean), std::array::from_fn(variance))
}

/// The same flight without one cause; as it is where the cause is none of a sensor's or of its surroundings.
fn without(cause: Cause, flight: &Flight) -> Flight {
    let mut flight = flight.clone();
    match cause {
        Cause::Sensor(source) => flight.axes.iter_mut().for_each(|axis| {
            let draw = axis.draw.clone();
            axis.draw = Arc::new(move |member| {
                let mut member = draw(member);
                member.sensor = source.off(&member.sensor);
                member
            });
            if source == ErrorSource::Mechanics {
                axis.integrator = Integrator::Ideal;
            }
        }),
        Cause::Coupling(key) if *key == coupling::GYRO_RANGE => {
            if let Some(follow) = flight.follow.take() {
                flight.follow = Some(Arc::new(move |member| {
                    let mut follow = follow(member);
                    follow.gyro_range_rad_s = [f64::INFINITY; 3];
                    follow
                }));
            }
        }
        Cause::Vibration => {
            let (truth, [standing, _]) = (flight.course.truth.clone(), flight.course.standing());
            for (axis, job) in flight.axes.iter_mut().enumerate() {
                let (truth, standing_m_s2) = (truth.clone(), standing[axis]);
                job.waveform = Arc::new(Along { truth, axis, standing_m_s2, vibration: None });
            }
        }
        Cause::Coupling(_) | Cause::Alignment | Cause::Fixes | Cause::Mechanisation => {}
    }
    flight
}
