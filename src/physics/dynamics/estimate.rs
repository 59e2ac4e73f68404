//! A number with its standard error, from replicates or from a straight line.
//!
//! Not a distribution: quantiles of ensembles are `statistics`' business.

use crate::numerics::moments::mean;
/// A value and its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Best value.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
}

impl Estimate {
    /// Mean of independent replicates. One replicate has no known error: NaN.
    pub fn of_mean(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = mean(values);
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let standard_error = if n > 1.0 { (squares / (n - 1.0) / n).sqrt() } else { f64::NAN };
        Self { value: mean, standard_error }
    }

    /// The same value with a further, independent standard error.
    pub fn with_further(self, standard_error: f64) -> Self {
        Self { standard_error: self.standard_error.hypot(standard_error), ..self }
    }
}

/// Slope of the least-squares line, its error from the scatter about the line.
pub fn slope(points: &[(f64, f64)]) -> Estimate {
    let n = points.len() as f64;
    let (mx, my) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let sxx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let sxy: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    let value = sxy / sxx;
    let residual: f64 = points.iter().map(|p| (p.1 - my - value * (p.0 - mx)).powi(2)).sum();
    Estimate { value, standard_error: (residual / (n - 2.0).max(1.0) / sxx).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_is_found_without_error() {
        let line = slope(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0), (5.0, 11.0)]);
        assert!((line.value - 2.0).abs() < 1e-12 && line.standard_error < 1e-7);
        let mean = Estimate::of_mean(&[1.0, 2.0, 3.0]);
        assert!((mean.value - 2.0).abs() < 1e-12 && (mean.standard_error - (1.0f64 / 3.0).sqrt()).abs() < 1e-12);
    }
}
