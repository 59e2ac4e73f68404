//! `scale-nonlinearity`: the scale changes with what is measured.

use super::term::{Role, Seen, Stated, Term};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::sensor::Sense;
use crate::tumble::calibration::{accelerometer, gyro};
use crate::tumble::group::Group;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "scale-nonlinearity",
    kind: Kind::Tumble,
    statement: "The scale factor changes with the force or rate that is measured.",
    equation: "y = o + s (v + k₂ v² + k₃ v³)",
    parameters: &[
        Parameter { name: "k2", unit: "1/u", range: (-0.1, 0.1) },
        Parameter { name: "k3", unit: "1/u^2", range: (-0.1, 0.1) },
    ],
    acts: "readout",
    signature: "|f| differs between an axis up and the same axis down (k₂), or between gravity along one axis and \
    along several (k₃)",
    confusable_with: &["scale-factor"],
    reference: "IEEE 1293, §5 (K₂, K₃)",
};

pub(super) const TERMS: &[Term] = &[
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Accelerometer,
        parameters: &[accelerometer::QUADRATIC, accelerometer::CUBIC],
        judged: Group::Gravity,
        stated: Stated::AsFitted,
        seen: Seen::InEveryParameter,
        role: Role::Effect,
    },
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Gyro,
        parameters: &[gyro::QUADRATIC, gyro::CUBIC],
        judged: Group::Turn,
        stated: Stated::AsFitted,
        seen: Seen::InEveryParameter,
        role: Role::Effect,
    },
];
