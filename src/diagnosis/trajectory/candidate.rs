//! States what a model of an IMU in motion may leave out, each with the parameters it frees.

use super::log::Halves;
use crate::candidate::Candidate;

mod beyond;
mod clock;
mod frame;
mod readout;
mod reference;
mod sensor;
mod term;

pub use clock::{CLOCK, TIME_OFFSET};
pub use frame::MOUNTING;
pub use readout::{AXIS_SWAP, LOWPASS, SATURATION, VIBRATION};
pub use reference::REFERENCE_NOISE;
pub use sensor::{G_SENSITIVITY, MISALIGNMENT};
pub use term::{Measure, Term, Unit};

/// The library of this kind.
pub const CANDIDATES: &[Candidate] = &[
    TIME_OFFSET,
    clock::CLOCK_DRIFT,
    MOUNTING,
    frame::LEVER_ARM,
    sensor::GYRO_BIAS,
    sensor::ACCELEROMETER_BIAS,
    sensor::SCALE_FACTOR,
    MISALIGNMENT,
    sensor::G_SENSITIVITY,
    SATURATION,
    LOWPASS,
    AXIS_SWAP,
    VIBRATION,
    sensor::EARTH_RATE,
    REFERENCE_NOISE,
];

/// Everything that is fitted and judged by held-out blocks.
fn fitted() -> impl Iterator<Item = &'static Term> {
    [clock::TERMS, frame::TERMS, sensor::TERMS, readout::TERMS].into_iter().flatten()
}

/// Returns what a reference with these halves of a pose can show.
pub(super) fn terms(halves: Halves) -> Vec<&'static Term> {
    fitted().filter(|t| t.needs.is_none_or(|half| halves.has(half))).collect()
}

/// Returns the laws that are no candidates and that such a reference can show: next to positions alone the
/// attitude is the gyro's own, and nothing is held against it.
pub(super) fn beyond(halves: Halves) -> Vec<&'static Term> {
    let shown = |t: &&Term| halves.attitude && t.needs.is_none_or(|half| halves.has(half));
    beyond::TERMS.iter().filter(shown).collect()
}

/// Returns what it cannot show.
pub(super) fn untold(halves: Halves) -> Vec<&'static Term> {
    fitted().filter(|t| t.needs.is_some_and(|half| !halves.has(half))).collect()
}
