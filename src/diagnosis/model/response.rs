//! model.toml with kind = "response": stepped-sine sweeps of a resonator.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

use super::output::Output;
use super::split::Ranges;

/// model.toml with kind = "response".
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Response {
    /// Topic, message or array, where the recording has several.
    pub topic: Option<String>,
    /// Data rows used, counted from zero after the header; absent means all. One range.
    #[serde(default)]
    pub rows: Ranges,
    /// Unit of the reading, where its heading does not state it.
    pub unit: Option<String>,
    /// Quantity of the resonator that is read.
    #[serde(default)]
    pub output_is: Output,
    /// Numbers by which thermomechanical noise is said next to the residual.
    pub thermal: Option<Thermal>,
    /// Headings: frequency, and `x` and `y` or `amplitude` and `phase`.
    pub columns: ResponseColumns,
}

/// Numbers of the resonator and of the lock-in that its thermomechanical noise follows from.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Thermal {
    /// Effective mass of the resonance, kg.
    pub mass_kg: f64,
    /// Temperature of the resonator, K.
    pub temperature_k: f64,
    /// Metres in one unit of the reading; m/s or m/s² where `output_is` says so.
    pub si_per_unit: f64,
    /// Noise-equivalent bandwidth of the lock-in's filter, Hz.
    pub bandwidth_hz: Option<f64>,
}

/// Columns of a stepped-sine recording, one row a step, in the order taken.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ResponseColumns {
    /// Frequency of the drive; Hz unless the heading says another unit.
    pub frequency: String,
    /// Component in phase with the reference.
    pub x: Option<String>,
    /// Component in quadrature.
    pub y: Option<String>,
    /// Amplitude, in place of `x` and `y`.
    pub amplitude: Option<String>,
    /// Phase; ° or rad by the heading.
    pub phase: Option<String>,
    /// Amplitude of the drive; absent: the same for all rows.
    pub drive: Option<String>,
    /// Time of each step, s; a drift of the resonance is tried with it alone.
    pub time: Option<String>,
}

impl ResponseColumns {
    /// All that are named.
    pub fn all(&self) -> impl Iterator<Item = &String> {
        let optional = [&self.x, &self.y, &self.amplitude, &self.phase, &self.drive, &self.time];
        std::iter::once(&self.frequency).chain(optional.into_iter().flatten())
    }
}
