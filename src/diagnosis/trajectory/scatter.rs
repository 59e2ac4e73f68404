//! Noise in motion, told apart by how it grows: what the reference errs by, and what the sensor
//! does.
//!
//! The angle between reference and dead reckoning changes over a time T by D(T) = ⟨|E(t + T) −
//! E(t)|²⟩. White noise of the gyro makes it grow as N² T; errors of the reference do not go on
//! growing. No more white noise is in the gyro at any frequency than its readings show where
//! nothing moves: their floor bounds N.

use nalgebra::Vector3;

use super::blocks::BLOCKS;
use super::judgement::FALSE_NAME;
use super::log::Log;
use crate::model::{InertialNoise, Noise};
use crate::numerics::order;
use crate::numerics::special::{f_survival, t_quantile};
use crate::numerics::spectrum::welch;

/// Times over which errors are compared, in bins.
const SPANS: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Variance over that of the sensor's noise from which the rest is the reference's.
const BEYOND: f64 = 2.0;
/// States where readings show their noise alone, as fractions of the sampling rate, and the
/// quantile of the lines that is the floor.
const FLOOR: ([f64; 2], f64) = ([0.15, 0.45], 0.25);

/// Noise that a reference has beyond the sensor's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Excess {
    /// Standard deviation per axis of the reference's means over `mean_s`, in the unit of the
    /// errors.
    pub deviation: f64,
    /// Its 95 % interval.
    pub ci95: [f64; 2],
    /// Time of which errors were averaged: single poses err by more, s.
    pub mean_s: f64,
    /// Variance over the sensor's.
    pub times: f64,
    /// Chance that so much is seen where there is no such excess, corrected for the times that were
    /// compared.
    pub p_value: f64,
}

/// Variance per Hz of the floor of readings, one-sided, unit²/Hz: mean of the axes.
pub(super) fn floor(readings: &[Vector3<f64>], rate_hz: f64) -> f64 {
    let axis = |i: usize| {
        let values: Vec<f64> = readings.iter().map(|r| r[i]).collect();
        let density = welch(&values, rate_hz, 512.min(values.len()));
        let [from, to] = FLOOR.0.map(|fraction| fraction * rate_hz);
        let mut inside: Vec<f64> = density
            .frequency_hz
            .iter()
            .zip(&density.density)
            .filter(|(hz, _)| (from..to).contains(*hz))
            .map(|l| *l.1)
            .collect();
        order::sort(&mut inside);
        if inside.is_empty() { 0.0 } else { order::quantile(&inside, FLOOR.1) }
    };
    (axis(0) + axis(1) + axis(2)) / 3.0
}

/// N² of gyro and accelerometer: half the one-sided density that is stated, else that of the floor
/// of the readings.
pub(super) fn random_walks(log: &Log, stated: InertialNoise) -> [f64; 2] {
    let walk = |stated: Option<Noise>, readings: &[Vector3<f64>]| {
        0.5 * stated.map_or_else(|| floor(readings, 1.0 / log.interval_s), |noise| noise.density * noise.density)
    };
    [walk(stated.gyro, &log.rate), walk(stated.accelerometer, &log.force)]
}

/// Returns what errors, given as changes per second from bin to bin, show beyond the sensor's white
/// noise; `random_walk` is its N².
pub(super) fn excess(changes: &[(Vector3<f64>, bool)], width_s: f64, random_walk: f64) -> Option<Excess> {
    let found = SPANS.into_iter().filter_map(|span| over(changes, width_s, random_walk, span));
    found.max_by(|a, b| a.deviation.total_cmp(&b.deviation))
}

fn over(changes: &[(Vector3<f64>, bool)], width_s: f64, random_walk: f64, span: usize) -> Option<Excess> {
    let mut blocks = vec![(0.0, 0.0); BLOCKS];
    let windows = changes.len().checked_sub(span)?;
    for k in 0..windows {
        let window = &changes[k..k + span];
        if window.iter().all(|c| c.1) {
            let block = &mut blocks[k * BLOCKS / windows.max(1)];
            block.0 += (window.iter().map(|c| c.0).sum::<Vector3<f64>>() * width_s).norm_squared();
            block.1 += 3.0;
        }
    }
    let blocks: Vec<(f64, f64)> = blocks.into_iter().filter(|b| b.1 > 0.0).collect();
    let n = blocks.len() as f64;
    if n < 5.0 {
        return None;
    }
    let mean = |skip: usize| {
        let kept = blocks.iter().enumerate().filter(|(k, _)| *k != skip);
        let (sum, count) = kept.fold((0.0, 0.0), |s, (_, b)| (s.0 + b.0, s.1 + b.1));
        sum / f64::max(count, 1.0)
    };
    let own = random_walk * width_s * span as f64;
    let all = mean(usize::MAX);
    let deviation = ((0..blocks.len()).map(|k| (mean(k) - all).powi(2)).sum::<f64>() * (n - 1.0) / n).sqrt();
    let least = all - t_quantile(1.0 - FALSE_NAME / SPANS.len() as f64, n - 1.0) * deviation;
    let half = t_quantile(0.975, n - 1.0) * deviation;
    let size = |variance: f64| (0.5 * (variance - own).max(0.0)).sqrt();
    (least > BEYOND * own).then(|| Excess {
        deviation: size(all),
        ci95: [size(all - half), size(all + half)],
        mean_s: width_s,
        times: all / own.max(f64::MIN_POSITIVE),
        p_value: (SPANS.len() as f64 * beyond(all - BEYOND * own, deviation, n)).min(1.0),
    })
}

/// Probability of a mean this far above zero by chance, where it is one of `blocks` values:
/// Student's t.
pub(super) fn beyond(mean: f64, deviation: f64, blocks: f64) -> f64 {
    let t = mean / deviation.max(f64::MIN_POSITIVE);
    let tail = 0.5 * f_survival(t * t, 1.0, blocks - 1.0);
    if t > 0.0 { tail.max(f64::MIN_POSITIVE) } else { 1.0 - tail }
}

/// Position errors that are white from bin to bin: σ of a bin's mean out of second differences,
/// whose variance is 6σ²/W⁴ and which follow each other with a correlation of −2/3. None where the
/// sensor's noise alone makes as much, or where they do not follow each other like that.
pub(super) fn position(changes: &[(Vector3<f64>, bool)], width_s: f64, random_walk: f64) -> Option<Excess> {
    /// Correlation half way between that of the sensor's noise (1/4 for means over two bins) and
    /// −2/3.
    const ALTERNATES: f64 = -0.2;
    let mut blocks = vec![(0.0, 0.0, 0.0); BLOCKS];
    for (k, pair) in changes.windows(2).enumerate().filter(|(_, p)| p[0].1 && p[1].1) {
        let block = &mut blocks[k * BLOCKS / changes.len()];
        block.0 += pair[0].0.norm_squared();
        block.1 += pair[0].0.dot(&pair[1].0);
        block.2 += 3.0;
    }
    let blocks: Vec<(f64, f64, f64)> = blocks.into_iter().filter(|b| b.2 > 0.0).collect();
    let n = blocks.len() as f64;
    if n < 5.0 {
        return None;
    }
    let sums = |skip: usize| {
        let kept = blocks.iter().enumerate().filter(|(k, _)| *k != skip);
        let (s, c, n) = kept.fold((0.0, 0.0, 0.0), |t, (_, b)| (t.0 + b.0, t.1 + b.1, t.2 + b.2));
        (s / f64::max(n, 1.0), c / f64::max(s, f64::MIN_POSITIVE))
    };
    // Specific force over two bins, weighted by a triangle: N² · 2/(3W).
    let own = random_walk * 2.0 / (3.0 * width_s);
    let (variance, follows) = sums(usize::MAX);
    let deviation = ((0..blocks.len()).map(|k| (sums(k).0 - variance).powi(2)).sum::<f64>() * (n - 1.0) / n).sqrt();
    let least = variance - t_quantile(1.0 - FALSE_NAME, n - 1.0) * deviation;
    let half = t_quantile(0.975, n - 1.0) * deviation;
    let size = |variance: f64| ((variance - own).max(0.0) / 6.0).sqrt() * width_s * width_s;
    (least > BEYOND * own && follows < ALTERNATES).then(|| Excess {
        deviation: size(variance),
        ci95: [size(variance - half), size(variance + half)],
        mean_s: width_s,
        times: variance / own.max(f64::MIN_POSITIVE),
        p_value: beyond(variance - BEYOND * own, deviation, n),
    })
}
