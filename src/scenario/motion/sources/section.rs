//! `[trajectory]` as it is written.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::compare::Compare;
use crate::motion::file::format::{Format, Order, Up};

/// The kinds, by name.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// At rest.
    Rest,
    /// A level circle.
    Circle,
    /// Two level loops.
    FigureEight,
    /// A curve through points.
    Waypoints,
    /// A drive with stops and turns.
    Car,
    /// A random flight.
    Drone,
    /// Recorded poses.
    File,
}

/// The section as it is written.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Kind of trajectory.
    pub kind: Kind,
    /// Heading of a body at rest, °.
    pub heading_deg: Option<f64>,
    /// Radius of the circle or of each loop, m.
    pub radius_m: Option<f64>,
    /// Speed over ground, m/s.
    pub speed_m_s: Option<f64>,
    /// Initial time at rest, s.
    pub still_s: Option<f64>,
    /// Points to go through, north, east and down, m.
    pub points_m: Option<Vec<[f64; 3]>>,
    /// Mean acceleration from and to standstill, m/s².
    pub acceleration_m_s2: Option<f64>,
    /// Size of the space that a drone flies in, m.
    pub extent_m: Option<f64>,
    /// Seed of a random drive or flight.
    pub seed: Option<u64>,
    /// Recorded poses, relative to the study.
    pub file: Option<PathBuf>,
    /// Format of the file; absent: recognised from its content.
    pub format: Option<Format>,
    /// Start in the file, s after its first pose.
    pub from_s: Option<f64>,
    /// File of times that belongs to a file of poses.
    pub times: Option<PathBuf>,
    /// The axis of the file's reference that points up.
    pub up: Option<Up>,
    /// Order of the file's quaternions; absent: recognised.
    pub quaternion: Option<Order>,
    /// The recorded IMU that belongs to the file of poses.
    pub compare: Option<Compare>,
}

impl Section {
    /// The same, with its files found from the folder of the study that names them.
    pub fn in_folder(mut self, folder: &Path) -> Self {
        for file in [&mut self.file, &mut self.times].into_iter().flatten() {
            *file = folder.join(&*file);
        }
        self.compare = self.compare.map(|compare| compare.in_folder(folder));
        self
    }

    /// The keys that were given, but `kind`.
    pub fn given(&self) -> Vec<&'static str> {
        let keys = [
            ("heading_deg", self.heading_deg.is_some()),
            ("radius_m", self.radius_m.is_some()),
            ("speed_m_s", self.speed_m_s.is_some()),
            ("still_s", self.still_s.is_some()),
            ("points_m", self.points_m.is_some()),
            ("acceleration_m_s2", self.acceleration_m_s2.is_some()),
            ("extent_m", self.extent_m.is_some()),
            ("seed", self.seed.is_some()),
            ("file", self.file.is_some()),
            ("format", self.format.is_some()),
            ("from_s", self.from_s.is_some()),
            ("times", self.times.is_some()),
            ("up", self.up.is_some()),
            ("quaternion", self.quaternion.is_some()),
            ("compare", self.compare.is_some()),
        ];
        keys.iter().filter(|(_, given)| *given).map(|(key, _)| *key).collect()
    }
}
