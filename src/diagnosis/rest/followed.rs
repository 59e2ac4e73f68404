//! How a channel follows an environment column: which one, with what delay, by which powers of it.

use super::profile::Profiled;

/// A column and the shape in which it is followed.
#[derive(Debug, Clone)]
pub(super) struct Followed {
    pub(super) column: String,
    /// How it is delayed.
    pub(super) delay: Delay,
    /// What one unit of the curves is in units of the column.
    pub(super) unit: f64,
    /// Which power of the column each curve is.
    pub(super) powers: &'static [i32],
}

/// How a reading comes after the column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Delay {
    None,
    /// A first-order lag; in samples.
    Lag(Profiled),
    /// It moves when the column has moved by the play; half its width, in units of the column.
    Play(Profiled),
}

impl Followed {
    /// At once and along a straight line, in units of the column.
    pub(super) fn straight(column: &str) -> Self {
        Self { column: column.into(), delay: Delay::None, unit: 1.0, powers: &[1] }
    }
}
