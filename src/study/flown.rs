//! `[trajectory.compare]` checked: the recorded flight that a study in motion is laid next to, and
//! the sensors next to its own.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use super::check;
use super::file::File;
use super::refusal::refuse;
use super::tolerances::Tolerances;
use crate::document::{parse_toml, read_text};
use crate::error::Result;
use crate::motion::sources::{Bias, Compare};
use crate::motion::{Section, sources};

/// Most window lengths.
const MOST_WINDOWS: usize = 16;

/// A recorded flight, as the study asks for it.
#[derive(Debug, Clone)]
pub struct Flown {
    /// Path of the recorded IMU's log.
    pub imu: PathBuf,
    /// The poses next to it.
    pub reference: Section,
    /// Vector from the body's origin to the sensor, m.
    pub lever_arm_m: Vector3<f64>,
    /// Lengths of the windows, s, increasing.
    pub windows_s: Vec<f64>,
    /// Source of the biases that are subtracted.
    pub bias: Bias,
    /// Length of the still stretch, s; 0 where none is used.
    pub still_s: f64,
    /// Other flights whose windows give the biases: IMU and reference.
    pub others: Vec<[PathBuf; 2]>,
    /// Other flights that the inflation is fitted on: IMU and reference.
    pub fit: Vec<[PathBuf; 2]>,
    /// Sensors next to the study's own, by the name of their file: the numbers of each axis.
    pub sensors: Vec<(String, [Tolerances; 3])>,
}

/// Reads what a file says, checked; `None` where nothing is asked for.
///
/// # Errors
/// Lengths that make no sense, keys that belong to another kind of bias, sensors that cannot be
/// read.
pub(super) fn read(name: &str, file: &File, lever_arm_m: Vector3<f64>) -> Result<Option<Flown>> {
    let Some((reference, asked)) = file.trajectory.as_ref().and_then(|t| t.compare.as_ref().map(|c| (t, c))) else {
        return Ok(None);
    };
    if reference.kind != sources::Kind::File {
        return Err(refuse(
            name,
            "`trajectory.compare` needs a recorded reference",
            "give [trajectory] kind = \"file\", with the poses that were recorded next to the IMU",
        ));
    }
    windows(name, asked)?;
    let bias = asked.bias.unwrap_or_default();
    let still_s = match (bias, asked.still_s) {
        (Bias::Others, None) => 0.0,
        (Bias::Others, Some(_)) => {
            return Err(refuse(
                name,
                "`trajectory.compare.still_s` belongs to bias = \"still\"",
                "take it out, or set bias = \"still\"",
            ));
        }
        (Bias::Still, Some(still_s)) if still_s > 0.0 && still_s.is_finite() => still_s,
        (Bias::Still, given) => {
            let cause = match given {
                Some(still_s) => format!("`trajectory.compare.still_s` = {still_s:?} s: need more than zero"),
                None => "`trajectory.compare.still_s` is missing: bias = \"still\" needs its length".into(),
            };
            return Err(refuse(name, cause, "e.g. still_s = 5.0"));
        }
    };
    if bias == Bias::Still && asked.files.is_some() {
        return Err(refuse(
            name,
            "`trajectory.compare.files` belongs to bias = \"others\"",
            "take it out, or set bias = \"others\"",
        ));
    }
    let sensors = asked.sensors.iter().flatten().map(|path| sensor(path)).collect::<Result<Vec<_>>>()?;
    Ok(Some(Flown {
        imu: asked.imu.clone(),
        reference: Section { compare: None, ..reference.clone() },
        lever_arm_m,
        windows_s: asked.windows_s.clone(),
        bias,
        still_s,
        others: asked.files.clone().unwrap_or_default(),
        fit: asked.fit.clone().unwrap_or_default(),
        sensors,
    }))
}

fn windows(name: &str, asked: &Compare) -> Result<()> {
    let (windows_s, key) = (&asked.windows_s, "trajectory.compare.windows_s");
    let example = "e.g. windows_s = [10.0, 30.0, 60.0]";
    if windows_s.is_empty() || windows_s.len() > MOST_WINDOWS {
        let cause = format!("`{key}` has {} lengths: need 1 to {MOST_WINDOWS}", windows_s.len());
        return Err(refuse(name, cause, example));
    }
    if let Some(wrong) = windows_s.iter().find(|w| !(**w > 0.0 && w.is_finite())) {
        return Err(refuse(name, format!("`{key}` holds {wrong:?} s: need more than zero"), example));
    }
    if windows_s.windows(2).any(|w| w[0] >= w[1]) {
        return Err(refuse(name, format!("`{key}` does not increase"), "sort the lengths and drop repeated ones"));
    }
    Ok(())
}

/// The numbers of a sensor that stands in a file of its own.
fn sensor(path: &Path) -> Result<(String, [Tolerances; 3])> {
    let shown = path.display().to_string();
    let file: File = parse_toml(&shown, &read_text(path)?)?;
    if file.accelerometer.is_none() && file.gyro.is_none() {
        return Err(refuse(
            &shown,
            "it has neither an [accelerometer] nor a [gyro]",
            "name a sensor.toml, a study.toml or a repaired.toml of an IMU",
        ));
    }
    let axes: Vec<Tolerances> = (0..3).map(|axis| check::tolerances(&shown, &file, axis)).collect::<Result<_>>()?;
    let name = path.file_name().map_or(shown.clone(), |name| name.to_string_lossy().into_owned());
    Ok((name, axes.try_into().unwrap_or_default()))
}

impl Flown {
    /// The same as another flight of the sensor: no files of poses but its own.
    pub fn reference_of(&self, reference: &Path) -> Section {
        Section { file: Some(reference.to_path_buf()), from_s: None, times: None, ..self.reference.clone() }
    }
}
