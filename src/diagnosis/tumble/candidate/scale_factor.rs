//! `scale-factor`: the axes of a sensor do not share one scale.

use super::term::{Role, Seen, Stated, Term};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::sensor::Sense;
use crate::tumble::calibration::{accelerometer, gyro};
use crate::tumble::group::Group;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "scale-factor",
    kind: Kind::Tumble,
    statement: "The three axes of the sensor have different scale factors; one common scale was assumed.",
    equation: "y_i = o_i + s_i v_i,  s_x ≠ s_y ≠ s_z",
    parameters: &[Parameter { name: "scale", unit: "count per m/s^2 or rad/s", range: (-0.3, 0.3) }],
    acts: "readout",
    signature: "|f| depends on which axis points up, as the square of its component; gyro: rotations about one axis \
    are over- or underestimated",
    confusable_with: &["scale-nonlinearity", "misalignment"],
    reference: "IEEE 1293, §5; Tedaldi, Pretto & Menegatti, ICRA 2014",
};

pub(super) const TERMS: &[Term] = &[
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Accelerometer,
        parameters: &[accelerometer::AXIS_SCALE],
        judged: Group::Gravity,
        stated: Stated::AxisScales {
            common: accelerometer::SCALE.start,
            ratio: accelerometer::AXIS_SCALE.start,
            unit: "count per m/s^2",
        },
        seen: Seen::InEveryParameter,
        role: Role::EveryUnit,
    },
    Term {
        candidate: &CANDIDATE,
        sensor: Sense::Gyro,
        parameters: &[gyro::AXIS_SCALE],
        judged: Group::Turn,
        stated: Stated::AxisScales {
            common: gyro::SCALE.start,
            ratio: gyro::AXIS_SCALE.start,
            unit: "count per rad/s",
        },
        seen: Seen::InEveryParameter,
        role: Role::EveryUnit,
    },
];
