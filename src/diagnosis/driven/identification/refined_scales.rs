//! Sizes of what a fit leaves: how large its velocity and its residual are, and which frequencies
//! stand out.

use crate::driven::intake::data::Data;
use crate::driven::simulation::run::trace;
use crate::numerics::moments::mean_sd;
use crate::numerics::{order, spectrum};
use crate::physics::scales::Scales;

use super::fit::Fit;

/// Sizes after the base (or a better model) has been fitted.
pub fn refined(data: &Data, fit: &Fit, scales: &Scales) -> Scales {
    let (innovations, states) = trace(data, &fit.structure, &fit.point, &fit.run(data, true));
    let mut scales = scales.clone();
    scales.velocity = mean_sd(&states.v).1.max(1e-300);
    scales.residual = fit.variance.sqrt().max(1e-300);
    scales.lines_hz = lines(&innovations, data.rate_hz);
    scales
}

/// Frequencies at which a sequence's spectrum stands out most from its neighbourhood, strongest
/// first.
pub(crate) fn lines(values: &[f64], rate_hz: f64) -> Vec<f64> {
    let raw = spectrum::periodogram(values, rate_hz);
    let count = raw.density.len();
    if count < 64 {
        return Vec::new();
    }
    // Against the mean of a neighbourhood, so that a broad hill does not hide a narrow line.
    let mut sums = vec![0.0; count + 1];
    for (i, v) in raw.density.iter().enumerate() {
        sums[i + 1] = sums[i] + v;
    }
    let reach = (count / 200).max(10);
    let mut stands: Vec<(f64, usize)> = (0..count)
        .map(|i| {
            let (a, b) = (i.saturating_sub(reach), (i + reach + 1).min(count));
            (raw.density[i] / ((sums[b] - sums[a]) / (b - a) as f64).max(1e-300), i)
        })
        .collect();
    order::sort_by_key(&mut stands, |s| -s.0);
    let mut chosen: Vec<usize> = Vec::new();
    // The highest density itself, and then what stands out locally.
    if let Some((i, _)) = raw.density.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) {
        chosen.push(i);
    }
    for (_, i) in stands {
        if chosen.len() >= 4 {
            break;
        }
        if !chosen.iter().any(|c| c.abs_diff(i) < reach) {
            chosen.push(i);
        }
    }
    chosen.into_iter().map(|i| raw.frequency_hz[i]).collect()
}
