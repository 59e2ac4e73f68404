//! What a diagnosis of this kind keeps for its figures, as plain numbers.

use std::ops::Range;

use crate::diagnosis::driven::identification::profile::Profile;
use crate::diagnosis::standing::Gain;
use crate::diagnosis::verdict::Detectable;

use super::surface::Surface;

/// Plain numbers behind the figures.
#[derive(Debug, Clone, Default)]
pub struct Detail {
    /// Output column.
    pub output: String,
    /// Its unit.
    pub unit: String,
    /// Sampling rate.
    pub rate_hz: f64,
    /// The stretch of held-out samples that is shown.
    pub shown: Shown,
    /// Displacement (base model) on the fitted stretch.
    pub state: Vec<f64>,
    /// Error of the base model's free simulation there.
    pub before: Vec<f64>,
    /// Error of the repaired model's free simulation there.
    pub after: Vec<f64>,
    /// One-step error of the repaired model there.
    pub innovations: Vec<f64>,
    /// Sample at which that stretch begins.
    pub from: usize,
    /// The force that the base model leaves unexplained over displacement and velocity, and the repaired one.
    pub surfaces: [Surface; 2],
    /// Where nothing is named: root-mean-square, over the noise, from which on something would have been.
    pub least_over_noise: f64,
    /// Candidates whose signatures could then not have been told apart.
    pub alike: Vec<[&'static str; 2]>,
    /// Whether anything was named.
    pub named: bool,
    /// How the misfit rises around each named parameter.
    pub profiles: Vec<Profile>,
    /// Where nothing is named: what would have been, candidate by candidate.
    pub detectable: Vec<Detectable>,
    /// The verdict in words.
    pub words: Words,
    /// Candidates: id, gain, named.
    pub candidates: Vec<(String, Gain, bool)>,
}

/// What is said of a driven recording.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Words {
    /// The verdict in one or two sentences.
    pub sentence: String,
    /// Where the mismatch lives.
    pub place: String,
    /// What would decide or confirm.
    pub next_experiment: String,
}

/// Recording and both models where they differ most, sample by sample.
#[derive(Debug, Clone, Default)]
pub struct Shown {
    /// First sample.
    pub from: usize,
    /// Samples of it that were not fitted.
    pub held_out: Vec<Range<usize>>,
    /// Recording.
    pub reading: Vec<f64>,
    /// Base model, freely simulated.
    pub base: Vec<f64>,
    /// Repaired model, freely simulated.
    pub repaired: Vec<f64>,
}
