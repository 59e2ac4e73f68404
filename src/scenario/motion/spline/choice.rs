//! Chooses how close the knots of a spline lie that follows measured poses: as the poses themselves
//! ask for.
//!
//! Every other pose is kept aside and predicted from the rest; the distance of the knots is the one
//! that predicts best, or a longer one that does as well: what is noise cannot be predicted, what
//! is motion can (Wahba, *Spline models for observational data*, 1990, ch. 4).

use super::curve::Spline;
use super::fit::{Departure, Knots, fit};
use crate::motion::pose::Pose;

/// Intervals between poses from knot to knot.
const INTERVALS: [usize; 5] = [3, 4, 8, 16, 32];
/// Prediction that is as good, as a share of the best.
const AS_GOOD: f64 = 1.03;
/// Poses looked at.
const MOST: usize = 6000;
/// Below, distances, m, and angles, rad, are rounding.
const FLOOR: [f64; 2] = [1e-9, 1e-9];

/// A spline through measured poses.
///
/// None where they cannot be fitted.
pub fn through(poses: &[Pose], usual_s: f64) -> Option<Spline> {
    let (first, last) = (poses.first()?.time_s, poses.last()?.time_s);
    let part = &poses[..poses.len().min(MOST)];
    let trained: Vec<Pose> = part.iter().step_by(2).copied().collect();
    let kept: Vec<Pose> = part.iter().skip(1).step_by(2).copied().collect();
    let end = trained.last()?.time_s;
    let kept = &kept[..kept.partition_point(|pose| pose.time_s <= end)];
    let scores: Vec<f64> = INTERVALS
        .iter()
        .map(|intervals| {
            let knots = Knots::over(first, end, usual_s * *intervals as f64);
            fit(&trained, knots).map_or(f64::INFINITY, |spline| {
                let departure = Departure::of(&spline, kept);
                departure.rms_m.max(FLOOR[0]) * departure.rms_rad.max(FLOOR[1])
            })
        })
        .collect();
    let best = scores.iter().copied().fold(f64::INFINITY, f64::min);
    let longest = scores.iter().rposition(|score| *score <= best * AS_GOOD)?;
    fit(poses, Knots::over(first, last, usual_s * INTERVALS[longest] as f64))
}
