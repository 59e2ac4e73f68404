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
use crate::numerics::moments::mean_sd;
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

/// Mean and variance of what each of the linear model's quantities loses, over the members that failed in neither run.
fn moments(all: &[[f64; QUANTITIES]], rest: &[[f64; QUANTITIES]]) -> ([f64; 9], [f64; 9]) {
    let (mut mean, mut variance) = ([0.0; 9], [0.0; 9]);
    for place in 0..9 {
        let lost = all.iter().zip(rest).map(|(all, rest)| all[place] - rest[place]);
        let lost: Vec<f64> = lost.filter(|lost| lost.is_finite()).collect();
        let (count, (of, sd)) = (lost.len().max(2) as f64, mean_sd(&lost));
        (mean[place], variance[place]) = (of, sd * sd * count / (count - 1.0));
    }
    (mean, variance)
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
