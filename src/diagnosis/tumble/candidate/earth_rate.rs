//! `earth-rate`: the gyro at rest feels the earth turn.

use super::term::{Role, Seen, Stated, Term};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::sensor::Sense;
use crate::tumble::calibration::gyro;
use crate::tumble::group::Group;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "earth-rate",
    kind: Kind::Tumble,
    statement: "The Earth's rotation, 15.04 °/h, was taken as zero rate.",
    equation: "w = M (ω + Rᵀ Ω)",
    parameters: &[Parameter { name: "omega_i", unit: "°/h", range: (-15.05, 15.05) }],
    acts: "reference",
    signature: "the gyro at rest follows the heading; the component along gravity looks like equal diagonal terms of \
    g-sensitivity",
    confusable_with: &["g-sensitivity"],
    reference: "IERS: 7.292115e-5 rad/s",
};

pub(super) const TERMS: &[Term] = &[Term {
    candidate: &CANDIDATE,
    sensor: Sense::Gyro,
    parameters: &[gyro::FRAME_RATE],
    judged: Group::Still,
    stated: Stated::AsFitted,
    seen: Seen::InItsBestDirection,
    role: Role::Effect,
}];
