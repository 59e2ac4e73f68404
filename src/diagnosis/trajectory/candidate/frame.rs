//! `mounting` and `lever-arm`: where and how the IMU sits on the body that the reference follows.

use super::term::{Measure, Term, Unit};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::model::Half;
use crate::trajectory::parameters;
use crate::units::DEGREE;

/// Library entry of `mounting`.
pub const MOUNTING: Candidate = Candidate {
    id: "mounting",
    kind: Kind::Trajectory,
    statement: "The IMU's axes are turned against the body axes of the reference.",
    equation: "v_body = C v_IMU",
    parameters: &[Parameter { name: "x, y, z", unit: "deg", range: (-180.0, 180.0) }],
    acts: "mounting",
    signature: "rates and specific forces of one axis appear on another, alike in both sensors",
    confusable_with: &["misalignment"],
    reference: "Groves, Principles of GNSS, inertial and multisensor navigation, §4.4",
};

pub(super) const LEVER_ARM: Candidate = Candidate {
    id: "lever-arm",
    kind: Kind::Trajectory,
    statement: "The IMU does not sit at the point that the reference follows.",
    equation: "p_IMU = p + R l",
    parameters: &[Parameter { name: "x, y, z", unit: "m", range: (-10.0, 10.0) }],
    acts: "mounting",
    signature: "accelerations that follow angular acceleration and the square of the rate",
    confusable_with: &["time-offset"],
    reference: "Groves, Principles of GNSS, inertial and multisensor navigation, §2.5.5",
};

pub(super) const TERMS: &[Term] = &[
    Term {
        candidate: &MOUNTING,
        sensor: None,
        parameters: parameters::MOUNTING,
        names: &["x", "y", "z"],
        unit: Unit { name: "deg", per_si: 1.0 / DEGREE },
        measure: Measure::Plain,
        smallest: 1e-3,
        per_tilt: 0.0,
        needs: Some(Half::Attitude),
    },
    Term {
        candidate: &LEVER_ARM,
        sensor: None,
        parameters: parameters::LEVER_ARM,
        names: &["x", "y", "z"],
        unit: Unit { name: "m", per_si: 1.0 },
        measure: Measure::Plain,
        smallest: 2e-3,
        per_tilt: 0.0,
        needs: Some(Half::Position),
    },
];
