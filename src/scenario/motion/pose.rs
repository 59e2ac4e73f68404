//! Holds where a body is and how it is turned, at one instant.

use nalgebra::{UnitQuaternion, Vector3};

/// Position and attitude of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Time since the start, s.
    pub time_s: f64,
    /// Position in north-east-down from some origin, m.
    pub position_m: Vector3<f64>,
    /// Rotation from body axes to north-east-down.
    pub attitude: UnitQuaternion<f64>,
}

impl Pose {
    /// Returns the distance of another pose from this one: a distance, m, and an angle, rad.
    pub fn distance(&self, other: &Self) -> [f64; 2] {
        [(self.position_m - other.position_m).norm(), self.attitude.angle_to(&other.attitude)]
    }
}
