//! States what the sensors do to rates and specific forces: scale, axes, gravity in the gyro,
//! biases that wander, the Earth's rate.

use super::term::{Measure, Term, Unit};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::model::Half;
use crate::sensor::Sense;
use crate::trajectory::parameters;
use crate::units::{DEGREE, STANDARD_GRAVITY_M_S2};

pub(super) const SCALE_FACTOR: Candidate = Candidate {
    id: "scale-factor",
    kind: Kind::Trajectory,
    statement: "The sensor's scale factors differ from the assumed ones.",
    equation: "y_i = (1 + s_i) v_i + b_i",
    parameters: &[
        Parameter { name: "gyro_x, gyro_y, gyro_z", unit: "ppm", range: (-1e5, 1e5) },
        Parameter { name: "accelerometer_x, accelerometer_y, accelerometer_z", unit: "ppm", range: (-1e5, 1e5) },
    ],
    acts: "readout",
    signature: "measured turns, or gravity as the body turns, are too large or too small, in proportion",
    confusable_with: &["readout-saturation", "accelerometer-bias"],
    reference: "IEEE 952, IEEE 1293",
};

/// Library entry of `misalignment`.
pub const MISALIGNMENT: Candidate = Candidate {
    id: "misalignment",
    kind: Kind::Trajectory,
    statement: "The sensor's axes are not orthogonal, or the gyro's not aligned with the accelerometer's.",
    equation: "y = (I + S) v + b, S off its diagonal",
    parameters: &[
        Parameter { name: "gyro_xy … gyro_zy", unit: "mrad", range: (-175.0, 175.0) },
        Parameter {
            name: "accelerometer_yx, accelerometer_zx, accelerometer_zy",
            unit: "mrad",
            range: (-175.0, 175.0),
        },
    ],
    acts: "readout",
    signature: "a rate, or gravity, along one axis appears on another, in one sensor alone",
    confusable_with: &["mounting"],
    reference: "IEEE 952, IEEE 1293",
};

/// The gyro's reading of specific force.
pub const G_SENSITIVITY: Candidate = Candidate {
    id: "g-sensitivity",
    kind: Kind::Trajectory,
    statement: "The gyro reads specific force.",
    equation: "y = ω + K f + b",
    parameters: &[Parameter { name: "gyro_xx … gyro_zz", unit: "deg/h/g", range: (-3600.0, 3600.0) }],
    acts: "readout",
    signature: "the gyro's bias changes with attitude and with acceleration",
    confusable_with: &["gyro-bias"],
    reference: "IEEE 1431, §4; Tedaldi, Pretto & Menegatti, ICRA 2014",
};

pub(super) const GYRO_BIAS: Candidate = Candidate {
    id: "gyro-bias",
    kind: Kind::Trajectory,
    statement: "The gyro's bias wanders during the motion.",
    equation: "b(t) = b + a₁ cos πu + a₂ cos 2πu, u = t/T",
    parameters: &[Parameter { name: "gyro_x1 … gyro_z2", unit: "deg/h", range: (-36_000.0, 36_000.0) }],
    acts: "readout",
    signature: "attitude errors that grow at a rate that changes slowly",
    confusable_with: &["g-sensitivity"],
    reference: "IEEE 952, annex C",
};

pub(super) const ACCELEROMETER_BIAS: Candidate = Candidate {
    id: "accelerometer-bias",
    kind: Kind::Trajectory,
    statement: "The accelerometer's bias wanders during the motion.",
    equation: "b(t) = b + a₁ cos πu + a₂ cos 2πu, u = t/T",
    parameters: &[Parameter { name: "accelerometer_x1 … accelerometer_z2", unit: "mg", range: (-200.0, 200.0) }],
    acts: "readout",
    signature: "acceleration errors in body axes that change slowly",
    confusable_with: &["reference-noise"],
    reference: "IEEE 1293, annex B",
};

pub(super) const EARTH_RATE: Candidate = Candidate {
    id: "earth-rate",
    kind: Kind::Trajectory,
    statement: "The gyro also reads the Earth's rotation, which the model takes as zero.",
    equation: "y = ω + Rᵀ ω_ie + b",
    parameters: &[Parameter { name: "north, east, down", unit: "deg/h", range: (-15.1, 15.1) }],
    acts: "readout",
    signature: "a constant rate in the axes of the reference, of 15 °/h; a consumer gyro's bias wanders by more",
    confusable_with: &["gyro-bias"],
    reference: "Groves, Principles of GNSS, inertial and multisensor navigation, §5.2",
};

const PPM: Unit = Unit { name: "ppm", per_si: 1e6 };
const MRAD: Unit = Unit { name: "mrad", per_si: 1e3 };
const DEG_H: Unit = Unit { name: "deg/h", per_si: 3600.0 / DEGREE };

pub(super) const TERMS: &[Term] = &[
    Term {
        candidate: &SCALE_FACTOR,
        sensor: Some(Sense::Gyro),
        parameters: parameters::GYRO_SCALE,
        names: &["gyro_x", "gyro_y", "gyro_z"],
        unit: PPM,
        measure: Measure::Plain,
        smallest: 5e-4,
        per_tilt: 0.0,
        needs: None,
    },
    Term {
        candidate: &MISALIGNMENT,
        sensor: Some(Sense::Gyro),
        parameters: parameters::GYRO_MISALIGNMENT,
        names: &["gyro_xy", "gyro_xz", "gyro_yx", "gyro_yz", "gyro_zx", "gyro_zy"],
        unit: MRAD,
        measure: Measure::Plain,
        smallest: 5e-4,
        per_tilt: 0.0,
        needs: None,
    },
    Term {
        candidate: &SCALE_FACTOR,
        sensor: Some(Sense::Accelerometer),
        parameters: parameters::FORCE_SCALE,
        names: &["accelerometer_x", "accelerometer_y", "accelerometer_z"],
        unit: PPM,
        measure: Measure::Plain,
        smallest: 5e-4,
        per_tilt: 1.0,
        needs: Some(Half::Position),
    },
    Term {
        candidate: &MISALIGNMENT,
        sensor: Some(Sense::Accelerometer),
        parameters: parameters::FORCE_MISALIGNMENT,
        names: &["accelerometer_yx", "accelerometer_zx", "accelerometer_zy"],
        unit: MRAD,
        measure: Measure::Plain,
        smallest: 5e-4,
        per_tilt: 1.0,
        needs: Some(Half::Position),
    },
    Term {
        candidate: &G_SENSITIVITY,
        sensor: Some(Sense::Gyro),
        parameters: parameters::G_SENSITIVITY,
        names: &["gyro_xx", "gyro_xy", "gyro_xz", "gyro_yx", "gyro_yy", "gyro_yz", "gyro_zx", "gyro_zy", "gyro_zz"],
        unit: Unit { name: "deg/h/g", per_si: 3600.0 / DEGREE * STANDARD_GRAVITY_M_S2 },
        measure: Measure::Plain,
        smallest: 5e-6,
        per_tilt: 0.0,
        needs: None,
    },
    Term {
        candidate: &GYRO_BIAS,
        sensor: Some(Sense::Gyro),
        parameters: parameters::GYRO_WANDER,
        names: &["gyro_x1", "gyro_x2", "gyro_y1", "gyro_y2", "gyro_z1", "gyro_z2"],
        unit: DEG_H,
        measure: Measure::Plain,
        smallest: 2e-5,
        per_tilt: 0.0,
        needs: None,
    },
    Term {
        candidate: &EARTH_RATE,
        sensor: Some(Sense::Gyro),
        parameters: parameters::EARTH_RATE,
        names: &["north", "east", "down"],
        unit: DEG_H,
        measure: Measure::Plain,
        smallest: 1e-5,
        per_tilt: 0.0,
        needs: None,
    },
    Term {
        candidate: &ACCELEROMETER_BIAS,
        sensor: Some(Sense::Accelerometer),
        parameters: parameters::FORCE_WANDER,
        names: &[
            "accelerometer_x1",
            "accelerometer_x2",
            "accelerometer_y1",
            "accelerometer_y2",
            "accelerometer_z1",
            "accelerometer_z2",
        ],
        unit: Unit { name: "mg", per_si: 1e3 / STANDARD_GRAVITY_M_S2 },
        measure: Measure::Plain,
        smallest: 2e-3,
        per_tilt: STANDARD_GRAVITY_M_S2,
        needs: Some(Half::Position),
    },
];
