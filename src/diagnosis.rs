//! When simulation and recording differ: locate the mismatch, name the physics, model it, show the fit improve.
//!
//! Chain: residual → detection → isolation → identification → selection → verdict. One sub-folder per kind of recording;
//! each returns the same [`Diagnosis`], with its own plain numbers for figures in [`Detail`]. Not for drawing: `report`
//! turns a `Diagnosis` into a page.

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

use crate::error::Result;
use crate::recording::Recording;

use candidate::Candidate;
use model::Model;
use repair::Repair;
use standing::Ranked;
use verdict::Verdict;

/// What a diagnosis found, whatever the kind of recording.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The public document.
    pub verdict: Verdict,
    /// Every candidate that was tried, best first, named or not.
    pub ranking: Vec<Ranked>,
    /// The sensor with and without the named physics, for a study and for the cost in metres. `None` where nothing a
    /// study could run came out, e.g. when the base model could not be fitted.
    pub repair: Option<Repair>,
    /// Plain numbers behind the figures.
    pub detail: Detail,
}

/// What each kind keeps for its figures and its own paragraphs.
#[derive(Debug, Clone)]
pub enum Detail {
    /// Input and output of one proof mass.
    Driven(Box<driven::Detail>),
    /// A sensor at rest.
    Static(Box<rest::Detail>),
    /// An IMU in many still poses.
    Tumble(Box<tumble::Detail>),
}

/// Diagnoses a recording by the kind its model states.
///
/// # Errors
/// When the recording cannot be judged at all (columns missing, too few samples); what can be survived stands in
/// `verdict.findings` instead.
pub fn diagnose(recording: &Recording, model: &Model) -> Result<Diagnosis> {
    match model {
        Model::Driven(model) => driven::diagnose(recording, model),
        Model::Static(model) => rest::diagnose(recording, model),
        Model::Tumble(model) => tumble::diagnose(recording, model),
    }
}

/// Every candidate of every kind, in the order of each kind's list.
pub fn library() -> impl Iterator<Item = &'static Candidate> {
    driven::CANDIDATES.iter().chain(rest::CANDIDATES).chain(tumble::CANDIDATES)
}
