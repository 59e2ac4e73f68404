//! model.toml with kind = "trajectory": an IMU in motion, next to a reference of that motion.

use std::path::{Path, PathBuf};

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

use super::rest::Noise;
use super::split::Ranges;
use crate::motion::file::format::{Format, Order, Up};

/// model.toml with kind = "trajectory".
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Trajectory {
    /// Topic, message or array, where the recording has several.
    pub topic: Option<String>,
    /// Sampling rate, or `columns.time`.
    pub rate_hz: Option<f64>,
    /// Use that rate against the recording's own clock, where the two contradict each other.
    #[serde(default)]
    pub force_rate: bool,
    /// Data rows used, counted from zero after the header; absent means all. One range.
    #[serde(default)]
    pub rows: Ranges,
    /// Geodetic latitude of the place, for gravity and the Earth's rate; absent: standard gravity.
    pub latitude_deg: Option<f64>,
    /// Height above the ellipsoid.
    pub height_m: Option<f64>,
    /// Columns by role; left out where the headings say it.
    #[serde(default)]
    pub columns: TrajectoryColumns,
    /// The reference of the motion; absent: only what the readings show by themselves.
    pub reference: Option<Reference>,
    /// Noise that the datasheet promises.
    #[serde(default)]
    pub noise: InertialNoise,
}

/// Columns of an IMU in motion.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TrajectoryColumns {
    /// Stamps, in the unit of the heading.
    pub time: Option<String>,
    /// Three rates, rad/s unless the heading says another unit.
    pub gyro: Option<[String; 3]>,
    /// Three specific forces, m/s² unless the heading says another unit.
    pub accelerometer: Option<[String; 3]>,
}

impl TrajectoryColumns {
    /// The six columns, where they are named.
    pub fn readings(&self) -> impl Iterator<Item = &String> {
        self.gyro.iter().flatten().chain(self.accelerometer.iter().flatten())
    }
}

/// The reference motion and how its file is read.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// EuRoC, TUM, KITTI or a table with headings.
    pub file: PathBuf,
    /// Layout of the file, where it is not to be recognised.
    pub format: Option<Format>,
    /// The file of times next to one of poses (KITTI).
    pub times: Option<PathBuf>,
    /// The axis of the reference that points up.
    pub up: Option<Up>,
    /// The order of its quaternions, to insist on it.
    pub quaternion: Option<Order>,
    /// The half of each pose that is used, where the file has both and one is not to be trusted.
    #[serde(rename = "use")]
    pub only: Option<Half>,
}

/// A half of each pose that a reference can be used for alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Half {
    /// States how the body is turned.
    Attitude,
    /// States where the body is.
    Position,
}

impl Reference {
    /// The same, with its files found from a folder.
    pub fn in_folder(&mut self, folder: &Path) {
        self.file = folder.join(&self.file);
        self.times = self.times.take().map(|times| folder.join(times));
    }
}

/// Noise of both sensors as a datasheet states it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct InertialNoise {
    /// Noise of the gyro, rad/s.
    pub gyro: Option<Noise>,
    /// Noise of the accelerometer, m/s².
    pub accelerometer: Option<Noise>,
}
