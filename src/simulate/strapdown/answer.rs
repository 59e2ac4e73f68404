//! The answer to a study in motion: the ensemble at the report times and, between them, at the
//! points of the curves.

use super::aiding;
use super::backends::run_kept;
use super::covariance::{self, Covariance, Part};
use super::kept::Kept;
use super::outages::{self, Outage};
use super::own_error;
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
    /// Error of the navigator on perfect readings, at the same times.
    pub own: Part,
    /// Outages of GNSS, where the study has them.
    pub outages: Vec<Outage>,
    /// Places where the two differ by more than chance.
    pub apart: Vec<Apart>,
    /// The recorded flight next to it, where the study asks for one.
    pub compared: Option<Compared>,
}

/// A spread of the ensemble that is not that of the linear model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Apart {
    /// Quantity that the curve shows.
    pub quantity: Quantity,
    /// Time since the start, s.
    pub time_s: f64,
    /// Standard deviation of the ensemble over that of the model.
    pub ratio: f64,
    /// By how many standard errors they differ.
    pub standard_errors: f64,
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
        self.covariance.parts.iter().chain([&self.own])
    }

    /// Fraction of the mean squared horizontal distance of all rows that one makes.
    pub fn fraction(&self, part: &Part, report: usize) -> f64 {
        let all: f64 = self.parts().map(|part| self.covariance.horizontal_m2(part, report)).sum();
        if all > 0.0 { self.covariance.horizontal_m2(part, report) / all } else { 0.0 }
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
    of_ensemble(study, motion, flight, ensemble, compared)
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
/// Fewer than two members that did not diverge.
pub(super) fn of_ensemble(
    study: &Study,
    motion: &InMotion,
    flight: Flight,
    ensemble: Ensemble,
    compared: Option<Compared>,
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
    let own = own_error::own_error(motion, &flight);
    let outages = outages::outages(motion.aiding.as_ref(), &study.clock, &samples);
    let report: Vec<usize> = study.clock.report_samples.iter().filter_map(|s| samples.binary_search(s).ok()).collect();
    let apart = report.iter().flat_map(|k| apart(&ensemble, &covariance, *k)).collect();
    Ok(Answer { flight, ensemble, report, covariance, own, outages, apart, compared })
}

/// Returns where ensemble and linear model differ at a report.
fn apart(ensemble: &Ensemble, covariance: &Covariance, report: usize) -> Vec<Apart> {
    let model = |place: usize| covariance.variance(report, place).sqrt();
    let largest = |place: usize| (place / 3 * 3..place / 3 * 3 + 3).map(model).fold(0.0, f64::max);
    let one = |(place, quantity): (usize, Quantity)| {
        let summary = ensemble.summary(report, quantity);
        let (sd, time_s) = (model(place), ensemble.time_s[report]);
        let floor = SMALLEST * [0.5 * time_s * time_s, time_s, 1.0][place / 3];
        if sd <= (SMALLEST_SPREAD * largest(place)).max(floor) {
            return None;
        }
        let ratio = summary.sd / sd;
        // A normal sample's standard deviation has the relative standard error 1/√2n.
        let standard_errors = (ratio - 1.0).abs() * (2.0 * summary.count as f64).sqrt();
        (standard_errors > MOST_STANDARD_ERRORS).then_some(Apart { quantity, time_s, ratio, standard_errors })
    };
    LINEAR.into_iter().enumerate().filter_map(one).collect()
}
