//! The steps of a recording as numbers: frequency, drive, complex reading, and the sweeps that they
//! form in the order in which they were taken.

use std::ops::Range;

use nalgebra::Complex;

use crate::error::{Error, Result};
use crate::model::Response;
use crate::numerics::order::median;
use crate::recording::Recording;

use super::units;

/// Steps of a recording at least.
const FEWEST: usize = 16;
/// Part of the drive by which it changes from sweep to sweep, and not by its own noise.
pub(super) const ANOTHER_DRIVE: f64 = 0.02;
/// Power of the drive below which it is asked whether the reading was divided by it: 0 then, else 1 off the
/// resonance.
const DIVIDED: f64 = 0.2;
/// Steps of a sweep on average, fewer of which say that rows are in no order of frequency.
const ORDERED: f64 = 4.0;

/// Steps in the order taken.
#[derive(Debug, Clone, Default)]
pub(super) struct Sweeps {
    /// Frequency of each step, Hz.
    pub frequency_hz: Vec<f64>,
    /// Amplitude of the drive.
    pub drive: Vec<f64>,
    /// Reading as X + iY, in the output's unit.
    pub reading: Vec<Complex<f64>>,
    /// Seconds after the first step, where they are recorded.
    pub time_s: Option<Vec<f64>>,
    /// States whether a step is fitted.
    pub counts: Vec<bool>,
    /// Steps of each sweep: one direction, one drive.
    pub sweeps: Vec<Range<usize>>,
    /// Steps after which the reading jumps.
    pub jumps: Vec<usize>,
    /// States whether neighbours in a sweep are neighbours in frequency.
    pub is_ordered: bool,
    /// Derivatives by time from displacement to the reading.
    pub derivatives: i32,
}

impl Sweeps {
    /// Number of steps.
    pub(super) fn len(&self) -> usize {
        self.frequency_hz.len()
    }

    /// Lowest and highest frequency, Hz.
    pub(super) fn span_hz(&self) -> [f64; 2] {
        let fold = |f: fn(f64, f64) -> f64, from: f64| self.frequency_hz.iter().copied().fold(from, f);
        [fold(f64::min, f64::INFINITY), fold(f64::max, 0.0)]
    }

    /// Distance between the neighbouring frequencies around this one, Hz; nothing outside the band.
    pub(super) fn spacing_hz(&self, at_hz: f64) -> f64 {
        let below = self.frequency_hz.iter().copied().filter(|f| *f <= at_hz).reduce(f64::max);
        let above = self.frequency_hz.iter().copied().filter(|f| *f > at_hz).reduce(f64::min);
        below.zip(above).map_or(0.0, |(below, above)| above - below)
    }

    /// Returns whether a sweep goes up.
    pub(super) fn rises(&self, sweep: &Range<usize>) -> bool {
        self.frequency_hz[sweep.end - 1] >= self.frequency_hz[sweep.start]
    }

    /// Drives that differ.
    pub(super) fn drives(&self) -> usize {
        let mut known: Vec<f64> = Vec::new();
        for sweep in &self.sweeps {
            let drive = self.drive[sweep.start];
            if known.iter().all(|k| (k - drive).abs() > ANOTHER_DRIVE * drive) {
                known.push(drive);
            }
        }
        known.len()
    }
}

/// Reads the steps of a recording, with what is to be said of them.
///
/// # Errors
/// Columns that are missing or contradict each other, values that no sweep has, too few steps.
pub(super) fn sweeps(recording: &Recording, model: &Response, findings: &mut Vec<String>) -> Result<Sweeps> {
    let fail = |cause: String, hint: &str| {
        Err(Error::new(format!("could not diagnose {}", recording.path.display()), cause, hint))
    };
    let column = |name: &String| {
        recording.column(name).map(<[f64]>::to_vec).ok_or_else(|| {
            let attempt = format!("could not diagnose {}", recording.path.display());
            Error::new(attempt, format!("the column `{name}` was not read"), "check [columns] in the model")
        })
    };
    let c = &model.columns;
    let per_hz = units::hertz(&c.frequency, recording.stated(&c.frequency));
    let frequency_hz: Vec<f64> = column(&c.frequency)?.iter().map(|f| f * per_hz).collect();
    let reading: Vec<Complex<f64>> = match (&c.x, &c.y, &c.amplitude, &c.phase) {
        (Some(x), Some(y), None, None) => {
            column(x)?.into_iter().zip(column(y)?).map(|(x, y)| Complex::new(x, y)).collect()
        }
        (None, None, Some(amplitude), Some(phase)) => {
            let (mut radius, angle) = (column(amplitude)?, column(phase)?);
            // Noise about an offset takes a few amplitudes below zero, a level in decibel below 1 V all of them.
            let below = radius.iter().filter(|r| **r < 0.0).count();
            let is_level = recording.unit_words(amplitude).is_none() && 2 * below > radius.len();
            if is_level || units::of_level(recording, amplitude).is_some() {
                radius.iter_mut().for_each(|level| *level = units::amplitude(*level));
                let why = if is_level { "states no unit and is mostly below zero, so it is taken" } else { "is" };
                findings.push(format!(
                    "`{amplitude}` {why} in decibel: the amplitude is 10 to the power of a twentieth of it"
                ));
            }
            let per_rad = units::radians(phase, recording.stated(phase)).unwrap_or_else(|| {
                let largest = angle.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                let per_rad = units::radians_by_size(largest);
                let taken = if per_rad == 1.0 { "rad" } else { "°" };
                findings.push(format!(
                    "`{phase}` states no unit and is taken in {taken}: its largest value is {largest:.4}"
                ));
                per_rad
            });
            radius.into_iter().zip(angle).map(|(r, a)| Complex::from_polar(r, a * per_rad)).collect()
        }
        _ => {
            return fail(
                "the model names neither `x` and `y` nor `amplitude` and `phase`, or some of both".into(),
                "give one pair under [columns]: x = \"x_v\" and y = \"y_v\", or amplitude and phase",
            );
        }
    };
    let drive = match &c.drive {
        Some(name) => column(name)?,
        None => {
            findings.push("no drive is given: it is taken as 1 for every step".into());
            vec![1.0; frequency_hz.len()]
        }
    };
    let of_time =
        |name: &String| -> Result<Vec<f64>> { Ok(column(name)?.iter().map(|t| t * units::seconds(name)).collect()) };
    let time_s = c.time.as_ref().map(of_time).transpose()?;
    let n = frequency_hz.len();
    if let Some(k) = reading.iter().position(|y| !(y.re.is_finite() && y.im.is_finite())) {
        return fail(format!("step {k} has no finite reading"), "check the columns under [columns] and their units");
    }
    if n < FEWEST {
        return fail(format!("it has {n} steps"), "a resonance needs 16 steps at least, most of them within its width");
    }
    if let Some(k) = frequency_hz.iter().position(|f| !(f.is_finite() && *f > 0.0)) {
        let cause = format!("step {k} has the frequency {} Hz", frequency_hz[k]);
        return fail(cause, "`frequency` must be above zero; is another column meant?");
    }
    let counts: Vec<bool> =
        (0..n).map(|k| drive[k] > 0.0 && recording.filled.iter().all(|f| !f.contains(&k))).collect();
    let used = counts.iter().filter(|c| **c).count();
    if used < n {
        findings.push(format!(
            "{} of {n} steps are not fitted: their drive is not above zero, or a cell is missing",
            n - used
        ));
    }
    if used < FEWEST {
        return fail(format!("{used} steps have a drive above zero"), "check the column `drive`");
    }
    if frequency_hz.iter().all(|f| (f - frequency_hz[0]).abs() < 1e-9 * f) {
        return fail(format!("every step is at {} Hz", frequency_hz[0]), "a response needs several frequencies");
    }
    if let Some(growth) = growth(&frequency_hz, &drive, &reading)
        && growth < DIVIDED
    {
        findings.push(format!(
            "over most of the band the reading grows with the drive to the power of {:.2}, where a resonator's grows \
             with its first: was it divided by the drive when it was logged? Then multiply it by the drive before it is \
             diagnosed. Or is most of it a background that does not come from the drive?",
            (100.0 * growth).round() / 100.0 + 0.0
        ));
    }
    let sweeps = in_sweeps(&frequency_hz, &drive);
    let is_ordered = n as f64 > ORDERED * sweeps.len() as f64;
    let sweeps = if is_ordered { sweeps } else { by_drive(&drive) };
    if !is_ordered {
        findings.push("the steps are in no order of frequency: no history is followed from one to the next".into());
    }
    let first_s = time_s.as_ref().map_or(0.0, |t| t[0]);
    Ok(Sweeps {
        frequency_hz,
        drive,
        reading,
        time_s: time_s.map(|t| t.iter().map(|v| v - first_s).collect()),
        counts,
        sweeps,
        jumps: Vec::new(),
        is_ordered,
        derivatives: model.output_is.derivatives(),
    })
}

/// Power of the drive with which the reading grows: the median over frequencies that were taken at drives half
/// as large again or more; `None` without such.
fn growth(frequency_hz: &[f64], drive: &[f64], reading: &[Complex<f64>]) -> Option<f64> {
    let mut by_frequency: Vec<usize> =
        (0..drive.len()).filter(|k| drive[*k] > 0.0 && reading[*k].norm() > 0.0).collect();
    by_frequency.sort_by(|a, b| frequency_hz[*a].total_cmp(&frequency_hz[*b]).then(drive[*a].total_cmp(&drive[*b])));
    let at_one = |a: usize, b: usize| (frequency_hz[a] - frequency_hz[b]).abs() < 1e-9 * frequency_hz[a];
    let powers = by_frequency.chunk_by(|a, b| at_one(*a, *b)).filter_map(|steps| {
        let (weak, strong) = (*steps.first()?, *steps.last()?);
        let ratio = (drive[strong] / drive[weak]).ln();
        (ratio > 1.5f64.ln()).then(|| (reading[strong].norm() / reading[weak].norm()).ln() / ratio)
    });
    median(powers.collect())
}

/// Stretches of one direction and one drive.
fn in_sweeps(frequency_hz: &[f64], drive: &[f64]) -> Vec<Range<usize>> {
    let (mut all, mut start, mut way) = (Vec::new(), 0, 0.0f64);
    for k in 1..frequency_hz.len() {
        let step = frequency_hz[k] - frequency_hz[k - 1];
        let other_drive = (drive[k] - drive[k - 1]).abs() > ANOTHER_DRIVE * drive[k - 1].abs();
        if other_drive || step * way < 0.0 {
            all.push(start..k);
            (start, way) = (k, 0.0);
        } else if step != 0.0 {
            way = step;
        }
    }
    all.push(start..frequency_hz.len());
    all
}

/// Stretches of one drive.
fn by_drive(drive: &[f64]) -> Vec<Range<usize>> {
    let flat = vec![1.0; drive.len()];
    in_sweeps(&flat, drive)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_and_another_drive_begin_another_sweep() {
        let frequency = [1.0, 2.0, 3.0, 3.0, 2.0, 1.0, 1.0, 2.0];
        let drive = [1.0, 1.0, 1.01, 1.0, 1.0, 1.0, 3.0, 3.0];
        assert_eq!(in_sweeps(&frequency, &drive), [0..4, 4..6, 6..8]);
        assert_eq!(by_drive(&drive), [0..6, 6..8]);
    }

    #[test]
    fn a_reading_that_was_divided_by_its_drive_does_not_grow_with_it() {
        let frequency = [1.0, 2.0, 3.0, 1.0, 2.0, 3.0];
        let drive = [1.0, 1.0, 1.0, 4.0, 4.0, 4.0];
        let read = |divided: bool| -> Vec<Complex<f64>> {
            let part = |k: usize| if divided { 1.0 } else { drive[k] };
            (0..6).map(|k| Complex::new(part(k) * frequency[k], 0.1)).collect()
        };
        let of = |divided| growth(&frequency, &drive, &read(divided)).expect("two drives at each frequency");
        assert!(of(true).abs() < DIVIDED && (of(false) - 1.0).abs() < 0.1, "{} {}", of(true), of(false));
        assert_eq!(growth(&frequency, &[1.0; 6], &read(false)), None);
    }

    #[test]
    fn the_spacing_is_that_of_the_two_frequencies_around() {
        let up_and_down = vec![1.0, 2.0, 4.0, 8.0, 8.0, 4.0, 2.0, 1.0];
        let sweeps = Sweeps { frequency_hz: up_and_down, ..Sweeps::default() };
        for (at_hz, expected) in [(1.0, 1.0), (3.0, 2.0), (7.9, 4.0), (0.5, 0.0), (9.0, 0.0)] {
            assert_eq!(sweeps.spacing_hz(at_hz), expected, "{at_hz}");
        }
    }
}
