//! The answer to a study in motion: the ensemble at the report times and, between them, at the
//! points of the curves.

use super::aiding;
use super::backends::run_kept;
use super::covariance::{self, Cause, Covariance, Part};
use super::kept::Kept;
use super::left_out;
use super::outages::{self, Outage};
use super::run::Ensemble;
use super::windows::{self, Compared};
use crate::backend::flight::Quantity;
use crate::control::Control;
use crate::drift::curve_samples;
use crate::ensemble::Choice;
use crate::error::{Error, Result};
use crate::kernel::flight::Flight;
use crate::study::Study;
use crate::study::in_motion::InMotion;

/// Result of a study along a trajectory.
pub struct Answer {
    /// Ensemble that was integrated.
    pub flight: Flight,
    /// The ensemble, summed up.
    pub ensemble: Ensemble,
    /// Places of the user's report times in it.
    pub report: Vec<usize>,
    /// Prediction of the linear model, at the same times as the ensemble.
    pub covariance: Covariance,
    /// Parts of the causes that the linear model leaves out, simulated.
    pub simulated: Vec<Part>,
    /// Error of the navigator on perfect readings, at the same times; the ensemble has it as well.
    pub own: Part,
    /// Outages of GNSS, where the study has them.
    pub outages: Vec<Outage>,
    /// Places where the two differ by more than chance.
    pub apart: Vec<Apart>,
    /// The recorded flight next to it, where the study asks for one.
    pub compared: Option<Compared>,
    /// Notes on how the study was read; those of a recorded flight next to it are its own.
    pub notes: Vec<String>,
}

/// A mean or a spread of the ensemble that is not that of the linear model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Apart {
    /// Quantity that the curve shows.
    pub quantity: Quantity,
    /// Time since the start, s.
    pub time_s: f64,
    /// Mean or spread, with its size.
    pub departure: Departure,
    /// By how many times what is tolerated they differ.
    pub times: f64,
}

/// States what differs between an ensemble and its linear model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Departure {
    /// The standard deviation: that of the ensemble over that of the model.
    Spread {
        /// The ratio.
        ratio: f64,
        /// By how many standard errors they differ.
        standard_errors: f64,
    },
    /// The mean, in SI.
    Mean {
        /// That of the ensemble.
        ensemble: f64,
        /// That of the model.
        model: f64,
    },
}

/// The quantities that the linear model has, in its order.
pub const LINEAR: [Quantity; 9] = [
    Quantity::Position(0),
    Quantity::Position(1),
    Quantity::Position(2),
    Quantity::Velocity(0),
    Quantity::Velocity(1),
    Quantity::Velocity(2),
    Quantity::Attitude(0),
    Quantity::Attitude(1),
    Quantity::Attitude(2),
];

/// Standard errors by which the ensemble's spread may differ from the linear model's: beyond, one
/// in 16 000 by chance.
const MOST_STANDARD_ERRORS: f64 = 4.0;
/// Spreads below this fraction of the largest of their kind matter to nobody, and are of second
/// order in the others.
const SMALLEST_SPREAD: f64 = 1e-2;
/// Spreads below what this acceleration makes, m/s², or this tilt, rad, are of second order or
/// rounding.
const SMALLEST: f64 = 1e-8;

impl Answer {
    /// The rows of the budget.
    pub fn parts(&self) -> impl Iterator<Item = &Part> {
        self.covariance.parts.iter().chain(&self.simulated).chain([&self.own])
    }

    /// Fraction of the mean squared horizontal distance of all rows that one makes.
    pub fn fraction(&self, part: &Part, report: usize) -> f64 {
        let all: f64 = self.parts().map(|part| part.horizontal_m2(report)).sum();
        if all > 0.0 { part.horizontal_m2(report) / all } else { 0.0 }
    }

    /// The user's report times, s.
    pub fn report_times_s(&self) -> Vec<f64> {
        self.report.iter().map(|k| self.ensemble.time_s[*k]).collect()
    }
}

/// Works out the answer.
///
/// # Errors
/// Whatever stops a run; mechanics that no integrator can step; fewer than two members that did not
/// diverge.
pub fn answer(study: &Study, motion: &InMotion, choice: Choice, control: &Control) -> Result<Answer> {
    answer_kept(study, motion, choice, &mut Kept::none(), control)
}

/// The same, keeping what is summed and going on with what was kept.
///
/// # Errors
/// As [`answer`]; a state that cannot be gone on with.
pub fn answer_kept(
    study: &Study,
    motion: &InMotion,
    choice: Choice,
    kept: &mut Kept,
    control: &Control,
) -> Result<Answer> {
    // Refused before the work, not after it.
    let compared = windows::compare(motion, control)?;
    let flight = flight(study, motion)?;
    let ensemble = run_kept(choice, &flight, kept, control)?;
    of_ensemble(study, motion, flight, ensemble, compared, control)
}

/// The samples after which a study is summed: its report times, the points of the curves, and those
/// around outages.
fn samples(study: &Study, motion: &InMotion) -> Vec<u64> {
    let mut samples = curve_samples(&study.clock);
    samples.extend(outages::samples(motion.aiding.as_ref()));
    samples.sort_unstable();
    samples.dedup();
    samples
}

/// The ensemble that a study asks for.
///
/// # Errors
/// Mechanics that no integrator can step.
pub fn flight(study: &Study, motion: &InMotion) -> Result<Flight> {
    aiding::flight(study, motion, samples(study, motion))
}

/// The answer from the ensemble.
///
/// # Errors
/// Fewer than two members that did not diverge; stopped.
pub(super) fn of_ensemble(
    study: &Study,
    motion: &InMotion,
    flight: Flight,
    ensemble: Ensemble,
    compared: Option<Compared>,
    control: &Control,
) -> Result<Answer> {
    if ensemble.failed + 2 > ensemble.members {
        return Err(Error::new(
            format!("could not simulate {}", study.name),
            format!("{} of {} members diverged: their errors are not finite", ensemble.failed, ensemble.members),
            "some error or spring is far too large; check the exponents and units of the study",
        ));
    }
    let samples = samples(study, motion);
    let covariance = covariance::of(motion, &flight);
    let simulated = left_out::parts(&flight, &covariance.left_out, control)?;
    let mean = flight.own.to_vec();
    let own = Part { cause: Cause::Mechanisation, variance: vec![[0.0; 9]; mean.len()], mean };
    let outages = outages::outages(motion.aiding.as_ref(), &study.clock, &samples);
    let report: Vec<usize> = study.clock.report_samples.iter().filter_map(|s| samples.binary_search(s).ok()).collect();
    let apart = report.iter().flat_map(|k| apart(&ensemble, &covariance, &own, *k)).collect();
    let notes = if compared.is_none() { motion.notes.clone() } else { Vec::new() };
    Ok(Answer { notes, flight, ensemble, report, covariance, simulated, own, outages, apart, compared })
}

/// Returns where ensemble and linear model differ at a report.
fn apart(ensemble: &Ensemble, covariance: &Covariance, own: &Part, report: usize) -> Vec<Apart> {
    let mean = |place: usize| covariance.mean(report, place) + own.mean[report][place];
    let spread = |place: usize| covariance.variance(report, place).sqrt();
    let largest = |of: &dyn Fn(usize) -> f64, place: usize| {
        (place / 3 * 3..place / 3 * 3 + 3).map(|p| of(p).abs()).fold(0.0, f64::max)
    };
    let time_s = ensemble.time_s[report];
    let floor = |place: usize| SMALLEST * [0.5 * time_s * time_s, time_s, 1.0][place / 3];
    let of_spread = |place: usize, quantity: Quantity| {
        let summary = ensemble.summary(report, quantity);
        let sd = spread(place);
        if sd <= (SMALLEST_SPREAD * largest(&spread, place)).max(floor(place)) {
            return None;
        }
        let ratio = summary.sd / sd;
        // A normal sample's standard deviation has the relative standard error 1/√2n.
        let standard_errors = (ratio - 1.0).abs() * (2.0 * summary.count as f64).sqrt();
        let departure = Departure::Spread { ratio, standard_errors };
        Some(Apart { quantity, time_s, departure, times: standard_errors / MOST_STANDARD_ERRORS })
    };
    let of_mean = |place: usize, quantity: Quantity| {
        let summary = ensemble.summary(report, quantity);
        let (ensemble, model) = (summary.mean, mean(place));
        let count = summary.count as f64;
        // By chance, and by the part of a size that a spread may be off.
        let size = model.hypot(summary.sd).max(SMALLEST_SPREAD * largest(&mean, place));
        let tolerated = MOST_STANDARD_ERRORS * (summary.sd / count.sqrt() + size / (2.0 * count).sqrt());
        // What is small next to the largest of its kind is of second order in it.
        let rms = |place: usize| mean(place).hypot(spread(place));
        let tolerated = tolerated.max(SMALLEST_SPREAD * largest(&rms, place)).max(floor(place));
        Some(Apart {
            quantity,
            time_s,
            departure: Departure::Mean { ensemble, model },
            times: (ensemble - model).abs() / tolerated,
        })
    };
    let each = LINEAR.into_iter().enumerate();
    let all = each.flat_map(|(place, quantity)| [of_spread(place, quantity), of_mean(place, quantity)]);
    all.flatten().filter(|apart| apart.times > 1.0).collect()
}
