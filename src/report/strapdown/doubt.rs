//! How well an ensemble knows a spread: what digits of it are worth printing.

use proofmass_numerics::statistics::Summary;

/// Standard error of a standard deviation.
pub(crate) fn doubt(summary: &Summary) -> f64 {
    summary.sd / (2.0 * summary.count.max(2) as f64).sqrt()
}
