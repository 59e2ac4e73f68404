//! Declares a kind of trajectory; holds what the kinds share.

use super::section::Section;
use crate::error::{Error, Result};
use crate::motion::pose::Pose;

/// Poses of a computed motion over this many seconds.
pub type Computed = fn(&Section, f64) -> Result<Vec<Pose>>;

/// A kind of trajectory.
#[derive(Debug)]
pub struct Source {
    /// Value of `trajectory.kind` that selects it.
    pub name: &'static str,
    /// The keys that it takes.
    pub keys: &'static [&'static str],
    /// Its poses over this many seconds; none: they come from a file.
    pub poses: Option<Computed>,
}

/// Between poses of a computed motion, s, and poses to a knot of its spline.
pub const POSES: (f64, f64) = (0.02, 2.0);

/// An error of the section.
pub fn fail(cause: impl Into<String>, hint: impl Into<String>) -> Error {
    Error::new("could not make the trajectory of [trajectory]", cause, hint)
}

/// A length or speed that has to be positive, or what it is when it is not given.
pub fn positive(key: &str, given: Option<f64>, otherwise: f64) -> Result<f64> {
    let value = given.unwrap_or(otherwise);
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(fail(format!("trajectory.{key}: need a number above zero, got {value}"), format!("e.g. {key} = {otherwise:?}")))
}

/// Poses of a motion that is known at any time.
pub fn sampled(duration_s: f64, pose: impl Fn(f64) -> Pose) -> Vec<Pose> {
    let steps = (duration_s / POSES.0 - 1e-9).ceil().max(2.0) as usize;
    (0..=steps).map(|k| pose(k as f64 * POSES.0)).collect()
}
