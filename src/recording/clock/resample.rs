//! Rows of an uneven clock made even: interpolated where the samples were uneven, as they are where
//! only the stamps were.

use crate::numerics::lagrange;
use crate::rng::{Philox, Stream};

/// Rows from which a value between them is made.
const REACH: usize = 6;
/// A step of more ticks than this has a straight line across it.
const GAP: f64 = 3.0;
/// Roughness that interpolation leaves of a signal, over what it leaves of white noise, below which the samples were
/// uneven: a quarter is six deviations of that ratio over a thousand rows with times off by up to 0.3 of a step each
/// way (0.043 in 60 draws).
const SMOOTHED: f64 = 0.75;

/// Returns whether the stamps stay within a tick of an even clock, from the first on.
pub fn near_even(times_s: &[f64], tick_s: f64) -> bool {
    times_s.iter().enumerate().all(|(i, t)| (t - times_s[0] - i as f64 * tick_s).abs() < tick_s)
}

/// Returns whether the samples were even and only the stamps were not, as told by columns: a signal
/// that was sampled evenly is smooth row by row, one that was not is smooth only after
/// interpolation.
pub fn samples_are_even(times_s: &[f64], tick_s: f64, columns: &[Vec<f64>]) -> bool {
    let ratio = |column: &[f64]| roughness(&even(times_s, tick_s, column)) / roughness(column).max(1e-300);
    let mut random = Philox::new(0, 0, Stream::Host);
    let noise: Vec<f64> = times_s.iter().map(|_| random.normal()).collect();
    // Interpolation smooths noise by itself.
    columns.iter().map(|c| ratio(c)).fold(f64::INFINITY, f64::min) > SMOOTHED * ratio(&noise)
}

fn roughness(values: &[f64]) -> f64 {
    let fourth = |w: &[f64]| w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4];
    values.windows(5).map(|w| fourth(w).powi(2)).filter(|v| v.is_finite()).sum()
}

/// Samples at even times: how many there are for these stamps.
pub fn count(times_s: &[f64], tick_s: f64) -> usize {
    let span = times_s.last().zip(times_s.first()).map_or(0.0, |(last, first)| last - first);
    (span / tick_s + 1e-6).floor() as usize + 1
}

/// The even times that lie within gaps.
pub fn gaps(times_s: &[f64], tick_s: f64) -> Vec<std::ops::Range<usize>> {
    let tick = |time: f64| ((time - times_s[0]) / tick_s).max(0.0);
    let long = times_s.windows(2).filter(|w| w[1] - w[0] > GAP * tick_s);
    long.map(|w| tick(w[0]).floor() as usize + 1..tick(w[1]).ceil() as usize).collect()
}

/// A column at even times, by the polynomial through the six rows around each; straight across
/// gaps.
pub fn even(times_s: &[f64], tick_s: f64, values: &[f64]) -> Vec<f64> {
    let mut row = 0;
    let rows = times_s.len();
    let at = |tick: usize| {
        let time = times_s[0] + tick as f64 * tick_s;
        while row + 2 < rows && times_s[row + 1] <= time {
            row += 1;
        }
        let reach = REACH.min(rows);
        let first = row.saturating_sub(REACH / 2 - 1).min(rows - reach);
        let around = &times_s[first..first + reach];
        if around.windows(2).any(|w| w[1] - w[0] > GAP * tick_s) {
            let next = (row + 1).min(rows - 1);
            let share = ((time - times_s[row]) / (times_s[next] - times_s[row]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            return values[row] + share * (values[next] - values[row]);
        }
        (0..reach).map(|j| lagrange::weight(around, j, time) * values[first + j]).sum()
    };
    (0..count(times_s, tick_s)).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_stays_straight_and_late_stamps_are_told_from_late_samples() {
        let times: Vec<f64> = (0..1000).map(|i| f64::from(i) + if i % 3 == 1 { 0.4 } else { 0.0 }).collect();
        let line = even(&times, 1.0, &times);
        assert!(line.windows(2).all(|w| (w[1] - w[0] - 1.0).abs() < 2e-3));
        assert!(near_even(&times, 1.0) && !near_even(&times, 1.01));
        let wave = |t: f64| (0.4 * t).sin();
        let late_stamps: Vec<f64> = (0..1000).map(|i| wave(f64::from(i))).collect();
        let late_samples: Vec<f64> = times.iter().map(|t| wave(*t)).collect();
        assert!(samples_are_even(&times, 1.0, &[late_stamps]));
        assert!(!samples_are_even(&times, 1.0, &[late_samples]));
    }

    #[test]
    fn a_gap_is_crossed_straight() {
        let mut times: Vec<f64> = (0..40).map(|i| f64::from(i) + if i % 2 == 0 { 0.3 } else { 0.0 }).collect();
        times.iter_mut().skip(20).for_each(|t| *t += 10.0);
        let values: Vec<f64> = (0..40).map(|i| if i < 20 { 0.0 } else { 1.0 }).collect();
        let made = even(&times, 1.0, &values);
        assert!(made.iter().all(|v| (-1e-9..=1.0 + 1e-9).contains(v)), "{made:?}");
    }
}
