//! study.toml as it is written: every key, its unit in its name. What the values mean together is checked in `check`.

use std::path::PathBuf;

use serde::Deserialize;

use super::number::Number;

/// The whole file.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct File {
    /// Name of the report's folder.
    pub name: Option<String>,
    /// Seed of every random number.
    pub seed: Option<u64>,
    /// Sensors in the ensemble.
    pub members: Option<u64>,
    /// Length of the run.
    pub duration_s: Option<f64>,
    /// Integration step.
    pub step_s: Option<f64>,
    /// Mechanics, sampling and range.
    #[serde(default)]
    pub sensor: Sensor,
    /// The accelerometer's reading errors.
    #[serde(default)]
    pub accelerometer: Accelerometer,
    /// The gyro's errors.
    #[serde(default)]
    pub gyro: Gyro,
    /// What the sensor is subjected to.
    #[serde(default)]
    pub excitation: Excitation,
    /// When to look.
    #[serde(default)]
    pub report: Report,
    /// A static log to lay beside the simulation.
    pub compare: Option<Compare>,
}

/// `[sensor]`
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs, reason = "the keys say it; units stand in study::parameter")]
pub struct Sensor {
    pub sample_rate_hz: Option<f64>,
    pub range_g: Option<Number>,
    pub resonance_hz: Option<Number>,
    pub damping_ratio: Option<Number>,
    pub cubic_stiffness_per_m2_s2: Option<Number>,
    pub quadratic_stiffness_per_m_s2: Option<Number>,
    pub quadratic_damping_per_m: Option<Number>,
    pub squeeze_film_per_m2_s: Option<Number>,
    pub coulomb_friction_m_s2: Option<Number>,
    pub force_noise_density_ug_rthz: Option<Number>,
    pub mass_kg: Option<Number>,
    pub damping_n_s_m: Option<Number>,
    pub stiffness_n_m: Option<Number>,
    pub cubic_stiffness_n_m3: Option<Number>,
}

/// `[accelerometer]`
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs, reason = "the keys say it; units stand in study::parameter")]
pub struct Accelerometer {
    pub bias_mg: Option<Number>,
    pub scale_factor_ppm: Option<Number>,
    pub k2_ug_per_g2: Option<Number>,
    pub noise_density_ug_rthz: Option<Number>,
    pub velocity_random_walk_m_s_rth: Option<Number>,
    pub bias_instability_ug: Option<Number>,
    pub acceleration_random_walk_ug_rts: Option<Number>,
    pub quantisation_mg: Option<Number>,
}

/// `[gyro]`
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs, reason = "the keys say it; units stand in study::parameter")]
pub struct Gyro {
    pub bias_deg_h: Option<Number>,
    pub noise_density_deg_s_rthz: Option<Number>,
    pub angle_random_walk_deg_rth: Option<Number>,
    pub bias_instability_deg_h: Option<Number>,
    pub rate_random_walk_deg_h_rth: Option<Number>,
}

/// `[excitation]`: `kind` says which of the other keys belong.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs, reason = "the keys say it; each kind's file in `excitation` says the rest")]
pub struct Excitation {
    pub kind: Option<Kind>,
    pub amplitude_m_s2: Option<Number>,
    pub frequency_hz: Option<Number>,
    pub phase_rad: Option<Number>,
    pub start_s: Option<Number>,
    pub length_s: Option<Number>,
    pub from_hz: Option<Number>,
    pub to_hz: Option<Number>,
    pub rms_m_s2: Option<Number>,
    pub lines: Option<u32>,
    pub psd_g2_hz: Option<Vec<[f64; 2]>>,
    pub peak_g: Option<Number>,
    pub file: Option<PathBuf>,
    pub column: Option<String>,
    pub scale: Option<Number>,
    pub rate_hz: Option<f64>,
    pub time: Option<String>,
}

/// Shapes of excitation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs, reason = "one file each in `excitation`")]
pub enum Kind {
    #[default]
    Rest,
    Rectangle,
    Sine,
    Sweep,
    Multisine,
    Random,
    Shock,
    Replay,
}

/// `[report]`
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// Report times; absent: four, evenly spaced on a log axis up to the end.
    pub times_s: Option<Vec<f64>>,
}

/// `[compare]`: a static log of the sensor that the study describes.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compare {
    /// CSV, relative to the study.
    pub file: PathBuf,
    /// Sampling rate of the log.
    pub rate_hz: f64,
    /// One per column of the log.
    pub axis: Vec<Axis>,
}

/// `[[compare.axis]]`: one column, and what is special about this axis of the sensor.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// Heading in the file.
    pub column: String,
    /// An accelerometer's axis: what one unit of the column is worth.
    pub scale_mg: Option<f64>,
    /// A gyro's axis: what one unit of the column is worth.
    pub scale_deg_s: Option<f64>,
    /// Takes the place of the study's `[accelerometer]` for this axis.
    pub accelerometer: Option<Accelerometer>,
    /// Takes the place of the study's `[gyro]` for this axis.
    pub gyro: Option<Gyro>,
}
