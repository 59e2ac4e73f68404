//! Powers by the logarithm, for laws whose exponent is fitted: the same on every machine, and
//! without a branch in the loop over lanes.

use crate::numerics::elementary::Real;
use crate::numerics::exponential;

/// Least argument in sizes: below it the logarithm is held, so that a law is finite at rest.
pub(super) const LEAST: f64 = 1e-6;

/// Says whether the exponent of a law is fitted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Exponent {
    /// It is a parameter like the others.
    #[default]
    Free,
    /// It stays what it is, and the strength has either sign: one power of a sum of several. Such a
    /// form is fitted to hold a law of one power against it, and never named.
    Held,
}

/// A function of f64 at a number of either width.
#[inline(always)]
pub(super) fn by<T: Real>(value: T, f: impl Fn(f64) -> f64) -> T {
    T::of(f(value.f64()))
}

/// base^exponent of a base above 0, within e^±40.
#[inline(always)]
pub(super) fn bounded_power<T: Real>(base: T, exponent: T) -> T {
    let log = exponent * by(base, exponential::ln);
    // In this order a NaN stays a NaN.
    let log = if log > T::of(40.0) { T::of(40.0) } else { log };
    by(if log < T::of(-40.0) { T::of(-40.0) } else { log }, exponential::exp)
}
