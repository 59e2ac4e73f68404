//! Fills lost readings with noise like that of the readings around them.
//!
//! A straight line between two noisy readings counts both of them more: with one reading in twenty
//! lost, white noise has 7.5 % more power at low frequencies than it had, and less at high ones, as
//! behind a filter. So a lost reading is drawn from the law that it had: normal, given its neighbours,
//! with the covariance of the channel about its level (sequential simulation: Journel, Adv. Appl.
//! Prob. 6 (1974) 439). Where noise is white that is a free draw, where it is smooth nearly the line.
//! The level is a mean over the time at which the Allan variance is least; over less it would count
//! noise for a wander. Not for channels whose readings do not rest.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::disturbance::{BLOCK, off_level, spread};
use crate::rng::{Philox, Stream};

/// Neighbours on either side that a lost reading is drawn by.
const NEIGHBOURS: usize = 6;
/// Robust standard deviations beyond which a reading counts as that far off in the covariance.
const CLIPPED: f64 = 4.0;
/// Part of the variance that keeps the covariance of a smooth channel invertible.
const RIDGE: f64 = 1e-9;
/// Fewest means of which an Allan variance is taken.
const FEWEST_MEANS: usize = 8;

/// Draws the readings of gaps, which lie in ascending order; a recording too short to say how noisy
/// it is, or that does not change, stays as it was.
pub fn draw(values: &mut [f64], gaps: &[Range<usize>]) {
    let count = values.len();
    let gaps: Vec<&Range<usize>> = gaps.iter().filter(|gap| gap.end <= count && !gap.is_empty()).collect();
    if gaps.is_empty() || count < 4 * BLOCK {
        return;
    }
    let mut is_lost = vec![false; count];
    gaps.iter().for_each(|gap| is_lost[(*gap).clone()].fill(true));
    let level = Level::of(values);
    if level.limit <= 0.0 {
        return;
    }
    let covariance = level.covariance(&is_lost);
    // The same readings are given the same draws, each channel its own.
    let seed = values.iter().fold(0u64, |sum, value| sum.rotate_left(5) ^ value.to_bits());
    let mut rng = Philox::new(seed, 0, Stream::Host);
    for gap in gaps {
        let line = level.across(gap);
        for n in gap.clone() {
            let before = n.saturating_sub(NEIGHBOURS)..n;
            let after = (n + 1)..(n + 1 + NEIGHBOURS).min(count);
            let known: Vec<usize> = before.chain(after.filter(|at| !is_lost[*at])).collect();
            let (mean, sd) = given(values, n, &known, &line, &covariance);
            values[n] = line.at(n) + mean + sd * rng.normal();
            is_lost[n] = false;
        }
    }
}

/// Holds means of a channel over any stretch, none of its readings counted as very far off.
struct Level {
    /// Sums of the readings before each.
    sums: Vec<f64>,
    /// Most that a reading may count off the medians about it.
    limit: f64,
    /// Readings of half a mean.
    half: usize,
}

impl Level {
    fn of(values: &[f64]) -> Self {
        let (off, medians) = off_level(values);
        let limit = CLIPPED * spread(&off);
        let mut sums = vec![0.0];
        let mut sum = 0.0;
        for (off, median) in off.iter().zip(&medians) {
            sum += median - medians[0] + off.clamp(-limit, limit);
            sums.push(sum);
        }
        let mut level = Self { sums, limit, half: BLOCK / 2 };
        let lengths = (0..).map(|n| BLOCK << n).take_while(|length| length * FEWEST_MEANS <= values.len());
        let best = lengths.min_by(|a, b| level.allan_variance(*a).total_cmp(&level.allan_variance(*b)));
        level.half = best.unwrap_or(BLOCK) / 2;
        level.sums.iter_mut().enumerate().for_each(|(n, sum)| *sum += n as f64 * medians[0]);
        level
    }

    fn mean(&self, stretch: Range<usize>) -> f64 {
        (self.sums[stretch.end] - self.sums[stretch.start]) / stretch.len() as f64
    }

    fn allan_variance(&self, length: usize) -> f64 {
        let means: Vec<f64> =
            (0..(self.sums.len() - 1) / length).map(|n| self.mean(n * length..(n + 1) * length)).collect();
        let squares = means.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        0.5 * squares.sum::<f64>() / (means.len() - 1).max(1) as f64
    }

    /// Covariance of the readings about the level at each lag that two neighbours of one reading have.
    fn covariance(&self, is_lost: &[bool]) -> Vec<f64> {
        let about = |n: usize| n.saturating_sub(self.half)..(n + self.half).min(is_lost.len());
        let off: Vec<f64> = (0..is_lost.len())
            .map(|n| (self.sums[n + 1] - self.sums[n] - self.mean(about(n))).clamp(-2.0 * self.limit, 2.0 * self.limit))
            .collect();
        let at = |lag: usize| {
            let pairs = (lag..off.len()).filter(|n| !is_lost[*n] && !is_lost[n - lag]);
            let (sum, count) = pairs.fold((0.0, 0usize), |(sum, count), n| (sum + off[n] * off[n - lag], count + 1));
            sum / count.max(1) as f64
        };
        (0..=2 * NEIGHBOURS).map(at).collect()
    }

    /// The level across a gap: a straight line between the means on its two sides.
    fn across(&self, gap: &Range<usize>) -> Line {
        // A level from fewer readings than half the gap's would be a drift that stands out.
        let reach = self.half.max(gap.len() / 2);
        let side = |from: usize, to: usize| (from < to).then(|| (0.5 * (from + to) as f64 - 0.5, self.mean(from..to)));
        let before = side(gap.start.saturating_sub(reach), gap.start);
        let after = side(gap.end, (gap.end + reach).min(self.sums.len() - 1));
        match (before, after) {
            (Some(from), Some(to)) => Line { from, slope: (to.1 - from.1) / (to.0 - from.0) },
            (one, other) => Line { from: one.or(other).unwrap_or_default(), slope: 0.0 },
        }
    }
}

/// A level that changes evenly.
struct Line {
    from: (f64, f64),
    slope: f64,
}

impl Line {
    fn at(&self, n: usize) -> f64 {
        self.from.1 + self.slope * (n as f64 - self.from.0)
    }
}

/// Mean off the line and standard deviation of one reading, given others.
fn given(values: &[f64], n: usize, known: &[usize], line: &Line, covariance: &[f64]) -> (f64, f64) {
    let between = |a: usize, b: usize| covariance[a.abs_diff(b)] + if a == b { RIDGE * covariance[0] } else { 0.0 };
    let all = DMatrix::from_fn(known.len(), known.len(), |i, j| between(known[i], known[j]));
    let own = DVector::from_fn(known.len(), |i, _| between(known[i], n));
    // Without a covariance that can be one, as of readings that never change, the line stays.
    let Some(weights) = all.cholesky().map(|factor| factor.solve(&own)) else { return (0.0, 0.0) };
    let mean = known.iter().zip(weights.iter()).map(|(at, weight)| weight * (values[*at] - line.at(*at))).sum();
    (mean, (covariance[0] - weights.dot(&own)).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(count: usize, member: u64) -> Vec<f64> {
        let mut rng = Philox::new(17, member, Stream::Host);
        (0..count).map(|_| rng.normal()).collect()
    }

    /// Fills gaps by linear interpolation, as a reader does.
    fn bridged(values: &mut [f64], gaps: &[Range<usize>]) {
        for gap in gaps {
            let (from, to) = (values[gap.start - 1], values[gap.end]);
            for n in gap.clone() {
                values[n] = from + (to - from) * (n + 1 - gap.start) as f64 / (gap.len() + 1) as f64;
            }
        }
    }

    /// Variance of sums over blocks of `length` readings, relative to white noise of unit variance.
    fn power(values: &[f64], length: usize) -> f64 {
        let sums = values.chunks_exact(length).map(|c| c.iter().sum::<f64>().powi(2) / length as f64);
        sums.sum::<f64>() / (values.len() / length) as f64
    }

    #[test]
    fn a_gap_is_as_noisy_as_what_is_about_it() {
        for gap in [1000..1500usize, 20..320, 5600..5900] {
            let mut values = noise(6000, 3);
            // From one reading to the next, which may be two standard deviations off.
            values[gap.clone()].fill(2.0);
            draw(&mut values, std::slice::from_ref(&gap));
            let there = &values[gap.clone()];
            let mean = there.iter().sum::<f64>() / there.len() as f64;
            let variance = there.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / there.len() as f64;
            // The level is a median of half a block on either side: sd √(π/2/150) at most; a variance
            // of 300 readings has the sd √(2/300).
            assert!(mean.abs() < 0.5 && (variance - 1.0).abs() < 0.33, "{gap:?}: {mean} {variance}");
        }
    }

    // With a part p of the readings lost singly, lines give sums of white noise the power 1 + 3p/2:
    // two neighbours of weight 3/2 for each of weight nothing.
    #[test]
    fn white_noise_with_lost_readings_keeps_its_power_at_low_frequencies() {
        const COUNT: usize = 400_000;
        let gaps: Vec<Range<usize>> = (5..COUNT - 5).step_by(10).map(|n| n..n + 1).collect();
        let mut lines = noise(COUNT, 5);
        bridged(&mut lines, &gaps);
        let mut drawn = lines.clone();
        draw(&mut drawn, &gaps);
        // Of 4000 sums: sd √(2/4000) = 2.2 %.
        assert!((power(&drawn, 100) - 1.0).abs() < 0.09, "{}", power(&drawn, 100));
        assert!((power(&lines, 100) - 1.15).abs() < 0.1, "control: {}", power(&lines, 100));
        // Of the drawn readings alone: sd √(2/40000) = 0.7 %.
        let variance = gaps.iter().map(|gap| drawn[gap.start].powi(2)).sum::<f64>() / gaps.len() as f64;
        assert!((variance - 1.0).abs() < 0.03, "{variance}");
    }

    #[test]
    fn a_smooth_channel_is_bridged_as_its_own_neighbours_say() {
        // First order with the pole a = 0.98: given both neighbours, the variance of a reading falls to
        // (1 − a²)/(1 + a²) of its own. A free draw keeps all of it.
        const POLE: f64 = 0.98;
        let mut clean = noise(100_000, 7);
        for n in 1..clean.len() {
            clean[n] = POLE * clean[n - 1] + (1.0 - POLE * POLE).sqrt() * clean[n];
        }
        let gaps: Vec<Range<usize>> = (5..clean.len() - 5).step_by(10).map(|n| n..n + 1).collect();
        let mut drawn = clean.clone();
        bridged(&mut drawn, &gaps);
        draw(&mut drawn, &gaps);
        let off = gaps.iter().map(|gap| (drawn[gap.start] - clean[gap.start]).powi(2)).sum::<f64>();
        // Twice: the reading and the draw are both off their common mean.
        let expected = 2.0 * (1.0 - POLE * POLE) / (1.0 + POLE * POLE);
        let ratio = off / gaps.len() as f64 / expected;
        // Of 9999 squares: sd 1.4 %; the covariance about a level of blocks adds a few per cent.
        assert!((0.9..1.15).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_channel_that_never_changes_stays_as_it_is() {
        let mut values = vec![9.8; 1000];
        draw(&mut values, &[100..101, 500..520]);
        assert!(values.iter().all(|v| *v == 9.8));
    }
}
