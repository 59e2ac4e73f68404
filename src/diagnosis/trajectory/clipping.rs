//! Readings that stand at a limit: flat tops, where nothing is known but that the truth lies
//! beyond.
//!
//! A number at the end of its range repeats itself exactly, and that alone is proof. An amplifier
//! at its rail goes on making noise; so does a turntable at a constant rate: such a rail is a
//! suspicion until a reference of attitude shows that the body turned quicker (`beyond`).

use nalgebra::Vector3;

use super::alignment::Alignment;
use super::faults::Fault;
use super::judgement::FALSE_NAME;
use super::log::{Log, Motion};

/// Readings at a limit that are needed to call it one, and in a row.
const AT_LEAST: (usize, usize) = (8, 3);
/// Share of the range below the limit, in which a reading that is not clipped would stand as often.
const BELOW: f64 = 0.02;

/// Noise of a rail at most, as part of the range: narrower than half of [`BELOW`], so that the
/// turning points of a swing of one size make none.
const NOISY: f64 = 0.004;
/// A body is quicker than a rail where its reference is by more than a sensor's scale factor may be
/// off.
const QUICKER: f64 = 1.1;

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
    let found = (0..3).filter_map(|axis| flat(readings, axis, 0.0));
    found.map(|flat| flat.mark(masked)).collect()
}

/// Noisy rails of the axes that have no exact limit.
pub(super) fn rails(readings: &[Vector3<f64>], exact: &[Limit]) -> Vec<Flat> {
    let free = (0..3).filter(|axis| exact.iter().all(|l| l.axis != *axis));
    free.filter_map(|axis| flat(readings, axis, NOISY)).collect()
}

/// Flat tops of one axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Flat {
    limit: Limit,
    /// Readings that stand there, with the sign of their side.
    held: Vec<(usize, f64)>,
}

impl Flat {
    /// The same with every reading of it marked, and those next to it: what lies between them and
    /// the limit is not known either.
    pub(super) fn mark(self, masked: &mut [bool]) -> Limit {
        for (k, _) in &self.held {
            let beside = k.saturating_sub(1)..(k + 2).min(masked.len());
            masked[beside].fill(true);
        }
        self.limit
    }

    /// Chance that the body turned so often quicker than the readings stand, where they are right:
    /// of the times when they stand there, half at most lie beyond by noise (sign test). Times in
    /// which the reference is wrong do not count.
    pub(super) fn beyond(&self, log: &Log, motion: &Motion, (faults, alignment): (&[Fault], &Alignment)) -> f64 {
        let (mut runs, mut quicker) = (0u32, 0u32);
        let mut at = 0;
        while at < self.held.len() {
            let (first, sign) = self.held[at];
            let mut last = first;
            while let Some((next, _)) = self.held.get(at).filter(|h| h.0 <= last + 1) {
                last = *next;
                at += 1;
            }
            let [from, to] = [first, last].map(|k| log.time_s[k] - alignment.late_s);
            // The poses around it: a mean over more than the run lies lower at most.
            let [before, after] =
                [motion.time_s.partition_point(|t| *t <= from), motion.time_s.partition_point(|t| *t < to)];
            if before == 0 || after >= motion.time_s.len() || after < before {
                continue;
            }
            if faults.iter().any(|f| before - 1 < f.poses[1] && after >= f.poses[0]) {
                continue;
            }
            // Step by step: meanwhile the body may turn round.
            let step = |pose: usize| (motion.attitude[pose].inverse() * motion.attitude[pose + 1]).scaled_axis();
            let turn: Vector3<f64> = (before - 1..after).map(step).sum();
            let rate = turn / (motion.time_s[after] - motion.time_s[before - 1]);
            runs += 1;
            quicker += u32::from(sign * alignment.expected(&rate)[self.limit.axis] > QUICKER * self.limit.value);
        }
        let heads = (0..=runs).rev().scan(0.5f64.powi(runs as i32), |chance, k| {
            let this = *chance;
            *chance *= f64::from(k) / f64::from(runs - k + 1);
            Some((k, this))
        });
        (LOOKS * heads.take_while(|(k, _)| *k >= quicker).map(|(_, chance)| chance).sum::<f64>()).min(1.0)
    }
}

fn flat(readings: &[Vector3<f64>], axis: usize, noise: f64) -> Option<Flat> {
    let values = || readings.iter().map(move |r| r[axis]);
    let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let range = high - low;
    let side = |top: f64, sign: f64| Side { axis, top, sign, width: noise * range };
    let sides: Vec<Side> =
        [side(high, 1.0), side(-low, -1.0)].into_iter().filter(|side| side.is_flat(readings, range)).collect();
    let p_value = sides.iter().map(|side| side.stays(readings)).fold(1.0, f64::min);
    if p_value >= FALSE_NAME {
        return None;
    }
    let widest = sides.iter().max_by(|a, b| a.top.abs().total_cmp(&b.top.abs()))?;
    let mut held = Vec::new();
    let mut gap = f64::INFINITY;
    for (k, reading) in readings.iter().enumerate() {
        match sides.iter().find(|side| side.holds(reading)) {
            Some(side) => held.push((k, side.sign)),
            None => gap = sides.iter().map(|side| side.below(reading)).fold(gap, f64::min),
        }
    }
    let gap = if gap.is_finite() { gap } else { 0.0 };
    Some(Flat { limit: Limit { axis, value: widest.top.abs(), gap, samples: held.len(), p_value }, held })
}

/// Sides of three axes of two sensors.
const LOOKS: f64 = 12.0;

/// One end of the readings of an axis.
struct Side {
    axis: usize,
    /// The extreme reading, times the sign.
    top: f64,
    sign: f64,
    /// Noise of what stands there.
    width: f64,
}

impl Side {
    fn below(&self, reading: &Vector3<f64>) -> f64 {
        self.top - self.sign * reading[self.axis]
    }

    fn holds(&self, reading: &Vector3<f64>) -> bool {
        self.below(reading) <= self.width
    }

    /// Chance that readings repeat themselves so often at their extreme, from how often they do
    /// elsewhere.
    fn stays(&self, readings: &[Vector3<f64>]) -> f64 {
        let (mut repeated, mut pairs, mut held) = (0.0, 0.0, 0.0);
        for pair in readings.windows(2) {
            let repeats = (pair[0][self.axis] - pair[1][self.axis]).abs() <= self.width;
            if self.holds(&pair[0]) {
                held += f64::from(repeats);
            } else {
                pairs += 1.0;
                repeated += f64::from(repeats);
            }
        }
        let usual: f64 = (repeated + 1.0) / (pairs + 1.0);
        (LOOKS * usual.powf(held)).clamp(f64::MIN_POSITIVE, 1.0)
    }

    /// Returns whether many readings, and some in a row, stand at the extreme one and few just
    /// below.
    fn is_flat(&self, readings: &[Vector3<f64>], range: f64) -> bool {
        let (mut at, mut near, mut run, mut longest) = (0, 0, 0, 0);
        for reading in readings {
            if self.holds(reading) {
                at += 1;
                run += 1;
                longest = longest.max(run);
            } else {
                run = 0;
                near += usize::from(self.below(reading) < self.width + BELOW * range);
            }
        }
        // Readings so coarse that none stands just below show no top.
        near > 0 && at >= AT_LEAST.0 && longest >= AT_LEAST.1 && at > near
    }
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
