//! The recording as simulations and fits see it: reading, input, environment, and what each sample
//! is for.

use std::ops::Range;
use std::sync::Arc;

use crate::numerics::moments::mean_sd;
use crate::trace::Trace;

use super::input::Input;
use super::observed::Observed;
use super::windows::Windows;
use super::work::Work;

/// An environment column that laws may follow: one that changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// Its heading.
    pub heading: String,
    /// Its mean, from which laws count it, in its unit.
    pub mean: f64,
}

impl Followed {
    /// A column of these values; `None` where it does not change beyond rounding.
    pub(super) fn of(heading: &str, values: &[f64]) -> Option<Self> {
        let (mean, sd) = mean_sd(values);
        (sd > 1e-12 * mean.abs()).then(|| Self { heading: heading.to_owned(), mean })
    }
}

/// The recording, as fits see it.
#[derive(Debug, Clone)]
pub struct Data {
    /// Readings, in the unit of the output.
    pub reading: Vec<f64>,
    /// Quantity that is read.
    pub observed: Observed,
    /// Input; `None` for a ring-down.
    pub input: Option<Input>,
    /// Environment less its mean, row by row.
    pub environment: Vec<f64>,
    /// Number of environment columns.
    pub environments: usize,
    /// Columns of the environment, by heading and mean; empty where nobody asks.
    pub followed: Vec<Followed>,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Range from the first to the last sample that is fitted.
    pub hull: Range<usize>,
    /// First samples of the further recordings within the hull, ascending: there the mass begins
    /// anew.
    pub breaks: Vec<usize>,
    /// Samples that are fitted, within the hull.
    pub train: Vec<Range<usize>>,
    /// Samples that choose between models, within the hull.
    pub validation: Vec<Range<usize>>,
    /// Samples that judge the model chosen, inside or outside the hull.
    pub test: Vec<Range<usize>>,
    /// States whether somebody named the samples that judge, which then choose nothing.
    pub own_test: bool,
    /// Places where simulations are begun anew, where the response is chaotic.
    pub windows: Option<Arc<Windows>>,
    /// Time of each sample, s, where they do not follow one another at the sampling rate; else empty.
    pub clock_s: Vec<f64>,
    /// Computing work spent on it so far.
    pub work: Work,
    /// Changes that the rules made so far.
    pub trace: Trace,
}

impl Data {
    /// Number of samples fitted.
    pub fn train_len(&self) -> usize {
        self.train.iter().map(Range::len).sum()
    }

    /// The samples of each recording within the hull.
    pub fn recordings(&self) -> Vec<Range<usize>> {
        let starts = std::iter::once(self.hull.start).chain(self.breaks.iter().copied());
        let ends = self.breaks.iter().copied().chain([self.hull.end]);
        starts.zip(ends).map(|(a, b)| a..b).collect()
    }

    /// Sampling interval, s.
    pub fn interval_s(&self) -> f64 {
        1.0 / self.rate_hz
    }
}
