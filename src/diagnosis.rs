//! When simulation and recording differ: locate the mismatch, name the physics, model it, show the fit improve.
//!
//! Chain: detection → isolation → selection → ruling. One sub-folder per kind of recording: it reads its recording, tries its
//! candidates and weighs what is left (`remainder`); from that evidence `ruling` draws the verdict, the same for all kinds.
//! The vocabulary of a selection stands in `standing`. Each kind returns the same [`answer::Answer`]: numbers and typed
//! reasons. Not for words or drawing: `report` turns an `Answer` into the public document and a page.

pub mod answer;
pub use crate::physics::candidate;
pub mod consequence;
pub mod detection;
pub mod driven;
pub mod model;
pub mod rectification;
pub mod remainder;
pub mod repair;
pub mod rest;
pub mod ruling;
pub mod standing;
pub mod tumble;
pub mod verdict;

use crate::control::Control;
use crate::error::Result;
use crate::recording::Recording;

use answer::Answer;
use candidate::Candidate;
use model::Model;

/// Diagnoses a recording by the kind its model states.
///
/// # Errors
/// When the recording cannot be judged at all (columns missing, too few samples), or when stopped; what can be survived is in
/// `Answer::findings` instead.
pub fn diagnose(recording: &Recording, model: &Model, control: &Control) -> Result<Answer> {
    match model {
        Model::Driven(model) => driven::diagnose(recording, model, control),
        Model::Static(model) => rest::diagnose(recording, model, control),
        Model::Tumble(model) => tumble::diagnose(recording, model),
    }
}

/// Every candidate of every kind, in the order of each kind's list.
pub fn library() -> impl Iterator<Item = &'static Candidate> {
    driven::CANDIDATES.iter().chain(rest::CANDIDATES).chain(tumble::CANDIDATES)
}
