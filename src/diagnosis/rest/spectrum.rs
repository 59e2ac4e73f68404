//! The likelihood of a still sensor: cosine coefficients are independent, each with the variance of
//! a sum of noise laws.
//!
//! See `numerics::cosine` for why no window is needed. Variances are fitted by Fisher scoring with
//! none negative.

use std::f64::consts::PI;

use crate::numerics::non_negative::non_negative;

/// A law of noise in discrete time; its variance is that of one coefficient, for unit strength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Law {
    White,
    /// Differences of independent samples: rounding of an integral.
    Differenced,
    Flicker,
    /// Sum of independent steps.
    Walk,
    /// First-order memory of this many samples, unit variance.
    Markov(f64),
    /// 1/f to any power.
    Power(f64),
    /// White noise behind a filter in the sensor.
    Filtered(Filter),
}

/// Holds what a sensor may do to its readings before it hands them out; the power it lets through
/// is one at low frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Filter {
    /// cos²ᵖθ: means of two neighbours, p times over.
    Smoothing(u8),
    /// Means of this many readings that overlap by all but one, once or twice over (the second is
    /// Bartlett's).
    MovingAverage {
        /// Readings in a mean.
        readings: u16,
        /// States how often in a row.
        times: u8,
    },
    /// One pole with a memory of this many samples.
    OnePole(f64),
    /// The same pole twice.
    PoleTwice(f64),
    /// Two poles: tangent of θ at the cut-off, and the quality factor (bilinear transform; 1/√2 is
    /// Butterworth's).
    TwoPoles {
        /// tan θ at the cut-off.
        cut: f64,
        /// Quality factor of the line.
        quality: f64,
    },
}

impl Filter {
    /// Power let through at θ = πk/(2N), half the angular frequency per sample.
    pub(super) fn power(self, theta: f64) -> f64 {
        match self {
            Filter::Smoothing(times) => theta.cos().powi(2 * i32::from(times)),
            Filter::MovingAverage { readings, times } => {
                let m = f64::from(readings);
                ((m * theta).sin() / (m * theta.sin())).powi(2 * i32::from(times))
            }
            Filter::OnePole(memory) => {
                let keep = (-1.0 / memory).exp();
                let s = 2.0 * theta.sin();
                (1.0 - keep).powi(2) / ((1.0 - keep).powi(2) + keep * s * s)
            }
            Filter::PoleTwice(memory) => Filter::OnePole(memory).power(theta).powi(2),
            Filter::TwoPoles { cut, quality } => {
                let ratio = theta.tan() / cut;
                1.0 / ((1.0 - ratio * ratio).powi(2) + (ratio / quality).powi(2))
            }
        }
    }
}

impl Law {
    /// Returns whether its power lies at low frequencies.
    pub(super) fn is_low_frequency(self) -> bool {
        matches!(self, Law::Flicker | Law::Walk | Law::Markov(_) | Law::Power(_))
    }

    /// At θ = πk/(2N), half the angular frequency per sample.
    pub(super) fn variance(self, theta: f64) -> f64 {
        let s = 2.0 * theta.sin();
        match self {
            Law::White => 1.0,
            Law::Differenced => s * s,
            Law::Flicker => 1.0 / s,
            Law::Walk => 1.0 / (s * s),
            Law::Markov(memory) => {
                let keep = (-1.0 / memory).exp();
                (1.0 - keep * keep) / ((1.0 - keep).powi(2) + keep * s * s)
            }
            Law::Power(exponent) => s.powf(-exponent),
            Law::Filtered(filter) => filter.power(theta),
        }
    }
}

/// Neighbouring coefficients taken together, by fold for held-out scores.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bin {
    pub(super) theta: f64,
    pub(super) from: usize,
    pub(super) to: usize,
    /// Number of coefficients in each fold.
    pub(super) count: [f64; 2],
    /// Sum of their squares.
    pub(super) sum: [f64; 2],
}

/// Folds alternate in pairs: 1 | 2 3 | 4 5 | …
pub(super) fn fold(k: usize) -> usize {
    k / 2 % 2
}

/// Bins of coefficients c₁ …: single ones up to 64, then 2 % wide.
pub(super) fn bins(coefficients: &[f64]) -> Vec<Bin> {
    let count = coefficients.len();
    let mut out = Vec::new();
    let mut from = 1;
    while from < count {
        let to = if from < 64 { from + 1 } else { (from + from / 50).min(count) };
        let mut bin = Bin { theta: 0.0, from, to, count: [0.0; 2], sum: [0.0; 2] };
        for (k, c) in coefficients.iter().enumerate().take(to).skip(from) {
            bin.count[fold(k)] += 1.0;
            bin.sum[fold(k)] += c * c;
        }
        bin.theta = PI * (from + to - 1) as f64 / 2.0 / (2 * count) as f64;
        out.push(bin);
        from = to;
    }
    out
}

/// Which coefficients are looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    All,
    Fold(usize),
}

impl Part {
    fn of(self, pair: &[f64; 2]) -> f64 {
        match self {
            Part::All => pair[0] + pair[1],
            Part::Fold(f) => pair[f],
        }
    }
}

/// Log-likelihood of variances, one per bin, up to a constant.
pub(super) fn log_likelihood(bins: &[Bin], variances: &[f64], part: Part) -> f64 {
    let each = |(b, v): (&Bin, &f64)| -0.5 * (part.of(&b.count) * v.ln() + part.of(&b.sum) / v);
    bins.iter().zip(variances).map(each).sum()
}

/// Strengths of laws, in their order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Strengths {
    pub(super) values: Vec<f64>,
    /// Standard errors from the Fisher information.
    pub(super) errors: Vec<f64>,
    pub(super) log_likelihood: f64,
}

/// Variance of every bin.
pub(super) fn variances(bins: &[Bin], laws: &[Law], strengths: &[f64], promised: &[f64]) -> Vec<f64> {
    let at = |(i, b): (usize, &Bin)| {
        let own: f64 = laws.iter().zip(strengths).map(|(l, s)| s * l.variance(b.theta)).sum();
        (own + promised.get(i).copied().unwrap_or(0.0)).max(f64::MIN_POSITIVE)
    };
    bins.iter().enumerate().map(at).collect()
}

/// Maximum likelihood for at most five laws on top of `promised` variances per bin (which may be
/// empty).
pub(super) fn fit(bins: &[Bin], laws: &[Law], promised: &[f64], part: Part) -> Strengths {
    let shapes: Vec<Vec<f64>> = laws.iter().map(|l| bins.iter().map(|b| l.variance(b.theta)).collect()).collect();
    let free: [bool; 5] = std::array::from_fn(|p| p < laws.len());
    let power: f64 = bins.iter().map(|b| part.of(&b.sum)).sum();
    let count: f64 = bins.iter().map(|b| part.of(&b.count)).sum();
    let mean = (power / count.max(1.0)).max(f64::MIN_POSITIVE);
    // Start from the power itself: then every law that is needed is seen at its own frequencies.
    let mut variances: Vec<f64> = smoothed(bins, part, mean);
    let mut values = [0.0; 5];
    let mut best = f64::NEG_INFINITY;
    let mut normal = [[0.0; 5]; 5];
    for round in 0..60 {
        normal = [[0.0; 5]; 5];
        let mut target = [0.0; 5];
        for (i, bin) in bins.iter().enumerate() {
            let n = part.of(&bin.count);
            if n == 0.0 {
                continue;
            }
            let weight = n / (variances[i] * variances[i]);
            let rest = part.of(&bin.sum) / n - promised.get(i).copied().unwrap_or(0.0);
            for p in 0..laws.len() {
                target[p] += weight * shapes[p][i] * rest;
                for q in 0..laws.len() {
                    normal[p][q] += weight * shapes[p][i] * shapes[q][i];
                }
            }
        }
        let proposed = non_negative(&normal, &target, &free);
        let (from, mut step) = (values, 1.0);
        let mut gained = f64::NEG_INFINITY;
        for _ in 0..12 {
            values = std::array::from_fn(|p| from[p] + step * (proposed[p] - from[p]));
            variances = self::variances(bins, laws, &values, promised);
            gained = log_likelihood(bins, &variances, part);
            if round == 0 || gained >= best {
                break;
            }
            step /= 2.0;
        }
        let done = gained - best < 1e-7 * (1.0 + best.abs() * 1e-6);
        best = best.max(gained);
        if done && round > 2 {
            break;
        }
    }
    let errors = (0..laws.len()).map(|p| standard_error(&normal, laws.len(), p)).collect();
    Strengths { values: values[..laws.len()].to_vec(), errors, log_likelihood: best }
}

fn smoothed(bins: &[Bin], part: Part, mean: f64) -> Vec<f64> {
    let at = |i: usize| {
        let near = &bins[i.saturating_sub(4)..(i + 5).min(bins.len())];
        let (sum, count) = near.iter().fold((0.0, 0.0), |(s, n), b| (s + part.of(&b.sum), n + part.of(&b.count)));
        if count > 0.0 { (sum / count).max(1e-12 * mean) } else { mean }
    };
    (0..bins.len()).map(at).collect()
}

/// Standard error of unknown `p`: the information is half the normal matrix.
fn standard_error(normal: &[[f64; 5]; 5], size: usize, p: usize) -> f64 {
    let matrix = nalgebra::DMatrix::from_fn(size, size, |i, j| normal[i][j] / (normal[i][i] * normal[j][j]).sqrt());
    let inverse = matrix.try_inverse().map_or(f64::INFINITY, |m| m[(p, p)]);
    (2.0 * inverse / normal[p][p]).abs().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::cosine;
    use crate::rng::{Philox, Stream};

    #[test]
    fn strengths_of_white_noise_and_a_walk_come_back_within_their_errors() {
        let mut inside = 0;
        for member in 0..40 {
            let mut rng = Philox::new(5, member, Stream::Host);
            let mut walk = 0.0;
            let values: Vec<f64> = (0..2000)
                .map(|_| {
                    walk += 0.05 * rng.normal();
                    walk + rng.normal()
                })
                .collect();
            let bins = bins(&cosine::transform(&values));
            let fit = fit(&bins, &[Law::White, Law::Walk], &[], Part::All);
            let off =
                [(0, 1.0), (1, 0.0025)].map(|(p, want): (usize, f64)| (fit.values[p] - want).abs() / fit.errors[p]);
            inside += off.iter().filter(|o| **o < 1.96).count();
        }
        // 95 % of 80, less three standard errors.
        assert!(inside >= 70, "{inside} of 80");
    }
}
