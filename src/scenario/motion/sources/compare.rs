//! `[trajectory.compare]` as it is written: the recorded IMU that belongs to a file of poses.

use std::path::{Path, PathBuf};

use serde::Deserialize;

/// `[trajectory.compare]` as written.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compare {
    /// The IMU's log, relative to the study.
    pub imu: PathBuf,
    /// Lengths of the windows that are dead-reckoned, s.
    pub windows_s: Vec<f64>,
    /// Source of the biases that are subtracted; from other windows where it is left out.
    pub bias: Option<Bias>,
    /// Length of the still stretch that `bias = "still"` takes, s.
    pub still_s: Option<f64>,
    /// Other flights of the same sensor, each its IMU's log and its reference: their windows give
    /// the biases that `bias = "others"` subtracts.
    pub files: Option<Vec<[PathBuf; 2]>>,
    /// Other flights, each its IMU's log and its reference, that the inflation is fitted on; left
    /// out, it is fitted on the windows that it is then judged by. The attitude error of the
    /// reference is this flight's either way; next to other flights it is of windows that do not
    /// overlap the one that is judged, where there are enough of them.
    pub fit: Option<Vec<[PathBuf; 2]>>,
    /// Further sensors shown next to the stated one: files with `[accelerometer]` and `[gyro]`,
    /// such as a repaired.toml.
    pub sensors: Option<Vec<PathBuf>>,
}

/// Source of the biases that are subtracted.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Bias {
    /// The quietest stretch of the recording in which the reference stands still.
    Still,
    /// The median over windows that share no reading with the one they are subtracted in.
    #[default]
    Others,
}

impl Compare {
    /// The same, with its files found from the folder of the study that names them.
    pub fn in_folder(mut self, folder: &Path) -> Self {
        let flights = [&mut self.files, &mut self.fit].into_iter().flatten().flatten().flatten();
        let sensors = self.sensors.iter_mut().flatten();
        for file in std::iter::once(&mut self.imu).chain(flights).chain(sensors) {
            *file = folder.join(&*file);
        }
        self
    }

    /// Every file that it names.
    pub fn reads(&self) -> impl Iterator<Item = &Path> {
        let flights = [&self.files, &self.fit].into_iter().flatten().flatten().flatten();
        let sensors = self.sensors.iter().flatten();
        std::iter::once(&self.imu).chain(flights).chain(sensors).map(PathBuf::as_path)
    }
}
