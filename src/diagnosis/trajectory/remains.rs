//! States what the chosen model leaves: how much, where, and of which colour.

use nalgebra::Vector3;

use super::account::Rest;
use super::fit::Fit;
use super::judgement::{COLOUR, HeldOut};
use super::parameters::Point;
use crate::numerics::special::normal_cdf;
use crate::remainder::{Remainder, Size, Test};

/// Held-out mean square over that of the noise which is tolerated, and from which on something is
/// missing.
const TOLERATED: [f64; 2] = [1.5, 3.0];

/// Fraction of the error of all rows that lies in those which do not hold.
pub(super) fn lies_in_clipped(at: &[(Vector3<f64>, bool)]) -> f64 {
    let mean = |wanted: &dyn Fn(bool) -> bool| {
        let squares = at.iter().filter(|(_, holds)| wanted(*holds)).map(|(value, _)| value.norm_squared());
        let (sum, n) = squares.fold((0.0, 0.0), |s, v| (s.0 + v, s.1 + 1.0));
        sum / f64::max(n, 1.0)
    };
    (1.0 - mean(&|holds| holds) / mean(&|_| true).max(f64::MIN_POSITIVE)).max(0.0)
}

/// Returns what the chosen model leaves: more than everything together would, or a colour that was
/// not seen; and a law that it goes with is real whatever its size.
pub(super) fn remainder(fit: &Fit, chosen: &Point, held: &HeldOut, has_law: bool) -> (Remainder, Rest) {
    let size = Size::of(held.rms()[1].powi(2), TOLERATED[0], TOLERATED[1]);
    // Of three tests: this one and the colour of each half of the pose.
    let mut tests = vec![Test { p_value: 3.0 * held.chance_after(TOLERATED[0]), size }];
    for (residuals, sums) in fit.residuals.iter().zip(&fit.linear.sensors) {
        let from = &fit.linear.point;
        let white = |k: usize| {
            let (residual, slope) = residuals.whitening.white(&residuals.rows, k)?;
            let to = sums.at(residuals.rows[k].time_s, from, chosen);
            Some(slope.iter().zip(to.iter().zip(from)).fold(residual, |r, (s, (to, from))| r + s * (to - from)))
        };
        let all: Vec<Option<Vector3<f64>>> = (0..residuals.rows.len()).map(white).collect();
        let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = all.windows(2).filter_map(|p| Some((p[0]?, p[1]?))).collect();
        let squares: f64 = pairs.iter().map(|(a, _)| a.norm_squared()).sum();
        let follows = pairs.iter().map(|(a, b)| a.dot(b)).sum::<f64>() / squares.max(f64::MIN_POSITIVE);
        let deviations = follows.abs() * (3.0 * pairs.len() as f64).sqrt();
        let p_value = 4.0 * (1.0 - normal_cdf(deviations));
        tests.push(Test { p_value, size: Size::of(follows.abs(), COLOUR, 3.0 * COLOUR) });
    }
    // By which of them the model is refused: the first that is real.
    let refused = |test: &Test| test.found() > Size::Negligible;
    let rest = match tests.iter().position(refused) {
        _ if has_law => Rest::Law,
        Some(0) | None => Rest::Large,
        Some(half) => Rest::Coloured(fit.residuals[half - 1].half),
    };
    if has_law {
        tests.push(Test { p_value: 0.0, size: Size::Material });
    }
    (Remainder::of(tests), rest)
}
