//! Readings at rest that are no part of a sensor's noise: single bad ones, and knocks. `allan` and the
//! diagnosis take them out with this one finder before anything is fitted.
//!
//! A reading is far off where it lies six robust standard deviations from the medians of its
//! surroundings. Several close together are a knock; a few alone are bad readings. Many alone, of
//! all sizes, are the tail of a heavy-tailed noise: those stay, except one that lies far beyond the
//! rest. Many alone of one size are spikes, which nothing in the library makes. Not for steps: a
//! level that changes stays as it is (`jump`).

use std::ops::Range;

use crate::numerics::order::median;

/// Readings in a block whose median stands for the level.
pub(crate) const BLOCK: usize = 64;
/// Robust standard deviations beyond which a reading is far off: one of 5 · 10⁸ of normal noise.
const FAR: f64 = 6.0;
/// So many far readings alone are bad ones; more are a property of the noise.
const FEW: usize = 12;
/// With more of them, one is bad if it is this many times as far off as the [`FEW`]th: 12/8³ is the
/// chance of it in noise with tails as heavy as Student's with three degrees of freedom.
const BEYOND_TAIL: f64 = 8.0;
/// Robust standard deviations beyond which a tail shows, before its readings are far off: one in
/// [`RARE`] of normal noise.
const OUTLYING: f64 = 4.0;
const RARE: f64 = 15_787.0;
/// Far readings no further apart than this belong together.
const CLOSE: usize = 8;
/// Outlier clusters more probable than this by chance are not called shocks.
const CHANCE: f64 = 1e-3;

/// A reading that was left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BadReading {
    /// Place among the values.
    pub at: usize,
    /// Its value before.
    pub value: f64,
    /// States how far off, in robust standard deviations of the noise.
    pub deviations: f64,
}

/// A stretch that was left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knock {
    /// First value of it.
    pub from: usize,
    /// One past its last.
    pub to: usize,
    /// Its largest reading off the level, in robust standard deviations of the noise.
    pub deviations: f64,
}

/// Holds what disturbs a channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Disturbances {
    /// Single readings that were left out.
    pub bad: Vec<BadReading>,
    /// Stretches that were left out.
    pub knocks: Vec<Knock>,
    /// Readings of spikes, too many for bad ones and too much of one size for a tail.
    pub spikes: usize,
    /// Readings of a heavy tail, which stay.
    pub tail: usize,
}

impl Disturbances {
    /// Returns whether there is anything that no library law and no noise makes.
    pub fn are_foreign(&self) -> bool {
        !self.knocks.is_empty() || self.spikes > 0
    }
}

/// Values less the level about them, and the level: medians of blocks, straight lines between them.
pub(crate) fn off_level(values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let blocks = (values.len() / BLOCK).max(1);
    let edge = |b: usize| b * values.len() / blocks;
    let knots: Vec<(f64, f64)> = (0..blocks)
        .map(|b| {
            let block = values[edge(b)..edge(b + 1)].to_vec();
            (0.5 * (edge(b) + edge(b + 1)) as f64 - 0.5, median(block).unwrap_or(0.0))
        })
        .collect();
    let mut level = Vec::with_capacity(values.len());
    let mut right = 0;
    for n in 0..values.len() {
        let x = n as f64;
        while right < knots.len() && knots[right].0 < x {
            right += 1;
        }
        level.push(match (right.checked_sub(1).map(|l| knots[l]), knots.get(right).copied()) {
            (Some((a, from)), Some((b, to))) => from + (to - from) * (x - a) / (b - a),
            (Some((_, only)), None) | (None, Some((_, only))) => only,
            (None, None) => 0.0,
        });
    }
    (values.iter().zip(&level).map(|(v, l)| v - l).collect(), level)
}

/// Robust standard deviation: the larger of what the middle and what 95 % of the values say, so
/// that neither a few readings far off nor a heavy tail decide; where rounding leaves both at
/// nothing, what is left of it further out.
pub(crate) fn spread(off: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = off.iter().map(|v| v.abs()).collect();
    let mut at = |part: f64| {
        let place = ((sizes.len() - 1) as f64 * part) as usize;
        *sizes.select_nth_unstable_by(place, f64::total_cmp).1
    };
    let spread = (1.4826 * at(0.5)).max(at(0.95) / 1.96);
    if spread > 0.0 { spread } else { [0.99, 0.999].map(&mut at).into_iter().find(|s| *s > 0.0).unwrap_or(0.0) }
}

/// Finds what disturbs a channel and puts in its place what its surroundings show: the level for a
/// single reading, for a knock the level with the noise of the readings before it (after it, at the
/// beginning).
pub fn take_out(values: &mut [f64]) -> Disturbances {
    let mut found = Disturbances::default();
    if values.len() < 4 * BLOCK {
        return found;
    }
    let (off, level) = off_level(values);
    let spread = spread(&off);
    let far: Vec<usize> = (0..off.len()).filter(|n| off[*n].abs() > FAR * spread).collect();
    if spread <= 0.0 || far.is_empty() {
        return found;
    }
    let size = |n: usize| off[n].abs() / spread;
    let mut runs: Vec<Vec<usize>> = Vec::new();
    for n in far.iter().copied() {
        match runs.last_mut() {
            Some(run) if run.last().is_some_and(|last| n - last <= CLOSE) => run.push(n),
            _ => runs.push(vec![n]),
        }
    }
    let rate = far.len() as f64 / off.len() as f64;
    // Chance that this many more follow one another so closely somewhere, if far readings were
    // placed at random.
    let by_chance = |run: &[usize]| far.len() as f64 * (CLOSE as f64 * rate).powi(run.len() as i32 - 1);
    let (knocks, alone): (Vec<Vec<usize>>, Vec<Vec<usize>>) =
        runs.into_iter().partition(|run| run.len() >= 3 && (far.len() - run.len() < FEW || by_chance(run) < CHANCE));
    for run in knocks {
        found.knocks.extend(knock(&run, values, &level, &off, spread));
    }
    let mut alone: Vec<usize> = alone.into_iter().flatten().collect();
    alone.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
    // The chance of this many between, in normal noise, is below one in a thousand; and a tail has
    // more of them than far ones.
    let beside_knock = |n: usize| found.knocks.iter().any(|k| k.from <= n + BLOCK && n < k.to + BLOCK);
    let between = (0..off.len()).filter(|n| (OUTLYING..=FAR).contains(&size(*n)) && !beside_knock(*n)).count();
    let expected = off.len() as f64 / RARE;
    let is_tailed = between as f64 > expected + 3.0 * expected.sqrt() + 3.0 && between > alone.len();
    let bad = if alone.len() <= FEW && !is_tailed {
        alone.len()
    } else if alone.len() <= FEW {
        let beyond = alone.iter().take_while(|n| size(**n) > BEYOND_TAIL * FAR).count();
        found.tail = alone.len() - beyond;
        beyond
    } else {
        // In a tail, half as far off again is three times as rare or more; spikes lie far out and
        // few on the way there.
        let beyond = alone.iter().filter(|n| size(**n) > 1.5 * FAR).count();
        if 2 * beyond > alone.len() {
            found.spikes = alone.len();
        } else {
            found.tail = alone.len();
        }
        let limit = BEYOND_TAIL * size(alone[FEW - 1]);
        alone.iter().take_while(|n| found.spikes == 0 && size(**n) > limit).count()
    };
    for n in alone.into_iter().take(bad) {
        found.bad.push(BadReading { at: n, value: values[n], deviations: size(n) });
        values[n] = level[n];
    }
    found.bad.sort_by_key(|b| b.at);
    found
}

/// Puts a line through two levels at their places in a stretch's place, with the noise of the
/// readings before it (after it, at the beginning).
fn lay(values: &mut [f64], stretch: Range<usize>, [first, last]: [(f64, f64); 2], off: &[f64], spread: f64) {
    let Range { start: from, end: to } = stretch;
    let count = off.len();
    let slope = if last.0 > first.0 { (last.1 - first.1) / (last.0 - first.0) } else { 0.0 };
    for n in from..to {
        let noise =
            if 2 * from >= to { off[2 * from - 1 - n.min(2 * from - 1)] } else { off[(2 * to - 1 - n).min(count - 1)] };
        let noise = noise.clamp(-3.0 * spread, 3.0 * spread);
        values[n] = first.1 + slope * (n as f64 - first.0) + noise;
    }
}

/// Takes one knock out, with the stretch in which it still rings; `None` where the level is another
/// one afterwards, which is a step.
fn knock(run: &[usize], values: &mut [f64], level: &[f64], off: &[f64], spread: f64) -> Option<Knock> {
    let (first, last) = (*run.first()?, *run.last()?);
    let largest = run.iter().map(|n| off[*n].abs()).fold(0.0, f64::max);
    let count = values.len();
    let side = |from: usize, to: usize| median(values[from.min(count)..to.min(count)].to_vec());
    let length = last - first + 1;
    // What dies out to six standard deviations over its length takes as long again to vanish in the
    // noise.
    let (from, to) = (first.saturating_sub(CLOSE + length / 4), (last + 1 + CLOSE + 2 * length).min(count));
    let before = side(from.saturating_sub(BLOCK / 2), from);
    let after = side(to, to + BLOCK / 2);
    // A level that wanders as far over such a length anyway shows no step.
    let wander = median(level.iter().zip(&level[to - from..]).map(|(a, b)| (a - b).abs()).collect()).unwrap_or(0.0);
    let limit = (2.0 * spread).max(6.0 * wander);
    let steps = before.zip(after).is_some_and(|(b, a)| (a - b).abs() > limit);
    // A stretch that is no short part of the recording is a state of it, not a knock.
    if steps || to - from > count / 20 {
        return None;
    }
    let ends = [(from as f64, before.unwrap_or(level[from])), (to as f64, after.unwrap_or(level[to - 1]))];
    lay(values, from..to, ends, off, spread);
    Some(Knock { from, to, deviations: largest / spread })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    fn noise(count: usize, member: u64) -> Vec<f64> {
        let mut rng = Philox::new(17, member, Stream::Host);
        (0..count).map(|_| rng.normal()).collect()
    }

    #[test]
    fn a_bad_reading_is_left_out_with_its_place_and_value_and_noise_is_left_as_it_is() {
        for member in 0..20 {
            let clean = noise(5000, member);
            let mut values = clean.clone();
            assert_eq!(take_out(&mut values), Disturbances::default(), "{member}");
            assert_eq!(values, clean);
            let at = 100 + 200 * member as usize;
            values[at] = 1e6;
            let found = take_out(&mut values);
            assert_eq!(found.bad.iter().map(|b| (b.at, b.value)).collect::<Vec<_>>(), [(at, 1e6)]);
            assert!(found.knocks.is_empty() && values[at].abs() < 1.0);
        }
    }

    // One of 5 · 10⁸ readings is called far off by chance: of 2 · 10⁶ none with a probability of
    // 99.6 %. Rounding may add half a step to six standard deviations at most, which the step's own
    // noise makes up for.
    #[test]
    fn noise_rounded_to_steps_of_any_size_loses_no_reading() {
        for (n, sigma) in [0.02, 0.05, 0.1, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.7, 1.0, 3.0].into_iter().enumerate() {
            for (member, offset) in [0.0, 0.25, 0.45, 0.5].into_iter().enumerate() {
                let clean = noise(40_000, 400 + (4 * n + member) as u64);
                let mut values: Vec<f64> = clean.iter().map(|v| (sigma * v + offset).round()).collect();
                let before = values.clone();
                assert_eq!(take_out(&mut values), Disturbances::default(), "{sigma} steps about {offset}");
                assert_eq!(values, before);
            }
        }
    }

    #[test]
    fn a_step_of_any_height_and_place_loses_no_reading() {
        let mut eaten = Vec::new();
        for height in 4..40 {
            for place in [3000, 3010, 3020, 3031, 3040, 3050] {
                let mut values = noise(6000, 500 + height * 7 + place);
                values[place as usize..].iter_mut().for_each(|v| *v += height as f64);
                let found = take_out(&mut values);
                if !found.bad.is_empty() || !found.knocks.is_empty() {
                    eaten.push((height, place, found.bad.len(), found.knocks.len()));
                }
            }
        }
        assert!(eaten.is_empty(), "{} of 216: {eaten:?}", eaten.len());
    }

    #[test]
    fn a_knock_is_taken_out_and_a_step_is_not() {
        for member in 0..20 {
            let mut values = noise(6000, 100 + member);
            for k in 0..40 {
                values[3000 + k] += 40.0 * (-(k as f64) / 10.0).exp() * (k as f64).cos();
            }
            let found = take_out(&mut values);
            assert!(matches!(found.knocks[..], [Knock { from: 2950..=3000, to: 3020..=3200, .. }]), "{found:?}");
            assert!(values.iter().all(|v| v.abs() < 6.5));
            let mut step: Vec<f64> = noise(6000, 200 + member);
            step[3000..].iter_mut().for_each(|v| *v += 20.0);
            assert_eq!(take_out(&mut step).knocks, [], "{member}");
        }
    }

    #[test]
    fn a_heavy_tail_stays_and_spikes_are_counted() {
        let mut rng = Philox::new(18, 0, Stream::Host);
        // Student's t with three degrees of freedom: a normal over the root of a mean of three
        // squares.
        let mut tailed: Vec<f64> = (0..50_000)
            .map(|_| {
                let square = (0..3).map(|_| rng.normal().powi(2)).sum::<f64>() / 3.0;
                rng.normal() / square.sqrt()
            })
            .collect();
        let before = tailed.clone();
        let found = take_out(&mut tailed);
        assert!(found.tail > 12 && found.spikes == 0 && found.bad.len() <= 1 && found.knocks.is_empty(), "{found:?}");
        assert!(tailed.iter().zip(&before).filter(|(a, b)| a != b).count() <= 1);
        let mut spiky = noise(20_000, 300);
        (0..60).for_each(|k| spiky[150 + 330 * k] += 40.0);
        let found = take_out(&mut spiky);
        assert!(found.spikes >= 58 && found.tail == 0, "{found:?}");
    }
}
