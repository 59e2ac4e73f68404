//! Predicted, and what the sensor then did: a recorded static log cut into windows and integrated,
//! next to the simulated sensors of the same axis.
//!
//! Windows do not overlap. Each begins with a still start of its own, whose mean is taken off; what
//! is left of an accelerometer is integrated twice, into position, and of a gyro once, into tilt.
//! The simulated members do the same with the axis' own coefficients and nothing else: the log
//! holds one channel. A log of n samples lasts n − 1 sample periods.

use std::ops::Range;
use std::sync::Arc;

use super::disturbance::{self, Kind};
use crate::error::{Error, Result};
use crate::kernel::integrator::Integrator;
use crate::kernel::job::Job;
use crate::number::rounded;
use crate::numerics::order;
use crate::recording::Recording;
use crate::sensor::{Accelerometer, Gyro, Sense};
use crate::statistics::{Moments, Statistics, Summary, quantity};
use crate::study::Study;
use crate::study::alignment::Alignment;
use crate::study::file::{Axis, Compare};

/// Most simulated members: their 0.5 and 99.5 % are then good to a few per cent.
const MOST_MEMBERS: u64 = 16_384;
/// Points of the curves over the longest window.
const CURVE_POINTS: usize = 24;
/// Quantiles that the curves show.
const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
/// Central bands, as fractions of the simulated members that they hold.
pub const BANDS: [f64; 3] = [0.5, 0.9, 0.99];

/// Cut of the log for windows of one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// Length of a window after its still start, as the study gives it, s.
    pub seconds: f64,
    /// Samples of the still start.
    still: usize,
    /// Samples after the still start.
    length: usize,
    /// Number of windows that fit.
    count: usize,
}

impl Cut {
    fn samples(&self, window: usize) -> Range<usize> {
        let whole = self.still + self.length;
        window * whole..(window + 1) * whole
    }
}

/// Recorded and predicted drift of one axis, window by window.
#[derive(Debug, Clone, PartialEq)]
pub struct Drifted {
    /// Heading in the log.
    pub column: String,
    /// Quantity that it measures; its errors below are positions in m or tilts in rad.
    pub sense: Sense,
    /// Per length of window.
    pub windows: Vec<Windows>,
    /// Quantiles along the longest windows.
    pub curve: Vec<Point>,
    /// Members behind the prediction.
    pub members: u64,
}

/// Windows of one length.
#[derive(Debug, Clone, PartialEq)]
pub struct Windows {
    /// Length of a window after its still start, s.
    pub seconds: f64,
    /// Recorded error at the end of each, and what disturbed it, if anything.
    pub recorded: Vec<(f64, Option<Kind>)>,
    /// Standard deviation of the simulated error.
    pub sd_predicted: f64,
    /// Ends of the central `BANDS` of the simulated error.
    pub bands: [[f64; 2]; 3],
}

/// Quantiles over windows and over members at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Time from the end of the still start, s.
    pub time_s: f64,
    /// `QUANTILES` of the recorded windows.
    pub recorded: [f64; 5],
    /// The same of the simulated members.
    pub predicted: [f64; 5],
}

impl Windows {
    /// Recorded errors; without the disturbed windows if asked.
    pub fn errors(&self, undisturbed: bool) -> Vec<f64> {
        self.recorded.iter().filter(|(_, kind)| !undisturbed || kind.is_none()).map(|(error, _)| *error).collect()
    }

    /// Number of windows with a disturbance.
    pub fn disturbed(&self) -> usize {
        self.recorded.iter().filter(|(_, kind)| kind.is_some()).count()
    }

    /// Standard deviation of the recorded errors (n − 1).
    pub fn sd_recorded(&self, undisturbed: bool) -> f64 {
        Moments::of(self.errors(undisturbed).into_iter()).sd()
    }

    /// Returns how many recorded errors lie inside each of the `BANDS`.
    pub fn inside(&self, undisturbed: bool) -> [usize; 3] {
        let errors = self.errors(undisturbed);
        self.bands.map(|[low, high]| errors.iter().filter(|e| (low..=high).contains(e)).count())
    }
}

impl Drifted {
    /// Which windows are disturbed, in sentences.
    pub fn findings(&self) -> Vec<String> {
        let sentence = |w: &Windows| {
            let of = |kind: Kind| w.recorded.iter().filter(|(_, k)| *k == Some(kind)).count();
            let parts: Vec<String> = [Kind::Knock, Kind::Jump, Kind::Gap]
                .into_iter()
                .filter(|kind| of(*kind) > 0)
                .map(|kind| format!("{} with a {}", of(kind), kind.name()))
                .collect();
            (!parts.is_empty()).then(|| {
                format!(
                    "`{}`: {} of {} windows of {} s disturbed ({}); results are given with and without",
                    self.column,
                    w.disturbed(),
                    w.recorded.len(),
                    w.seconds,
                    parts.join(", ")
                )
            })
        };
        self.windows.iter().filter_map(sentence).collect()
    }
}

/// Cuts a log, for each length that the study asks for; none where it asks for no windows.
///
/// # Errors
/// A log that is shorter than a still start or than two windows with theirs; windows below one
/// sample.
pub(super) fn cuts(study: &Study, compare: &Compare, log: &Recording) -> Result<Vec<Cut>> {
    let (Some(windows_s), Alignment::Still { .. }) = (&compare.windows_s, study.alignment) else {
        return Ok(Vec::new());
    };
    let still_s = study.still_s();
    let refuse = |cause: String, hint: String| {
        Error::new(format!("could not cut {} into windows", log.path.display()), cause, hint)
    };
    let period_s = 1.0 / log.rate_hz;
    let periods = log.samples().saturating_sub(1);
    let lasts_s = periods as f64 * period_s;
    let short = |s: f64| rounded(s, 6);
    let still = (still_s * log.rate_hz).round();
    if still > periods as f64 {
        return Err(refuse(
            format!("the still start of {} s is longer than the log, which lasts {} s", short(still_s), short(lasts_s)),
            "shorten `alignment.still_s`, or give a longer log; check rate_hz".into(),
        ));
    }
    if still < 1.0 {
        return Err(refuse(
            format!(
                "a still start of {} s is less than one sample of the log at {} Hz",
                short(still_s),
                short(log.rate_hz)
            ),
            format!("`alignment.still_s` must be at least {} s", short(period_s)),
        ));
    }
    let cut = |seconds: &f64| {
        let length = (seconds * log.rate_hz).round();
        if length < 1.0 {
            return Err(refuse(
                format!(
                    "a window of {} s is less than one sample of the log at {} Hz",
                    short(*seconds),
                    short(log.rate_hz)
                ),
                format!("`compare.windows_s` must be at least {} s", short(period_s)),
            ));
        }
        let count = (periods as f64 / (still + length)).floor();
        if count < 2.0 {
            let fits =
                if count < 1.0 { "shorter than one window" } else { "only one window long, which has no spread" };
            return Err(refuse(
                format!(
                    "the log lasts {} s: {fits} of {} s after a still start of {} s",
                    short(lasts_s),
                    short(*seconds),
                    short(still_s)
                ),
                match lasts_s / 2.0 - still_s {
                    most if most > period_s => {
                        format!("use windows of at most {} s, or give a longer log", short(most))
                    }
                    _ => "shorten `alignment.still_s` and `compare.windows_s`, or give a longer log".into(),
                },
            ));
        }
        Ok(Cut { seconds: *seconds, still: still as usize, length: length as usize, count: count as usize })
    };
    windows_s.iter().map(cut).collect()
}

/// The errors of one window after its still start, in units of samples (s = 1): once integrated,
/// and twice. As the kernels have it: the error is held over a sample, its first integral a
/// trapezium.
fn integrals(values: &[f64], still: usize) -> impl Iterator<Item = [f64; 2]> + '_ {
    let mean = values[..still].iter().sum::<f64>() / still as f64;
    let (mut once, mut twice) = (0.0, 0.0);
    values[still..].iter().map(move |value| {
        let error = value - mean;
        twice += once + 0.5 * error;
        once += error;
        [once, twice]
    })
}

/// The windows of one axis next to its prediction.
///
/// # Errors
/// Sections of the axis that make no sense; whatever stops the simulation.
pub(crate) fn drifted(
    study: &Study,
    axis: &Axis,
    log: &Recording,
    cuts: &[Cut],
    simulate: &mut dyn FnMut(&Job, &str) -> Result<Statistics>,
) -> Result<Drifted> {
    let (sense, scale) = axis.unit();
    let values: Vec<f64> = log.column(&axis.column).unwrap_or_default().iter().map(|v| v * scale).collect();
    let period_s = 1.0 / log.rate_hz;
    let (place, factor, quantity) = match sense {
        Sense::Accelerometer => (1, period_s * period_s, quantity::POSITION),
        Sense::Gyro => (0, period_s, quantity::TILT),
    };
    let disturbances = disturbance::find(&values, log.rate_hz, &log.filled);
    let disturbed = |window: &Range<usize>| {
        let overlaps = |d: &&disturbance::Disturbance| d.samples.start < window.end && window.start < d.samples.end;
        disturbances.iter().find(overlaps).map(|d| d.kind)
    };
    let (longest, points) = points(cuts);
    let statistics = simulate(&ensemble(study, axis, log, cuts)?, &format!("windows of {}", axis.column))?;
    let predicted =
        |length: usize| -> Option<&Summary> { points.binary_search(&length).ok().map(|k| &statistics.at[k][quantity]) };
    let quantile = |s: &Summary, p: f64| s.histogram.quantile(p, s.min, s.max);
    let mut windows = Vec::new();
    let mut curve = Vec::new();
    for cut in cuts {
        let ranges: Vec<Range<usize>> = (0..cut.count).map(|k| cut.samples(k)).collect();
        let Some(summary) = predicted(cut.length) else { continue };
        let end = |range: &Range<usize>| {
            let last = integrals(&values[range.clone()], cut.still).last().map_or(0.0, |both| factor * both[place]);
            (last, disturbed(range))
        };
        windows.push(Windows {
            seconds: cut.seconds,
            recorded: ranges.iter().map(end).collect(),
            sd_predicted: summary.sd,
            bands: BANDS
                .map(|fraction| [quantile(summary, 0.5 - 0.5 * fraction), quantile(summary, 0.5 + 0.5 * fraction)]),
        });
        if cut.length == longest {
            let runs: Vec<Vec<f64>> = ranges
                .iter()
                .map(|range| integrals(&values[range.clone()], cut.still).map(|both| factor * both[place]).collect())
                .collect();
            let point = |length: &usize| {
                let mut at: Vec<f64> = runs.iter().map(|run| run[length - 1]).collect();
                order::sort(&mut at);
                let summary = predicted(*length)?;
                Some(Point {
                    time_s: *length as f64 * period_s,
                    recorded: QUANTILES.map(|p| order::quantile(&at, p)),
                    predicted: QUANTILES.map(|p| quantile(summary, p)),
                })
            };
            curve = points.iter().filter_map(point).collect();
        }
    }
    Ok(Drifted { column: axis.column.clone(), sense, windows, curve, members: statistics.members })
}

/// The longest window, and where along it there are statistics, in samples.
fn points(cuts: &[Cut]) -> (usize, Vec<usize>) {
    let longest = cuts.iter().map(|c| c.length).max().unwrap_or(1);
    let mut points: Vec<usize> =
        (1..=CURVE_POINTS).map(|k| (longest * k).div_ceil(CURVE_POINTS)).chain(cuts.iter().map(|c| c.length)).collect();
    points.sort_unstable();
    points.dedup();
    (longest, points)
}

/// The ensemble that `drifted` asks for.
///
/// # Errors
/// Sections of the axis that make no sense.
pub fn ensemble(study: &Study, axis: &Axis, log: &Recording, cuts: &[Cut]) -> Result<Job> {
    job(study, axis, log, cuts.first().map_or(0, |c| c.still), &points(cuts).1)
}

/// The members of one axis: at rest after a still start, with the errors of that sensor and of no
/// other.
fn job(study: &Study, axis: &Axis, log: &Recording, still: usize, points: &[usize]) -> Result<Job> {
    let (sense, _) = axis.unit();
    let samples = points.last().copied().unwrap_or(1) as u64;
    let mut resting = study.at_rest(axis, 1.0 / log.rate_hz, samples, study.members.min(MOST_MEMBERS))?;
    resting.alignment = Alignment::Still { samples: still as u64 };
    let integrator = match sense {
        Sense::Accelerometer => resting.integrator()?.integrator,
        Sense::Gyro => Integrator::Ideal,
    };
    let job = resting.job(integrator, points.iter().map(|p| *p as u64).collect());
    let draw = job.draw.clone();
    let alone = move |index| {
        let mut member = draw(index);
        match sense {
            Sense::Accelerometer => member.sensor.gyro = Gyro::default(),
            Sense::Gyro => {
                (member.sensor.accelerometer, member.sensor.proof_mass) = (Accelerometer::default(), None);
            }
        }
        member
    };
    Ok(Job { draw: Arc::new(alone), ..job })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_leaves_nothing_and_a_ramp_its_integrals() {
        assert!(integrals(&[3.0; 50], 10).all(|both| both == [0.0, 0.0]));
        // From its middle over the still start a ramp of 1 per sample runs on: after n samples
        // n·(still/2) + n²/2.
        let ramp: Vec<f64> = (0..1100).map(f64::from).collect();
        let last = integrals(&ramp, 100).last().expect("a thousand samples");
        let (n, lead) = (1000.0, 50.0);
        assert!((last[0] - (n * lead + n * n / 2.0)).abs() < 1e-6, "{last:?}");
        assert!((last[1] / (n * n * lead / 2.0 + n * n * n / 6.0) - 1.0).abs() < 1e-3, "{last:?}");
    }

    #[test]
    fn shares_are_counted_with_and_without_disturbed_windows() {
        let windows = Windows {
            seconds: 10.0,
            recorded: vec![(0.1, None), (-0.1, None), (0.7, None), (9.0, Some(Kind::Knock))],
            sd_predicted: 0.5,
            bands: [[-0.3, 0.3], [-0.8, 0.8], [-1.2, 1.2]],
        };
        assert_eq!((windows.inside(false), windows.inside(true)), ([2, 3, 3], [2, 3, 3]));
        assert_eq!((windows.errors(false).len(), windows.errors(true).len(), windows.disturbed()), (4, 3, 1));
        assert!(windows.sd_recorded(false) > 4.0 && windows.sd_recorded(true) < 0.5);
    }
}
