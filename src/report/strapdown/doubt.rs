//! Says how well an ensemble knows a spread, and so which of its digits are printed.

use proofmass_numerics::statistics::Summary;

/// Standard error of a standard deviation.
pub(crate) fn doubt(summary: &Summary) -> f64 {
    summary.sd / (2.0 * summary.count.max(2) as f64).sqrt()
}
