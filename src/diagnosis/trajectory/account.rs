//! States what a diagnosis of an IMU in motion has to tell, as data; the words are made in
//! `report::diagnosis`.

use super::candidate::Term;
use crate::model::Half;
use crate::sensor::Sense;

/// Holds what the verdict's sentence and the next experiment rest on.
#[derive(Debug, Clone, PartialEq)]
pub struct Account {
    /// Named effects, strongest first.
    pub named: Vec<NamedEffect>,
    /// Holds what the motion cannot tell, and what it would take.
    pub hidden: Vec<Hidden>,
    /// Holds what the reference cannot tell because it lacks one half of a pose.
    pub untold: Option<Untold>,
    /// States whether one of them is a fitted term; noise, limits and exchanged columns of the
    /// readings are none.
    pub is_fitted: bool,
    /// Noise density in motion over the one stated, of each sensor that vibrates more than stated.
    pub louder: Vec<(Sense, f64)>,
    /// States whether there is a reference.
    pub with_reference: bool,
    /// Numbers that the fit needed and no IMU or reference has: the fit failed, and no fitted term
    /// is named.
    pub absurd: Vec<Absurd>,
    /// By what the chosen model is refused, where it is.
    pub rest: Rest,
    /// Root mean square of the base model's whitened residual on held-out blocks, and that with the
    /// named effects.
    pub held_out: [f64; 2],
}

/// By what a model is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rest {
    /// More than noise is left on held-out parts.
    Large,
    /// No more than noise is left, but it is not white, in this half of a pose.
    Coloured(Half),
    /// A law that is no candidate.
    Law,
}

/// A number beyond what is plausible.
#[derive(Debug, Clone, PartialEq)]
pub struct Absurd {
    /// "a bias of the gyro".
    pub what: String,
    /// Its size, in the unit.
    pub value: f64,
    /// The largest that there is, in the unit.
    pub most: f64,
    /// Unit of both.
    pub unit: &'static str,
    /// States where the largest is taken from.
    pub source: &'static str,
}

/// Holds what a reference without one half of a pose says nothing about.
#[derive(Debug, Clone, PartialEq)]
pub struct Untold {
    /// The half that it lacks.
    pub half: Half,
    /// Holds what only that half could show.
    pub terms: Vec<&'static Term>,
}

/// An effect as a sentence names it.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedEffect {
    /// Its id in the library of candidates.
    pub id: String,
    /// "misalignment of the gyro".
    pub phrase: String,
    /// Ids that would do as well.
    pub rivals: Vec<String>,
}

/// Holds what was not determined: sizes below which it could not have been seen, in the term's
/// unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Hidden {
    /// The candidate that the motion does not show.
    pub term: &'static Term,
    /// Names of those of its numbers that are not determined, where the others are.
    pub elements: Vec<&'static str>,
    /// Its widest interval, half, in its unit.
    pub half_width: f64,
    /// Manoeuvre that would determine it.
    pub manoeuvre: Manoeuvre,
}

/// Motion that a further recording should contain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Manoeuvre {
    /// Turns about every axis.
    TurnEveryAxis,
    /// The six faces up, each for a while.
    SixPositions,
    /// Figures of eight, with accelerations to all sides.
    FigureEight,
    /// A recording that lasts longer.
    Longer,
}
