//! `temperature-sensitivity`: offsets follow a temperature column. Without one there is no such
//! name: see `slow_drift`.

use super::term::{Role, Seen, Stated, Term};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::sensor::Sense;
use crate::tumble::calibration::{accelerometer, gyro};
use crate::tumble::group::Group;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "temperature-sensitivity",
    kind: Kind::Tumble,
    statement: "The offsets follow temperature.",
    equation: "y = o + s (v + c (T − T̄))",
    // Unbounded: the column's unit is its owner's, so that no slope over it is too steep.
    parameters: &[Parameter { name: "c", unit: "u per unit of the column", range: (f64::MIN, f64::MAX) }],
    acts: "readout",
    signature: "poses of equal attitude differ as the temperature did; needs a temperature column",
    confusable_with: &["g-sensitivity"],
    reference: "IEEE 1293, §5 (bias temperature sensitivity)",
};

pub(super) const TERMS: &[Term] = &[
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Accelerometer,
        parameters: &[accelerometer::TEMPERATURE],
        judged: Group::Gravity,
        stated: Stated::AsFitted,
        seen: Seen::InEveryParameter,
        role: Role::OfAColumn,
    },
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Gyro,
        parameters: &[gyro::TEMPERATURE],
        judged: Group::Still,
        stated: Stated::AsFitted,
        seen: Seen::InEveryParameter,
        role: Role::OfAColumn,
    },
];
