//! The best of a grid of models, refined once between its neighbours.

use super::channel::Fitted;
use crate::progress;

/// The model of highest likelihood between two values of a number, from a grid of so many points.
pub(super) fn best([from, to]: [f64; 2], points: usize, fit: impl Fn(f64) -> Fitted) -> Fitted {
    let step = (to - from) / (points - 1) as f64;
    let at = |i: f64| fit(from + i * step);
    let better = |a: &Fitted, b: &Fitted| a.log_likelihood().total_cmp(&b.log_likelihood());
    let grid = (0..points).take_while(|_| !progress::interrupted()).map(|i| (i as f64, at(i as f64)));
    let Some((mut centre, mut best)) = grid.max_by(|a, b| better(&a.1, &b.1)) else { return fit(from) };
    let mut width = 0.5;
    for _ in 0..5 {
        if progress::interrupted() {
            break;
        }
        for side in [-width, width] {
            let other = at((centre + side).clamp(0.0, (points - 1) as f64));
            if better(&other, &best).is_gt() {
                (centre, best) = ((centre + side).clamp(0.0, (points - 1) as f64), other);
                break;
            }
        }
        width /= 2.0;
    }
    best
}
