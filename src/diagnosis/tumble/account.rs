//! States what a diagnosis of poses has to tell, as data; the words are made in
//! `report::diagnosis`.

use super::group::Group;
use crate::sensor::Sense;

/// Holds what the verdict's sentence and the next experiment rest on.
#[derive(Debug, Clone, PartialEq)]
pub struct Account {
    /// States whether the poses determine the base model's own parameters.
    pub base_determined: bool,
    /// States whether a gyro was recorded next to the accelerometer.
    pub with_gyro: bool,
    /// Named effects, strongest first.
    pub named: Vec<NamedTerm>,
    /// Residuals of the repaired model above their noise, worst first, with their variance over
    /// that of the noise.
    pub above: Vec<(Group, f64)>,
    /// Candidates that would account for it with values that no sensor has.
    pub oversized: Vec<(&'static str, Sense)>,
    /// Location of the mismatch that the base model leaves.
    pub location: Location,
    /// Offsets that drift slowly.
    pub drifts: Vec<Drift>,
    /// States whether a temperature (or other environment) column was given.
    pub has_column: bool,
    /// Poses that were left out because they disagree with all others.
    pub knocked: Vec<Knocked>,
    /// States whether offsets wander between the poses by more than the noise inside them says.
    pub wanders: bool,
}

/// A slow drift of offsets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Sensor whose offsets drift.
    pub sensor: Sense,
    /// States whether it is named, not only told.
    pub is_named: bool,
    /// From the lowest to the highest over the poses, per axis: mm/s² or °/s.
    pub range: [f64; 3],
}

/// A pose that was left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knocked {
    /// Number of the pose, counted from one.
    pub pose: usize,
    /// Beginning and end of the pose, s.
    pub time_s: [f64; 2],
}

/// Location of the base model's mismatch.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Location {
    /// Each kind of residual.
    pub residuals: Vec<Rms>,
    /// Poses that stand out of the noise.
    pub standing_out: usize,
    /// The component of gravity that the excess follows most.
    pub axis: Option<&'static str>,
}

/// One kind of residual, root-mean-square, in the unit of its group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rms {
    /// Kind of residual.
    pub group: Group,
    /// Root-mean-square of the residual.
    pub value: f64,
    /// Root-mean-square that noise alone leaves.
    pub noise: f64,
}

/// A named effect and what it cannot be told from.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedTerm {
    /// Library id of the effect.
    pub id: &'static str,
    /// The sensor it acts in.
    pub sensor: Sense,
    /// Library ids of effects that fit equally well.
    pub rivals: Vec<&'static str>,
}

/// Holds what became of a candidate.
#[derive(Debug, Clone, PartialEq)]
pub enum Fate {
    /// Named, judged next to the others named.
    Named,
    /// It helps, but what is left of the residual stays above the noise.
    Withdrawn,
    /// These poses do not determine its parameters.
    Undetermined,
    /// Its parameters take values that no sensor has.
    Implausible,
    /// The poses fit without it.
    Absent {
        /// States whether it was judged next to named effects.
        beside_named: bool,
        /// The smallest strength that would have been seen, where one can be stated.
        seen_from: Option<SeenFrom>,
    },
}

/// The smallest strength that would have been seen.
#[derive(Debug, Clone, PartialEq)]
pub enum SeenFrom {
    /// Strength in its least visible parameter.
    Strength {
        /// Smallest strength that would have been seen.
        value: f64,
        /// Unit of that strength.
        unit: String,
    },
    /// Of the earth's rate, whose size is known: °/h, in the direction in which it shows best.
    EarthRateDegH(f64),
}
