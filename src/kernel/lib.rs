//! The contract between host and device: what a backend is given and what it returns.
//!
//! Not for choosing what to simulate (`study`) nor for looping over batches (`ensemble`).

#![warn(unreachable_pub)]

pub mod aiding;
pub mod chained;
pub mod cpu;
pub mod environment;
pub mod flicker;
pub mod flight;
pub mod force;
pub mod fragment;
pub mod integrator;
pub mod job;
pub mod layout;
pub mod low_pass;
pub mod member;
pub mod orbit;
pub mod places;
pub mod source;
pub mod truth_step;

// The crates below, under the names by which files here call them.
use proofmass_base::{error, parallel};
use proofmass_numerics::{numerics, rng, statistics};
use proofmass_physics::{self as physics, dynamics};
use proofmass_scenario::{excitation, motion, sensor};
