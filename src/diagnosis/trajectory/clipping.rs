//! Readings that stand at a limit: flat tops, where nothing is known but that the truth lies
//! beyond.

use nalgebra::Vector3;

use super::judgement::FALSE_NAME;

/// Readings at a limit that are needed to call it one, and in a row.
const AT_LEAST: (usize, usize) = (8, 3);
/// Share of the range below the limit, in which a reading that is not clipped would stand as often.
const BELOW: f64 = 0.02;

/// A limit of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limit {
    /// Which axis, 0 to 2.
    pub axis: usize,
    /// Its size, unit of the reading.
    pub value: f64,
    /// From the highest reading below it, unit of the reading.
    pub gap: f64,
    /// Readings at it, from both sides.
    pub samples: usize,
    /// Chance that readings which are not held by a limit stay at their extreme so long.
    pub p_value: f64,
}

/// Limits of three axes; every reading that stands at one is marked.
pub(super) fn limits(readings: &[Vector3<f64>], masked: &mut [bool]) -> Vec<Limit> {
    (0..3).filter_map(|axis| limit(readings, axis, masked)).collect()
}

fn limit(readings: &[Vector3<f64>], axis: usize, masked: &mut [bool]) -> Option<Limit> {
    let values = || readings.iter().map(move |r| r[axis]);
    let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let range = high - low;
    let sides = [(high, 1.0), (-low, -1.0)];
    let flat: Vec<(f64, f64)> =
        sides.into_iter().filter(|(top, sign)| is_flat(readings, axis, *top, *sign, range)).collect();
    let p_value = flat.iter().map(|(top, sign)| stays(readings, axis, *top, *sign)).fold(1.0, f64::min);
    if p_value >= FALSE_NAME {
        return None;
    }
    let (value, _) = *flat.iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
    let mut samples = 0;
    let mut gap = f64::INFINITY;
    for (k, reading) in readings.iter().enumerate() {
        let below = flat.iter().map(|(top, sign)| top - sign * reading[axis]).fold(f64::INFINITY, f64::min);
        if below <= 0.0 {
            samples += 1;
            masked[k] = true;
        } else {
            gap = gap.min(below);
        }
    }
    Some(Limit { axis, value: value.abs(), gap: if gap.is_finite() { gap } else { 0.0 }, samples, p_value })
}

/// Sides of three axes of two sensors.
const LOOKS: f64 = 12.0;

/// Chance that readings repeat themselves so often at their extreme, from how often they do
/// elsewhere.
fn stays(readings: &[Vector3<f64>], axis: usize, top: f64, sign: f64) -> f64 {
    let (mut repeated, mut pairs, mut held) = (0.0, 0.0, 0.0);
    for pair in readings.windows(2) {
        let [before, after] = [pair[0][axis], pair[1][axis]];
        if top - sign * before <= 0.0 {
            held += f64::from(before == after);
        } else {
            pairs += 1.0;
            repeated += f64::from(before == after);
        }
    }
    let usual: f64 = (repeated + 1.0) / (pairs + 1.0);
    (LOOKS * usual.powf(held)).clamp(f64::MIN_POSITIVE, 1.0)
}

/// Whether many readings, and some in a row, stand at the extreme one and few just below.
fn is_flat(readings: &[Vector3<f64>], axis: usize, top: f64, sign: f64, range: f64) -> bool {
    let (mut at, mut near, mut run, mut longest) = (0, 0, 0, 0);
    for reading in readings {
        let below = top - sign * reading[axis];
        if below <= 0.0 {
            at += 1;
            run += 1;
            longest = longest.max(run);
        } else {
            run = 0;
            near += usize::from(below < BELOW * range);
        }
    }
    // Readings so coarse that none stands just below show no top.
    near > 0 && at >= AT_LEAST.0 && longest >= AT_LEAST.1 && at > near
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swinging(clip: f64) -> Vec<Vector3<f64>> {
        let at = |k: u32| (f64::from(k) * 0.01 * (1.0 + 0.1 * (f64::from(k) * 0.003).sin())).sin() * 2.0;
        (0..4000).map(|k| Vector3::new(at(k).clamp(-clip, clip), 0.3 * at(k + 50), (0.7 * at(k)).round())).collect()
    }

    #[test]
    fn a_flat_top_is_a_limit_and_a_round_one_is_not() {
        let (clipped, whole) = (swinging(1.2), swinging(9.0));
        let mut masked = vec![false; clipped.len()];
        let found = limits(&clipped[..], &mut masked);
        let x = found.iter().find(|l| l.axis == 0).expect("a limit");
        assert!((x.value - 1.2).abs() < 1e-12 && masked.iter().filter(|s| **s).count() >= x.samples);
        assert!(found.iter().all(|l| l.axis != 1));
        let mut none = vec![false; whole.len()];
        assert_eq!(limits(&whole, &mut none), []);
    }
}
