//! What is wrong with a driven recording besides its physics: glitches, a scale that changes midway, jumps that neither the
//! past nor the input foretells.
//!
//! Only what no oscillator does, so that none of it is taken for physics. What one column shows by itself (gaps, rails, a
//! dead channel) is the business of `recording`.

use std::ops::Range;

use crate::numerics::least_squares::Linear;
use crate::numerics::order;

use super::start::spread;

/// A reading this many times farther off its neighbours than readings are wont to be is a glitch.
const FAR_OFF: f64 = 60.0;
/// Share of the readings that may be glitches; more is no accident.
const RARE: f64 = 1e-3;
/// Blocks in which the scale is looked at.
const BLOCKS: usize = 24;
/// Change of scale that no physics makes from one moment to the next.
const RESCALED: f64 = 50.0;
/// A change that no change of unit makes either: one of the two went dead.
const DEAD: f64 = 1e7;
/// Past readings, and inputs on either side, from which a reading is foretold.
const LAGS: usize = 8;
/// A forecast this many times worse than forecasts are wont to be is a jump.
const SURPRISING: f64 = 15.0;
/// More surprises than this are the sensor's way and not an accident.
const FEW: usize = 3;

/// Typical absolute size: that of normally distributed values would be their standard deviation.
fn typical(values: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<f64> = values.map(f64::abs).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    sizes.select_nth_unstable_by(middle, f64::total_cmp);
    1.4826 * sizes[middle]
}

/// Replaces single readings far off their neighbours by straight lines; gives their places.
pub fn glitches(values: &mut [f64]) -> Vec<usize> {
    let n = values.len();
    if n < 100 {
        return Vec::new();
    }
    let off = |v: &[f64], k: usize| v[k] - 0.5 * (v[k - 1] + v[k + 1]);
    let usual = typical((1..n - 1).map(|k| off(values, k)));
    let mut sorted = values.to_vec();
    order::sort(&mut sorted);
    // A wave as large as the signal, and far from smooth.
    let least = FAR_OFF * usual + 0.5 * (sorted[n - 1 - n / 100] - sorted[n / 100]);
    let found: Vec<usize> = (2..n - 2)
        .filter(|k| {
            let here = off(values, *k).abs();
            // A step bends two neighbouring places alike, a single stray value bends its own most.
            here > least && here > 1.8 * off(values, k - 1).abs() && here > 1.8 * off(values, k + 1).abs()
        })
        .collect();
    if found.len() as f64 > (RARE * n as f64).max(1.0) {
        return Vec::new();
    }
    for k in &found {
        values[*k] = 0.5 * (values[k - 1] + values[k + 1]);
    }
    found
}

/// Where the size of the output relative to the input's changes at once and for good, and by what factor.
pub fn rescaled(input: &[f64], output: &[f64], among: &Range<usize>) -> Option<(usize, f64)> {
    let edge = |i: usize| among.start + among.len() * i / BLOCKS;
    let logs: Vec<f64> = (0..BLOCKS)
        .filter_map(|i| {
            let size = |v: &[f64]| spread(&v[edge(i)..edge(i + 1)]).1;
            let ratio = size(output) / size(input);
            (ratio.is_finite() && ratio > 0.0).then(|| ratio.ln())
        })
        .collect();
    if logs.len() < BLOCKS {
        return None;
    }
    let extremes =
        |part: &[f64]| part.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    (2..BLOCKS - 1).find_map(|cut| {
        // The block before the cut may hold some of both.
        let (before, after) = (extremes(&logs[..cut - 1]), extremes(&logs[cut..]));
        let gap = (after.0 - before.1).max(before.0 - after.1);
        if gap < RESCALED.ln() || gap > DEAD.ln() {
            return None;
        }
        let middle = |(low, high): (f64, f64)| 0.5 * (low + high);
        Some((edge(cut), (middle(after) - middle(before)).exp()))
    })
}

/// Places where the output jumps as neither its past nor the input foretells; none where that happens often.
pub fn jumps(input: Option<&[f64]>, output: &[f64], among: &Range<usize>) -> Vec<usize> {
    let rows = among.start.max(LAGS)..among.end.min(output.len().saturating_sub(LAGS));
    if rows.len() < 40 * LAGS {
        return Vec::new();
    }
    let back = |values: &[f64], lag: isize| -> Vec<f64> {
        rows.clone().map(|k| values[(k as isize - lag) as usize]).collect()
    };
    let mut columns = vec![vec![1.0; rows.len()]];
    columns.extend((1..=LAGS as isize).map(|lag| back(output, lag)));
    if let Some(input) = input {
        columns.extend((-(LAGS as isize) / 2..=LAGS as isize / 2).map(|lag| back(input, lag)));
    }
    let body = back(output, 0);
    let linear = Linear { residual: body.clone(), columns };
    let step = linear.normal().step(1e-12);
    let error: Vec<f64> = (0..body.len())
        .map(|i| body[i] + linear.columns.iter().zip(step.iter()).map(|(c, s)| c[i] * s).sum::<f64>())
        .collect();
    let usual = typical(error.iter().copied());
    let mut places: Vec<usize> = Vec::new();
    for (i, e) in error.iter().enumerate() {
        if e.abs() > SURPRISING * usual && e.is_finite() {
            match places.last() {
                Some(last) if rows.start + i <= last + 4 * LAGS => {}
                _ => places.push(rows.start + i),
            }
        }
    }
    if places.len() > FEW { Vec::new() } else { places }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(n: usize) -> Vec<f64> {
        // Two tones and a small deterministic roughness in place of noise.
        let rough = |k: usize| ((k * 7919) % 1013) as f64 / 1013.0 - 0.5;
        (0..n).map(|k| (0.2 * k as f64).sin() + 0.3 * (0.51 * k as f64).cos() + 0.004 * rough(k)).collect()
    }

    #[test]
    fn a_stray_value_is_replaced_and_a_step_is_not() {
        let mut values = sine(2000);
        let truth = values[700];
        values[700] = 1e5;
        assert_eq!(glitches(&mut values), [700]);
        assert!((values[700] - truth).abs() < 0.1);
        let mut square: Vec<f64> = (0..2000).map(|k| if k / 50 % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!(glitches(&mut square).is_empty() && glitches(&mut sine(2000)).is_empty());
    }

    #[test]
    fn a_unit_that_changes_midway_is_found_and_a_growing_signal_is_not() {
        let (u, mut y) = (sine(4000), sine(4000));
        assert_eq!(rescaled(&u, &y, &(0..4000)), None);
        y[2000..].iter_mut().for_each(|v| *v *= 1000.0);
        let (place, factor) = rescaled(&u, &y, &(0..4000)).expect("a thousandfold");
        assert!(place.abs_diff(2000) <= 4000 / BLOCKS && (factor / 1000.0).ln().abs() < 0.7, "{place} {factor}");
        let growing: Vec<f64> = sine(4000).iter().enumerate().map(|(k, v)| v * (k as f64 / 300.0).exp()).collect();
        assert_eq!(rescaled(&u, &growing, &(0..4000)), None);
    }

    #[test]
    fn a_lost_sample_is_a_jump_and_a_whole_recording_has_none() {
        let mut y = sine(3000);
        assert!(jumps(None, &y, &(0..3000)).is_empty());
        y.remove(1500);
        let found = jumps(None, &y, &(0..2999));
        assert!(found.len() == 1 && found[0].abs_diff(1500) <= 2, "{found:?}");
    }
}
