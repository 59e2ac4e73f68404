//! What a model leaves: is it more than noise, and does it remember the pose before?

use super::fit::Fit;
use super::rows::{GROUPS, Group};
use crate::numerics::order;
use crate::numerics::special::{f_above, normal_cdf};

/// Degrees of freedom behind the measured noise: its own uncertainty is about ±13 % in standard deviation.
const NOISE_FREEDOM: f64 = 60.0;
/// The remaining residual is more than noise below this probability.
const UNEXPLAINED: f64 = 0.003;
/// The remaining residual must also be this many times the noise variance: less is within what a noise model can promise.
const MATERIAL: f64 = 1.6;

/// What is left after repair.
#[derive(Debug, Clone)]
pub struct Remainder {
    /// Smallest probability over all tests, corrected for their number.
    pub p_value: f64,
    /// Residuals above their noise, with their variance over that of the noise, worst first.
    pub above: Vec<(Group, f64)>,
}

impl Remainder {
    /// Judges a fit.
    pub fn of(fit: &Fit) -> Self {
        let mut tests: Vec<f64> = Vec::new();
        let mut above: Vec<(Group, f64)> = Vec::new();
        for group in GROUPS {
            let (ratio, n) = (fit.reduced(group), fit.rows.chi_square(group).1 as f64);
            let freedom = (n - fit.leverage(group)).max(1.0);
            let p = f_above(ratio, freedom, NOISE_FREEDOM);
            tests.push(p);
            if p < UNEXPLAINED / GROUPS.len() as f64 && ratio > MATERIAL {
                above.push((group, ratio));
            }
        }
        order::sort_by_key(&mut above, |a| -a.1);
        // Per pose one row of gravity, then three of the gyro at rest.
        let at_rest: Vec<usize> = (0..fit.rows.group.len()).filter(|r| fit.rows.group[*r] != Group::Turn).collect();
        for channel in 0..4 {
            let values: Vec<f64> = at_rest.chunks_exact(4).map(|rows| fit.rows.residual[rows[channel]]).collect();
            tests.push(memory(&values));
        }
        let count = tests.len() as f64;
        let smallest = tests.into_iter().fold(1.0, f64::min);
        Self { p_value: (smallest * count).min(1.0), above }
    }
}

/// Probability of so strong a correlation between neighbouring poses by chance.
fn memory(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n.max(1.0);
    let power: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    if n < 8.0 || power <= 0.0 {
        return 1.0;
    }
    let product: f64 = values.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
    // Removing the mean alone biases the correlation by −1/n.
    let z = (product / power + 1.0 / n) * n.sqrt();
    2.0 * (1.0 - normal_cdf(z.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_wave_is_remembered_and_an_alternation_too_but_not_chance() {
        let wave: Vec<f64> = (0..40).map(|k| (f64::from(k) * 0.2).sin()).collect();
        let chance: Vec<f64> = (0..40).map(|k| (f64::from(k * k) * 1.7).sin()).collect();
        assert!(memory(&wave) < 1e-4);
        assert!(memory(&chance) > 0.01, "{}", memory(&chance));
    }
}
