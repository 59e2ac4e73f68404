//! Moments of numbers in memory.
//!
//! Not for ensembles, whose moments are summed while they run (`statistics`).

/// Mean and standard deviation (of the whole, not of a sample: divided by n). Zero and zero of nothing.
pub fn mean_sd(values: &[f64]) -> (f64, f64) {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt())
}
