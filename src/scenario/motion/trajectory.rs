//! A continuous motion over the Earth: what gyros and accelerometers on it would read, without
//! error, at every instant.
//!
//! With positions p in metres along meridian and parallel, velocity v = p′ and attitude C from body
//! axes to the local level, specific force is Cᵀ(v′ + (2ω_ie + ω_en) × v − g) and the rate against
//! inertial space ω_nb + Cᵀ(ω_ie + ω_en): Groves, *Principles of GNSS, inertial, and multisensor
//! integrated navigation systems*, second edition, §5.4.

use nalgebra::Vector3;

use super::earth::{Earth, Place};
use super::file::finding::Finding;
use super::spline::{Departure, Motion, Spline};
use super::truth::{Sample, Truth};
use crate::error::{Error, Result};

/// A motion that goes on for a while.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    spline: Spline,
    /// Distance of the motion from the poses given.
    pub departure: Departure,
    /// Length of the motion, s.
    pub duration_s: f64,
    /// Findings on the file that it comes from.
    pub findings: Vec<Finding>,
}

/// Rate and length at which a motion is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Samples per second.
    pub rate_hz: f64,
    /// Length of the motion, s.
    pub duration_s: f64,
    /// From the body's origin to the sensor, in body axes, m.
    pub lever_arm_m: Vector3<f64>,
}

/// A stretch of a motion, evenly sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Time of the first sample, s.
    pub from_s: f64,
    /// Time between samples, s.
    pub interval_s: f64,
    /// Number of intervals.
    pub steps: usize,
}

/// Share of a sample by which a motion may end early.
const ROUNDING: f64 = 1e-6;

impl Trajectory {
    /// The motion of a spline from zero on.
    pub fn new(spline: Spline, departure: Departure, findings: Vec<Finding>) -> Self {
        let duration_s = spline.end_s();
        Self { spline, departure, duration_s, findings }
    }

    /// From one knot of its spline to the next, s.
    pub fn knot_s(&self) -> f64 {
        self.spline.knot_s()
    }

    /// The motion of a sensor at an instant, over a level that does not turn.
    pub fn at(&self, time_s: f64, lever_arm_m: Vector3<f64>) -> Motion {
        let body = self.spline.at(time_s);
        let (arm, rate) = (lever_arm_m, body.rate_rad_s);
        let carried = rate.cross(&arm);
        let pressed = body.angular_acceleration_rad_s2.cross(&arm) + rate.cross(&carried);
        let mut pose = body.pose;
        pose.position_m += pose.attitude * arm;
        Motion {
            pose,
            velocity_m_s: body.velocity_m_s + pose.attitude * carried,
            acceleration_m_s2: body.acceleration_m_s2 + pose.attitude * pressed,
            ..body
        }
    }

    /// The truth at every sample, the first at zero and the last at the end.
    ///
    /// # Errors
    /// A motion shorter than the time asked for, need and got.
    pub fn truth(&self, earth: &Earth, sampling: Sampling) -> Result<Truth> {
        let interval_s = 1.0 / sampling.rate_hz;
        if sampling.duration_s > self.duration_s + ROUNDING * interval_s {
            return Err(Error::new(
                "could not follow the trajectory to the end of the study",
                format!("it lasts {:.3} s, the study {:.3} s", self.duration_s, sampling.duration_s),
                "shorten duration_s, begin earlier (trajectory.from_s) or give a longer file",
            ));
        }
        let steps = (sampling.duration_s * sampling.rate_hz).round().max(0.0) as usize;
        Ok(self.stretch(earth, sampling.lever_arm_m, Stretch { from_s: 0.0, interval_s, steps }))
    }

    /// The truth over a stretch, as a separate motion that begins at the Earth's start; the body
    /// stands still before the trajectory begins and after it ends.
    pub fn stretch(&self, earth: &Earth, lever_arm_m: Vector3<f64>, over: Stretch) -> Truth {
        let Stretch { from_s, interval_s, steps } = over;
        let mut place = earth.start();
        let origin = self.at(from_s, lever_arm_m).pose.position_m;
        let mut samples: Vec<Sample> = Vec::with_capacity(steps + 1);
        for k in 0..=steps {
            let motion = self.at(from_s + k as f64 * interval_s, lever_arm_m);
            if let Some(before) = samples.last() {
                let mean = 0.5 * (before.velocity_m_s + motion.velocity_m_s);
                place = place.moved(earth.place_rates(place, mean), interval_s);
            }
            let mut sample = reading(earth, place, &motion);
            sample.position_m -= origin;
            sample.time_s -= from_s;
            samples.push(sample);
        }
        Truth { interval_s, samples }
    }
}

/// Returns what sensors that move like this over the Earth read.
fn reading(earth: &Earth, place: Place, motion: &Motion) -> Sample {
    let velocity = motion.velocity_m_s;
    let (earth_rate, transport) = (earth.rate_rad_s(place), earth.transport_rate_rad_s(place, velocity));
    let gravity = Vector3::new(0.0, 0.0, earth.gravity_m_s2(place));
    let force = motion.acceleration_m_s2 + (2.0 * earth_rate + transport).cross(&velocity) - gravity;
    let attitude = motion.pose.attitude;
    Sample {
        time_s: motion.pose.time_s,
        attitude,
        velocity_m_s: velocity,
        position_m: motion.pose.position_m,
        specific_force_m_s2: attitude.inverse_transform_vector(&force),
        rate_rad_s: motion.rate_rad_s + attitude.inverse_transform_vector(&(earth_rate + transport)),
    }
}
