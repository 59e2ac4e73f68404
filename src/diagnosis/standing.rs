//! States how a candidate stands after a search, as data: what it gained, on which data, and what
//! became of it.
//!
//! The kinds share the vocabulary. A *standing* is what one candidate does to a model without it.
//! A *selection* holds the base model, the model chosen, and its terms that are *named*, each with
//! the evidence that it rests on and the *rivals* that would do as well in its place. Words for
//! people are made from these in `report::diagnosis`.

use super::driven::verdict::dropped::Dropped;
use super::tumble::account::Fate;
use super::tumble::group::Group;

/// Fraction of the error that a candidate removes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gain {
    /// On data that were not fitted: the share of the error above the noise that goes away, or of
    /// the log-likelihood that can be gained there; 1 is all of it.
    HeldOut {
        /// Fraction of the error above the noise, or of the log-likelihood.
        value: f64,
        /// Its 95 % interval, where there is one.
        ci95: Option<[f64; 2]>,
    },
    /// Log-likelihood per held-out sample that a noise term adds; no simulation predicts noise
    /// sample by sample.
    LogScore {
        /// Difference of the mean log-likelihoods.
        value: f64,
    },
    /// The share of the fitted error that one linear step removes: a promise, not a test.
    InSample {
        /// Fraction of the fitted error.
        value: f64,
    },
}

impl Gain {
    /// On held-out data, without an interval where it is not finite.
    pub fn held_out(value: f64, ci95: [f64; 2]) -> Self {
        Self::HeldOut { value, ci95: Some(ci95).filter(|c| c.iter().all(|v| v.is_finite())) }
    }

    /// The order of its kind in a list: shares of the held-out error first, then noise, then what
    /// no held-out sample has judged.
    pub fn rank(self) -> f64 {
        match self {
            Self::HeldOut { .. } => 0.0,
            Self::LogScore { .. } => 1.0,
            Self::InSample { .. } => 2.0,
        }
    }

    /// The number, whatever it was measured on.
    pub fn value(self) -> f64 {
        match self {
            Self::HeldOut { value, .. } | Self::LogScore { value } | Self::InSample { value } => value,
        }
    }

    /// The 95 % interval, where there is one.
    pub fn ci95(self) -> Option<[f64; 2]> {
        match self {
            Self::HeldOut { ci95, .. } => ci95,
            Self::LogScore { .. } | Self::InSample { .. } => None,
        }
    }
}

/// States how one candidate stood after the search.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranked {
    /// Library id of the candidate.
    pub id: &'static str,
    /// Columns it was tried in; the same id may stand once per sensor or channel.
    pub channels: Vec<String>,
    /// Holds what it adds, to the base model or to the effects already named (`note` says which).
    pub gain: Gain,
    /// Corrected for the number of candidates tried.
    pub p_value: f64,
    /// States whether the verdict names it.
    pub named: bool,
    /// Holds what became of it in the search.
    pub note: Note,
}

/// Holds what became of a candidate.
#[derive(Debug, Clone, PartialEq)]
pub enum Note {
    /// Not fitted in full: the linear step promised too little.
    Screened,
    /// Judged as an addition to the base model.
    Alone,
    /// The same by its likelihood, at rest.
    AloneByLikelihood {
        /// Gain in log-likelihood on all data.
        gain: f64,
        /// States whether held-out data gain too.
        held_out_better: bool,
    },
    /// Judged by what it adds to the other named effects.
    BesideNamed,
    /// Its parameter was in the model, but holds no more than the lag of this named effect (its
    /// id).
    LagOf(&'static str),
    /// It was in the model and was removed.
    Dropped(Dropped),
    /// It stays in the repaired model, so that it does not bias the named terms, and has no name.
    Unnamed(Dropped),
    /// In the poses of an IMU that was hand-rotated.
    InPoses {
        /// The residual it is judged by.
        judged: Group,
        /// States how it came out.
        fate: Fate,
    },
    /// Never fitted: no pose can tell it from the common scale.
    Indistinguishable,
    /// Never fitted: one pose cannot tell it from biases and scale factors.
    OnePose,
}
