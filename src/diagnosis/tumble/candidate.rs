//! States what an IMU's calibration model may leave out; one file per candidate, each with the
//! parameters it frees.

use crate::candidate::Candidate;
use crate::sensor::Sense;

mod earth_rate;
mod g_sensitivity;
mod local_gravity;
mod misalignment;
mod scale_factor;
mod scale_nonlinearity;
mod slow_drift;
mod temperature_sensitivity;
mod term;

pub(super) use term::{Role, Seen, Stated, Term};

/// The library of this kind.
pub const CANDIDATES: &[Candidate] = &[
    scale_factor::CANDIDATE,
    misalignment::CANDIDATE,
    g_sensitivity::CANDIDATE,
    scale_nonlinearity::CANDIDATE,
    temperature_sensitivity::CANDIDATE,
    local_gravity::CANDIDATE,
    earth_rate::CANDIDATE,
    slow_drift::CANDIDATE,
];

/// States what no pose can tell from the common scale: in the library to be said, never to be
/// fitted.
pub(super) const NEVER_FITTED: &Candidate = &local_gravity::CANDIDATE;

/// Everything that can be fitted to a recording with or without a gyro and an environment column.
/// `local-gravity` is not among it: no pose can tell it from the common scale.
pub(crate) fn terms(with_gyro: bool, with_column: bool) -> Vec<&'static Term> {
    [
        scale_factor::TERMS,
        misalignment::TERMS,
        g_sensitivity::TERMS,
        scale_nonlinearity::TERMS,
        temperature_sensitivity::TERMS,
        earth_rate::TERMS,
        slow_drift::TERMS,
    ]
    .into_iter()
    .flatten()
    .filter(|t| (with_gyro || t.sensor == Sense::Accelerometer) && (with_column || t.role != Role::OfAColumn))
    .collect()
}
