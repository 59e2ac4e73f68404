//! model.toml with kind = "tumble": an IMU in many still poses.

use std::path::PathBuf;

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

use super::split::{Ranges, Split};

/// model.toml with kind = "tumble".
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Tumble {
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
    /// |g| where it was recorded.
    pub gravity_m_s2: f64,
    /// CSV of start_row,end_row_exclusive; absent: found by the tool.
    pub poses: Option<PathBuf>,
    /// Headings of gyro, accelerometer and environment columns.
    pub columns: TumbleColumns,
    /// Rows for fitting and for validation.
    #[serde(default)]
    pub split: Split,
}

/// Columns of a tumble recording.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TumbleColumns {
    /// Stamps, in the unit of the heading; absent where `rate_hz` is given.
    pub time: Option<String>,
    /// Three rates; absent: the accelerometer alone.
    pub gyro: Option<[String; 3]>,
    /// Specific force along x, y, z, in counts.
    pub accelerometer: [String; 3],
    /// Temperature and the like.
    #[serde(default)]
    pub environment: Vec<String>,
}
