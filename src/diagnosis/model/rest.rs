//! model.toml with kind = "static": a sensor at rest.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

use super::split::{Ranges, Split};

/// model.toml with kind = "static".
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Static {
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
    /// Unit of the channels, for words and plots.
    #[serde(default)]
    pub unit: String,
    /// Geodetic latitude of the place: gravity and the Earth's rate there stand next to the means.
    pub latitude_deg: Option<f64>,
    /// Height above the ellipsoid.
    pub height_m: Option<f64>,
    /// Headings of channels and environment columns.
    pub columns: StaticColumns,
    /// Holds what the datasheet promises; absent, white noise whose level is estimated.
    pub noise: Option<Noise>,
    /// Samples for fitting and for validation.
    #[serde(default)]
    pub split: Split,
}

/// Columns of a static recording.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct StaticColumns {
    /// Stamps, in the unit of the heading; absent where `rate_hz` is given.
    pub time: Option<String>,
    /// Readings, judged one by one, in `unit`.
    pub channels: Vec<String>,
    /// Temperature and the like.
    #[serde(default)]
    pub environment: Vec<String>,
}

/// Noise as a datasheet states it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// White noise, one-sided density, unit/√Hz.
    pub density: f64,
    /// Bias instability B, unit (IEEE 952).
    #[serde(default)]
    pub bias_instability: f64,
    /// Random walk K, unit/√s (IEEE 952).
    #[serde(default)]
    pub random_walk: f64,
}
