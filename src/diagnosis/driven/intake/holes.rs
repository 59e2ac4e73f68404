//! Fills short holes of an input from both sides: a straight line, as a reader puts there, is off by
//! what the input does in between, and the mass then moves as under a force that nobody recorded.
//!
//! By the values that an autoregression fitted to the rest finds least surprising (Janssen,
//! Veldhuis & Vries 1986). Not for readings: those are left out where they were not recorded.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::numerics::least_squares::Linear;
use crate::numerics::order;

/// Past values from which the next one is predicted.
const ORDER: usize = 16;
/// A longer hole has a middle of which its sides know little.
const LONGEST: usize = ORDER / 2;
/// Values that the autoregression is fitted to.
const FITTED: usize = 20_000;
/// Values, evenly spaced, by which prediction is compared with straight lines.
const COMPARED: usize = 400;

/// Fills the short ones among the holes of these values; gives their number.
pub(super) fn refill(values: &mut [f64], holes: &[Range<usize>]) -> usize {
    let inside = |hole: &&Range<usize>| hole.start >= ORDER && hole.end + ORDER <= values.len();
    let short: Vec<Range<usize>> = holes.iter().filter(|h| h.len() <= LONGEST).filter(inside).cloned().collect();
    // From the median: where an input is silent, nothing is predicted but that.
    let Some(middle) = (!short.is_empty()).then(|| order::median(values.to_vec())).flatten() else { return 0 };
    let mut off: Vec<f64> = values.iter().map(|value| value - middle).collect();
    let weights = autoregression(&off, holes).filter(|weights| is_nearer(&off, holes, weights));
    let Some(weights) = weights else { return 0 };
    let mut count = 0;
    for hole in short {
        let Some(found) = predicted(&off, &hole, &weights) else { continue };
        off[hole.clone()].copy_from_slice(&found);
        hole.zip(found).for_each(|(k, value)| values[k] = middle + value);
        count += 1;
    }
    count
}

/// Weights of a value and of those before it in an error of prediction, the first of them 1.
fn autoregression(values: &[f64], holes: &[Range<usize>]) -> Option<Vec<f64>> {
    let mut is_whole = vec![true; values.len()];
    holes.iter().flat_map(|hole| hole.start..(hole.end + ORDER).min(values.len())).for_each(|k| is_whole[k] = false);
    let rows: Vec<usize> = (ORDER..values.len()).filter(|k| is_whole[*k]).take(FITTED).collect();
    if rows.len() < 20 * ORDER {
        return None;
    }
    let lag = |by: usize| rows.iter().map(|k| values[k - by]).collect::<Vec<f64>>();
    let linear = Linear { residual: lag(0), columns: (1..=ORDER).map(lag).collect() };
    let step = linear.normal().step(1e-12);
    Some([1.0].into_iter().chain(step.iter().copied()).collect())
}

/// Returns whether prediction mostly comes as near to what was recorded as a straight line does: not where
/// an input is held between its samples.
fn is_nearer(values: &[f64], holes: &[Range<usize>], weights: &[f64]) -> bool {
    let (count, mut off) = (values.len(), [Vec::new(), Vec::new()]);
    let is_near_a_hole = |k: usize| holes.iter().any(|hole| hole.start <= k + ORDER && k < hole.end + ORDER);
    for k in (ORDER..count - ORDER).step_by((count / COMPARED).max(1)).filter(|k| !is_near_a_hole(*k)) {
        let Some(found) = predicted(values, &(k..k + 1), weights) else { continue };
        let line = 0.5 * (values[k - 1] + values[k + 1]);
        off[0].push((found[0] - values[k]).abs());
        off[1].push((line - values[k]).abs());
    }
    let [prediction, line] = off.map(order::median);
    prediction.zip(line).is_some_and(|(prediction, line)| prediction <= line)
}

/// The values in a hole that make the errors of prediction smallest in which they take part.
fn predicted(values: &[f64], hole: &Range<usize>, weights: &[f64]) -> Option<Vec<f64>> {
    let (errors, count) = (hole.len() + ORDER, hole.len());
    let weight = |error: usize, at: usize| error.checked_sub(at).and_then(|lag| weights.get(lag)).copied();
    let of_hole = DMatrix::from_fn(errors, count, |e, k| weight(e, k).unwrap_or(0.0));
    let of_others = |e: usize| -> f64 {
        let terms = weights.iter().enumerate().map(|(lag, w)| (hole.start + e - lag, w));
        terms.filter(|(k, _)| !hole.contains(k)).map(|(k, w)| w * values[k]).sum()
    };
    let known = DVector::from_fn(errors, |e, _| -of_others(e));
    // The weight of the value itself is 1: the matrix is positive definite.
    let found = of_hole.tr_mul(&of_hole).cholesky()?.solve(&of_hole.tr_mul(&known));
    Some(found.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use std::slice::from_ref;

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
        // What was recorded stays to the bit.
        let is_hole = |k: usize| holes.iter().any(|hole| hole.contains(&k));
        assert!((0..6000).filter(|k| !is_hole(*k)).all(|k| filled[k].to_bits() == truth[k].to_bits()));
    }

    #[test]
    fn a_silent_input_stays_silent_and_what_cannot_be_predicted_is_left() {
        // One blow of 40 samples in 6000 of silence, at a level of its own.
        let truth: Vec<f64> = (0..6000).map(|k| 2.5 + if k < 40 { smooth(k) } else { 0.0 }).collect();
        let mut filled = truth.clone();
        assert_eq!(refill(&mut filled, from_ref(&(3000..3002))), 1);
        assert_eq!(filled, truth);
        let mut long = truth.clone();
        assert_eq!(refill(&mut long, from_ref(&(3000..3001 + LONGEST))), 0, "its sides know little of its middle");
        assert_eq!(refill(&mut long[..300], from_ref(&(100..101))), 0, "too few values to learn from");
        let switched = |k: usize| if (k / 6 * 7919) % 13 < 6 { 1.0 } else { -1.0 };
        let mut held: Vec<f64> = (0..6000).map(switched).collect();
        assert_eq!(refill(&mut held, from_ref(&(3001..3002))), 0, "between equal values a line is exact");
    }
}
