//! States where the IMU lay still: read from a file of row ranges, or found in the recording.
//!
//! The finder follows Tedaldi, Pretto & Menegatti (ICRA 2014): the variance in a sliding window
//! against a multiple of the quietest one, the multiple chosen by scanning. They take the one that
//! calibrates best; here the lowest that finds nearly as many poses as any does, so that the choice
//! does not look at the model that is to be judged.

use std::ops::Range;
use std::path::Path;

use super::imu::Imu;
use crate::error::{Error, Result};
use crate::numerics::order;
use crate::recording::Recording;
use crate::recording::rows::Rows;

/// Window of the variance, s.
const WINDOW_S: f64 = 1.0;
const SHORTEST_S: f64 = 1.5;
/// Left out at both ends of a pose, where a motion begins gently, s.
const MARGIN_S: f64 = 0.1;
/// Multiples of the quietest variance that are tried.
const MULTIPLES: [f64; 9] = [2.0, 3.0, 5.0, 8.0, 12.0, 20.0, 40.0, 80.0, 160.0];

/// Reads `start_row,end_row_exclusive`, which count rows of the whole file. Of a recording that is
/// only a part of its file, poses outside that part are left out.
///
/// # Errors
/// A file that cannot be read; ranges that are empty, out of order or beyond the recording, each
/// with its line.
pub fn read(path: &Path, recording: &Recording) -> Result<Vec<Range<usize>>> {
    let (first, samples) = (recording.first_row, recording.samples());
    let fail = |line: usize, cause: String| {
        Error::new(
            format!("could not use the poses in {}", path.display()),
            format!("line {line}: {cause}"),
            "one range of rows per line, start_row,end_row_exclusive, counted from zero and in chronological order",
        )
    };
    let mut rows = Rows::open(path, &["start_row".to_owned(), "end_row_exclusive".to_owned()])?;
    let mut out: Vec<Range<usize>> = Vec::new();
    let mut row = [f64::NAN; 2];
    while rows.next(&mut row)? {
        let line = out.len() + 2;
        let whole = |v: f64| (v >= 0.0 && v.fract() == 0.0 && v < 1e15).then_some(v as usize);
        let (Some(start), Some(end)) = (whole(row[0]), whole(row[1])) else {
            return Err(fail(line, format!("{}, {} are not row numbers", row[0], row[1])));
        };
        if start >= end {
            return Err(fail(line, format!("rows {start} to {end} are an empty range")));
        }
        if out.last().is_some_and(|last| last.end + first > start) {
            return Err(fail(line, format!("rows {start} to {end} overlap the pose before")));
        }
        if recording.is_part() && (start < first || end > first + samples) {
            continue;
        }
        if end > samples {
            return Err(fail(line, format!("rows {start} to {end}, but the recording has {samples}")));
        }
        out.push(start - first..end - first);
    }
    Ok(out)
}

/// Stretches of samples in which the IMU lay still, half-open and in order.
pub fn find(imu: &Imu<'_>) -> Vec<Range<usize>> {
    let window = ((WINDOW_S * imu.rate_hz).round() as usize).max(4);
    let activity = activity(imu, window);
    if activity.is_empty() {
        return Vec::new();
    }
    let mut sorted = activity.clone();
    order::sort(&mut sorted);
    // The quietest hundredth: below it lies chance, above it motion may begin.
    let quiet = sorted[sorted.len() / 100].max(f64::MIN_POSITIVE);
    let tried: Vec<Vec<Range<usize>>> =
        MULTIPLES.iter().map(|m| stretches(&activity, quiet * m, window, imu.rate_hz)).collect();
    // A low threshold breaks poses apart or loses them, a high one swallows the gentle beginnings
    // of motion: the lowest that finds nearly all.
    let most = tried.iter().map(Vec::len).max().unwrap_or(0);
    tried.into_iter().find(|poses| 10 * poses.len() >= 9 * most).unwrap_or_default()
}

/// Sum over the axes of the variance in a window centred on each sample, each sensor over its own
/// quiet level.
fn activity(imu: &Imu<'_>, window: usize) -> Vec<f64> {
    let samples = imu.accelerometer[0].len();
    if samples < 2 * window {
        return Vec::new();
    }
    let mut total = vec![0.0; samples - window];
    for sensor in [Some(&imu.accelerometer), imu.gyro.as_ref()].into_iter().flatten() {
        let mut sum = vec![0.0; total.len()];
        let mut finest = 0.0;
        for values in sensor {
            // Rounding hides motion below its own variance, so no quiet level lies below it.
            let step =
                values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|c| *c > 0.0).fold(f64::INFINITY, f64::min);
            finest += if step.is_finite() { step * step / 12.0 } else { 0.0 };
            let centre = values.iter().sum::<f64>() / samples as f64;
            let (mut first, mut second) = (0.0, 0.0);
            for (k, value) in values.iter().enumerate() {
                let v = value - centre;
                (first, second) = (first + v, second + v * v);
                if k >= window {
                    let old = values[k - window] - centre;
                    (first, second) = (first - old, second - old * old);
                }
                if k + 1 >= window && k + 1 - window < sum.len() {
                    let n = window as f64;
                    sum[k + 1 - window] += (second / n - (first / n).powi(2)).max(0.0);
                }
            }
        }
        let mut sorted = sum.clone();
        order::sort(&mut sorted);
        let level = sorted[sorted.len() / 100].max(finest).max(f64::MIN_POSITIVE);
        total.iter_mut().zip(&sum).for_each(|(t, s)| *t += s / level);
    }
    total
}

/// Stretches whose windows all stay below the threshold.
fn stretches(activity: &[f64], threshold: f64, window: usize, rate_hz: f64) -> Vec<Range<usize>> {
    let mut out: Vec<Range<usize>> = Vec::new();
    let mut start = None;
    for k in 0..=activity.len() {
        let still = k < activity.len() && activity[k] < threshold;
        match (start, still) {
            (None, true) => start = Some(k),
            (Some(begin), false) => {
                // The windows k cover samples k..k+window; all of them lie within the stretch.
                let range = begin..k - 1 + window;
                match out.last_mut() {
                    // A motion would leave a gap; stretches that overlap are one, broken by a
                    // chance excursion.
                    Some(last) if range.start <= last.end => last.end = range.end,
                    _ => out.push(range),
                }
                start = None;
            }
            _ => {}
        }
    }
    let margin = (MARGIN_S * rate_hz).round() as usize;
    out.retain(|r| r.len() as f64 >= (SHORTEST_S + 2.0 * MARGIN_S) * rate_hz && r.len() > 2 * margin);
    out.iter().map(|r| r.start + margin..r.end - margin).collect()
}
