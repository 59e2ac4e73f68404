//! What a model of an IMU in motion may leave out, each with the parameters it frees.

use crate::diagnosis::candidate::Candidate;

mod clock;
mod frame;
mod readout;
mod reference;
mod sensor;
mod term;

pub use frame::MOUNTING;
pub use readout::{AXIS_SWAP, SATURATION, VIBRATION};
pub use reference::REFERENCE_NOISE;
pub use sensor::MISALIGNMENT;
pub use term::{Term, Unit};

/// The library of this kind.
pub const CANDIDATES: &[Candidate] = &[
    clock::TIME_OFFSET,
    clock::CLOCK_DRIFT,
    MOUNTING,
    frame::LEVER_ARM,
    sensor::GYRO_BIAS,
    sensor::ACCELEROMETER_BIAS,
    sensor::SCALE_FACTOR,
    MISALIGNMENT,
    sensor::G_SENSITIVITY,
    SATURATION,
    AXIS_SWAP,
    VIBRATION,
    sensor::EARTH_RATE,
    REFERENCE_NOISE,
];

/// What a reference of attitude alone cannot show.
pub fn by_position() -> Vec<&'static Term> {
    terms(true).into_iter().filter(|t| !t.by_attitude).collect()
}

/// Everything that is fitted and judged by held-out blocks, with or without positions in the
/// reference.
pub fn terms(has_position: bool) -> Vec<&'static Term> {
    [clock::TERMS, frame::TERMS, sensor::TERMS]
        .into_iter()
        .flatten()
        .filter(|t| has_position || t.by_attitude)
        .collect()
}
