//! States what happens between sensor and file: limits, a low-pass, exchanged columns, vibration.

use super::term::{Measure, Term, Unit};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::model::Half;
use crate::sensor::Sense;
use crate::trajectory::parameters;

/// Library entry of `readout-saturation`.
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

/// Library entry of `readout-lowpass`.
pub const LOWPASS: Candidate = Candidate {
    id: "readout-lowpass",
    kind: Kind::Trajectory,
    statement: "The gyro's readings went through a low-pass; the accelerometer's are taken to have gone through the same.",
    equation: "τ dy/dt = v − y",
    parameters: &[Parameter { name: "tau", unit: "s", range: (0.0, 0.2) }],
    acts: "readout",
    signature: "readings that are late, and smaller the quicker the motion",
    confusable_with: &["time-offset"],
    reference: "Titterton & Weston, Strapdown inertial navigation technology, §8.6: bandwidth",
};

pub(super) const TERMS: &[Term] = &[Term {
    candidate: &LOWPASS,
    sensor: Some(Sense::Gyro),
    parameters: parameters::LOWPASS..parameters::LOWPASS + 1,
    names: &["tau"],
    unit: Unit { name: "s", per_si: 1.0 },
    measure: Measure::Time,
    smallest: 3e-3,
    per_tilt: 0.0,
    needs: Some(Half::Attitude),
}];

/// Library entry of `axis-swap`.
pub const AXIS_SWAP: Candidate = Candidate {
    id: "axis-swap",
    kind: Kind::Trajectory,
    statement: "Columns of the sensor are exchanged, or one has the wrong sign.",
    equation: "y = P v, P a signed permutation that is no rotation of both sensors",
    parameters: &[],
    acts: "readout",
    signature: "each column follows another axis of the reference",
    confusable_with: &["mounting"],
    reference: "Umeyama, IEEE PAMI 13, 1991: rotations and reflections that map one set of vectors onto another",
};

/// Library entry of `vibration`.
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
