//! What a diagnosis of an IMU in motion has to tell, as data; the words are made in
//! `report::diagnosis`.

use super::candidate::Term;
use crate::model::Half;
use crate::sensor::Sense;

/// What the verdict's sentence and the next experiment rest on.
#[derive(Debug, Clone, PartialEq)]
pub struct Account {
    /// Named effects, strongest first.
    pub named: Vec<NamedEffect>,
    /// What the motion cannot tell, and what it would take.
    pub hidden: Vec<Hidden>,
    /// What the reference cannot tell because it lacks one half of a pose.
    pub untold: Option<Untold>,
    /// Whether one of them is a fitted term; noise, limits and exchanged columns of the readings
    /// are none.
    pub is_fitted: bool,
    /// Noise density in motion over the one stated, of each sensor that vibrates more than stated.
    pub louder: Vec<(Sense, f64)>,
    /// Whether there is a reference.
    pub with_reference: bool,
    /// Root mean square of the base model's whitened residual on held-out blocks, and that with the
    /// named effects.
    pub held_out: [f64; 2],
}

/// What a reference without one half of a pose says nothing about.
#[derive(Debug, Clone, PartialEq)]
pub struct Untold {
    /// The half that it lacks.
    pub half: Half,
    /// What only that half could show.
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

/// What was not determined: sizes below which it could not have been seen, in the term's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Hidden {
    /// The candidate that the motion does not show.
    pub term: &'static Term,
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
