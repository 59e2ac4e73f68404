//! A sensor at rest: its noise and its drift: which physics its model leaves out.

use crate::error::{Error, Result};
use crate::recording::Recording;

use super::Diagnosis;
use super::candidate::Candidate;
use super::model;

/// What can be named in this kind of recording.
pub const CANDIDATES: &[Candidate] = &[];

/// Plain numbers behind the figures.
#[derive(Debug, Clone, Default)]
pub struct Detail {}

/// Diagnoses it.
///
/// # Errors
/// Always, until it is built.
pub fn diagnose(_recording: &Recording, _model: &model::Static) -> Result<Diagnosis> {
    Err(Error::new("could not diagnose the recording", "this kind is not built yet", "use kind = \"tumble\""))
}
