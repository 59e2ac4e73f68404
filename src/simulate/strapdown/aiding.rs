//! Computes what a navigator makes of fixes: the gains by which they correct its errors, the same
//! for every member.
//!
//! A reset takes what is measured for the truth. A filter is the loosely coupled Kalman filter of
//! fifteen errors (Groves, *Principles of GNSS, Inertial, and Multisensor Integrated Navigation
//! Systems*, 2nd ed., §14.2): attitude, velocity, position, and the biases of accelerometers and
//! gyros. What else errs, such as scale factors, is considered but not estimated
//! (Schmidt, *Application of state-space methods to navigation problems*, 1966), with the study's
//! own numbers: no filter of these states is better informed. Its gains are for small errors; the
//! ensemble applies them whatever the errors are.

use nalgebra::SMatrix;

use super::covariance::{self, steps};
use super::family::{Column, Family, Gain, Process};
use super::gains::Gains;
use super::own_error;
use crate::error::Result;
use crate::kernel::aiding::{CORRECTED, Fix, SEEN};
use crate::kernel::flight::Flight;
use crate::study::Study;
use crate::study::aiding::Aiding;
use crate::study::file::AidingMethod;
use crate::study::in_motion::InMotion;

/// The ensemble of a study in motion, aided where the study says so and with the navigator's own error in every
/// member, with statistics at `report_samples`.
///
/// # Errors
/// A proof mass that no integrator can step.
pub fn flight(study: &Study, motion: &InMotion, report_samples: Vec<u64>) -> Result<Flight> {
    let mut flight = study.flight(motion, report_samples)?;
    if let Some(aiding) = &motion.aiding {
        flight.fixes = aiding.fixes.clone().into();
        flight.fixes = fixes(motion, &flight, aiding).into();
    }
    flight.own = own_error::own_error(motion, &flight).into();
    Ok(flight)
}

/// The fixes with their gains.
fn fixes(motion: &InMotion, flight: &Flight, aiding: &Aiding) -> Vec<Fix> {
    match aiding.method {
        AidingMethod::Reset => aiding.fixes.iter().map(reset).collect(),
        AidingMethod::Filter => filtered(motion, flight, aiding),
    }
}

/// Takes what is seen off in full.
fn reset(fix: &Fix) -> Fix {
    let mut fix = fix.clone();
    for (k, sd) in fix.sd.iter().enumerate() {
        fix.gain[3 + k][k] = if sd.is_some() { 1.0 } else { 0.0 };
    }
    fix
}

/// A filter's gains: the covariance is carried from fix to fix, and each is given those that leave
/// the least of it.
fn filtered(motion: &InMotion, flight: &Flight, aiding: &Aiding) -> Vec<Fix> {
    let stride = steps::stride(flight, covariance::FEWEST_STEPS);
    let (causes, _) = covariance::causes(motion, flight, stride);
    let mut known = Known { columns: Vec::new(), families: Vec::new() };
    for carried in causes {
        known.columns.extend(carried.columns);
        known.families.extend(one_phase(carried.families));
    }
    let mut fixes = aiding.fixes.clone();
    for stop in steps::steps(flight, stride).iter().filter(|stop| stop.goes_on()) {
        let step = stop.step();
        if stop.begins() {
            known.families.iter_mut().for_each(|family| family.renew(stop.number()));
        }
        known.columns.iter_mut().for_each(|column| column.advance(step, stop.begin_s()));
        known.families.iter_mut().for_each(|family| family.advance(step));
        if let Some(fix) = stop.fix().and_then(|number| fixes.get_mut(number)) {
            known.sees(fix, stop.begin_s() + step.seconds);
            let gains = Gains::of(fix);
            known.columns.iter_mut().for_each(|column| column.correct(&gains));
            known.families.iter_mut().for_each(|family| family.correct(&gains));
        }
    }
    fixes
}

/// Held processes with one phase for all: a filter need not know when they are renewed.
fn one_phase(families: Vec<Family>) -> Vec<Family> {
    let mut kept: Vec<Family> = Vec::new();
    for mut family in families {
        let held = |family: &Family| match family.process {
            Process::Held { every, .. } => Some(every),
            _ => None,
        };
        if held(&family).is_none() || kept.last().and_then(held) != held(&family) {
            family.share = 1.0;
            kept.push(family);
        }
    }
    kept
}

/// All that errs, as far as a fix has been taken.
struct Known {
    columns: Vec<Column>,
    families: Vec<Family>,
}

impl Known {
    /// Gives a fix Kalman's gains. What is taken off the readings grows by the bias that it tells
    /// of.
    fn sees(&self, fix: &mut Fix, time_s: f64) {
        let mut errors = SMatrix::<f64, 9, 9>::zeros();
        let mut biases = SMatrix::<f64, 6, 9>::zeros();
        for column in &self.columns {
            // A constant that is the same for all members is as little known to the filter.
            let square = column.variance + column.mean * column.mean;
            let bias = match column.gain {
                Gain::One(_) | Gain::Time(..) => column.gain.inputs(&Default::default(), time_s),
                _ => SMatrix::zeros(),
            };
            errors += column.state * column.state.transpose() * square;
            biases += (bias - column.taken) * column.state.transpose() * square;
        }
        for family in &self.families {
            errors += family.errors;
            biases += (family.with_process - family.with_taken).transpose();
        }
        let mut seen = SMatrix::<f64, 9, SEEN>::zeros();
        let mut variance = SMatrix::<f64, SEEN, SEEN>::identity();
        for (k, sd) in fix.sd.iter().enumerate() {
            if let Some(sd) = sd {
                seen[(3 + k, k)] = 1.0;
                variance[(k, k)] = sd * sd;
            }
        }
        let Some(inverse) = (seen.transpose() * errors * seen + variance).try_inverse() else { return };
        let (of_errors, of_biases) = (errors * seen * inverse, biases * seen * inverse);
        for row in 0..CORRECTED {
            fix.gain[row] =
                std::array::from_fn(|k| if row < 9 { of_errors[(row, k)] } else { of_biases[(row - 9, k)] });
        }
    }
}
