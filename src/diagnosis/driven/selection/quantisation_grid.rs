//! Finds the quantisation grid of coarsely rounded readings in the values themselves, and judges it
//! by the likelihood of a rounded reading.

use crate::numerics::order;
use crate::numerics::special::normal_cdf;

/// A lattice that readings fall on, and what it explains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuantisationGrid {
    /// Distance of neighbouring values.
    pub step: f64,
    /// Standard deviation of the noise before rounding.
    pub noise: f64,
    /// Mean log-likelihood per sample that rounding adds to plain Gaussian noise.
    pub gain: f64,
    /// Mean log-likelihood per sample, rounding and all.
    pub log_score: f64,
}

/// The lattice of `reading` and its likelihood, given the innovations of a model; `None` where
/// values do not fall on one or it is finer than the noise.
pub(crate) fn lattice(reading: &[f64], innovations: &[f64]) -> Option<QuantisationGrid> {
    let step = spacing(reading)?;
    let variance = innovations.iter().map(|e| e * e).sum::<f64>() / innovations.len().max(1) as f64;
    let sigma = variance.sqrt();
    if step < 0.3 * sigma {
        return None;
    }
    let gaussian = -0.5 * ((2.0 * std::f64::consts::PI * variance).ln() + 1.0);
    let mut best = QuantisationGrid { step, noise: sigma, gain: f64::NEG_INFINITY, log_score: f64::NEG_INFINITY };
    for k in 0..24 {
        let noise = sigma * 0.03 * 1.19f64.powi(k);
        let sum: f64 = innovations
            .iter()
            .map(|e| {
                let probability = normal_cdf((e + 0.5 * step) / noise) - normal_cdf((e - 0.5 * step) / noise);
                (probability.max(1e-12) / step).ln()
            })
            .sum();
        let log_score = sum / innovations.len() as f64;
        if log_score > best.log_score {
            best = QuantisationGrid { step, noise, gain: log_score - gaussian, log_score };
        }
    }
    Some(best)
}

/// The spacing that all values share, if there is one.
fn spacing(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    order::sort(&mut sorted);
    let reach = sorted.last()? - sorted.first()?;
    sorted.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * reach);
    // The outermost values may be rails, which need not lie on it.
    sorted.pop();
    sorted.drain(..sorted.len().min(1));
    // Many samples on few values, or there is no lattice to speak of.
    if sorted.len() < 3 || sorted.len() * 4 > values.len() {
        return None;
    }
    let mut gaps: Vec<f64> = sorted.windows(2).map(|w| w[1] - w[0]).collect();
    order::sort(&mut gaps);
    // The smallest gap, averaged over all that round to it, shrugs off decimal rounding in the
    // file.
    let least = gaps[0];
    let near: Vec<f64> = gaps.iter().copied().filter(|g| *g < 1.5 * least).collect();
    let step = near.iter().sum::<f64>() / near.len() as f64;
    let fits = gaps.iter().filter(|g| (*g / step - (*g / step).round()).abs() < 0.1).count();
    (fits as f64 > 0.98 * gaps.len() as f64).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_rounding_is_seen_and_fine_rounding_is_not() {
        let truth: Vec<f64> = (0..5000).map(|k| (k as f64 * 0.137).sin() + 0.3 * (k as f64 * 0.0411).cos()).collect();
        let rounded = |step: f64| truth.iter().map(|v| (v / step).round() * step).collect::<Vec<f64>>();
        let coarse = rounded(0.05);
        let errors: Vec<f64> = coarse.iter().zip(&truth).map(|(a, b)| a - b).collect();
        let found = lattice(&coarse, &errors).map_or(0.0, |l| l.gain);
        // Uniform against Gaussian of the same variance: ½ ln(2πe/12) = 0.176 per sample. The least
        // noise tried, 3 % of the error, softens both edges: 2·0.03·∫−ln Φ/√12 = 0.010 less. Of
        // 5000 errors, ½ ln of the variance has a standard deviation of ½√(0.8/5000) = 0.0063;
        // twice that is allowed.
        assert!((found - 0.166).abs() < 0.0126, "{found}");
        let noisy: Vec<f64> = errors.iter().enumerate().map(|(k, _)| 0.1 * ((k * k) as f64).sin()).collect();
        assert!(lattice(&rounded(0.001), &noisy).is_none());
    }
}
