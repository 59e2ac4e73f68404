//! A free decay: a recording of one proof mass without an input, from where it is let go until it
//! rests; or one under an input whose velocity or acceleration is read.
//!
//! Intake finds the motion (`swings`) and its rows (`rows`); the engine searches the laws of a
//! proof mass (`simulated`) by free simulation from the base model (`base_model`, `searched`, under
//! an input `driven`); `answer` reports what was found, in the units of what was read (`read`).

pub(in crate::driven) mod alone;
pub mod answer;
mod base_model;
pub mod driven;
mod effects;
mod findings;
mod form;
mod hits;
mod input;
mod known;
mod read;
mod rows;
pub mod searched;
mod swings;
