//! model.toml with kind = "driven": input and output of one proof mass.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

use super::output::Output;
use super::split::{Ranges, Split};
use crate::gate::Gate;

/// model.toml with kind = "driven".
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Driven {
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
    /// Unit of the output, for words, plots and numbers; absent, what its heading ends in.
    pub unit: Option<String>,
    /// Quantity of the mass that is read.
    #[serde(default)]
    pub output_is: Output,
    /// Headings of input, output and environment columns.
    pub columns: DrivenColumns,
    /// Hints, which may be off by a factor of two.
    #[serde(default)]
    pub start: Start,
    /// Samples for fitting and for validation.
    #[serde(default)]
    pub split: Split,
    /// Rules that never act; no key of the file.
    #[serde(skip)]
    pub without: Vec<Gate>,
}

/// Columns of a driven recording.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DrivenColumns {
    /// Stamps, in the unit of the heading; absent where `rate_hz` is given.
    pub time: Option<String>,
    /// Force; absent for a free ring-down.
    pub input: Option<String>,
    /// Reading of the sensor, in its own unit.
    pub output: String,
    /// Recorded surroundings (temperature …) that a candidate may depend on.
    #[serde(default)]
    pub environment: Vec<String>,
}

/// Hints for the base model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Resonance ω₀/2π, Hz: a place to begin, not a bound.
    pub resonance_hz: Option<f64>,
    /// Damping ratio ζ, 1: a place to begin.
    pub damping_ratio: Option<f64>,
}
