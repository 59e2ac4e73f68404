//! Laws that are no candidates; the residual is tested against them.

use super::term::{Measure, Term, Unit};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::model::Half;
use crate::sensor::Sense;
use crate::trajectory::parameters;

const SQUARE: Candidate = Candidate {
    id: "square of the gyro's rate",
    kind: Kind::Trajectory,
    statement: "The gyro reads too much in the square of its rate.",
    equation: "y = ω + k ω² + b",
    parameters: &[Parameter { name: "gyro_x, gyro_y, gyro_z", unit: "mrad/s per (rad/s)²", range: (-500.0, 500.0) }],
    acts: "readout",
    signature: "errors of the rate that have one sign, whichever way it turns",
    confusable_with: &["scale-factor"],
    reference: "IEEE 952, annex C",
};

const LENGTH: Candidate = Candidate {
    id: "size of the reference's positions, or scale of the accelerometer",
    kind: Kind::Trajectory,
    statement: "The reference's positions are too large, or the accelerometer's scale too small.",
    equation: "p_reference = (1 + s) p",
    parameters: &[Parameter { name: "too_large", unit: "%", range: (-50.0, 50.0) }],
    acts: "reference",
    signature: "errors of acceleration that go with acceleration",
    confusable_with: &["time-offset"],
    reference: "Geneva & Huang, vicon2gt: derivations and analysis, RPNG-2020-VICON2GT",
};

/// Sizes below which they are nothing: of the square those of a scale factor, which it is at a rate of 1 rad/s; of the
/// positions the scale that an accelerometer has as it is delivered, for they are smoothed by no law.
pub(super) const TERMS: &[Term] = &[
    Term {
        candidate: &SQUARE,
        sensor: Some(Sense::Gyro),
        parameters: parameters::RATE_SQUARE,
        names: &["gyro_x", "gyro_y", "gyro_z"],
        unit: Unit { name: "mrad/s per (rad/s)²", per_si: 1e3 },
        measure: Measure::Plain,
        smallest: 5e-4,
        per_tilt: 0.0,
        needs: Some(Half::Attitude),
    },
    Term {
        candidate: &LENGTH,
        sensor: None,
        parameters: parameters::LENGTH..parameters::LENGTH + 1,
        names: &["too_large"],
        unit: Unit { name: "%", per_si: 1e2 },
        measure: Measure::Plain,
        smallest: parameters::DELIVERED,
        per_tilt: 0.0,
        needs: Some(Half::Position),
    },
];
