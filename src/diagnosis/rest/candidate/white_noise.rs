//! `white-noise`: its level is not the promised one. In every model; judged apart, against the
//! promise.

use super::row::{IEEE, NO_CANDIDATE, Row, size};
use crate::candidate::{Candidate, Kind};

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "white-noise",
    kind: Kind::Static,
    statement: "The white noise is not at the level that the datasheet states.",
    equation: "S(f) = n²",
    parameters: &[size("density", "y/√Hz")],
    acts: "readout",
    signature: "The Allan curve differs from the stated one by a constant factor at short averaging times.",
    confusable_with: &["quantisation-noise"],
    reference: IEEE,
};

pub(super) const ROW: Row = Row { entry: Some(&CANDIDATE), ..NO_CANDIDATE };
