//! `circle`: a level circle to the right at constant speed, nose along the way; it begins
//! northward.

use nalgebra::{UnitQuaternion, Vector3};

use super::ramp::Start;
use super::section::Section;
use super::source::{Source, positive, sampled};
use crate::error::Result;
use crate::motion::pose::Pose;

/// Name, keys and poses of kind = "circle".
pub const SOURCE: Source = Source { name: "circle", keys: &["radius_m", "speed_m_s", "still_s"], poses: Some(poses) };

fn poses(section: &Section, duration_s: f64) -> Result<Vec<Pose>> {
    let radius = positive("radius_m", section.radius_m, 50.0)?;
    let speed_m_s = positive("speed_m_s", section.speed_m_s, 10.0)?;
    let start = Start { still_s: section.still_s.unwrap_or_default(), speed_m_s };
    Ok(sampled(duration_s, |time_s| {
        let heading = start.way_m(time_s) / radius;
        let position_m = Vector3::new(heading.sin(), 1.0 - heading.cos(), 0.0) * radius;
        Pose { time_s, position_m, attitude: UnitQuaternion::from_euler_angles(0.0, 0.0, heading) }
    }))
}
