//! Holds the motion of the body at every sample: the f64 truth that errors are integrated about.

use nalgebra::{UnitQuaternion, Vector3};

/// The motion at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time since the start, s.
    pub time_s: f64,
    /// Rotation from body axes to north-east-down.
    pub attitude: UnitQuaternion<f64>,
    /// Velocity over the Earth in north-east-down, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Position in north-east-down from the start, m (metres along meridian and parallel on an
    /// ellipsoid).
    pub position_m: Vector3<f64>,
    /// Specific force at the sensor in body axes, m/s².
    pub specific_force_m_s2: Vector3<f64>,
    /// Angular rate against inertial space in body axes, rad/s.
    pub rate_rad_s: Vector3<f64>,
}

/// A motion, sampled evenly; the values hold at the instants themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Time between samples, s.
    pub interval_s: f64,
    /// The samples, one per instant.
    pub samples: Vec<Sample>,
}
