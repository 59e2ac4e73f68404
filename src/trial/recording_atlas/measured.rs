//! Numbers that `allan` and `study` give of a log at rest, as far as an atlas shows them.

use proofmass_report::table::Table;
use serde::Serialize;

/// Noise of a log at rest, and its drift.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Measured {
    /// Samples that were used, those that stand in for missing ones included.
    pub samples: usize,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// SHA-256 of what was read, hexadecimal.
    pub sha256: String,
    /// The tables of `proofmass allan`.
    #[serde(skip)]
    pub tables: Vec<Table>,
    /// Noise of each column.
    pub axes: Vec<Axis>,
    /// Drift in windows; empty where it was not asked for or the log is too short.
    pub drift: Vec<Drift>,
}

impl Measured {
    /// Returns the length of the log, s.
    pub fn length_s(&self) -> f64 {
        self.samples as f64 / self.rate_hz
    }
}

/// Quantity that a column measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Quantity {
    /// Angular rate.
    Gyro,
    /// Specific force.
    Accelerometer,
}

/// Noise of one column, in the units of datasheets.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// Heading of the column.
    pub name: String,
    /// Quantity that it measures.
    pub quantity: Quantity,
    /// Mean of its readings, in the unit of `flicker`.
    pub mean: f64,
    /// Lowest Allan deviation of at least ten degrees of freedom, in that unit.
    pub lowest: Option<f64>,
    /// Longest averaging time of the fit, s.
    pub longest_s: f64,
    /// B: flicker noise.
    pub flicker: Coefficient,
    /// K: random walk.
    pub walk: Coefficient,
    /// R: ramp.
    pub ramp: Coefficient,
    /// Random walk in the unit of `walk` for one of the file's units per √s.
    pub walk_per_file_unit: f64,
}

/// A coefficient of the Allan deviation with its 95 % interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coefficient {
    /// Estimate; absent where the interval begins at zero, so that its upper end is a limit.
    pub value: Option<f64>,
    /// 95 % interval, lower and upper end.
    pub ci95: [f64; 2],
    /// Unit of all three.
    pub unit: &'static str,
}

/// Drift of one axis in windows of one length, next to that of simulated sensors with its
/// coefficients.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Drift {
    /// Heading of the column.
    pub axis: String,
    /// Length of a window after its still start, s.
    pub seconds: f64,
    /// Number of windows.
    pub windows: usize,
    /// Windows that end inside the central 90 % of the simulated sensors.
    pub inside: usize,
    /// Standard deviation of the recorded error, in `unit`.
    pub recorded: f64,
    /// Standard deviation of the simulated error, in `unit`.
    pub predicted: f64,
    /// Unit of both: m of an accelerometer, ° of a gyro.
    pub unit: &'static str,
}
