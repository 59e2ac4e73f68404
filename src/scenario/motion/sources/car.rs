//! `car`: streets drawn at random; it stands, accelerates, drives, brakes, turns by 90° and now and
//! then stops again.
//!
//! Speed and heading go smoothly from value to value; the body pitches under acceleration and rolls
//! in turns as springs let it.

use nalgebra::{UnitQuaternion, Vector3};

use super::ramp;
use super::section::Section;
use super::source::{POSES, Source, positive};
use crate::error::Result;
use crate::motion::pose::Pose;
use crate::rng::{Philox, Stream};
use crate::units::DEGREE;
use rand::Rng as _;

/// Name, keys and poses of kind = "car".
pub const SOURCE: Source = Source { name: "car", keys: &["speed_m_s", "still_s", "seed"], poses: Some(poses) };

/// Mean acceleration and braking, m/s², and sideways acceleration in turns, m/s².
const ACCELERATION_M_S2: f64 = 1.5;
const SIDEWAYS_M_S2: f64 = 1.5;
/// Pitch and roll per acceleration: 0.3° per m/s² and 0.4° per m/s² are those of a saloon.
const PITCH_RAD_PER_M_S2: f64 = 0.3 * DEGREE;
const ROLL_RAD_PER_M_S2: f64 = 0.4 * DEGREE;

/// A stretch of the drive: speed and heading go from where they are to these.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch {
    from_s: f64,
    length_s: f64,
    speed_m_s: [f64; 2],
    heading_rad: [f64; 2],
}

impl Stretch {
    /// Speed, its derivative, heading and its derivative.
    fn at(&self, time_s: f64) -> [f64; 4] {
        let x = ((time_s - self.from_s) / self.length_s).clamp(0.0, 1.0);
        let slope = 30.0 * x * x * (1.0 - x).powi(2) / self.length_s;
        let go = |[from, to]: [f64; 2]| (from + (to - from) * ramp::step(x), (to - from) * slope);
        let ((speed, gain), (heading, turn)) = (go(self.speed_m_s), go(self.heading_rad));
        [speed, gain, heading, turn]
    }
}

/// The drive, from a standstill of this many seconds on.
fn drive(random: &mut Philox, speed_m_s: f64, still_s: f64, duration_s: f64) -> Vec<Stretch> {
    let mut uniform = |low: f64, high: f64| low + (high - low) * f64::from(random.next_u32()) / f64::from(u32::MAX);
    let mut stretches: Vec<Stretch> = Vec::new();
    let (mut now, mut speed, mut heading) = (0.0, 0.0, 0.0);
    let mut add = |length_s: f64, to: f64, turn: f64| {
        if length_s > 0.0 {
            let ends = ([speed, to], [heading, heading + turn]);
            stretches.push(Stretch { from_s: now, length_s, speed_m_s: ends.0, heading_rad: ends.1 });
            (now, speed, heading) = (now + length_s, to, heading + turn);
        }
        now
    };
    let mut end = add(still_s.max(POSES.0), 0.0, 0.0);
    let mut from = 0.0;
    while end < duration_s {
        let top = speed_m_s * uniform(0.6, 1.0);
        add((top - from) / ACCELERATION_M_S2, top, 0.0);
        add(uniform(5.0, 20.0), top, 0.0);
        if uniform(0.0, 1.0) < 0.3 {
            add(top / ACCELERATION_M_S2, 0.0, 0.0);
            end = add(uniform(3.0, 15.0), 0.0, 0.0);
            from = 0.0;
        } else {
            from = top.min(0.4 * speed_m_s);
            add((top - from) / ACCELERATION_M_S2, from, 0.0);
            let side = if uniform(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
            end = add(90.0 * DEGREE * from / SIDEWAYS_M_S2, from, side * 90.0 * DEGREE);
        }
    }
    stretches
}

fn poses(section: &Section, duration_s: f64) -> Result<Vec<Pose>> {
    let speed = positive("speed_m_s", section.speed_m_s, 15.0)?;
    let mut random = Philox::new(section.seed.unwrap_or(1), 0, Stream::Excitation);
    let still = section.still_s.unwrap_or(10.0);
    let stretches = drive(&mut random, speed, still, duration_s + 1.0);
    let at = |time_s: f64| {
        let k = stretches.partition_point(|s| s.from_s <= time_s).clamp(1, stretches.len());
        stretches[k - 1].at(time_s)
    };
    let velocity = |time_s: f64| {
        let [speed, _, heading, _] = at(time_s);
        Vector3::new(heading.cos(), heading.sin(), 0.0) * speed
    };
    let count = (duration_s / POSES.0 - 1e-9).ceil().max(2.0) as usize;
    let mut position_m = Vector3::zeros();
    let mut poses = Vec::with_capacity(count + 1);
    for k in 0..=count {
        let time_s = k as f64 * POSES.0;
        let [speed, gain, heading, turn] = at(time_s);
        // Nose up under acceleration, out of the turn in it.
        let (roll, pitch) = (-ROLL_RAD_PER_M_S2 * speed * turn, PITCH_RAD_PER_M_S2 * gain);
        poses.push(Pose { time_s, position_m, attitude: UnitQuaternion::from_euler_angles(roll, pitch, heading) });
        // Simpson's rule from pose to pose.
        let (middle, next) = (time_s + 0.5 * POSES.0, time_s + POSES.0);
        position_m += (velocity(time_s) + 4.0 * velocity(middle) + velocity(next)) * (POSES.0 / 6.0);
    }
    Ok(poses)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_car_stands_drives_turns_and_never_slides() {
        let section: Section = proofmass_base::document::parse_toml("study.toml", "kind = \"car\"").expect("read");
        let poses = poses(&section, 600.0).expect("made");
        assert!(poses[499].position_m.norm() < 1e-12, "ten seconds at rest");
        let (mut stopped, mut fastest) = (0, 0.0f64);
        for pair in poses.windows(2).skip(600) {
            let way = pair[1].position_m - pair[0].position_m;
            let speed = way.norm() / POSES.0;
            stopped += usize::from(speed < 1e-6);
            fastest = fastest.max(speed);
            if speed > 0.5 {
                let nose = pair[0].attitude.slerp(&pair[1].attitude, 0.5) * Vector3::x();
                let ground = Vector3::new(nose.x, nose.y, 0.0).normalize();
                assert!(way.cross(&ground).norm() < 1e-4 * way.norm(), "it slides");
            }
        }
        assert!(stopped > 100 && fastest > 8.0 && fastest <= 15.0, "{stopped} {fastest}");
        let headings = poses.iter().map(|p| p.attitude.euler_angles().2);
        assert!(headings.clone().fold(0.0, f64::max) > 1.0 || headings.fold(0.0, f64::min) < -1.0, "it turns");
    }
}
