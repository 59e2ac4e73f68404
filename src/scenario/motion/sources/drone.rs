//! `drone`: smooth random motion in all six degrees of freedom; it hovers first, then tilts as its
//! thrust has to.
//!
//! Position is a sum of slow sine waves per axis, drawn at random; the thrust axis (body −z) points
//! against the specific force that this takes, and heading wanders.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::ramp;
use super::section::Section;
use super::source::{Source, positive, sampled};
use crate::error::Result;
use crate::motion::pose::Pose;
use crate::rng::{Philox, Stream};
use crate::units::STANDARD_GRAVITY_M_S2;
use rand::Rng as _;

/// Name, keys and poses of kind = "drone".
pub const SOURCE: Source =
    Source { name: "drone", keys: &["speed_m_s", "extent_m", "still_s", "seed"], poses: Some(poses) };

/// Waves per axis, and how long the motion takes to come up, s.
const WAVES: usize = 6;
const RISE_S: f64 = 5.0;
/// Root mean square of the heading's wander, rad.
const HEADING_RAD: f64 = 1.0;

/// One wave of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wave {
    amplitude: f64,
    omega_rad_s: f64,
    phase_rad: f64,
}

impl Wave {
    /// Displacement from where it starts, and its first two derivatives.
    fn at(&self, time_s: f64) -> [f64; 3] {
        let (sin, cos) = (self.omega_rad_s * time_s + self.phase_rad).sin_cos();
        let (a, w) = (self.amplitude, self.omega_rad_s);
        [a * (sin - self.phase_rad.sin()), a * w * cos, -a * w * w * sin]
    }
}

/// Waves whose sum has this root mean square, about this frequency.
fn waves(random: &mut Philox, rms: f64, omega_rad_s: f64) -> [Wave; WAVES] {
    let amplitude = rms * (2.0 / WAVES as f64).sqrt();
    std::array::from_fn(|k| {
        let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX);
        // Spread from half the frequency to one and a half, each in a part of its own.
        let omega_rad_s = omega_rad_s * (0.5 + (k as f64 + uniform()) / WAVES as f64);
        Wave { amplitude, omega_rad_s, phase_rad: std::f64::consts::TAU * uniform() }
    })
}

/// Value and derivatives of a sum of waves that comes up smoothly.
fn sum(waves: &[Wave], since_s: f64) -> [f64; 3] {
    if since_s <= 0.0 {
        return [0.0; 3];
    }
    let total = waves.iter().map(|w| w.at(since_s)).fold([0.0; 3], |a, b| std::array::from_fn(|k| a[k] + b[k]));
    let x = (since_s / RISE_S).min(1.0);
    let rise = [
        ramp::step(x),
        30.0 * x * x * (1.0 - x).powi(2) / RISE_S,
        60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (RISE_S * RISE_S),
    ];
    [
        rise[0] * total[0],
        rise[1] * total[0] + rise[0] * total[1],
        rise[2] * total[0] + 2.0 * rise[1] * total[1] + rise[0] * total[2],
    ]
}

/// The attitude whose −z axis pushes along a specific force, nose at a heading.
fn attitude(force: Vector3<f64>, heading_rad: f64) -> UnitQuaternion<f64> {
    let down = -force.normalize();
    let nose = Vector3::new(heading_rad.cos(), heading_rad.sin(), 0.0);
    let right = down.cross(&nose).normalize();
    let axes = Matrix3::from_columns(&[right.cross(&down), right, down]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
}

fn poses(section: &Section, duration_s: f64) -> Result<Vec<Pose>> {
    let extent = positive("extent_m", section.extent_m, 10.0)?;
    let speed = positive("speed_m_s", section.speed_m_s, 3.0)?;
    let still = section.still_s.unwrap_or(10.0);
    let mut random = Philox::new(section.seed.unwrap_or(1), 0, Stream::Excitation);
    // Root mean squares of three axes: a third of the squares each; the vertical moves half as far.
    let rms = extent / 4.0;
    let omega = speed / (rms * 3f64.sqrt());
    let axes: [_; 3] = std::array::from_fn(|k| waves(&mut random, if k < 2 { rms } else { 0.5 * rms }, omega));
    let wander = waves(&mut random, HEADING_RAD, 0.5 * omega);
    Ok(sampled(duration_s, |time_s| {
        let of = axes.each_ref().map(|waves| sum(waves, time_s - still));
        let [position_m, _, acceleration] = std::array::from_fn(|k| Vector3::new(of[0][k], of[1][k], of[2][k]));
        let heading = sum(&wander, time_s - still)[0];
        let force = acceleration - Vector3::new(0.0, 0.0, STANDARD_GRAVITY_M_S2);
        Pose { time_s, position_m, attitude: attitude(force, heading) }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn acceleration_is_that_of_the_motion_and_thrust_carries_it() {
        let waves = waves(&mut Philox::new(1, 0, Stream::Host), 2.0, 1.0);
        let step = 1e-4;
        for t in [0.7, 3.0, 6.0] {
            let [before, here, after] = [t - step, t, t + step].map(|t| sum(&waves, t));
            assert!(((after[0] - before[0]) / (2.0 * step) - here[1]).abs() < 1e-6);
            assert!(((after[1] - before[1]) / (2.0 * step) - here[2]).abs() < 1e-5);
        }
        let force = Vector3::new(2.0, -1.0, -9.0);
        let attitude = attitude(force, 0.5);
        assert!((attitude.inverse_transform_vector(&force) - Vector3::new(0.0, 0.0, -force.norm())).norm() < 1e-12);
    }

    #[test]
    fn it_moves_in_all_six_degrees_of_freedom_after_hovering() {
        let section: Section = proofmass_base::document::parse_toml("study.toml", "kind = \"drone\"").expect("read");
        let poses = poses(&section, 120.0).expect("made");
        assert!(poses[499].position_m.norm() == 0.0 && poses[499].attitude.angle() < 1e-12);
        for axis in 0..3 {
            let turns = poses.iter().map(|p| p.attitude.scaled_axis()[axis].abs()).fold(0.0, f64::max);
            let ways = poses.iter().map(|p| p.position_m[axis].abs()).fold(0.0, f64::max);
            assert!(turns > 0.05 && ways > 1.0, "{axis}: {turns} {ways}");
        }
    }
}
