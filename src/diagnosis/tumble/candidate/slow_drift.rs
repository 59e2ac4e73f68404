//! The slow drift of offsets where nothing recorded accounts for it: fitted so that it does not bend a calibration, told as
//! a finding, and never a name: 1/f noise, a battery and warmth look alike in poses.

use super::term::{Role, Seen, Stated, Term};
use crate::diagnosis::candidate::{Candidate, Kind, Parameter};
use crate::diagnosis::tumble::calibration::{accelerometer, gyro};
use crate::diagnosis::tumble::group::Group;
use crate::sensor::Sense;

/// Not in the public library.
const CANDIDATE: Candidate = Candidate {
    id: "slow-drift",
    kind: Kind::Tumble,
    statement: "The offsets drift slowly over the recording.",
    equation: "y = o + s (v + d(t)),  d = Σ d_n cos(nπt/T), n ≤ 3",
    parameters: &[Parameter { name: "d", unit: "u", range: (f64::MIN, f64::MAX) }],
    acts: "readout",
    signature: "poses of equal attitude differ by when they were taken",
    confusable_with: &["temperature-sensitivity"],
    reference: "IEEE 952, annex C",
};

pub(super) const TERMS: &[Term] = &[
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Accelerometer,
        parameters: &[accelerometer::DRIFT],
        judged: Group::Gravity,
        stated: Stated::AsFitted,
        seen: Seen::InEveryParameter,
        role: Role::Finding,
    },
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Gyro,
        parameters: &[gyro::DRIFT],
        judged: Group::Still,
        stated: Stated::AsFitted,
        seen: Seen::InEveryParameter,
        role: Role::Finding,
    },
];
