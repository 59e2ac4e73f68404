//! `rest`: the body stays where it is.

use nalgebra::{UnitQuaternion, Vector3};

use super::section::Section;
use super::source::Source;
use crate::error::Result;
use crate::motion::pose::Pose;
use crate::units::DEGREE;

/// Name, keys and poses of kind = "rest".
pub const SOURCE: Source = Source { name: "rest", keys: &["heading_deg"], poses: Some(poses) };

/// Two poses hold it.
fn poses(section: &Section, duration_s: f64) -> Result<Vec<Pose>> {
    let heading = section.heading_deg.unwrap_or_default() * DEGREE;
    let attitude = UnitQuaternion::from_euler_angles(0.0, 0.0, heading);
    Ok([0.0, duration_s].map(|time_s| Pose { time_s, position_m: Vector3::zeros(), attitude }).into())
}
