//! Differences of a parameter from run to run beyond the errors of its estimates.
//!
//! Random effects: the true value differs from run to run, about a mean with standard deviation τ. The estimate
//! of Paule & Mandel (J. Res. NBS 87 (1982) 377), at which Cochran's Q is what is expected of it, never negative: it
//! weighs runs alike where they differ by more than their errors. The interval by the profile of the same Q
//! (Viechtbauer, Statistics in Medicine 26 (2007) 37).

use crate::numerics::special::chi_squared_quantile;

/// A parameter over runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Mean over the runs.
    pub mean: f64,
    /// Standard error of the mean, the spread included.
    pub mean_error: f64,
    /// τ: standard deviation from run to run.
    pub between: f64,
    /// 95 % interval of τ; its upper end is infinite where the runs are too few to bound it.
    pub between_ci95: [f64; 2],
}

/// A value and its standard error.
pub type Measured = (f64, f64);

impl Spread {
    /// Estimates mean and spread; `None` of fewer than two runs or of runs without an error.
    pub fn of(runs: &[Measured]) -> Option<Self> {
        let usable = |(value, error): &Measured| value.is_finite() && error.is_finite() && *error > 0.0;
        if runs.len() < 2 || !runs.iter().all(usable) {
            return None;
        }
        let freedom = runs.len() as f64 - 1.0;
        let variance = crossing(runs, freedom);
        let (mean, weight) = mean(runs, variance);
        let ends = [0.975, 0.025].map(|p| crossing(runs, chi_squared_quantile(p, freedom)).sqrt());
        Some(Self { mean, mean_error: weight.recip().sqrt(), between: variance.sqrt(), between_ci95: ends })
    }

    /// Standard deviation of what the next run will have, about the mean.
    pub fn of_the_next_run(&self) -> f64 {
        self.between.hypot(self.mean_error)
    }
}

/// Weighted mean with this variance between runs, and the sum of the weights.
fn mean(runs: &[Measured], variance: f64) -> (f64, f64) {
    let weigh = |error: f64| 1.0 / (error * error + variance);
    let (sum, weight) = runs.iter().fold((0.0, 0.0), |s, r| (s.0 + weigh(r.1) * r.0, s.1 + weigh(r.1)));
    (sum / weight, weight)
}

/// Cochran's Q with this variance between runs.
pub(super) fn misfit(runs: &[Measured], variance: f64) -> f64 {
    let (mean, _) = mean(runs, variance);
    runs.iter().map(|r| (r.0 - mean).powi(2) / (r.1 * r.1 + variance)).sum()
}

/// The variance at which Q falls to `level`, by bisection; zero where it lies below from the start.
fn crossing(runs: &[Measured], level: f64) -> f64 {
    if misfit(runs, 0.0) <= level {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, runs.iter().map(|r| r.1 * r.1).sum::<f64>());
    let mut steps = 0;
    while misfit(runs, high) > level {
        (low, high, steps) = (high, high * 4.0, steps + 1);
        if steps > 200 {
            return f64::INFINITY;
        }
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if misfit(runs, middle) > level { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    #[test]
    fn the_spread_of_runs_is_found_and_its_interval_holds_it() {
        let mut rng = Philox::new(5, 0, Stream::Host);
        for truth in [0.0, 2.0] {
            let (mut held, mut sum, cases) = (0, 0.0, 400);
            for _ in 0..cases {
                let runs: Vec<Measured> = (0..8)
                    .map(|n| {
                        (
                            7.0 + truth * rng.normal() + (1.0 + 0.1 * f64::from(n)) * rng.normal(),
                            1.0 + 0.1 * f64::from(n),
                        )
                    })
                    .collect();
                let spread = Spread::of(&runs).expect("runs");
                assert!(spread.between >= 0.0);
                sum += spread.between * spread.between;
                held += usize::from((spread.between_ci95[0]..=spread.between_ci95[1]).contains(&truth));
            }
            // 95 % of 400, five standard deviations; a bound at zero holds it more often.
            assert!(held >= 358, "{truth}: {held}");
            let mean = sum / f64::from(cases);
            assert!((mean - truth * truth).abs() < 0.5 * (1.0 + truth * truth) / 2.0 + 0.2, "{truth}: {mean}");
        }
        assert!(Spread::of(&[(1.0, 0.1)]).is_none() && Spread::of(&[(1.0, 0.1), (1.0, 0.0)]).is_none());
    }
}
