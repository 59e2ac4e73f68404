//! The time from which the tilt of a study along one axis is no longer small.
//!
//! Such a study takes the tilt θ for its sine, so that gravity leaks by g θ into the reading. That
//! errs by θ²/6 of itself: 1 % at √0.06 rad, 14.0°.

use super::Drift;
use crate::statistics::quantity;

/// Tilt at which its sine departs from it by 1 %, rad.
pub const SMALL_TILT_RAD: f64 = 0.244_948_974_278_317_8;

impl Drift {
    /// Returns the first time of the curves, s, at which one sensor in twenty is tilted by more than
    /// [`SMALL_TILT_RAD`] to one side; `None` where that does not happen within the study.
    pub fn small_tilt_ends_s(&self) -> Option<f64> {
        let tilts = self.statistics.at.iter().map(|at| at[quantity::TILT].percentiles);
        let beyond = tilts.map(|[_, p05, _, p95, _]| p95.max(-p05) > SMALL_TILT_RAD);
        let mut late = beyond.zip(&self.statistics.time_s).filter(|(beyond, _)| *beyond);
        late.next().map(|(_, time_s)| *time_s)
    }
}
