//! Windows of one length: what was recorded at their ends, and what was expected.

use super::inflation::Split;
use super::predict::Expected;
use super::window::{Biases, Nine};

/// Windows of one length.
#[derive(Debug, Clone)]
pub struct Length {
    /// Length of the windows, s.
    pub seconds: f64,
    /// Seconds of the overlap that lie in no window.
    pub unused_s: f64,
    /// The windows, in order.
    pub windows: Vec<Reckoned>,
    /// Per sensor, what each window's end is expected to be.
    pub expected: Vec<Vec<Expected>>,
    /// Per window, the covariance of its end by cause.
    pub(super) splits: Vec<Split>,
}

/// A window after dead reckoning, with its errors at the end.
#[derive(Debug, Clone, Copy)]
pub struct Reckoned {
    /// When it begins and ends on the reference's clock, s.
    pub span_s: [f64; 2],
    /// The rows of the log at its ends.
    pub rows: [usize; 2],
    /// The biases that were taken off.
    pub biases: Biases,
    /// The error at its end.
    pub error: Nine,
}

/// A window as it was recorded.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// When it begins and ends on the reference's clock, s.
    pub span_s: [f64; 2],
    /// The error at its end, and its covariance by cause.
    pub end: (Nine, Split),
}

impl Length {
    /// The errors at the ends.
    pub fn errors(&self) -> Vec<Nine> {
        self.windows.iter().map(|w| w.error).collect()
    }

    /// The windows with the errors at their ends and what makes these.
    pub(super) fn seen(&self) -> Vec<Seen> {
        let pairs = self.windows.iter().zip(&self.splits);
        pairs.map(|(window, split)| Seen { span_s: window.span_s, end: (window.error, *split) }).collect()
    }
}
