//! States how far parameters may be from the truth: their scores are summed with slow waves of the
//! recording's time, whose mean square is what noise of any colour adds to a sum over all of it.
//!
//! Rows are differences of what a reference says, and noise of single poses, which differences make
//! anticorrelated, almost cancels in a sum over the recording. Blocks that are left out one by one
//! count what enters at each of their ends as if it stayed, and an autoregression of low order
//! leaves it in: intervals from either are several times too wide. The slowest waves see the noise
//! where it matters, at the frequency of the recording itself (Phillips, Econometric Theory 21,
//! 2005; Lazarus, Lewis, Stock & Watson, JBES 36, 2018: Student's t with as many degrees of freedom
//! as there are waves). Blocks that are left out serve where nothing passes their ends.

use nalgebra::DVector;

use super::blocks::{Linear, Solved};
use super::parameters::{COSINES, FORCE_WANDER, GYRO_WANDER, Point};
use crate::numerics::special::t_quantile;

/// Number of waves: of half a period, a whole one and so on.
const WAVES: usize = 8;

/// The solution moved by what each wave of the scores does to it: the sum of the squares of the
/// moves is its variance.
pub(super) fn apart(linear: &Linear, active: &[usize], solved: &Solved) -> Vec<Point> {
    if linear.turns_by_block() {
        let without = linear.replicates(active);
        if without.len() > WAVES {
            return left_out(&without, solved);
        }
    }
    let pieces = linear.scores(active, &solved.point);
    let count = pieces.len() as f64;
    let wave = |n: usize| {
        let phase = |k: usize| (std::f64::consts::PI * n as f64 * (k as f64 + 0.5) / count).cos();
        let score = pieces.iter().enumerate().fold(DVector::zeros(active.len()), |s, (k, piece)| s + piece * phase(k));
        // The mean square of a cosine is one half.
        let moved = &solved.covariance * score * (2.0 / WAVES as f64).sqrt();
        let mut point = solved.point;
        active.iter().enumerate().for_each(|(i, p)| point[*p] += moved[i]);
        point
    };
    // The slowest are the wander itself where that is free, and then add nothing.
    let wanders = active.iter().any(|p| GYRO_WANDER.contains(p) || FORCE_WANDER.contains(p));
    let first = 1 + if wanders { COSINES } else { 0 };
    (first..first + WAVES).map(wave).collect()
}

/// The solution moved by what leaving each block out does to it; of more blocks than waves, so that
/// their quantile is on the safe side. Where an attitude turns by
/// block, no noise goes on from one to the next, and there are too few rows in each to see it go on
/// within.
fn left_out(without: &[Point], solved: &Solved) -> Vec<Point> {
    let n = without.len() as f64;
    let mean: Point = std::array::from_fn(|p| without.iter().map(|point| point[p]).sum::<f64>() / n);
    let spread = ((n - 1.0) / n).sqrt();
    let moved = |point: &Point| std::array::from_fn(|p| solved.point[p] + spread * (point[p] - mean[p]));
    without.iter().map(moved).collect()
}

/// Standard error of a number that is made of parameters.
pub(super) fn deviation(of: &dyn Fn(&Point) -> f64, at: &Point, apart: &[Point]) -> f64 {
    let value = of(at);
    apart.iter().map(|point| (of(point) - value).powi(2)).sum::<f64>().sqrt()
}

/// Half the width of its 95 % interval.
pub(super) fn half_width(of: &dyn Fn(&Point) -> f64, at: &Point, apart: &[Point]) -> f64 {
    t_quantile(0.975, WAVES as f64) * deviation(of, at, apart)
}
