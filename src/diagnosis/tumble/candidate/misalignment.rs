//! `misalignment`: sensitive axes are not orthogonal, or the gyro's stand turned against the
//! accelerometer's.

use super::term::{Role, Seen, Stated, Term};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::sensor::Sense;
use crate::tumble::calibration::{accelerometer, gyro};
use crate::tumble::group::Group;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "misalignment",
    kind: Kind::Tumble,
    statement: "The sensitive axes are not orthogonal, or the gyro's axes are turned against the accelerometer's.",
    equation: "v = M f,  w = M ω,  M_ii = 1, M_ij ≠ 0",
    parameters: &[Parameter { name: "m_ij", unit: "rad", range: (-0.3, 0.3) }],
    acts: "readout",
    signature: "|f| depends on products of two axes' components; gyro: a rotation does not carry gravity to where it \
    should",
    confusable_with: &["scale-factor", "g-sensitivity"],
    reference: "IEEE 1293, §5; Tedaldi, Pretto & Menegatti, ICRA 2014",
};

pub(super) const TERMS: &[Term] = &[
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Accelerometer,
        parameters: &[accelerometer::MISALIGNMENT],
        judged: Group::Gravity,
        stated: Stated::AsFitted,
        seen: Seen::InEveryParameter,
        role: Role::EveryUnit,
    },
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Gyro,
        parameters: &[gyro::MISALIGNMENT],
        judged: Group::Turn,
        stated: Stated::AsFitted,
        seen: Seen::InEveryParameter,
        role: Role::EveryUnit,
    },
];
