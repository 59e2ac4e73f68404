//! States what a recording may lack, and how fast it may have been sampled.

use std::ops::RangeInclusive;

/// Share of a recording that may be missing and is then filled by straight lines; more is an error.
pub const FILL_LIMIT: f64 = 0.05;

/// Slowest and fastest sampling that is one: from a sample in thirty years to a terahertz, Hz.
pub(crate) const RATES_HZ: RangeInclusive<f64> = 1e-9..=1e12;
