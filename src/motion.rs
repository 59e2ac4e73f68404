//! Motion in six axes: where trajectories come from, the Earth under them, and what a navigator makes of readings.

pub mod earth;
pub mod truth;

pub use earth::{Earth, Place};
pub use truth::{Sample, Truth};
