//! Input and output of one proof mass, or its free ring-down: which physics its model leaves out.

pub mod contact;
pub mod damping;
pub mod drift;
pub mod drive;
pub mod filter;
pub mod fit;
pub mod gain;
pub mod held_out;
pub mod hysteresis;
pub mod input;
pub mod lag;
pub mod mode;
pub mod noise;
pub mod pickup;
pub mod readout;
pub mod select;
pub mod spring;
pub mod start;
pub mod term;

use crate::error::{Error, Result};
use crate::recording::Recording;

use super::Diagnosis;
use super::candidate::Candidate;
use super::model;

/// What can be named in this kind of recording.
pub const CANDIDATES: &[Candidate] = &[
    spring::CUBIC,
    spring::QUADRATIC,
    damping::QUADRATIC,
    damping::SQUEEZE_FILM,
    damping::COULOMB,
    hysteresis::BOUC_WEN,
    spring::DRIFT,
    mode::PARASITIC,
    drive::SQUARE,
    contact::END_STOP,
    noise::FORCE,
    readout::SATURATION,
    readout::QUANTISATION,
    lag::DELAY,
    lag::LOWPASS,
    readout::POLYNOMIAL,
    drive::FEEDTHROUGH,
    drift::RAMP,
    drift::WARM_UP,
    noise::WALK,
    pickup::PERIODIC,
];

/// Plain numbers behind the figures.
#[derive(Debug, Clone, Default)]
pub struct Detail {}

/// Diagnoses it.
///
/// # Errors
/// Always, until it is built.
pub fn diagnose(_recording: &Recording, _model: &model::Driven) -> Result<Diagnosis> {
    Err(Error::new("could not diagnose the recording", "this kind is not built yet", "use kind = \"tumble\""))
}
