//! `slow-drift`: the slow drift of offsets where nothing recorded accounts for it. It is fitted so
//! that it does not bend a calibration, and named where it moves the poses by more than 1/f noise
//! may; smaller, it is told as a finding. Never named for what drives it: warmth, a battery and age
//! look alike in poses.
//!
//! Each cosine is judged by itself. Most drifts are nearly a ramp, which the first one absorbs;
//! all three at once are nine parameters of a sensor, too many for the poses that remain when a
//! fold is held out.

use std::ops::Range;

use super::term::{Role, Seen, Stated, Term};
use crate::candidate::{Candidate, Kind, Parameter};
use crate::sensor::Sense;
use crate::tumble::calibration::{DRIFT_TERMS, accelerometer, gyro};
use crate::tumble::group::Group;

pub(super) const CANDIDATE: Candidate = Candidate {
    id: "slow-drift",
    kind: Kind::Tumble,
    statement: "The offsets drift slowly over the recording.",
    equation: "y = o + s (v + d(t)),  d = Σ d_n cos(nπt/T), n ≤ 3",
    parameters: &[Parameter { name: "rms", unit: "u", range: (f64::MIN, f64::MAX) }],
    acts: "readout",
    signature: "poses of equal attitude differ with the time at which they were taken",
    confusable_with: &["temperature-sensitivity"],
    reference: "IEEE 952, annex C",
};

pub(super) const TERMS: &[Term] = &[
    term(Sense::Accelerometer, &ACCELEROMETER[0]),
    term(Sense::Accelerometer, &ACCELEROMETER[1]),
    term(Sense::Accelerometer, &ACCELEROMETER[2]),
    term(Sense::Gyro, &GYRO[0]),
    term(Sense::Gyro, &GYRO[1]),
    term(Sense::Gyro, &GYRO[2]),
];

/// One cosine of all three axes: its parameters.
type Cosine = [Range<usize>; 3];

const ACCELEROMETER: &[Cosine; DRIFT_TERMS] = &cosines(accelerometer::DRIFT.start);
const GYRO: &[Cosine; DRIFT_TERMS] = &cosines(gyro::DRIFT.start);

/// The cosines of x stand first, then those of y and z.
const fn cosines(first: usize) -> [Cosine; DRIFT_TERMS] {
    [axes(first), axes(first + 1), axes(first + 2)]
}

const fn axes(x: usize) -> Cosine {
    [x..x + 1, x + DRIFT_TERMS..x + DRIFT_TERMS + 1, x + 2 * DRIFT_TERMS..x + 2 * DRIFT_TERMS + 1]
}

const fn term(sensor: Sense, parameters: &'static Cosine) -> Term {
    Term {
        candidate: &CANDIDATE,
        sensor,
        parameters,
        judged: match sensor {
            Sense::Accelerometer => Group::Gravity,
            Sense::Gyro => Group::Still,
        },
        stated: Stated::RmsOfDrift,
        seen: Seen::InEveryParameter,
        role: Role::Finding,
    }
}
