//! `temperature-sensitivity`: offsets follow a temperature column, or drift slowly with time where none was recorded.

use super::term::{Seen, Stated, Term};
use crate::diagnosis::candidate::{Candidate, Kind, Parameter};
use crate::diagnosis::tumble::calibration::{accelerometer, gyro};
use crate::diagnosis::tumble::group::Group;
use crate::sensor::Sense;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "temperature-sensitivity",
    kind: Kind::Tumble,
    statement: "The offsets follow temperature; where no temperature was recorded, they drift slowly with time.",
    equation: "y = o + s (v + c (T − T̄))",
    // Unbounded: the column's unit is its owner's, so that no slope over it is too steep.
    parameters: &[Parameter {
        name: "c",
        unit: "u per unit of the column, or per minute",
        range: (f64::MIN, f64::MAX),
    }],
    acts: "readout",
    signature: "poses of equal attitude differ by when they were taken",
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
    },
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Gyro,
        parameters: &[gyro::TEMPERATURE],
        judged: Group::Still,
        stated: Stated::AsFitted,
        seen: Seen::InEveryParameter,
    },
];
