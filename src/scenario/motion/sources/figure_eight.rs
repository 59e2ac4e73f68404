//! `figure-eight`: two level loops, the first to the right, at constant speed; Gerono's lemniscate.

use nalgebra::Vector3;

use super::ramp::Start;
use super::section::Section;
use super::source::{Source, positive};
use super::track::{Curve, along, endless};
use crate::error::Result;
use crate::motion::pose::Pose;

/// Name, keys and poses of kind = "figure-eight".
pub const SOURCE: Source =
    Source { name: "figure-eight", keys: &["radius_m", "speed_m_s", "still_s"], poses: Some(poses) };

/// North r sin q, east r/2 sin 2q: from the crossing north-eastward.
struct Lemniscate {
    radius_m: f64,
}

impl Curve for Lemniscate {
    fn point(&self, q: f64) -> Vector3<f64> {
        Vector3::new(q.sin(), 0.5 * (2.0 * q).sin(), 0.0) * self.radius_m
    }

    fn slope(&self, q: f64) -> Vector3<f64> {
        Vector3::new(q.cos(), (2.0 * q).cos(), 0.0) * self.radius_m
    }
}

fn poses(section: &Section, duration_s: f64) -> Result<Vec<Pose>> {
    let radius_m = positive("radius_m", section.radius_m, 50.0)?;
    let speed_m_s = positive("speed_m_s", section.speed_m_s, 10.0)?;
    let start = Start { still_s: section.still_s.unwrap_or_default(), speed_m_s };
    Ok(along(&Lemniscate { radius_m }, duration_s, endless(start)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eight_is_round_at_its_speed() {
        let eight = Lemniscate { radius_m: 20.0 };
        let poses = along(&eight, 40.0, |t| 8.0 * t);
        for pair in poses.windows(2) {
            let speed = (pair[1].position_m - pair[0].position_m).norm() / (pair[1].time_s - pair[0].time_s);
            assert!((speed / 8.0 - 1.0).abs() < 1e-4, "{speed}");
        }
        // x⁴ = r²(x² − y²) is Gerono's equation.
        let on_it = |p: &Pose| p.position_m.x.powi(4) - 400.0 * (p.position_m.x.powi(2) - p.position_m.y.powi(2));
        assert!(poses.iter().all(|p| on_it(p).abs() < 1e-9 * 20f64.powi(4)));
        assert!(poses.iter().any(|p| p.position_m.y > 9.9) && poses.iter().any(|p| p.position_m.y < -9.9));
    }
}
