//! The sensor as diagnosed, as a study along the reference that it was diagnosed next to.
//!
//! A number that was fitted is drawn about its value with its standard error. A study has one
//! number for each axis of the gyro's misalignment and g-sensitivity, drawn for each element of
//! that row: mean and spread over the elements that were found.

use std::fmt::Write as _;
use std::path::{Path, PathBuf, absolute};

use nalgebra::UnitQuaternion;

use crate::by_axis::{Drawn, drawn, line, number, over, three};
use crate::document::toml_string;
use crate::model::{Half, Reference};
use crate::motion::file::format::{Format, Order};
use crate::repair::{name, preamble, round_rate};
use crate::sensor::{SensorTerm, coupling};
use crate::units::key::Key;
use crate::units::{DEGREE, DENSITY_TO_RANDOM_WALK};
use crate::verdict::Verdict;

/// Longest study, s.
const LONGEST_S: f64 = 60.0;
/// Times that drift is reported for, s.
const REPORTED_S: [f64; 3] = [1.0, 10.0, 60.0];
/// Turns and arms below which none is written, rad and m.
const NOTHING: f64 = 1e-9;
/// Largest offset of the clocks that a study states, s: it moves its readings by the first order of
/// the offset, which holds while the motion is even.
const LATEST_S: f64 = 0.02;

/// States where the study goes: a stretch of the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Along {
    /// The file, and how it is read.
    pub reference: Reference,
    /// The half of a pose that it has not; the study stands still where it lacks one.
    pub lacks: Option<Half>,
    /// First and last pose that was used, s after the file's first.
    pub ends_s: [f64; 2],
    /// Latitude, °, and height, m, where they are stated.
    pub place: Option<(f64, f64)>,
    /// States whether the Earth's rotation was named.
    pub earth_turns: bool,
}

/// A sensor on a body that moves. What was not named is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// States where the study goes.
    pub along: Along,
    /// Biases of the gyro, rad/s.
    pub gyro_bias: [Drawn; 3],
    /// Biases of the accelerometer, m/s².
    pub force_bias: [Drawn; 3],
    /// Scale-factor errors of the accelerometer, 1.
    pub force_scale: [Drawn; 3],
    /// Misalignment of its y and z axes, the elements below the diagonal, rad.
    pub force_misalignment: [Vec<f64>; 2],
    /// Scale-factor errors of the gyro, 1.
    pub gyro_scale: [Drawn; 3],
    /// Misalignment of the gyro by rows, the element on the diagonal left out, rad.
    pub gyro_misalignment: [[f64; 2]; 3],
    /// Sensitivity of the gyro to specific force by rows, (rad/s)/(m/s²).
    pub g_sensitivity: [[f64; 3]; 3],
    /// By how much its stamps are late in the middle of the recording, s.
    pub time_offset: Drawn,
    /// Holds what its clock gains on the reference's, 1.
    pub clock_drift: Drawn,
    /// The middle of the recording, s after the reference's first pose.
    pub middle_s: f64,
    /// One-sided noise densities of gyro and accelerometer in motion, unit/√Hz.
    pub density: [f64; 2],
    /// Limits of the gyro's readings, rad/s, and of the accelerometer's, m/s², where they have any.
    pub range: [Option<f64>; 2],
    /// From the IMU's axes to the body's.
    pub mounting: UnitQuaternion<f64>,
    /// From the reference's origin to the accelerometer, body axes, m.
    pub lever_arm_m: [f64; 3],
    /// Named, and not expressible in a study.
    pub not_expressible: Vec<String>,
}

impl Repaired {
    /// Returns the sensor as a navigator flies it that subtracts what was calibrated: constants are
    /// zero, and those with an interval keep their standard error as the spread.
    pub(crate) fn corrected(&self) -> Self {
        let rest = |of: Drawn| Drawn { mean: 0.0, ..of };
        Self {
            gyro_bias: self.gyro_bias.map(rest),
            force_bias: self.force_bias.map(rest),
            force_scale: self.force_scale.map(rest),
            force_misalignment: [Vec::new(), Vec::new()],
            gyro_scale: self.gyro_scale.map(rest),
            gyro_misalignment: [[0.0; 2]; 3],
            g_sensitivity: [[0.0; 3]; 3],
            time_offset: rest(self.time_offset),
            clock_drift: rest(self.clock_drift),
            ..self.clone()
        }
    }

    /// Writes it as a study; `what` it is stands in the name.
    pub(crate) fn document(&self, verdict: &Verdict, what: &str) -> String {
        let [from_s, to_s] = self.along.ends_s;
        let from_s = (from_s * 100.0).ceil() / 100.0;
        let mut lacking = self.not_expressible.clone();
        if self.offset_at(from_s).mean.abs() > LATEST_S {
            lacking
                .push(format!("time-offset beyond {LATEST_S} s: a study moves its readings by the first order of it"));
        }
        let mut text = preamble(verdict, self.along.relation(), &lacking);
        let duration_s = if self.along.lacks.is_none() { (to_s - from_s).floor().min(LONGEST_S) } else { LONGEST_S };
        let _ = write!(
            text,
            "\nname = {}\nseed = 1\nmembers = 4096\nduration_s = {duration_s:?}\n",
            toml_string(&name(verdict, what))
        );
        text += &self.along.section(from_s);
        text += &self.sensor(round_rate(verdict.recording.rate_hz), from_s);
        let times_s: Vec<f64> = REPORTED_S.into_iter().filter(|t| *t <= duration_s).collect();
        let _ = write!(text, "\n[report]\ntimes_s = {times_s:?}\n");
        text
    }

    /// By how much its stamps are late where a study begins, which counts the drift from there.
    fn offset_at(&self, from_s: f64) -> Drawn {
        let since_s = from_s - self.middle_s;
        Drawn {
            mean: self.time_offset.mean + self.clock_drift.mean * since_s,
            sd: self.time_offset.sd.hypot(self.clock_drift.sd * since_s),
        }
    }

    fn sensor(&self, rate_hz: f64, from_s: f64) -> String {
        let mut text = format!("\n[sensor]\nsample_rate_hz = {rate_hz:?}\n");
        let row = |term: SensorTerm| term.row().keys;
        let one = |key: &Key, value: f64| if value == 0.0 { String::new() } else { line(key, &number(key, value)) };
        text += &self.range[1].map_or(String::new(), |limit| one(&row(SensorTerm::Range)[0], limit));
        let offset = self.offset_at(from_s);
        if offset != Drawn::default() && offset.mean.abs() <= LATEST_S {
            text += &line(&coupling::TIME_OFFSET, &drawn(&coupling::TIME_OFFSET, offset));
        }
        if self.clock_drift != Drawn::default() {
            text += &line(&coupling::CLOCK_DRIFT, &drawn(&coupling::CLOCK_DRIFT, self.clock_drift));
        }
        text += "\n[accelerometer]\n";
        text += &three(&row(SensorTerm::AccelerometerBias)[0], self.force_bias);
        text += &one(&row(SensorTerm::VelocityRandomWalk)[0], self.density[1] * DENSITY_TO_RANDOM_WALK);
        text += &three(&row(SensorTerm::ScaleFactor)[0], self.force_scale);
        let [y, z] = &self.force_misalignment;
        text += &three(&coupling::ACCELEROMETER_MISALIGNMENT, [Drawn::default(), over(y), over(z)]);
        text += "\n[gyro]\n";
        text += &three(&row(SensorTerm::GyroBias)[0], self.gyro_bias);
        text += &one(&row(SensorTerm::AngleRandomWalk)[0], self.density[0] * DENSITY_TO_RANDOM_WALK);
        text += &self.range[0].map_or(String::new(), |limit| one(&coupling::GYRO_RANGE, limit));
        text += &three(&coupling::GYRO_SCALE_FACTOR, self.gyro_scale);
        text += &three(&coupling::GYRO_MISALIGNMENT, self.gyro_misalignment.map(|row| over(&row)));
        text += &three(&coupling::G_SENSITIVITY, self.g_sensitivity.map(|row| over(&row)));
        let turned = self.mounting.angle() > NOTHING;
        let shifted = self.lever_arm_m.iter().any(|l| l.abs() > NOTHING);
        if turned || shifted {
            text += "\n[mounting]\n";
        }
        if shifted {
            let _ = writeln!(text, "lever_arm_m = {:?}", self.lever_arm_m);
        }
        if turned {
            let (roll, pitch, yaw) = self.mounting.euler_angles();
            let _ = writeln!(text, "rotation_deg = {:?}", [roll, pitch, yaw].map(|a| a / DEGREE));
        }
        text
    }
}

impl Along {
    fn relation(&self) -> &'static str {
        match self.lacks {
            None => {
                "The study goes along the reference of the recording. Numbers that were fitted are drawn about their \
                 values with their standard errors."
            }
            Some(Half::Position) => {
                "The reference has no positions, so the study stands still. Numbers that were fitted are drawn about \
                 their values with their standard errors."
            }
            Some(Half::Attitude) => {
                "The reference has no attitudes, so the study stands still. Numbers that were fitted are drawn about \
                 their values with their standard errors."
            }
        }
    }

    fn section(&self, from_s: f64) -> String {
        if self.lacks.is_some() {
            return "\n[trajectory]\nkind = \"rest\"\n".into();
        }
        // From wherever the study is run.
        let path = |file: &Path| {
            let file: PathBuf = absolute(file).unwrap_or_else(|_| file.to_path_buf());
            toml_string(&file.to_string_lossy())
        };
        let reference = &self.reference;
        let mut text =
            format!("\n[trajectory]\nkind = \"file\"\nfile = {}\nfrom_s = {from_s:?}\n", path(&reference.file));
        let mut key = |name: &str, value: Option<String>| {
            value.into_iter().for_each(|value| {
                let _ = writeln!(text, "{name} = {value}");
            });
        };
        key("format", reference.format.map(|format| toml_string(format_key(format))));
        key("times", reference.times.as_deref().map(path));
        key("up", reference.up.map(|up| toml_string(up.name())));
        key("quaternion", reference.quaternion.map(|order| toml_string(order_key(order))));
        if let Some((latitude_deg, height_m)) = self.place {
            let _ = write!(
                text,
                "\n[earth]\nlatitude_deg = {latitude_deg:?}\nheight_m = {height_m:?}\nrotation = {}\n",
                self.earth_turns
            );
        }
        text
    }
}

fn format_key(format: Format) -> &'static str {
    match format {
        Format::Euroc => "euroc",
        Format::Tum => "tum",
        Format::Kitti => "kitti",
        Format::Csv => "csv",
    }
}

fn order_key(order: Order) -> &'static str {
    match order {
        Order::ScalarFirst => "scalar-first",
        Order::ScalarLast => "scalar-last",
    }
}
