//! Sums up an ensemble: moments, extremes and a histogram per quantity and report time, mergeable
//! in any number of parts.
//!
//! Not for time series of one sensor (`numerics` has Allan deviation and spectra).

pub mod fold;
pub mod histogram;
pub mod jcgm101;
pub mod moments;
pub mod sensitivity;
pub mod subset;

pub use fold::Fold;
pub use histogram::{Bins, Histogram};
pub use moments::Moments;

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Estimate {
    /// Estimate, in the unit of its quantity.
    pub value: f64,
    /// 95 % confidence interval, lower and upper end.
    pub ci95: [f64; 2],
}

/// The distribution of one quantity over the members that did not fail, at one report time.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Members that did not fail.
    pub count: u64,
    /// Mean over them, in the unit of the quantity.
    pub mean: f64,
    /// Standard deviation (n − 1).
    pub sd: f64,
    /// Smallest value, in the unit of the quantity.
    pub min: f64,
    /// Largest value, in the unit of the quantity.
    pub max: f64,
    /// Percentiles 1, 5, 50, 95 and 99, interpolated in the histogram.
    pub percentiles: [f64; 5],
    /// Histogram over the members, from which quantiles are read.
    pub histogram: Histogram,
}

/// Which percentiles a [`Summary`] holds, in its order.
const PERCENTILES: [f64; 5] = [0.01, 0.05, 0.50, 0.95, 0.99];

impl Summary {
    /// The summary of moments and histogram of the same values.
    pub fn of(moments: &Moments, histogram: Histogram) -> Self {
        let percentiles = PERCENTILES.map(|p| histogram.quantile(p, moments.min, moments.max));
        Self {
            count: moments.count,
            mean: moments.mean,
            sd: moments.sd(),
            min: moments.min,
            max: moments.max,
            percentiles,
            histogram,
        }
    }
}

/// On what an ensemble was integrated, for the provenance of a report.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// "cpu" or "gpu".
    pub kind: String,
    /// Name of the processor or adapter.
    pub name: String,
    /// Driver and its version; for a CPU, the vector instructions used.
    pub driver: String,
    /// "f32" or "f64".
    pub precision: String,
    /// Says whether multiply and add were fused; "unknown" on a GPU, whose compiler decides.
    pub fused_multiply_add: String,
    /// Integrator of the proof mass.
    pub integrator: String,
}

impl Machine {
    /// Returns whether two machines give the same bits: the number of threads and the width of
    /// vectors do not matter, fused multiply-add does, and a GPU is its own.
    pub fn same_bits(&self, other: &Self) -> bool {
        let of = |m: &Self| {
            let device = if m.kind == "cpu" { String::new() } else { format!("{} {}", m.name, m.driver) };
            [device, m.kind.clone(), m.precision.clone(), m.fused_multiply_add.clone(), m.integrator.clone()]
        };
        of(self) == of(other)
    }
}

/// A range of members and the machine that integrated them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Numbers of the members.
    pub members: Range<u64>,
    /// The machine that integrated them.
    pub machine: Machine,
    /// Why there, where another machine was tried first.
    pub reason: Option<String>,
}

/// An ensemble, summed up.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Members asked for, failed ones included.
    pub members: u64,
    /// Members that left the range of numbers by the end, and are in no summary from then on.
    pub failed: u64,
    /// Report times from the end of the still start, s.
    pub time_s: Vec<f64>,
    /// Per report time, in the order of [`crate::statistics::QUANTITIES`].
    pub at: Vec<[Summary; 4]>,
    /// Integration steps done, over all members.
    pub member_steps: u64,
    /// Wall time of the run, s.
    pub seconds: f64,
    /// The machine that integrated most members.
    pub machine: Machine,
    /// Machine of each range of members, in their order.
    pub origins: Vec<Origin>,
}

/// Holds what is measured of every member at every report time, in this order.
pub const QUANTITIES: [&str; 4] =
    ["position_error_m", "velocity_error_m_s", "acceleration_error_m_s2", "tilt_error_rad"];

/// Indices of the four error quantities in [`QUANTITIES`].
pub mod quantity {
    /// Position error, m.
    pub const POSITION: usize = 0;
    /// Velocity error, m/s.
    pub const VELOCITY: usize = 1;
    /// Acceleration error, m/s².
    pub const ACCELERATION: usize = 2;
    /// Tilt error, rad.
    pub const TILT: usize = 3;
}

impl Statistics {
    /// One number per report time: `statistics.series(quantity::POSITION, |s| s.sd)`.
    pub fn series(&self, quantity: usize, pick: impl Fn(&Summary) -> f64) -> Vec<f64> {
        self.at.iter().map(|at| pick(&at[quantity])).collect()
    }
}
