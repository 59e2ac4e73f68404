//! The one clock: from the time stamps of a whole recording to its unit, its rate and the place of
//! every row.
//!
//! `survey` gathers in a first pass, [`judge`] decides, `place` puts each row where it belongs in a
//! second pass. All readers go by it, so they agree. Not for values: gaps are filled and uneven
//! rows resampled by the readers.

mod date;
pub mod instant;
pub mod place;
pub mod resample;
pub mod stamp;
pub mod survey;
pub mod timeline;
pub mod unit;
pub mod variation;

use std::path::Path;

use super::finding::{Finding, at};
use super::limits::{FILL_LIMIT, RATES_HZ};
use super::time_unit::{Basis, TimeUnit, UNITS};
use crate::error::{Error, Result};
use crate::number::rounded;
use survey::{Break, Survey, Value};
use unit::Evidence;
use variation::{Count, Variation};

/// Share of uneven steps above which a clock is uneven.
const MOSTLY_EVEN: f64 = 0.01;
/// Share of steps that must have one of two values where stamps are rounded.
const NEARLY_ALL: f64 = 0.995;
/// A clock by which so few stamps differ has no rate.
const FEWEST_STAMPS: usize = 10;

/// States how rows follow from stamps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// A row per tick, some ticks without one.
    Even,
    /// Stamps rounded to about the sampling interval or more: every row is a sample.
    Rounded {
        /// Usual step between stamps that differ, in the file's unit.
        quantum: f64,
        /// Longest run of one stamp that is no stopped clock.
        longest_run: usize,
        /// A row that repeats the whole row before it was written twice.
        drop_alike: bool,
    },
    /// Steps that are no whole ticks.
    Uneven {
        /// Share of such steps.
        share: f64,
    },
}

/// Holds what the stamps of a recording say.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// Sampling rate that the clock shows, Hz.
    pub rate_hz: f64,
    /// Unit of the stamps.
    pub unit: TimeUnit,
    /// From sample to sample, in that unit.
    pub tick: f64,
    /// States whether the rows are evenly spaced.
    pub kind: Kind,
    /// Steps of more than ten ticks.
    pub breaks: Vec<Break>,
    /// Rows that have a stamp.
    pub stamped: usize,
    /// Holds what was found and survived.
    pub findings: Vec<Finding>,
}

/// Holds what is asked of a clock: words for messages, and what the user said of it.
#[derive(Debug, Clone, Copy)]
pub struct Question<'a> {
    /// File whose clock is read, for messages.
    pub path: &'a Path,
    /// Heading of the time column.
    pub heading: &'a str,
    /// Rate given, Hz.
    pub rate_hz: Option<f64>,
}

impl Question<'_> {
    /// An error about this clock.
    pub fn refuse(&self, cause: impl Into<String>, hint: impl Into<String>) -> Error {
        Error::new(format!("could not assign times to {}", self.path.display()), cause, hint)
    }

    /// Time that runs backwards.
    pub fn set_back(&self, back: &timeline::SetBack) -> Error {
        self.refuse(
            format!("time runs backwards in data row {}: {}, then {} in `{}`", back.row, back.from, back.to, self.heading),
            "sort the rows, or use a stretch of the file that does not hold this row: --from-s, --to-s, or rows = [[a, b]] in \
             the model",
        )
    }
}

/// The unit of a clock that was surveyed.
///
/// # Errors
/// Where its heading names none and its numbers cannot decide.
pub fn unit_of(question: &Question<'_>, survey: &Survey) -> Result<(TimeUnit, Basis)> {
    let whole = survey.whole();
    let samples = if survey.zero > survey.steps / 20 { whole.steps } else { whole.ticks };
    let evidence = Evidence {
        heading: TimeUnit::of_heading(question.heading),
        origin: survey.timeline.origin().map_or(0.0, |s| s.value()),
        step: whole.span / samples.max(1.0),
        rate_hz: question.rate_hz,
    };
    unit::decide(&evidence).map_err(|units| {
        let choices = units.map(|u| format!("{} Hz in {}", rounded(1.0 / (evidence.step * u.seconds()), 6), u.name()));
        question.refuse(
            format!(
                "the heading `{}` names no unit of time, and its steps of {} could be {}",
                question.heading,
                rounded(evidence.step, 6),
                choices.join(" or ")
            ),
            "name the unit in the heading, e.g. t_s, t_ms, t_us or t_ns, or give the sampling rate with the column",
        )
    })
}

/// Judges a clock by all of its stamps.
///
/// # Errors
/// A clock that stands still, more than 5 % of the stamps missing or repeated, a rate that changes
/// or drifts by more than 5 %, is not a positive number, or disagrees with the one given.
pub fn judge(question: &Question<'_>, survey: &Survey) -> Result<Clock> {
    let stamped = survey.rows - survey.unknown.0;
    let forward = survey.steps - survey.zero;
    if forward == 0 {
        return Err(question.refuse(
            format!("all {stamped} time stamps in `{}` repeat the first one", question.heading),
            "is this the column that holds the time? Else give the sampling rate instead",
        ));
    }
    let (unit, basis) = unit_of(question, survey)?;
    let seconds = unit.seconds();
    refuse_stopped(question, survey, seconds)?;
    let whole = survey.whole();
    let kind = kind(survey);
    let (tick, count) = match kind {
        Kind::Rounded { quantum, .. } => (survey.line.slope(), Count::Rows { quantum }),
        Kind::Even => (usual(whole.span / whole.ticks, survey.by_tick.slope()), Count::Ticks),
        Kind::Uneven { .. } => (usual(whole.span / whole.steps, survey.line.slope()), Count::Steps),
    };
    // Stamps say so many digits, and no more.
    let rate_hz = rounded(1.0 / (tick * seconds), 12);
    if !RATES_HZ.contains(&rate_hz) {
        return Err(question.refuse(
            format!("the stamps in `{}` are {:?} {} apart", question.heading, tick, unit.name()),
            "is this the column that holds the time, and in this unit?",
        ));
    }
    refuse_disagreement(question, rate_hz, tick, unit)?;
    let mut findings = Vec::new();
    let in_hz = |step: f64| 1.0 / (step * seconds);
    match variation::judge(&survey.stretches, count) {
        Variation::None => {}
        Variation::Slight { shortest, longest } => {
            findings.push(Finding::RateVaries { from_hz: in_hz(longest), to_hz: in_hz(shortest), mean_hz: rate_hz });
        }
        Variation::Sudden { row, at: when, before, after } => {
            return Err(question.refuse(
                format!(
                    "the sampling rate changes from {} to {} Hz near data row {row}, {} after the start",
                    rounded(in_hz(before), 6),
                    rounded(in_hz(after), 6),
                    at(when * seconds)
                ),
                "use one side of it: --from-s, --to-s, or rows = [[a, b]] in the model",
            ));
        }
        Variation::Far { shortest, longest } => {
            return Err(question.refuse(
                format!(
                    "the sampling rate changes between {} Hz near data row {} and {} Hz near data row {}",
                    rounded(in_hz(longest.0), 6),
                    longest.1,
                    rounded(in_hz(shortest.0), 6),
                    shortest.1
                ),
                "no one rate describes it: use a stretch in which it is steady (--from-s, --to-s, or rows = [[a, b]] in the \
                 model), or resample the recording to an even clock",
            ));
        }
    }
    if !matches!(basis, Basis::Heading | Basis::Default) {
        findings.push(Finding::TimeUnit { heading: question.heading.into(), unit, basis, rate_hz });
    }
    if let Some(wraps) = survey.timeline.wraps() {
        let (times, modulus, first_row) = (wraps.times, wraps.modulus, wraps.first_row);
        findings.push(Finding::ClockWrapped { times, modulus, unit, first_row });
    }
    findings.extend(in_groups(survey, seconds));
    if let Kind::Rounded { quantum, .. } = kind {
        findings.push(Finding::CoarseStamps { step_s: quantum * seconds, rate_hz });
    }
    Ok(Clock { rate_hz, unit, tick, kind, breaks: survey.breaks.clone(), stamped, findings })
}

/// Pauses from which groups of rows are many.
const MANY_PAUSES: usize = 10;

/// Says so where most of the time lies in pauses between groups of rows: samples that were taken evenly and stamped
/// as they arrived look like that, and so do samples taken in bursts.
fn in_groups(survey: &Survey, seconds: f64) -> Option<Finding> {
    let elapsed = survey.timeline.elapsed();
    let pauses: f64 = survey.breaks.iter().map(|pause| pause.step).sum();
    let is_mostly = survey.breaks.len() >= MANY_PAUSES && 2.0 * pauses > elapsed;
    is_mostly.then(|| Finding::InGroups {
        groups: survey.breaks.len() + 1,
        share: pauses / elapsed,
        mean_hz: rounded(survey.steps as f64 / (elapsed * seconds), 4),
    })
}

/// Stamps of the same step to this share are exact: a straight line through them would only round them.
const EXACT: f64 = 1e-9;

/// The step of stamps, from their ends and of a straight line through all of them. Stamps that err each by itself
/// err in two of all at the ends, and in the mean on a line.
fn usual(by_ends: f64, by_line: f64) -> f64 {
    if (by_line / by_ends - 1.0).abs() > EXACT { by_line } else { by_ends }
}

/// Returns whether rows share stamps, and why.
fn kind(survey: &Survey) -> Kind {
    let steps = survey.steps as f64;
    let mut common: Vec<Value> = survey.values.clone();
    common.sort_by(|a, b| b.count.total_cmp(&a.count));
    let two = match common[..] {
        [most, least, ..] if most.count + least.count >= NEARLY_ALL * steps && least.is_regular() => {
            Some([most.step.min(least.step), most.step.max(least.step)])
        }
        _ => None,
    };
    let forward = (survey.steps - survey.zero) as f64;
    let other_alike = survey.other_alike as f64 / forward;
    let drop_alike = other_alike < 0.01;
    let (longest_run, stuck) = survey.stuck();
    let shared = survey.zero - stuck.min(survey.zero);
    let alike = survey.zero_alike as f64 / survey.zero.max(1) as f64;
    let twice = alike > 0.5 && alike > 5.0 * other_alike;
    let often = shared as f64 > FILL_LIMIT * steps && forward >= FEWEST_STAMPS as f64;
    if shared > 0 && !twice && (often || two.is_some_and(|[low, _]| low == 0.0)) {
        let quantum = two.map_or(survey.whole().span / forward, |[low, high]| high - low);
        return Kind::Rounded { quantum, longest_run, drop_alike };
    }
    if let (Some([low, high]), Some(digit)) = (two, survey.last_digit)
        && !(twice && low == 0.0)
    {
        let quantum = high - low;
        let whole = low / quantum;
        let printed = (quantum / digit - 1.0).abs() < 1e-3;
        if printed && whole < 3.5 && (whole - whole.round()).abs() < 1e-3 {
            return Kind::Rounded { quantum, longest_run, drop_alike };
        }
    }
    let whole = survey.whole();
    let share = whole.uneven / whole.steps.max(1.0);
    if share > MOSTLY_EVEN { Kind::Uneven { share } } else { Kind::Even }
}

fn refuse_stopped(question: &Question<'_>, survey: &Survey, seconds: f64) -> Result<()> {
    let rows = survey.rows as f64;
    let hint = "use a stretch where the clock runs (--from-s, --to-s, or rows = [[a, b]] in the model), or give the sampling \
                rate instead of the time column";
    let (_, stuck) = survey.stuck();
    if stuck as f64 > FILL_LIMIT * rows {
        let (length, row, when) = survey.longest_run;
        return Err(question.refuse(
            format!(
                "the clock stands still for {length} of {} rows from data row {row} on, {} after the start",
                survey.rows,
                at(when * seconds)
            ),
            hint,
        ));
    }
    let dropped = match kind(survey) {
        Kind::Rounded { drop_alike: true, .. } => survey.zero_alike,
        Kind::Rounded { .. } => 0,
        // Nothing is lost with a row that was written twice.
        _ => survey.zero - survey.zero_alike,
    };
    if (dropped + survey.unknown.0 + stuck) as f64 > FILL_LIMIT * rows {
        return Err(question.refuse(
            format!(
                "of {} time stamps {dropped} repeat the one before and {} are missing",
                survey.rows, survey.unknown.0
            ),
            "is this the column that holds the time? Else give the sampling rate instead of it",
        ));
    }
    Ok(())
}

/// A rate given agrees with a clock's within this share: what a sensor's own oscillator and a
/// rounded number in a datasheet are off by, and half as much in a noise coefficient.
const AGREES: f64 = 0.01;

/// Returns whether two rates contradict each other.
pub(super) fn contradict(clock_hz: f64, given_hz: f64) -> bool {
    (clock_hz / given_hz - 1.0).abs() > AGREES
}

fn refuse_disagreement(question: &Question<'_>, rate_hz: f64, tick: f64, unit: TimeUnit) -> Result<()> {
    let Some(stated) = question.rate_hz.filter(|given| contradict(rate_hz, *given)) else { return Ok(()) };
    let other = UNITS.into_iter().find(|u| (1.0 / (tick * u.seconds()) / stated - 1.0).abs() < 0.05);
    let hint = match other {
        Some(other) => {
            format!("its heading says {}, its numbers look like {}: correct the heading", unit.name(), other.name())
        }
        None => "correct the rate, or leave it out and let the time column decide; --force-rate uses the rate given"
            .to_owned(),
    };
    Err(question.refuse(
        format!("the time column `{}` says {rate_hz:.6} Hz, the rate given is {stated} Hz", question.heading),
        hint,
    ))
}
