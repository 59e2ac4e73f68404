//! What happens between sensor and file: limits, filters, exchanged columns, vibration.

use super::term::{Term, Unit};
use crate::diagnosis::candidate::{Candidate, Kind, Parameter};
use crate::diagnosis::trajectory::parameters;
use crate::sensor::Sense;

/// `readout-saturation`.
pub const SATURATION: Candidate = Candidate {
    id: "readout-saturation",
    kind: Kind::Trajectory,
    statement: "The readings stop at a limit that the motion exceeds.",
    equation: "y = min(max(v, −L), L)",
    parameters: &[Parameter { name: "gyro_x … accelerometer_z", unit: "rad/s or m/s^2", range: (0.0, 1e4) }],
    acts: "readout",
    signature: "flat tops at one common value",
    confusable_with: &["scale-factor"],
    reference: "IEEE 952, §3",
};

pub(super) const LOW_PASS: Candidate = Candidate {
    id: "readout-lowpass",
    kind: Kind::Trajectory,
    statement: "A low-pass filter lies between the sensor and its readings.",
    equation: "y = v(t − τ) + κ v″",
    parameters: &[Parameter { name: "gyro or accelerometer", unit: "ms^2", range: (0.0, 1e4) }],
    acts: "readout",
    signature: "what changes fast comes out too small and late; a pure delay alone is a time offset",
    confusable_with: &["time-offset", "scale-factor"],
    reference: "Groves, Principles of GNSS, inertial and multisensor navigation, §4.4",
};

/// `axis-swap`.
pub const AXIS_SWAP: Candidate = Candidate {
    id: "axis-swap",
    kind: Kind::Trajectory,
    statement: "Columns of the sensor are exchanged, or a sign is turned round.",
    equation: "y = P v, P a signed permutation that is no rotation of both sensors",
    parameters: &[],
    acts: "readout",
    signature: "each column follows another axis of the reference",
    confusable_with: &["mounting"],
    reference: "Umeyama, IEEE PAMI 13, 1991: rotations and reflections that lay one set of vectors on another",
};

/// `vibration`.
pub const VIBRATION: Candidate = Candidate {
    id: "vibration",
    kind: Kind::Trajectory,
    statement: "In motion the readings are noisier than at rest: the body vibrates.",
    equation: "PSD(f) = N² + lines",
    parameters: &[
        Parameter { name: "density", unit: "unit/√Hz", range: (0.0, 1e6) },
        Parameter { name: "frequency", unit: "Hz", range: (0.0, 1e6) },
    ],
    acts: "surroundings",
    signature: "a spectrum above the static figure where the reference does not move, with lines",
    confusable_with: &["reference-noise"],
    reference: "IEEE 1293, annex D",
};

const SQUARE_MS: Unit = Unit { name: "ms^2", per_si: 1e6 };

pub(super) const TERMS: &[Term] = &[
    Term {
        candidate: &LOW_PASS,
        sensor: Some(Sense::Gyro),
        parameters: parameters::LOW_PASS.start..parameters::LOW_PASS.start + 1,
        names: &["gyro"],
        unit: SQUARE_MS,
        largest: 1e-2,
        smallest: 2e-5,
        per_tilt: 0.0,
        by_attitude: true,
    },
    Term {
        candidate: &LOW_PASS,
        sensor: Some(Sense::Accelerometer),
        parameters: parameters::LOW_PASS.start + 1..parameters::LOW_PASS.end,
        names: &["accelerometer"],
        unit: SQUARE_MS,
        largest: 1e-2,
        smallest: 2e-5,
        per_tilt: 0.0,
        by_attitude: false,
    },
];
