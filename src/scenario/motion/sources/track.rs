//! A way along a curve at a given speed: the curve's parameter advances by speed over its slope.

use nalgebra::{UnitQuaternion, Vector3};

use super::ramp::Start;
use super::source::POSES;
use crate::motion::pose::Pose;

/// A curve and its slope by its own parameter, north-east-down, m.
pub trait Curve {
    /// Point of the curve at the parameter, m.
    fn point(&self, parameter: f64) -> Vector3<f64>;
    /// The derivative by the parameter, nowhere zero.
    fn slope(&self, parameter: f64) -> Vector3<f64>;
}

/// Steps of the parameter's equation between poses.
const STEPS: usize = 4;

/// Poses of a body that follows a curve, nose along it and wings level, from parameter zero on;
/// `way_m` is the length gone.
pub fn along(curve: &impl Curve, duration_s: f64, way_m: impl Fn(f64) -> f64) -> Vec<Pose> {
    let count = (duration_s / POSES.0 - 1e-9).ceil().max(2.0) as usize;
    let mut parameter = 0.0;
    let mut poses = Vec::with_capacity(count + 1);
    for k in 0..=count {
        let time_s = k as f64 * POSES.0;
        poses.push(pose(curve, parameter, time_s));
        for step in 0..STEPS {
            let at = |part: f64| way_m(time_s + (step as f64 + part) * POSES.0 / STEPS as f64);
            parameter = advanced(curve, parameter, at(1.0) - at(0.0));
        }
    }
    poses
}

/// The parameter a short way further on: dq/ds = 1/|slope|, by Runge and Kutta's fourth order.
fn advanced(curve: &impl Curve, parameter: f64, way_m: f64) -> f64 {
    let rate = |q: f64| 1.0 / curve.slope(q).norm();
    let first = rate(parameter);
    let second = rate(parameter + 0.5 * way_m * first);
    let third = rate(parameter + 0.5 * way_m * second);
    let fourth = rate(parameter + way_m * third);
    parameter + way_m * (first + 2.0 * second + 2.0 * third + fourth) / 6.0
}

fn pose(curve: &impl Curve, parameter: f64, time_s: f64) -> Pose {
    let slope = curve.slope(parameter);
    let (heading, climb) = (slope.y.atan2(slope.x), -slope.z);
    let pitch = climb.atan2(slope.x.hypot(slope.y));
    let attitude = UnitQuaternion::from_euler_angles(0.0, pitch, heading);
    Pose { time_s, position_m: curve.point(parameter), attitude }
}

/// The way of a start that goes on for ever.
pub fn endless(start: Start) -> impl Fn(f64) -> f64 {
    move |time_s| start.way_m(time_s)
}
