//! Inertial sensors, what excites them, how they move, and closed forms of their drift.
//! The order of its modules stands in the table of the facade.

#![warn(unreachable_pub)]

pub mod excitation;
pub mod motion;
pub mod navigation;
pub mod sensor;

// The crates below, under the names by which files here call them.
use proofmass_base::{control, error, number, units};
use proofmass_numerics::{numerics, rng};
use proofmass_physics as physics;
use proofmass_recording as recording;
