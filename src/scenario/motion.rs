//! Motion in six axes: where trajectories come from, the Earth under them, and what a navigator
//! makes of readings.
//!
//! `earth`: gravity and rates of the local level · `sources`: the kinds of `[trajectory]`, each a
//! list of poses · `spline`: the continuous motion through them · `file`: poses out of files, and
//! what is wrong with them · `trajectory`: that motion over the Earth, sampled as `truth` ·
//! `mechanisation`: the strapdown navigator in f64, and its own error · `temperature`: how warm the
//! sensor is on the way. Local level is north-east-down. Not for errors of sensors.

pub mod earth;
pub mod file;
pub mod mechanisation;
pub mod pose;
pub mod sources;
pub mod spline;
pub mod temperature;
pub mod trajectory;
pub mod truth;

pub use earth::{Earth, Place};
pub use file::finding::Finding;
pub use mechanisation::Integrator;
pub use sources::Section;
pub use trajectory::{Sampling, Trajectory};
pub use truth::{Sample, Truth};
