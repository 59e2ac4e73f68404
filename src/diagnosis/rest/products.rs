//! Sums over bins of the products of a channel's and its curves' coefficients: all that generalised
//! least squares needs, since a model has one variance per bin.
//!
//! A recording of half a million values has some seven hundred bins, so that its curves and laws are
//! fitted in turn without a pass over its values. Not for the residual itself.

use nalgebra::{DMatrix, DVector};

use super::spectrum::{Bin, fold};

/// Products of every two of the channel (first) and its curves, by bin, fold and pair.
pub(super) struct Products {
    /// Number of curves and the channel.
    width: usize,
    sums: Vec<[f64; 2]>,
}

impl Products {
    /// Sums the products of the channel's coefficients (first) and those of each curve.
    pub(super) fn of(all: &[&[f64]], bins: &[Bin]) -> Self {
        let width = all.len();
        let mut sums = Vec::with_capacity(bins.len() * width * (width + 1) / 2);
        for bin in bins {
            for p in 0..width {
                for q in 0..=p {
                    let mut sum = [0.0; 2];
                    let both = all[p][bin.from..bin.to].iter().zip(&all[q][bin.from..bin.to]);
                    both.enumerate().for_each(|(i, (a, b))| sum[fold(bin.from + i)] += a * b);
                    sums.push(sum);
                }
            }
        }
        Self { width, sums }
    }

    /// Products of one bin, by pair: `p` ≥ `q` stand at p(p + 1)/2 + q.
    fn by_bin(&self) -> std::slice::ChunksExact<'_, [f64; 2]> {
        self.sums.chunks_exact(self.width * (self.width + 1) / 2)
    }

    /// Amplitudes of the curves and their standard errors under these variances of the bins.
    pub(super) fn amplitudes(&self, variances: &[f64]) -> Vec<(f64, f64)> {
        let count = self.width - 1;
        let (mut normal, mut target) = (DMatrix::<f64>::zeros(count, count), DVector::<f64>::zeros(count));
        for (pairs, variance) in self.by_bin().zip(variances) {
            let of = |p: usize, q: usize| pairs[p * (p + 1) / 2 + q].iter().sum::<f64>() / variance;
            for p in 0..count {
                target[p] += of(p + 1, 0);
                for q in 0..=p {
                    normal[(p, q)] += of(p + 1, q + 1);
                }
            }
        }
        normal.fill_upper_triangle_with_lower_triangle();
        match normal.try_inverse() {
            Some(inverse) => {
                let solution = &inverse * target;
                (0..count).map(|p| (solution[p], inverse[(p, p)].max(0.0).sqrt())).collect()
            }
            None => vec![(0.0, f64::INFINITY); count],
        }
    }

    /// Sets the power of bins to what curves of these amplitudes leave of it.
    pub(super) fn leave(&self, amplitudes: &[(f64, f64)], bins: &mut [Bin]) {
        let weights: Vec<f64> = std::iter::once(1.0).chain(amplitudes.iter().map(|(a, _)| -a)).collect();
        for (pairs, bin) in self.by_bin().zip(bins) {
            let mut sum = [0.0; 2];
            for p in 0..self.width {
                for q in 0..=p {
                    let weight = weights[p] * weights[q] * if p == q { 1.0 } else { 2.0 };
                    let pair = pairs[p * (p + 1) / 2 + q];
                    sum[0] += weight * pair[0];
                    sum[1] += weight * pair[1];
                }
            }
            bin.sum = sum.map(|s| s.max(0.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rest::spectrum::bins;

    #[test]
    fn what_the_sums_leave_is_what_the_values_leave() {
        let count = 3000;
        let curve = |rate: f64| (0..count).map(|n| (rate * n as f64 / count as f64).sin()).collect::<Vec<f64>>();
        let (one, two) = (curve(3.0), curve(11.0));
        let noise = |n: usize| (n * 7919 % 1009) as f64 / 1009.0;
        let channel: Vec<f64> = (0..count).map(|n| 2.0 * one[n] - 0.5 * two[n] + noise(n)).collect();
        let mut found = bins(&channel);
        let products = Products::of(&[&channel, &one, &two], &found);
        let amplitudes = products.amplitudes(&vec![1.0; found.len()]);
        products.leave(&amplitudes, &mut found);
        let each = channel.iter().zip(&one).zip(&two);
        let left: Vec<f64> = each.map(|((y, a), b)| y - amplitudes[0].0 * a - amplitudes[1].0 * b).collect();
        // 1e-9: rounding of sums of 3000 products of order one, with room.
        let near = |a: &Bin, b: &Bin| (0..2).all(|f| (a.sum[f] - b.sum[f]).abs() < 1e-9 * (1.0 + b.sum[f]));
        assert!(found.iter().zip(&bins(&left)).all(|(a, b)| near(a, b)));
        // With equal variances this is ordinary regression: the residual is orthogonal to each curve.
        // The first value belongs to no bin.
        for curve in [&one, &two] {
            let angle: f64 = left.iter().zip(curve).skip(1).map(|(l, c)| l * c).sum();
            assert!(angle.abs() < 1e-6, "{angle}");
        }
        // Control: without the second curve other sums are left.
        let mut other = bins(&channel);
        products.leave(&[amplitudes[0], (0.0, 0.0)], &mut other);
        assert!(!other.iter().zip(&bins(&left)).all(|(a, b)| near(a, b)));
    }
}
