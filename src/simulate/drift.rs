//! Computes how far the sensors of a study drift: envelopes, closed forms, powers of time and the
//! error budget, in one answer.
//!
//! Not for choosing a backend or for showing anything: it is handed a way to integrate a job, and
//! `report` shows it.

pub mod budget;
pub mod carried;
pub mod compare;
mod course;
pub mod disturbance;
pub mod divided;
pub mod document;
pub mod expected;
pub mod scope;
pub mod windows;

use crate::control::Control;
use crate::error::{Error, Result};
use crate::kernel::integrator::Choice;
use crate::kernel::job::{Clock, Job};
use crate::navigation::closed_form::Process;
use crate::navigation::power_law;
use crate::sensor::source::ErrorSource;
use crate::statistics::{Statistics, Summary, quantity};
use crate::study::Study;
use crate::units::STANDARD_GRAVITY_M_S2;
use budget::Budget;
use expected::{Expected, Moment};

/// Points of a curve, evenly spaced on a log axis and, for its end on a linear one, evenly in time.
const CURVE_POINTS: [usize; 2] = [36, 20];

/// The drift of a study: error statistics over time, closed forms, fitted powers and error budget.
#[derive(Debug, Clone)]
pub struct Drift {
    /// The ensemble at the report times and, between them, at the points of the curves.
    pub statistics: Statistics,
    /// Places of the user's report times in `statistics`.
    pub report: Vec<usize>,
    /// Closed forms at the same times.
    pub expected: Expected,
    /// Powers of time fitted to the envelope.
    pub growth: Growth,
    /// Contribution of each error source.
    pub budget: Budget,
    /// Integrator of the proof mass, and the reason for it.
    pub choice: Choice,
    /// Comparison with a static log of the sensor.
    pub compared: compare::Outcome,
}

/// The position envelope as powers of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Growth {
    /// Fitted coefficients of `power_law::EXPONENTS`, m/s^p.
    pub fitted: [f64; 4],
    /// The same from the closed forms of the sources that grow with that power, m/s^p.
    pub expected: [f64; 4],
    /// Local exponent d ln σ / d ln t, per time of the statistics.
    pub exponents: Vec<f64>,
}

impl Drift {
    /// Summary of one quantity at the user's report times.
    pub fn at_report(&self, quantity: usize) -> Vec<&Summary> {
        self.report.iter().map(|k| &self.statistics.at[*k][quantity]).collect()
    }

    /// The user's report times, s.
    pub fn report_times_s(&self) -> Vec<f64> {
        self.report.iter().map(|k| self.statistics.time_s[*k]).collect()
    }
}

/// Works out the answer. `run` integrates a job under a name for its progress bar.
///
/// # Errors
/// Whatever stops a run; mechanics that no integrator can step.
pub fn answer(
    study: &Study,
    control: &Control,
    mut run: impl FnMut(&Job, &str) -> Result<Statistics>,
) -> Result<Drift> {
    let choice = integrator(study)?;
    let samples = curve_samples(&study.clock);
    let statistics = run(&study.job(choice.integrator, samples.clone()), "simulating")?;
    if statistics.failed + 2 > statistics.members {
        return Err(Error::new(
            format!("could not simulate {}", study.name),
            format!(
                "{} of {} members diverged: their position error is not finite",
                statistics.failed, statistics.members
            ),
            "some error, spring or excitation is far too large; check the exponents and units of the study",
        ));
    }
    let report = study.clock.report_samples.iter().filter_map(|s| samples.binary_search(s).ok()).collect();
    let expected = Expected::of(study, &samples);
    let budget = budget::make(study, choice.integrator, &samples, &mut run)?;
    let growth = growth(&statistics, &expected);
    let compared = compare::run(study, control, &mut run)?;
    Ok(Drift { statistics, report, expected, growth, budget, choice, compared })
}

/// The ensembles that [`answer`] asks for, in its order: a study that is divided among machines
/// integrates pieces of each.
///
/// # Errors
/// Mechanics that no integrator can step; a log that is there and cannot be read; Ctrl-C.
pub fn jobs(study: &Study, control: &Control) -> Result<Vec<Job>> {
    let integrator = integrator(study)?.integrator;
    let samples = curve_samples(&study.clock);
    let mut jobs = vec![study.job(integrator, samples.clone())];
    jobs.extend(budget::jobs(study, integrator, &samples));
    jobs.extend(compare::jobs(study, control)?);
    Ok(jobs)
}

fn integrator(study: &Study) -> Result<Choice> {
    study.along_one_axis()?;
    study.integrator()
}

/// The report times and the points of the curves between a thousandth of the run (or one sample)
/// and its end.
pub(crate) fn curve_samples(clock: &Clock) -> Vec<u64> {
    let last = clock.samples as f64;
    let first = (last / 1000.0).max(1.0);
    let [by_ratio, by_time] = CURVE_POINTS;
    let rising = (0..by_ratio).map(|k| first * (last / first).powf(k as f64 / (by_ratio - 1) as f64));
    let even = (1..=by_time).map(|k| last * k as f64 / by_time as f64);
    let curve = rising.chain(even).map(|place| (place.round() as u64).clamp(1, clock.samples));
    let mut samples: Vec<u64> = curve.chain(clock.report_samples.clone()).collect();
    samples.sort_unstable();
    samples.dedup();
    samples
}

fn growth(statistics: &Statistics, expected: &Expected) -> Growth {
    let sd = statistics.series(quantity::POSITION, |s| s.sd);
    let envelope: Vec<(f64, f64)> = statistics.time_s.iter().copied().zip(sd).collect();
    let last = expected.time_s.len() - 1;
    // What a still start leaves of a source is a constant bias, and grows as one; the rest of it by
    // its own power.
    let bias_share = |source: ErrorSource| {
        let (integrations, factor) = if source.is_gyro() { (3, STANDARD_GRAVITY_M_S2.powi(2)) } else { (2, 1.0) };
        let coefficient =
            expected.bias_left.iter().find(|(other, _)| *other == source).map_or(0.0, |(_, coefficient)| *coefficient);
        factor * coefficient * Process::Constant(1.0).variance(integrations, expected.time_s[last])
    };
    let from_sources = power_law::EXPONENTS.map(|exponent| {
        let part = |(source, rows): &(ErrorSource, Vec<[Moment; 4]>)| {
            let (whole, bias) = (rows[last][quantity::POSITION].variance, bias_share(*source));
            let own = if source.position_exponent() == Some(exponent) { (whole - bias).max(0.0) } else { 0.0 };
            let of_bias = if source.is_gyro() { 3.0 } else { 2.0 };
            own + if of_bias == exponent { bias } else { 0.0 }
        };
        let variance: f64 = expected.sources.iter().map(part).sum();
        variance.sqrt() / expected.time_s[last].powf(exponent)
    });
    Growth {
        fitted: power_law::fit(&envelope),
        expected: from_sources,
        exponents: power_law::local_exponents(&envelope),
    }
}
