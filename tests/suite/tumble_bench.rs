//! A synthetic turntable for `diagnosis_tumble`: an IMU in random still poses with smooth turns
//! between them, its rates in closed form. Independent of the fitting code: it goes from truth to
//! counts, the tool goes the other way.

use std::f64::consts::FRAC_PI_2;
use std::path::PathBuf;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use proofmass::diagnosis::model::{Split, Tumble, TumbleColumns};
use proofmass::recording::{Column, Recording};
use proofmass::rng::{Philox, Stream};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

/// The IMU's truth. Zero or identity is "absent".
#[derive(Clone)]
pub struct Imu {
    /// Counts at rest.
    pub offset: [Vector3<f64>; 2],
    /// Counts per m/s² and per rad/s, per axis.
    pub scale: [Vector3<f64>; 2],
    /// M of both sensors.
    pub alignment: [Matrix3<f64>; 2],
    /// rad/s per m/s².
    pub g_sensitivity: Matrix3<f64>,
    /// k₂ of both sensors, 1/unit.
    pub quadratic: [Vector3<f64>; 2],
    /// Offset drift of both sensors, unit per minute.
    pub drift_per_minute: [Vector3<f64>; 2],
    /// Offset of both sensors that follows `deg_c`, unit per kelvin.
    pub per_kelvin: [Vector3<f64>; 2],
    /// Rate of the frame, rad/s.
    pub frame_rate_rad_s: Vector3<f64>,
    /// Accelerometer bias that keeps the sign of the last time an axis pointed up or down, m/s²:
    /// not in the library.
    pub hysteresis_m_s2: f64,
    /// Gyro bias that follows the heading, as a magnetic field would make it, rad/s: not in the
    /// library.
    pub heading_rad_s: f64,
    /// Accelerometer error by pointing on one side only (a soft stop), m/s²: not in the library.
    pub soft_stop_m_s2: f64,
    /// Scale error of the gyro by |ω|, s/rad: not in the library.
    pub bend_s: f64,
    /// White noise per sample of both sensors, SI.
    pub noise: [f64; 2],
    /// Poses.
    pub poses: usize,
    /// Share of each body axis in the axes of the turns: zero where it is never turned about.
    pub turned: Vector3<f64>,
    /// From face to face: quarters of a turn about a body axis, every other one a half.
    pub from_face_to_face: bool,
    /// Angle of each turn where all are alike, as on a dividing head, rad.
    pub step_rad: Option<f64>,
}

impl Imu {
    /// No defect; `seed` decides offsets, scales and noise level.
    pub fn without_defect(seed: u64) -> Self {
        let mut rng = Philox::new(seed, 1, Stream::Host);
        let mut about = |centre: f64, half: f64| centre + half * (2.0 * rng.random::<f64>() - 1.0);
        let (a, g) = (about(415.0, 100.0), about(4770.0, 1000.0));
        Self {
            offset: [0.0, 300.0].map(|c| Vector3::from_fn(|_, _| about(c, 200.0))),
            scale: [Vector3::repeat(a), Vector3::repeat(g)],
            alignment: [Matrix3::identity(); 2],
            g_sensitivity: Matrix3::zeros(),
            quadratic: [Vector3::zeros(); 2],
            drift_per_minute: [Vector3::zeros(); 2],
            per_kelvin: [Vector3::zeros(); 2],
            frame_rate_rad_s: Vector3::zeros(),
            hysteresis_m_s2: 0.0,
            heading_rad_s: 0.0,
            soft_stop_m_s2: 0.0,
            bend_s: 0.0,
            noise: [about(0.008, 0.004), about(0.006, 0.003)],
            poses: 30,
            turned: Vector3::repeat(1.0),
            from_face_to_face: false,
            step_rad: None,
        }
    }

    /// Records it: 2 s per pose, 1 s per turn, 50 Hz.
    pub fn record(&self, seed: u64) -> (Recording, Vec<std::ops::Range<usize>>) {
        const RATE_HZ: f64 = 50.0;
        const STILL: usize = 100;
        const TURN: usize = 50;
        let mut rng = Philox::new(seed, 2, Stream::Host);
        let mut normal = {
            let mut noise = Philox::new(seed, 3, Stream::Host);
            move || -> f64 { StandardNormal.sample(&mut noise) }
        };
        let mut attitude = Rotation3::<f64>::identity();
        let mut memory = Vector3::repeat(1.0);
        let mut columns: [Vec<f64>; 6] = Default::default();
        let mut ranges = Vec::new();
        let total_s = (self.poses * (STILL + TURN)) as f64 / RATE_HZ;
        for pose in 0..self.poses {
            ranges.push(columns[0].len()..columns[0].len() + STILL);
            let (axis, angle) = match self.from_face_to_face {
                false => {
                    let axis = Unit::new_normalize(Vector3::from_fn(|_, _| normal()).component_mul(&self.turned));
                    (axis, self.step_rad.unwrap_or_else(|| 0.7 + 1.8 * rng.random::<f64>()))
                }
                // A hand is some degrees off.
                true => {
                    let axis = Vector3::ith(rng.random_range(0..3), 1.0) + Vector3::from_fn(|_, _| 0.03 * normal());
                    (Unit::new_normalize(axis), FRAC_PI_2 * (1 + pose % 2) as f64 + 0.05 * normal())
                }
            };
            let turns = if pose + 1 < self.poses { TURN } else { 0 };
            for k in 0..STILL + turns {
                let progress = |t: f64| {
                    let s = (t / TURN as f64).clamp(0.0, 1.0);
                    s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
                };
                let (from, to) = (progress(k as f64 - STILL as f64), progress(k as f64 + 1.0 - STILL as f64));
                // Body to world; the turn is about a body axis, so its rate in the body is exact.
                let here = attitude * Rotation3::from_axis_angle(&axis, angle * 0.5 * (from + to));
                let rate = axis.into_inner() * angle * (to - from) * RATE_HZ;
                let force = here.inverse() * Vector3::new(0.0, 0.0, 9.81);
                memory.zip_apply(&force, |m, f| {
                    if f.abs() > 6.0 {
                        *m = f.signum();
                    }
                });
                let minutes = (columns[0].len() as f64 / RATE_HZ - total_s / 2.0) / 60.0;
                let counts = self.counts(&force, &rate, &here, &memory, minutes);
                for i in 0..3 {
                    columns[i].push((counts[0][i] + self.noise[0] * self.scale[0][i] * normal()).round());
                    columns[3 + i].push((counts[1][i] + self.noise[1] * self.scale[1][i] * normal()).round());
                }
            }
            attitude *= Rotation3::from_axis_angle(&axis, angle);
        }
        let names = ["ax", "ay", "az", "gx", "gy", "gz"];
        let columns = names.iter().zip(columns).map(|(n, values)| Column { name: (*n).into(), values }).collect();
        let recording =
            Recording { path: PathBuf::from("synthetic.csv"), rate_hz: RATE_HZ, columns, ..Recording::default() };
        (recording, ranges)
    }

    fn counts(
        &self,
        force: &Vector3<f64>,
        rate: &Vector3<f64>,
        attitude: &Rotation3<f64>,
        memory: &Vector3<f64>,
        minutes: f64,
    ) -> [Vector3<f64>; 2] {
        let curved = |v: Vector3<f64>, k: &Vector3<f64>| v + k.component_mul(&v.component_mul(&v));
        let stop = force.map(|f| if f > 5.0 { self.soft_stop_m_s2 * (f - 5.0) / 5.0 } else { 0.0 });
        let acceleration = curved(self.alignment[0] * force, &self.quadratic[0])
            + self.drift_per_minute[0] * minutes
            + self.per_kelvin[0] * (deg_c(minutes) - 25.0)
            + memory * self.hysteresis_m_s2
            + stop;
        let heading = attitude.inverse() * Vector3::new(1.0, 0.0, 0.0);
        let turning = rate + attitude.inverse() * self.frame_rate_rad_s;
        let along = self.alignment[1] * turning + self.g_sensitivity * force;
        let angular = curved(along, &self.quadratic[1])
            + along.map(|w| self.bend_s * w.abs() * w)
            + self.drift_per_minute[1] * minutes
            + self.per_kelvin[1] * (deg_c(minutes) - 25.0)
            + heading * self.heading_rad_s;
        [acceleration, angular]
            .into_iter()
            .enumerate()
            .map(|(n, v)| self.offset[n] + self.scale[n].component_mul(&v))
            .collect::<Vec<_>>()
            .try_into()
            .unwrap_or_default()
    }
}

/// Temperature of the turntable, °C, by the time in minutes from the middle of the recording.
pub fn deg_c(minutes: f64) -> f64 {
    25.0 + 4.0 * (9.0 * minutes).sin()
}

/// model.toml for it, without a file of poses.
pub fn model() -> Tumble {
    let three = |s: &str| ["x", "y", "z"].map(|a| format!("{s}{a}"));
    Tumble {
        force_rate: false,
        topic: None,
        rate_hz: Some(50.0),
        rows: Vec::new(),
        gravity_m_s2: 9.81,
        poses: None,
        columns: TumbleColumns {
            time: None,
            gyro: Some(three("g")),
            accelerometer: three("a"),
            environment: Vec::new(),
        },
        split: Split::default(),
    }
}
