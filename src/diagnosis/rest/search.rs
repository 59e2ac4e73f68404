//! The best of a grid of models, refined once between its neighbours.

use super::channel::Fitted;
use crate::control::{Control, Stopped};

/// The model of highest likelihood between two values of a number, from a grid of this many points.
///
/// # Errors
/// Stopped.
pub(super) fn best(
    [from, to]: [f64; 2],
    points: usize,
    control: &Control,
    fit: impl Fn(f64) -> Fitted,
) -> Result<Fitted, Stopped> {
    let step = (to - from) / (points - 1) as f64;
    let at = |i: f64| fit(from + i * step);
    let better = |a: &Fitted, b: &Fitted| a.log_likelihood().total_cmp(&b.log_likelihood());
    let (mut centre, mut best) = (0.0, at(0.0));
    for i in (1..points).map(|i| i as f64) {
        control.go_on()?;
        let other = at(i);
        // The last of equals.
        if better(&other, &best).is_ge() {
            (centre, best) = (i, other);
        }
    }
    let mut width = 0.5;
    for _ in 0..5 {
        control.go_on()?;
        for side in [-width, width] {
            let other = at((centre + side).clamp(0.0, (points - 1) as f64));
            if better(&other, &best).is_gt() {
                (centre, best) = ((centre + side).clamp(0.0, (points - 1) as f64), other);
                break;
            }
        }
        width /= 2.0;
    }
    Ok(best)
}
