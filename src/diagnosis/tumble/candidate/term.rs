//! A candidate as the fit takes it: which parameters it frees in which sensor, and the residual
//! that judges it.

use std::ops::Range;

use crate::candidate::Candidate;
use crate::sensor::Sense;
use crate::tumble::group::Group;

/// A candidate in one of the two sensors.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Term {
    /// Its entry in the library of candidates.
    pub candidate: &'static Candidate,
    /// Sensor on which it acts.
    pub sensor: Sense,
    /// Ranges of the parameters that it frees.
    pub parameters: &'static [Range<usize>],
    /// The residual it is judged by.
    pub judged: Group,
    /// In which numbers its parameters are stated.
    pub stated: Stated,
    /// From which strength on it would have been seen.
    pub seen: Seen,
    /// Holds what it is to a diagnosis.
    pub role: Role,
}

/// Holds what a candidate is to a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// An effect that nearly every unit has: the search begins with it.
    EveryUnit,
    /// An effect that some have.
    Effect,
    /// An effect that needs an environment column.
    OfAColumn,
    /// Fitted and told; named only where it is more than 1/f noise may be.
    Finding,
}

/// From which strength on a candidate with several parameters would have been seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Seen {
    /// From where its least visible parameter would have been.
    InEveryParameter,
    /// From where its most visible parameter would have been: a known rate, of which one direction
    /// looks like something else.
    InItsBestDirection,
}

/// States how fitted parameters become the numbers that a verdict states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stated {
    /// Each in its public unit.
    AsFitted,
    /// Root mean square of each offset's drift about its mean over the poses: a single cosine
    /// gives that of a straight drift to a per cent, its range only to a fifth.
    RmsOfDrift,
    /// The scale of each axis, from the common scale and the other two axes' ratios to the first:
    /// where these stand, and the unit.
    AxisScales {
        /// Index of the common scale.
        common: usize,
        /// Index of the first ratio.
        ratio: usize,
        /// Unit of a scale.
        unit: &'static str,
    },
}

impl Term {
    /// Indices of the parameters it frees.
    pub(crate) fn active(&self) -> impl Iterator<Item = usize> {
        self.parameters.iter().cloned().flatten()
    }

    /// Library id of the candidate.
    pub(crate) fn id(&self) -> &'static str {
        self.candidate.id
    }

    /// "misalignment of the gyro".
    pub(crate) fn phrase(&self) -> String {
        format!("{} of the {}", self.id(), self.sensor.name())
    }
}
