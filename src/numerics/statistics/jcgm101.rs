//! Finds how many trials a Monte Carlo result takes to be stable to this many digits, and the
//! result: estimate, standard uncertainty, coverage intervals. JCGM 101:2008, §7.
//!
//! The adaptive procedure of §7.9.4 stops when twice the standard error of a few block results is
//! small enough, and because it asks again after each block, it stops too early too often. Here the
//! first blocks only say how many there must be in all (Stein's two stages; Wübbeler, Harris, Cox &
//! Elster, *Metrologia* 47, 317, 2010), for the four results together at 95 %.

use std::ops::Range;

use serde::Serialize;

use super::Summary;
use crate::numerics::order;
use crate::numerics::special::{normal_quantile, t_quantile};

/// Trials of a block: JCGM 101 §7.9.4 b) asks for 10⁴; a multiple of the 256 members that are
/// summed together.
pub const BLOCK: u64 = 10_240;
/// Blocks of the first stage.
pub const BLOCKS: u64 = 10;
/// Coverage probability of the intervals.
const COVERAGE: f64 = 0.95;
/// Probability with which all four results are within the tolerance.
const CONFIDENCE: f64 = 0.95;

/// Results of one block: mean, standard deviation, lower and upper end of the symmetric coverage
/// interval.
pub type Block = [f64; 4];

/// Number of trials needed, by the first stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Need {
    /// Trials in all, a multiple of [`BLOCK`].
    pub trials: u64,
    /// Numerical tolerance δ of JCGM 101 §7.9.2, half a unit of the last digit.
    pub tolerance: f64,
}

/// Half a unit of the last of this many digits of a standard uncertainty: c × 10ˡ with c of that
/// many digits has δ = ½ 10ˡ.
pub fn tolerance(standard_uncertainty: f64, digits: u32) -> f64 {
    if standard_uncertainty == 0.0 || !standard_uncertainty.is_finite() {
        return 0.0;
    }
    let written = format!("{:.*e}", digits.saturating_sub(1) as usize, standard_uncertainty);
    let exponent: i32 = written.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    0.5 * 10f64.powi(exponent - digits as i32 + 1)
}

/// The results of a block of values, in any order; they are sorted.
pub fn block(values: &mut [f64]) -> Block {
    order::sort(values);
    let [low, high] = symmetric(values);
    let (mean, sd) = mean_and_sd(values);
    [mean, sd, low, high]
}

/// Number of trials for this many stable digits, judged by the blocks of the first stage.
pub fn need(blocks: &[Block], digits: u32) -> Need {
    let h = blocks.len() as f64;
    // Bonferroni over the four results.
    let t = t_quantile(1.0 - (1.0 - CONFIDENCE) / (2.0 * 4.0), h - 1.0);
    let moments = |k: usize| mean_and_sd(&blocks.iter().map(|b| b[k]).collect::<Vec<f64>>());
    // Where the uncertainty might turn out with a digit more or less, the finer tolerance of the
    // two.
    let (u, of_u) = moments(1);
    let tolerance = tolerance(u, digits).min(tolerance((u - t * of_u / h.sqrt()).max(0.5 * u), digits));
    let wanted = |k: usize| if tolerance > 0.0 { (moments(k).1 * t / tolerance).powi(2).ceil() } else { 0.0 };
    let blocks = (0..4).map(wanted).fold(h, f64::max);
    Need { trials: (blocks as u64).saturating_mul(BLOCK), tolerance }
}

/// Estimate, standard uncertainty and intervals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Stated {
    /// Number of Monte Carlo trials.
    pub trials: u64,
    /// Digits of the standard uncertainty that are stable.
    pub digits: u32,
    /// Numerical tolerance within which all four are.
    pub tolerance: f64,
    /// Mean over the trials.
    pub estimate: f64,
    /// Standard deviation over the trials.
    pub standard_uncertainty: f64,
    /// Coverage intervals of 95 %.
    pub interval95: Intervals,
}

/// Coverage intervals at 95 %, lower and upper end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Intervals {
    /// The probabilistically symmetric interval.
    pub symmetric: [f64; 2],
    /// The shortest interval with that coverage.
    pub shortest: [f64; 2],
}

/// The linear (GUM) answer next to the simulated one, JCGM 101 §8.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Linear {
    /// Mean of the linear model.
    pub estimate: f64,
    /// Standard uncertainty by linear propagation.
    pub standard_uncertainty: f64,
    /// Estimate ± 1.96 standard uncertainties.
    pub interval95: [f64; 2],
    /// Distance between the lower ends of both intervals.
    pub d_low: f64,
    /// Distance between the upper ends of both intervals.
    pub d_high: f64,
    /// Says whether both are within the tolerance; absent where the trials leave that open.
    pub validated: Option<bool>,
}

impl Stated {
    /// The result of trials whose values are sorted in increasing order.
    pub fn of_sorted(values: &[f64], digits: u32) -> Self {
        let (estimate, standard_uncertainty) = mean_and_sd(values);
        let interval95 = Intervals { symmetric: symmetric(values), shortest: shortest(values) };
        let tolerance = tolerance(standard_uncertainty, digits);
        Self { trials: values.len() as u64, digits, tolerance, estimate, standard_uncertainty, interval95 }
    }

    /// Of an ensemble's sums: quantiles to a small part of a bin, 1/256 of a standard deviation.
    pub fn of_summary(summary: &Summary, digits: u32) -> Self {
        let quantile = |p: f64| summary.histogram.quantile(p, summary.min, summary.max);
        let tail = 1.0 - COVERAGE;
        // The ends move with the bins, so that a thousand places are enough.
        let pairs = (0..=1000).map(|k| tail * f64::from(k) / 1000.0).map(|p| [quantile(p), quantile(p + COVERAGE)]);
        let symmetric = [quantile(0.5 * tail), quantile(1.0 - 0.5 * tail)];
        let shorter = |a: [f64; 2], b: [f64; 2]| if b[1] - b[0] < a[1] - a[0] { b } else { a };
        Self {
            trials: summary.count,
            digits,
            tolerance: tolerance(summary.sd, digits),
            estimate: summary.mean,
            standard_uncertainty: summary.sd,
            interval95: Intervals { symmetric, shortest: pairs.fold(symmetric, shorter) },
        }
    }

    /// The linear answer with this mean and standard deviation held against this one.
    pub fn beside(&self, estimate: f64, standard_uncertainty: f64) -> Linear {
        let half = normal_quantile(0.5 + 0.5 * COVERAGE) * standard_uncertainty;
        let interval95 = [estimate - half, estimate + half];
        let [d_low, d_high] = [0, 1].map(|k| (interval95[k] - self.interval95.symmetric[k]).abs());
        let largest = d_low.max(d_high);
        // JCGM 101 §8.1; the simulated ends are within the tolerance themselves.
        let validated = match largest {
            d if d + self.end_doubt() <= self.tolerance => Some(true),
            d if d - self.end_doubt() > self.tolerance => Some(false),
            _ => None,
        };
        Linear { estimate, standard_uncertainty, interval95, d_low, d_high, validated }
    }

    /// Twice the standard error of an end, as a normal law has it: √(p(1 − p)/n)/f at 2.5 %.
    fn end_doubt(&self) -> f64 {
        2.0 * 2.671 * self.standard_uncertainty / (self.trials as f64).sqrt()
    }
}

/// The result of any sampler, stable to this many digits: `sample` gives the values of a range of
/// trials.
///
/// # Errors
/// Those of the sampler.
pub fn adaptive<E>(digits: u32, mut sample: impl FnMut(Range<u64>) -> Result<Vec<f64>, E>) -> Result<Stated, E> {
    let mut values = Vec::new();
    let mut blocks = Vec::new();
    for k in 0..BLOCKS {
        let mut more = sample(k * BLOCK..(k + 1) * BLOCK)?;
        blocks.push(block(&mut more));
        values.append(&mut more);
    }
    let need = need(&blocks, digits);
    if need.trials > BLOCKS * BLOCK {
        values.append(&mut sample(BLOCKS * BLOCK..need.trials)?);
    }
    order::sort(&mut values);
    Ok(Stated::of_sorted(&values, digits))
}

/// Mean and standard deviation (n − 1); 0 for fewer than two values.
fn mean_and_sd(values: &[f64]) -> (f64, f64) {
    let moments = super::Moments::of(values.iter().copied());
    (moments.mean, moments.sd())
}

/// JCGM 101 §7.7.2, the probabilistically symmetric interval of sorted values.
fn symmetric(sorted: &[f64]) -> [f64; 2] {
    let tail = 0.5 * (1.0 - COVERAGE);
    [order::quantile(sorted, tail), order::quantile(sorted, 1.0 - tail)]
}

/// JCGM 101 §7.7.4, the shortest interval of sorted values.
fn shortest(sorted: &[f64]) -> [f64; 2] {
    let q = ((COVERAGE * sorted.len() as f64 + 0.5) as usize).min(sorted.len().saturating_sub(1));
    let pairs = sorted.iter().zip(sorted.iter().skip(q)).map(|(low, high)| [*low, *high]);
    pairs.reduce(|a, b| if b[1] - b[0] < a[1] - a[0] { b } else { a }).unwrap_or([f64::NAN; 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    // JCGM 101 §7.9.2, examples 1 and 3: u = 0.000 35 g and 2 digits give δ = 0.000 005 g; u = 2 K
    // and 1 digit δ = 0.5 K.
    #[test]
    fn the_tolerance_is_that_of_the_examples() {
        assert!((tolerance(0.000_35, 2) / 0.000_005 - 1.0).abs() < 1e-9);
        assert_eq!(
            [tolerance(2.0, 1), tolerance(9.97, 2), tolerance(9.4, 2), tolerance(0.0, 2)],
            [0.5, 0.5, 0.05, 0.0]
        );
    }
}
