//! Smooth courses in time, of no physics in particular: what any slow cause may look like over one
//! recording.

use super::cause::Cause;
use super::channel::Curve;
use crate::numerics::legendre::legendre;
use crate::numerics::log_time::log_time;

/// Returns whether it is a course that the library names.
pub(super) fn is_course(cause: Cause) -> bool {
    matches!(cause, Cause::RateRamp | Cause::WarmUp)
}

/// Exponents of a drift in time that are tried.
pub(super) const EXPONENTS: [f64; 2] = [0.15, 4.0];
/// Highest degree of a polynomial that stands for a smooth course.
const DEGREES: usize = 6;

/// A curve over the recording, from 0 to 1.
pub(super) fn course(count: usize, at: impl Fn(f64) -> f64) -> Curve {
    Curve::new((0..count).map(|n| at((n as f64 + 0.5) / count as f64)).collect())
}

/// Lines with a kink, and polynomials of time and of its logarithm (what settles in several
/// speeds), each with its numbers.
pub(super) fn smooth(count: usize) -> impl Iterator<Item = (Vec<Curve>, f64)> {
    let kinked = (1..16).map(|k| f64::from(k) / 16.0).map(move |place| {
        let curves = vec![course(count, |u| u), course(count, |u| (u - place).max(0.0))];
        (curves, 3.0)
    });
    let clocks: [fn(f64) -> f64; 2] = [|u| u, log_time];
    let polynomials = clocks.into_iter().flat_map(|clock| (2..=DEGREES).map(move |degree| (clock, degree)));
    let polynomials = polynomials.map(move |(clock, degree)| {
        let curve = |d| course(count, |u| legendre(d, 2.0 * clock(u) - 1.0));
        ((1..=degree).map(curve).collect(), degree as f64)
    });
    kinked.chain(polynomials)
}
