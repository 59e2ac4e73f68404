//! `g-sensitivity`: the gyro follows specific force.

use super::term::{Role, Seen, Stated, Term};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::sensor::Sense;
use crate::tumble::calibration::gyro;
use crate::tumble::group::Group;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "g-sensitivity",
    kind: Kind::Tumble,
    statement: "The gyro's bias follows the specific force: at rest it reads a different rate in every attitude.",
    equation: "w = M ω + K f",
    parameters: &[Parameter { name: "k_ij", unit: "°/s/g", range: (-5.0, 5.0) }],
    acts: "readout",
    signature: "the gyro at rest follows the direction of gravity; rotations of gravity improve as well",
    confusable_with: &["earth-rate", "temperature-sensitivity"],
    reference: "IEEE 952, §5 (acceleration-sensitive drift); Bancroft & Lachapelle, Sensors 2012",
};

pub(super) const TERMS: &[Term] = &[Term {
    candidate: &CANDIDATE,
    sensor: Sense::Gyro,
    parameters: &[gyro::G_SENSITIVITY],
    judged: Group::Still,
    stated: Stated::AsFitted,
    seen: Seen::InEveryParameter,
    role: Role::Effect,
}];
