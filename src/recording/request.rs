//! States what is asked of a file: columns, clock, and which stretch of it.

use std::ops::Range;

use super::memory::Memory;
use crate::control::Control;

/// Holds what to read of a file, and what its clock is.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Topic, message or array, where the file has several; absent: the only one that holds an
    /// IMU's readings.
    pub topic: Option<String>,
    /// Headings, in the order wanted; without a header, "1", "2", … Empty: every column but the
    /// clock.
    pub columns: Vec<String>,
    /// Headings of columns that may be written in a few rows only, as a temperature often is: a row
    /// without them is one nevertheless, and they are taken to go straight in between.
    pub slow: Vec<String>,
    /// Sampling rate, where rows are evenly spaced by construction.
    pub rate_hz: Option<f64>,
    /// Use that rate against the file's own clock, where the two contradict each other.
    pub force_rate: bool,
    /// Heading of a time column. Where both are given, the column must agree with the rate.
    pub time: Option<String>,
    /// Data rows wanted, counted from zero after the header; absent means all. Later indices count
    /// from its start.
    pub rows: Option<Range<usize>>,
    /// Seconds after the first row at which to begin.
    pub from_s: Option<f64>,
    /// Seconds after the first row at which to end.
    pub to_s: Option<f64>,
    /// Samples wanted of those that come of these rows; absent means all. `recording::read` alone
    /// looks at it.
    pub samples: Option<Range<usize>>,
    /// About the most samples that are wanted: of more, neighbours are averaged. `recording::read`
    /// alone looks at it.
    pub at_most: Option<usize>,
    /// Read in place of the file, whose path then is only a name.
    pub memory: Option<Memory>,
    /// Who watches the reading and may stop it.
    pub control: Control,
}
