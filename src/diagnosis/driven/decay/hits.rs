//! Hits in the middle of a decay: rows at which amplitude and phase leap, and after which the mass swings freely
//! again. A leap is sought in windows of a few cycles, next to an amplitude and a phase that change evenly, by the
//! likelihood ratio of a model with it over one without (Willsky & Jones, IEEE Trans. Autom. Control 21, 1976).

use std::f64::consts::TAU;
use std::ops::Range;

use crate::numerics::moments::dot;

/// Cycles of a window.
const CYCLES: f64 = 6.0;
/// Windows that begin within the length of one.
const OVERLAP: usize = 4;
/// Twice the logarithm of the likelihood ratio from which on a leap is no chance: χ² of two exceeds it once in
/// 10¹⁰ times, and a recording has some 10⁴ places.
const LOUD: f64 = 50.0;
/// Part that a leap removes of what a window leaves over the noise. Each of 27 hits, of 0.03 to 0.4 of the first
/// speed, removed 0.93 or more in two windows; where a law is missing, the even change has removed most already.
const SHARE: f64 = 0.85;
/// Part of a cycle within which two windows see the same leap.
const SAME: f64 = 0.25;

/// A free motion, as windows see it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ringing<'a> {
    /// Displacement, row by row.
    pub reading: &'a [f64],
    /// Rows that were not recorded.
    pub filled: &'a [Range<usize>],
    /// Rows of a cycle.
    pub cycle: f64,
    /// Part of its size by which the motion decays in a row.
    pub decay: f64,
    /// Standard deviation of the noise of a row.
    pub noise: f64,
}

/// A leap that a window shows.
#[derive(Debug, Clone, Copy)]
struct Leap {
    /// First row after it.
    row: usize,
    /// Twice the logarithm of the likelihood ratio.
    gain: f64,
}

impl Ringing<'_> {
    /// Rows of a stretch at which the motion leaps, ascending: those that each window around them shows.
    pub(super) fn hits(&self, stretch: &Range<usize>) -> Vec<usize> {
        let length = ((CYCLES * self.cycle) as usize).min(stretch.len());
        let hop = (length / OVERLAP).max(1);
        let starts = (stretch.start..=stretch.end - length).step_by(hop);
        let leaps: Vec<Option<Leap>> = starts.map(|start| self.leap(start..start + length)).collect();
        let mut hits: Vec<Leap> = Vec::new();
        for pair in leaps.windows(2) {
            let [Some(one), Some(other)] = *pair else { continue };
            let strong = if one.gain > other.gain { one } else { other };
            if one.row.abs_diff(other.row) as f64 > SAME * self.cycle {
                continue;
            }
            match hits.last_mut().filter(|last| strong.row.abs_diff(last.row) as f64 <= SAME * self.cycle) {
                Some(last) => *last = if strong.gain > last.gain { strong } else { *last },
                None => hits.push(strong),
            }
        }
        hits.iter().map(|leap| leap.row).collect()
    }

    /// The likeliest leap in the middle half of a window; `None` where it is no more than chance, or leaves more
    /// than the noise.
    fn leap(&self, window: Range<usize>) -> Option<Leap> {
        if self.filled.iter().any(|f| f.start < window.end && f.end > window.start) {
            return None;
        }
        let n = window.len();
        let turn = TAU / self.cycle;
        let swing = |k: usize| {
            let (sin, cos) = (turn * k as f64).sin_cos();
            let size = (-self.decay * k as f64).exp();
            [size * cos, size * sin]
        };
        let swings: Vec<[f64; 2]> = (0..n).map(swing).collect();
        let along = |k: usize| k as f64 / n as f64 - 0.5;
        let even = [0, 1].map(|i| swings.iter().map(|s| s[i]).collect::<Vec<f64>>());
        let changing = [0, 1].map(|i| swings.iter().enumerate().map(|(k, s)| along(k) * s[i]).collect::<Vec<f64>>());
        let basis = orthonormal(even.into_iter().chain(changing).chain([vec![1.0; n]]));
        let mut rest = self.reading[window.clone()].to_vec();
        basis.iter().for_each(|q| subtract(&mut rest, q));
        let left = dot(&rest, &rest);
        // Going backwards, each leap adds one row to the inner products of the swings after it: with each other, with
        // the rest and with the basis.
        let (mut own, mut by_rest, mut by_basis) = ([0.0; 3], [0.0; 2], vec![[0.0; 2]; basis.len()]);
        let mut best = (0.0, 0);
        for k in (n / 4..n).rev() {
            let [c, s] = swings[k];
            own = [own[0] + c * c, own[1] + c * s, own[2] + s * s];
            by_rest = [by_rest[0] + c * rest[k], by_rest[1] + s * rest[k]];
            by_basis.iter_mut().zip(&basis).for_each(|(sum, q)| *sum = [sum[0] + c * q[k], sum[1] + s * q[k]]);
            if k > n - n / 4 {
                continue;
            }
            let less = |i: usize, j: usize| by_basis.iter().map(|sum| sum[i] * sum[j]).sum::<f64>();
            let [cc, cs, ss] = [own[0] - less(0, 0), own[1] - less(0, 1), own[2] - less(1, 1)];
            let det = cc * ss - cs * cs;
            let removed =
                (ss * by_rest[0].powi(2) - 2.0 * cs * by_rest[0] * by_rest[1] + cc * by_rest[1].powi(2)) / det;
            if det > 1e-9 * own[0] * own[2] && removed > best.0 {
                best = (removed, k);
            }
        }
        let (removed, at) = best;
        let free = n.saturating_sub(basis.len() + 2).max(1) as f64;
        let variance = self.noise.powi(2).max((left - removed) / free);
        let excess = left - free * self.noise.powi(2);
        let is_leap = removed > LOUD * variance && removed > SHARE * excess;
        is_leap.then(|| Leap { row: window.start + at, gain: removed / variance })
    }
}

/// Takes the part along a unit vector off.
fn subtract(values: &mut [f64], unit: &[f64]) {
    let part = dot(values, unit);
    values.iter_mut().zip(unit).for_each(|(v, q)| *v -= part * q);
}

/// Unit vectors at right angles to one another that span the same (modified Gram–Schmidt).
fn orthonormal(columns: impl Iterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let before = dot(&column, &column);
        basis.iter().for_each(|q| subtract(&mut column, q));
        let size = dot(&column, &column);
        if size > 1e-12 * before {
            column.iter_mut().for_each(|v| *v /= size.sqrt());
            basis.push(column);
        }
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// A decay of 40 rows a cycle with a spring stiffer by `cubic` of the displacement's square, hit at these rows
    /// by this part of its first speed, in noise.
    fn ringing(rows: usize, cubic: f64, hits: &[(usize, f64)], noise: f64, seed: u64) -> Vec<f64> {
        let mut rng = Philox::new(seed, 0, Stream::Host);
        let (mut x, mut v) = (1.0, 0.0);
        let (fine, turn) = (8, TAU / 40.0);
        let mut reading = Vec::new();
        for k in 0..rows {
            v += hits.iter().filter(|(row, _)| *row == k).map(|(_, speed)| speed).sum::<f64>();
            reading.push(x + noise * rng.normal());
            // Symplectic steps of an eighth of a row.
            for _ in 0..fine {
                let h = turn / fine as f64;
                v -= h * (x + cubic * x * x * x + 0.01 * v);
                x += h * v;
            }
        }
        reading
    }

    fn hits(reading: &[f64], noise: f64) -> Vec<usize> {
        let seen = Ringing { reading, filled: &[], cycle: 40.0, decay: 0.005 * TAU / 40.0, noise };
        seen.hits(&(0..reading.len()))
    }

    // Noise of 0.5 %: a hit of 0.05 at 0.3 of the first size has a gain of about (0.05/0.005)²·120/4 > 1000.
    #[test]
    fn hits_are_found_where_they_are() {
        for seed in 0..5 {
            let found = hits(&ringing(4000, 0.0, &[(1210, 0.05), (2505, -0.08)], 0.005, seed), 0.005);
            assert!(found.len() == 2 && found[0].abs_diff(1210) < 6 && found[1].abs_diff(2505) < 6, "{found:?}");
        }
    }

    // The negative control: without a hit none is found, nor where the frequency changes with the amplitude.
    #[test]
    fn no_hit_is_found_where_there_is_none() {
        for seed in 0..20 {
            for cubic in [0.0, 0.05, -0.05] {
                let found = hits(&ringing(4000, cubic, &[], 0.005, seed), 0.005);
                assert!(found.is_empty(), "{cubic} {seed}: {found:?}");
            }
        }
    }
}
