//! Finds defects of a driven recording other than its physics: glitches, a scale that changes
//! midway, jumps that neither the past nor the input predicts.
//!
//! Only what no oscillator does, so that none of it is taken for physics. What one column shows by
//! itself (gaps, rails, a dead channel) is the business of `recording`.

use std::ops::Range;

use crate::numerics::least_squares::Linear;
use crate::numerics::moments::mean_sd;
use crate::numerics::order;

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
/// Past readings, and inputs on either side, from which a reading is predicted.
const LAGS: usize = 8;
/// A forecast this many times worse than forecasts are wont to be is a jump.
const SURPRISING: f64 = 15.0;
/// More surprises than this are the sensor's way and not an accident.
const FEW: usize = 3;
/// Surprises nearer to each other than this are one, which is where it is strongest.
const APART: usize = 4 * LAGS;
/// Share of the readings on either side of the range of which too few are known to learn what is
/// usual there.
const TAIL: f64 = 0.01;

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
pub(super) fn glitches(values: &mut [f64]) -> Vec<usize> {
    let n = values.len();
    if n < 100 {
        return Vec::new();
    }
    let off = |v: &[f64], k: usize| v[k] - 0.5 * (v[k - 1] + v[k + 1]);
    let usual = typical((1..n - 1).map(|k| off(values, k)));
    let mut sorted = values.to_vec();
    order::sort(&mut sorted);
    // About it, a stray value finds what is usual; the peak of a ringing finds others.
    let about = |k: usize| {
        let near = k.saturating_sub(LAGS).max(1)..(k + LAGS + 1).min(n - 1);
        typical(near.filter(|i| i.abs_diff(k) > 1).map(|i| off(values, i)))
    };
    // A wave as large as the signal, and far from smooth.
    let wave = 0.5 * (sorted[n - 1 - n / 100] - sorted[n / 100]);
    let found: Vec<usize> = (2..n - 2)
        .filter(|k| {
            let here = off(values, *k).abs();
            // A step bends two neighbouring places alike, a single stray value bends its own most.
            here > FAR_OFF * usual + wave
                && here > FAR_OFF * about(*k)
                && here > 1.8 * off(values, k - 1).abs()
                && here > 1.8 * off(values, k + 1).abs()
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

/// Returns where the size of the output relative to the input's changes at once and for good, and
/// by what factor.
pub(super) fn rescaled(input: &[f64], output: &[f64], among: &Range<usize>) -> Option<(usize, f64)> {
    let edge = |i: usize| among.start + among.len() * i / BLOCKS;
    let logs: Vec<f64> = (0..BLOCKS)
        .filter_map(|i| {
            let size = |v: &[f64]| mean_sd(&v[edge(i)..edge(i + 1)]).1;
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

/// Places where the output jumps and neither its past nor the input predicts it; none where the
/// forecast itself goes to the ends of the range: what a law does where the motion hardly ever
/// comes is not known.
pub(crate) fn jumps(input: Option<&[f64]>, output: &[f64], among: &Range<usize>) -> Vec<usize> {
    let mut sorted = output[among.clone()].to_vec();
    order::sort(&mut sorted);
    let tail = (TAIL * sorted.len() as f64) as usize;
    let Some(known) = sorted.get(tail).zip(sorted.get(sorted.len().saturating_sub(1 + tail))) else {
        return Vec::new();
    };
    let surprises = surprises(input, output, among);
    surprises.into_iter().filter(|s| (known.0..=known.1).contains(&&s.forecast)).map(|s| s.row).collect()
}

/// Those of these places at which the errors of a model, sample by sample of `hull`, jump too: what
/// a model predicts is physics and no accident.
pub(super) fn unpredicted(places: &[usize], input: Option<&[f64]>, errors: &[f64], hull: &Range<usize>) -> Vec<usize> {
    let seen = surprises(input.map(|u| &u[hull.clone()]), errors, &(0..errors.len()));
    let near = |place: &usize| seen.iter().any(|s| (hull.start + s.row).abs_diff(*place) <= APART);
    places.iter().copied().filter(near).collect()
}

/// Something that a linear forecast does not predict.
struct Surprise {
    row: usize,
    error: f64,
    forecast: f64,
}

/// Returns where a sequence goes far from what its past and the input predict; nowhere where that
/// happens often.
fn surprises(input: Option<&[f64]>, output: &[f64], among: &Range<usize>) -> Vec<Surprise> {
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
    let linear = Linear { residual: back(output, 0), columns };
    let step = linear.normal().step(1e-12);
    let error: Vec<f64> = (0..rows.len())
        .map(|i| linear.residual[i] + linear.columns.iter().zip(step.iter()).map(|(c, s)| c[i] * s).sum::<f64>())
        .collect();
    let usual = typical(error.iter().copied());
    let mut found: Vec<Surprise> = Vec::new();
    let mut last = 0;
    for (row, (e, y)) in rows.zip(error.iter().zip(&linear.residual)) {
        if e.abs() <= SURPRISING * usual || !e.is_finite() {
            continue;
        }
        let here = Surprise { row, error: e.abs(), forecast: y - e };
        match found.last_mut() {
            Some(other) if row <= last + APART => {
                if here.error > other.error {
                    *other = here;
                }
            }
            _ => found.push(here),
        }
        last = row;
    }
    if found.len() > FEW { Vec::new() } else { found }
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
    fn the_ringing_after_a_blow_in_a_long_silence_is_no_stray_value() {
        let rough = |k: usize| ((k * 7919) % 1013) as f64 / 1013.0 - 0.5;
        // Some 3.4 samples a cycle.
        let ring = |k: usize| if k < 900 { 0.0 } else { (1.85 * (k - 900) as f64).sin() };
        let decayed = |k: usize| 70.0 * ring(k) * (-(k as f64 - 900.0) / 85.0).exp();
        let mut values: Vec<f64> = (0..17_000).map(|k| decayed(k) + rough(k)).collect();
        assert!(glitches(&mut values).is_empty());
        values[5000] += 1000.0;
        assert_eq!(glitches(&mut values), [5000]);
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

    /// Displacement under two tones that swell once in 3000 samples so that it reaches `stop`, by
    /// the semi-implicit method in 40 steps per sample, with a small roughness of its own; the
    /// force is the second sequence.
    fn stopped(stop: f64) -> (Vec<f64>, Vec<f64>) {
        let loud = |k: usize| 0.03 + 0.018 * (-((k as f64 - 900.0) / 20.0).powi(2)).exp();
        let force: Vec<f64> = sine(3000).iter().enumerate().map(|(k, f)| loud(k) * f).collect();
        let (mut x, mut v) = (0.0, 0.0);
        let step = |(k, u): (usize, &f64)| {
            for _ in 0..40 {
                let pushed = if x > stop { 30.0 * (x - stop) } else { 0.0 };
                v += (u - 0.16 * x - 0.08 * v - pushed) / 40.0;
                x += v / 40.0;
            }
            x + 0.004 * (((k * 6007) % 1009) as f64 / 1009.0 - 0.5)
        };
        (force.iter().enumerate().map(step).collect(), force)
    }

    #[test]
    fn what_happens_only_at_the_ends_of_the_range_is_a_law_and_no_jump() {
        let mut sorted = stopped(f64::INFINITY).0;
        sorted.sort_by(f64::total_cmp);
        let (mut y, u) = stopped(sorted[2992]);
        let rows = 0..3000;
        assert!(!surprises(Some(&u), &y, &rows).is_empty(), "the stop is no surprise: the test shows nothing");
        assert_eq!(jumps(Some(&u), &y, &rows), [0; 0]);
        // A step in the reading of a sixth of its range is one, whatever the law.
        let middle = (1500..2000).min_by(|a, b| y[*a].abs().total_cmp(&y[*b].abs())).unwrap_or(1500);
        y[middle..].iter_mut().for_each(|v| *v += 0.1);
        let found = jumps(Some(&u), &y, &rows);
        assert!(found.len() == 1 && found[0].abs_diff(middle) <= 2, "{found:?} {middle}");
    }

    #[test]
    fn a_jump_that_a_model_foresees_is_none() {
        let (rough, hull) = (sine(3100), 100..3100);
        let noise: Vec<f64> = (0..3000).map(|k| ((k * 7919) % 1013) as f64 / 1013.0 - 0.5).collect();
        let mut lost = noise.clone();
        lost[1400..].iter_mut().for_each(|e| *e += 20.0);
        assert_eq!(unpredicted(&[1500, 700], Some(&rough), &noise, &hull), [0; 0]);
        assert_eq!(unpredicted(&[1500, 700], Some(&rough), &lost, &hull), [1500]);
    }
}
