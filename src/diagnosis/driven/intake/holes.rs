//! Fills short holes of an input from both sides: a straight line, as a reader puts there, is off by
//! what the input does in between, and the mass then moves as under a force that nobody recorded.
//!
//! By the values that an autoregression fitted to the rest finds least surprising (Janssen,
//! Veldhuis & Vries 1986). Not for readings: those are left out where they were not recorded.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::numerics::least_squares::Linear;
use crate::numerics::moments::mean_sd;

/// Past values from which the next one is predicted.
const ORDER: usize = 16;
/// A longer hole has a middle of which its sides know little.
const LONGEST: usize = ORDER / 2;
/// Values that the autoregression is fitted to.
const FITTED: usize = 20_000;
/// Distance from a straight line between its neighbours, in parts of them, below which a value was put there.
const ON_THE_LINE: f64 = 1e-9;

/// Fills the holes of these values among those that were filled in some column; gives their number.
pub(super) fn refill(values: &mut [f64], filled: &[Range<usize>]) -> usize {
    let inside = |hole: &&Range<usize>| hole.start >= 2 * ORDER && hole.end + 2 * ORDER <= values.len();
    let is_hole = |hole: &&Range<usize>| hole.len() <= LONGEST && is_straight(values, hole);
    let holes: Vec<Range<usize>> = filled.iter().filter(inside).filter(is_hole).cloned().collect();
    if holes.is_empty() {
        return 0;
    }
    let mean = mean_sd(values).0;
    values.iter_mut().for_each(|value| *value -= mean);
    if let Some(weights) = autoregression(values, filled) {
        holes.iter().for_each(|hole| fill(values, hole, &weights));
    }
    values.iter_mut().for_each(|value| *value += mean);
    holes.len()
}

fn is_straight(values: &[f64], hole: &Range<usize>) -> bool {
    let (from, to) = (values[hole.start - 1], values[hole.end]);
    let (length, near) = ((hole.len() + 1) as f64, ON_THE_LINE * (from.abs() + to.abs()));
    let off = |k: usize| values[k] - from - (to - from) * (k + 1 - hole.start) as f64 / length;
    hole.clone().all(|k| off(k).abs() <= near)
}

/// Weights of a value and of those before it in an error of prediction, the first of them 1.
fn autoregression(values: &[f64], filled: &[Range<usize>]) -> Option<Vec<f64>> {
    let mut is_whole = vec![true; values.len()];
    filled.iter().flat_map(|hole| hole.start..(hole.end + ORDER).min(values.len())).for_each(|k| is_whole[k] = false);
    let rows: Vec<usize> = (ORDER..values.len()).filter(|k| is_whole[*k]).take(FITTED).collect();
    if rows.len() < 20 * ORDER {
        return None;
    }
    let lag = |by: usize| rows.iter().map(|k| values[k - by]).collect::<Vec<f64>>();
    let linear = Linear { residual: lag(0), columns: (1..=ORDER).map(lag).collect() };
    let step = linear.normal().step(1e-12);
    Some([1.0].into_iter().chain(step.iter().copied()).collect())
}

/// Puts into a hole what makes the errors of prediction smallest that it takes part in.
fn fill(values: &mut [f64], hole: &Range<usize>, weights: &[f64]) {
    let (errors, count) = (hole.len() + ORDER, hole.len());
    let weight = |error: usize, at: usize| (hole.start + error).checked_sub(at).and_then(|lag| weights.get(lag));
    let of_hole = DMatrix::from_fn(errors, count, |e, k| weight(e, hole.start + k).copied().unwrap_or(0.0));
    hole.clone().for_each(|k| values[k] = 0.0);
    let known = |e: usize| -> f64 { weights.iter().enumerate().map(|(lag, w)| w * values[hole.start + e - lag]).sum() };
    let known = DVector::from_fn(errors, |e, _| -known(e));
    let normal = of_hole.tr_mul(&of_hole);
    // The first weight is 1: the matrix is positive definite.
    if let Some(found) = normal.cholesky().map(|c| c.solve(&of_hole.tr_mul(&known))) {
        hole.clone().zip(found.iter()).for_each(|(k, value)| values[k] = *value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of up to an eighth of the sampling rate, of unit power.
    fn smooth(k: usize) -> f64 {
        let line = |n: usize| (0.78 * (n + 1) as f64 / 20.0 * k as f64 + (n * n) as f64).sin();
        (0..20).map(line).sum::<f64>() / 10f64.sqrt()
    }

    #[test]
    fn short_holes_are_filled_a_hundred_times_better_than_by_lines() {
        let rough = |k: usize| 1e-4 * (((k * 7919) % 1013) as f64 / 1013.0 - 0.5);
        let truth: Vec<f64> = (0..6000).map(|k| 3.0 + smooth(k) + rough(k)).collect();
        let holes: Vec<Range<usize>> = (1..25).map(|i| 230 * i..230 * i + 1 + i % 3).collect();
        let mut lines = truth.clone();
        for hole in &holes {
            let (from, to) = (truth[hole.start - 1], truth[hole.end]);
            let length = (hole.len() + 1) as f64;
            hole.clone().for_each(|k| lines[k] = from + (to - from) * (k + 1 - hole.start) as f64 / length);
        }
        let off = |values: &[f64]| -> f64 {
            holes.iter().flat_map(Range::clone).map(|k| (values[k] - truth[k]).powi(2)).sum::<f64>().sqrt()
        };
        let mut filled = lines.clone();
        assert_eq!(refill(&mut filled, &holes), holes.len());
        assert!(off(&filled) < 0.01 * off(&lines), "{} {}", off(&filled), off(&lines));
        // Control: what was recorded there stays.
        let mut recorded = truth.clone();
        assert_eq!(refill(&mut recorded, &holes), 0);
        assert_eq!(recorded, truth);
    }
}
