//! One proof mass as the second generator has it: its input, laws and readout as a recipe.

use serde::{Deserialize, Serialize};

use super::law::Law;
use super::readout::Readout;
use super::wave::Shape;

/// Everything about one driven recording, in internal units (displacement about one).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Oscillator {
    /// Seed of what is random in it.
    pub seed: u64,
    /// Rows per second.
    pub rate_hz: f64,
    /// Number of rows in the recording.
    pub rows: usize,
    /// Natural frequency ω₀, rad/s.
    pub omega: f64,
    /// Damping ratio ζ.
    pub zeta: f64,
    /// Force per unit mass for one unit of input.
    pub gain: f64,
    /// Displacement and velocity at the start of motion.
    pub start: [f64; 2],
    /// Rows of motion before the first recorded one.
    pub before: usize,
    /// Shape of the input.
    pub input: Shape,
    /// States whether the input is held between rows, as by a converter, or continuous.
    pub held: bool,
    /// Constant part of the input, measured with it.
    pub constant: f64,
    /// Constant force that is not measured.
    pub hidden: f64,
    /// Laws in the equation of motion that a base model lacks.
    pub laws: Vec<Law>,
    /// Holds what is missing at the readout, in the order in which it acts.
    pub readout: Vec<Readout>,
    /// The environment column: rise and its time constant as a part of the recording; none when
    /// absent.
    pub environment: Option<[f64; 2]>,
    /// The input column is late by this, s.
    pub input_lag_s: f64,
    /// Noise on the input column, of its rms.
    pub input_noise: f64,
    /// Standard deviation of sampling instants, rows.
    pub jitter: f64,
    /// Rows lost without a trace: after this part of the recording, this many rows.
    pub slip: Option<[f64; 2]>,
}

/// Poles of the readout's analogue filters.
pub(crate) fn filters(o: &Oscillator) -> usize {
    o.readout.iter().map(|r| r.poles().len()).sum()
}

/// Departure of the environment from its value at the start of the recording.
pub(crate) fn environment(o: &Oscillator, part: f64) -> f64 {
    o.environment.map_or(0.0, |[rise, tau]| rise * (1.0 - (-part.max(0.0) / tau).exp()))
}
