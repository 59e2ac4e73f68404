//! study.toml as it is written: its sections and the keys of those that hold more than numbers.
//! What the values mean together is checked in `check`.

use std::path::PathBuf;

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

use super::section::{self, Numbers, Section};
use super::tolerances::Tolerances;
use crate::excitation;
use crate::motion;
use crate::sensor::Sense;
use crate::units::{DEGREE, MILLI_G};

/// study.toml as written.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct File {
    /// Name of the report's folder.
    pub name: Option<String>,
    /// Seed of every random number.
    pub seed: Option<u64>,
    /// Number of sensors in the ensemble.
    pub members: Option<u64>,
    /// Length of the run, s.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub duration_s: Option<f64>,
    /// Integration step, s.
    pub step_s: Option<f64>,
    /// Mechanics, sampling and range.
    #[serde(default, deserialize_with = "section::sensor")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "section::schema_of_sensor"))]
    pub sensor: section::Sensor,
    /// The accelerometer's reading errors.
    #[serde(default, deserialize_with = "section::accelerometer")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "section::schema_of_accelerometer"))]
    pub accelerometer: Option<Numbers>,
    /// The gyro's reading errors.
    #[serde(default, deserialize_with = "section::gyro")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "section::schema_of_gyro"))]
    pub gyro: Option<Numbers>,
    /// Excitation of the sensor.
    #[serde(default, deserialize_with = "excitation::section")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "excitation::schema"))]
    pub excitation: excitation::section::Section,
    /// Times at which the errors are tabulated.
    #[serde(default)]
    pub report: Report,
    /// Alignment of the navigator at the start.
    pub alignment: Option<Alignment>,
    /// A static log to compare with the simulation.
    pub compare: Option<Compare>,
    /// Keys that take several values, one after the other: see `sweep`.
    #[cfg_attr(feature = "schema", schemars(with = "Option<serde_json::Map<String, serde_json::Value>>"))]
    pub sweep: Option<toml::Table>,
    /// Trajectory of the body that carries the sensor (six axes).
    pub trajectory: Option<motion::Section>,
    /// Navigation algorithm whose own error is a row of the error budget.
    pub navigator: Option<Navigator>,
    /// The Earth under the trajectory.
    pub earth: Option<Earth>,
    /// Measurements that aid the navigation along the trajectory.
    pub aiding: Option<Aiding>,
    /// Temperature of the sensor during the run.
    pub temperature: Option<Temperature>,
    /// Mounting of the sensor in the moving body.
    pub mounting: Option<Mounting>,
    /// Vibration of the sensor in addition to the motion.
    pub vibration: Option<Vibration>,
}

/// `[mounting]`: where and how the sensor sits in the body.
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mounting {
    /// From the body's origin to the sensor, in body axes.
    pub lever_arm_m: Option<[f64; 3]>,
    /// Roll, pitch and yaw of the sensor's axes against the body's.
    pub rotation_deg: Option<[f64; 3]>,
}

/// `[vibration]`: along each axis of the sensor a power spectral density, pairs of frequency and
/// g²/Hz.
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vibration {
    /// Along x: pairs of frequency, Hz, and density, g²/Hz.
    pub x_g2_hz: Option<Vec<[f64; 2]>>,
    /// Along y: pairs of frequency, Hz, and density, g²/Hz.
    pub y_g2_hz: Option<Vec<[f64; 2]>>,
    /// Along z: pairs of frequency, Hz, and density, g²/Hz.
    pub z_g2_hz: Option<Vec<[f64; 2]>>,
}

/// `[aiding]`: measurements that aid the navigator during the run.
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aiding {
    /// Use of a measurement by the navigator (default: filter).
    pub method: Option<AidingMethod>,
    /// Position and velocity from satellites.
    pub gnss: Option<Gnss>,
    /// Zero-velocity updates while the body stands still.
    pub zupt: Option<Zupt>,
}

/// `[aiding.gnss]`: satellite fixes of position, velocity or both.
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gnss {
    /// Time between fixes, s (default: 1).
    pub every_s: Option<f64>,
    /// Standard deviation of a position fix: north, east, down; absent: no position.
    pub position_sd_m: Option<[f64; 3]>,
    /// Standard deviation of a velocity fix: north, east, down; absent: no velocity.
    pub velocity_sd_m_s: Option<[f64; 3]>,
    /// Times without fixes: pairs of begin and end, s.
    pub outages_s: Option<Vec<[f64; 2]>>,
}

/// `[aiding.zupt]`: zero-velocity updates.
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Zupt {
    /// Time between updates while the body stands still, s (default: 1).
    pub every_s: Option<f64>,
    /// Standard deviation of the velocity that is taken for zero (default: 0.01).
    pub velocity_sd_m_s: Option<f64>,
}

/// Use of a measurement by a navigator.
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AidingMethod {
    /// A Kalman filter of fifteen errors (attitude, velocity, position, biases of both
    /// instruments), loosely coupled.
    #[default]
    Filter,
    /// Velocity and position are set to what is measured; attitude and biases are left as they are.
    Reset,
}

/// `[temperature]`: the sensor's temperature over time.
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Temperature {
    /// Pairs of time, s, and temperature, °C, with straight lines between; during a still start the
    /// first one holds.
    pub profile_s_deg_c: Vec<[f64; 2]>,
    /// Temperature at which the stated biases and scale factors hold, °C; absent: the first of the
    /// profile.
    pub reference_deg_c: Option<f64>,
    /// Time constant, s, of the first-order lag with which the sensor follows the profile, from its
    /// first point on; absent: it follows at once.
    pub lag_s: Option<f64>,
}

/// `[navigator]`: how the readings are integrated.
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Navigator {
    /// Treatment of motion within a sample.
    pub integrator: Option<motion::Integrator>,
}

/// `[earth]`: place, gravity and rotation.
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Earth {
    /// Geodetic latitude of the start; absent, the Earth is flat and still.
    pub latitude_deg: Option<f64>,
    /// Height of the start over the ellipsoid.
    pub height_m: Option<f64>,
    /// Says whether the Earth rotates (default: true).
    pub rotation: Option<bool>,
    /// Says whether the vertical channel runs free or is held by an aid.
    pub vertical: Option<VerticalKind>,
}

/// Ways to keep height.
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VerticalKind {
    /// Height from the inertial sensors alone.
    Free,
    /// Held by an ideal height aid.
    Held,
}

/// `[report]`: the report times.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// Report times, s; absent: four, log-spaced up to the end.
    pub times_s: Option<Vec<f64>>,
}

/// `[alignment]`: what is known at the start.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Alignment {
    /// Kind of alignment; absent: ideal.
    pub kind: Option<AlignmentKind>,
    /// Length of a still start.
    pub still_s: Option<f64>,
    /// Standard deviation of a drawn tilt; in six axes about north and about east, °.
    pub tilt_sd_deg: Option<f64>,
    /// Six axes: spread of the heading, drawn or after a still start, °.
    pub heading_sd_deg: Option<f64>,
}

/// Ways to align at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum AlignmentKind {
    /// Level, with the biases that the study gives.
    Ideal,
    /// Tilt error, and in six axes heading error, drawn per member.
    Drawn,
    /// Bias and levelling from the mean of the first seconds, during which the sensor is at rest.
    Still,
}

/// `[compare]`: a static log of the sensor that the study describes.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Compare {
    /// The log, relative to the study.
    pub file: PathBuf,
    /// Topic, message or array, if the log has several; its own clock is used.
    pub topic: Option<String>,
    /// Sampling rate of the log, Hz.
    pub rate_hz: Option<f64>,
    /// Use that rate against the log's own clock, where the two contradict each other.
    #[serde(default)]
    pub force_rate: bool,
    /// Heading of its time column, s. Where both are given, they must agree.
    pub time: Option<String>,
    /// Lengths of the windows into which the log is cut, s, each after its own still start; absent:
    /// only Allan deviations are compared. With a `[temperature]`, each window is simulated from
    /// the start of the profile.
    pub windows_s: Option<Vec<f64>>,
    /// Axes, one per column of the log.
    pub axis: Vec<Axis>,
}

/// `[[compare.axis]]`: one column, and the errors of this axis of the sensor.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// Heading in the file.
    pub column: String,
    /// Value of one unit of an accelerometer column, mg; without a scale, the unit that the log
    /// states holds.
    pub scale_mg: Option<f64>,
    /// Value of one unit of a gyro column, °/s.
    pub scale_deg_s: Option<f64>,
    /// Replaces the study's `[accelerometer]` for this axis.
    #[serde(default, deserialize_with = "section::accelerometer")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "section::schema_of_accelerometer"))]
    pub accelerometer: Option<Numbers>,
    /// Replaces the study's `[gyro]` for this axis.
    #[serde(default, deserialize_with = "section::gyro")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "section::schema_of_gyro"))]
    pub gyro: Option<Numbers>,
}

impl Axis {
    /// The study's numbers, with this axis's own in their place.
    pub fn over(&self, study: &Tolerances) -> Tolerances {
        let mut all = study.clone();
        for (section, numbers) in [(Section::Accelerometer, &self.accelerometer), (Section::Gyro, &self.gyro)] {
            numbers.iter().for_each(|numbers| numbers.replace(section, 0, &mut all));
        }
        all
    }

    /// Returns what one unit of the column measures, in SI units.
    pub fn unit(&self) -> (Sense, f64) {
        match (self.scale_mg, self.scale_deg_s) {
            (Some(scale), _) => (Sense::Accelerometer, scale * MILLI_G),
            (None, scale) => (Sense::Gyro, scale.unwrap_or(1.0) * DEGREE),
        }
    }
}
