//! The covariance of the linear error model, source by source, in f64: what the ensemble's spread
//! must be as long as errors are small, and where it comes from.
//!
//! Left out, and simulated in `left_out`: rounding, saturation, vibration and the proof mass' own lag and springs, which no
//! linear model has, and what is slow by a time that is drawn per member.

pub mod found;
pub mod given;
mod slow;
pub mod steps;

use super::family::{Column, Family, Process};
use crate::kernel::flight::Flight;
use crate::parallel;
use crate::sensor::source::ErrorSource;
use crate::sensor::{Sense, coupling};
use crate::study::in_motion::InMotion;
use crate::units::key::Key;
use found::Found;
use given::Given;
use steps::Errors;

/// Source of an error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cause {
    /// A sensor on each axis.
    Sensor(ErrorSource),
    /// Part that a reading takes from other axes or instruments.
    Coupling(&'static Key),
    /// The heading at the start, and without a still start the tilt.
    Alignment,
    /// Noise of the measurements that aid the navigation.
    Fixes,
    /// The navigator itself, on perfect readings.
    Mechanisation,
    /// Vibration, which squares and limits of a reading rectify.
    Vibration,
}

impl Cause {
    /// Its name in tables and figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sensor(source) => source.name(),
            Self::Coupling(key) => key.name,
            Self::Alignment => "initial attitude",
            Self::Fixes => "noise of the fixes",
            Self::Mechanisation => "navigator's integration",
            Self::Vibration => "vibration",
        }
    }
}

/// Effect of one cause.
#[derive(Debug, Clone)]
pub struct Part {
    /// Error source.
    pub cause: Cause,
    /// Per report time, position (m), velocity (m/s), and roll, pitch and heading (rad): mean of
    /// each.
    pub mean: Vec<[f64; 9]>,
    /// Variance of the nine errors at each report time, squared SI units.
    pub variance: Vec<[f64; 9]>,
}

/// The covariance at the report times.
#[derive(Debug, Clone)]
pub struct Covariance {
    /// Contribution of each error source.
    pub parts: Vec<Part>,
    /// Causes that it has no place for.
    pub left_out: Vec<Cause>,
}

impl Part {
    /// Mean square of one of the nine errors at a report time, squared SI units.
    pub fn mean_square(&self, report: usize, quantity: usize) -> f64 {
        self.variance[report][quantity] + self.mean[report][quantity].powi(2)
    }

    /// Mean of the squared horizontal distance from the truth that it makes at a report time, m².
    pub fn horizontal_m2(&self, report: usize) -> f64 {
        (0..2).map(|axis| self.mean_square(report, axis)).sum()
    }

    /// Root mean square of the error down, m.
    pub fn down_m(&self, report: usize) -> f64 {
        self.mean_square(report, 2).sqrt()
    }
}

impl Covariance {
    /// Variance of one of the nine at a report time, all causes together.
    pub fn variance(&self, report: usize, quantity: usize) -> f64 {
        self.parts.iter().map(|part| part.variance[report][quantity]).sum()
    }

    /// Mean of an error at a report time, SI.
    pub fn mean(&self, report: usize, quantity: usize) -> f64 {
        self.parts.iter().map(|part| part.mean[report][quantity]).sum()
    }
}

/// One cause, as the covariance carries it.
pub struct Carried {
    /// Error source.
    pub cause: Cause,
    /// Errors that stay constant during a run.
    pub columns: Vec<Column>,
    /// Noise processes.
    pub families: Vec<Family>,
    /// Mean squares of a sensor's coefficient at the six inputs, SI.
    pub squares: [f64; 6],
}

/// Fewest steps of a run, so that a step resolves it.
pub(super) const FEWEST_STEPS: u64 = 1500;

/// The error sources of a flight for steps of `stride` samples, and those that the linear model
/// does not represent.
pub fn causes(motion: &InMotion, flight: &Flight, stride: u64) -> (Vec<Carried>, Vec<Cause>) {
    let found = (flight.clock().still_samples > 0).then(|| found::found(flight));
    let found: Option<&Found> = found.as_ref();
    let (mut causes, mut left_out) = (Vec::new(), Vec::new());
    let step_s = stride as f64 * flight.clock().sample_s();
    for source in ErrorSource::ALL {
        let Some(given) = Given::of(source, motion) else { continue };
        let cause = Cause::Sensor(source);
        match given.built(flight, found, stride, step_s) {
            Some((columns, families)) => {
                causes.push(Carried {
                    cause,
                    columns,
                    families,
                    squares: given.squares(if source.is_gyro() { Sense::Gyro } else { Sense::Accelerometer }),
                });
            }
            None => left_out.push(cause),
        }
    }
    if motion.between.iter().any(|axis| axis[&coupling::GYRO_RANGE].is_some()) {
        left_out.push(Cause::Coupling(&coupling::GYRO_RANGE));
    }
    for key in coupling::KEYS {
        let columns = given::couplings(key, motion, found, flight);
        if !columns.is_empty() {
            causes.push(Carried { cause: Cause::Coupling(key), columns, families: Vec::new(), squares: [0.0; 6] });
        }
    }
    if motion.vibrates() {
        left_out.push(Cause::Vibration);
    }
    let (mean, variance) = motion.between[0].moments(&coupling::TIME_JITTER);
    if flight.jitters {
        let process = Process::Jitter((mean * mean + variance) * flight.clock().sample_s());
        let families = vec![Family::new(process, 1.0)];
        let cause = Cause::Coupling(&coupling::TIME_JITTER);
        causes.push(Carried { cause, columns: Vec::new(), families, squares: [0.0; 6] });
    }
    let columns = found::alignment(flight, found);
    if !columns.is_empty() {
        causes.push(Carried { cause: Cause::Alignment, columns, families: Vec::new(), squares: [0.0; 6] });
    }
    if !flight.fixes.is_empty() {
        let families = vec![Family::new(Process::Fixes, 1.0)];
        causes.push(Carried { cause: Cause::Fixes, columns: Vec::new(), families, squares: [0.0; 6] });
    }
    (causes, left_out)
}

/// Works it out at the report samples of a flight.
pub fn of(motion: &InMotion, flight: &Flight) -> Covariance {
    let stride = steps::stride(flight, FEWEST_STEPS);
    let (causes, left_out) = causes(motion, flight, stride);
    let steps = steps::steps(flight, stride);
    let part = |carried: &Carried| {
        let errors = steps::propagated(&steps, &flight.fixes, carried.columns.clone(), carried.families.clone());
        let (mean, variance) = Errors::apart(&errors);
        Part { cause: carried.cause, mean, variance }
    };
    Covariance { parts: parallel::map(&causes, part), left_out }
}
