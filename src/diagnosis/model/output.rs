//! Quantity of a mass that a reading is in proportion to.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

/// Quantity of the mass that a reading is in proportion to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Output {
    /// Its displacement.
    #[default]
    Displacement,
    /// Its velocity, as of a wire in a magnetic field or under a laser vibrometer.
    Velocity,
    /// Its acceleration, as of a beam with an accelerometer on it.
    Acceleration,
}

impl Output {
    /// Returns the number of derivatives by time from displacement to the reading.
    pub fn derivatives(self) -> i32 {
        match self {
            Self::Displacement => 0,
            Self::Velocity => 1,
            Self::Acceleration => 2,
        }
    }
}
