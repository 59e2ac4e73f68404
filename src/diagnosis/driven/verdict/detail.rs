//! Keeps what a diagnosis of this kind needs for its figures, as plain numbers.

use std::ops::Range;

use crate::driven::identification::profile::Profile;
use crate::driven::intake::notes::Broken;
use crate::standing::Gain;
use crate::verdict::{Detectable, Form};

use super::surface::Surface;

/// Plain numbers behind the figures.
#[derive(Debug, Clone, Default)]
pub struct Detail {
    /// Heading of the output column.
    pub output: String,
    /// Unit of the output.
    pub unit: String,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// The stretch of held-out samples that is shown.
    pub shown: Shown,
    /// Displacement (base model) on the fitted stretch.
    pub state: Vec<f64>,
    /// Error of the base model's free simulation there.
    pub before: Vec<f64>,
    /// Error of the repaired model's free simulation there.
    pub after: Vec<f64>,
    /// One-step error of the repaired model on that stretch.
    pub innovations: Vec<f64>,
    /// Sample at which that stretch begins.
    pub from: usize,
    /// The force that the base model leaves unexplained over displacement and velocity, and the
    /// repaired one.
    pub surfaces: [Surface; 2],
    /// Root-mean-square, over the noise, from which on something would have been named, where
    /// nothing is.
    pub least_over_noise: f64,
    /// Candidates whose signatures could then not have been distinguished.
    pub indistinguishable: Vec<[&'static str; 2]>,
    /// States whether anything was named.
    pub named: bool,
    /// Departure of named laws from their stated form, each with its id.
    pub forms: Vec<(&'static str, Form)>,
    /// Profile likelihood of each named parameter.
    pub profiles: Vec<Profile>,
    /// Smallest strengths that would have been named, candidate by candidate, where nothing is
    /// named.
    pub detectable: Vec<Detectable>,
    /// Facts that the sentences of the verdict are made from.
    pub account: Account,
    /// Candidates: id, gain, named.
    pub candidates: Vec<(String, Gain, bool)>,
}

/// Facts that the sentences about a driven recording are made from.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Account {
    /// Location of the mismatch, as a sentence.
    pub place: String,
    /// States whether the power of the base model's error is that of the noise.
    pub at_noise: bool,
    /// Doubts that a reader of the verdict must know, as clauses.
    pub doubts: Vec<String>,
    /// Reason why input and output do not belong together as they stand; `None` if they do.
    pub broken: Option<Broken>,
    /// States whether it was driven; else it is a free ring-down.
    pub has_input: bool,
    /// Fraction of the variance of the residual that is predictable from its past, the input and
    /// the state; less what a short memory of the noise accounts for.
    pub predictable: f64,
    /// Correlation of neighbouring readings' errors, where the noise has a short memory.
    pub neighbour: Option<f64>,
    /// States whether that is too much to be called white.
    pub is_structured: bool,
    /// States whether only samples outside the recordings fitted are not followed.
    pub strays_elsewhere: bool,
    /// States whether the base model, simulated from the state that was measured, strays further than the reading moves.
    pub runs_away: bool,
    /// Smallest such fraction that would have been seen.
    pub detectable_r_squared: f64,
    /// Frequencies of the input's lines, Hz, where they are few.
    pub lines_hz: Vec<f64>,
    /// States whether they distinguish nothing linear.
    pub is_linear_class: bool,
    /// Cycles of the resonance in the recording, where they are too few.
    pub few_cycles: Option<f64>,
    /// Resonance of the base model, Hz.
    pub resonance_hz: f64,
}

/// Recording and both models where they differ most, sample by sample.
#[derive(Debug, Clone, Default)]
pub struct Shown {
    /// First sample shown.
    pub from: usize,
    /// Samples of it that were not fitted.
    pub held_out: Vec<Range<usize>>,
    /// Readings, one per sample shown.
    pub reading: Vec<f64>,
    /// Base model, freely simulated.
    pub base: Vec<f64>,
    /// Repaired model, freely simulated.
    pub repaired: Vec<f64>,
}
