//! Monte Carlo ensembles of inertial sensors: kernels on CPU lanes and on GPUs, and what is drawn
//! from them.
//! The order of its modules stands in the table of the facade.

#![warn(unreachable_pub)]

pub mod backend;
pub mod decision;
pub mod drift;
pub mod ensemble;
pub mod strapdown;
pub mod validation;

// The crates below, under the names by which files here call them.
use proofmass_base::{columns, control, document, error, number, parallel, shard, units};
use proofmass_kernel as kernel;
use proofmass_numerics::{numerics, rng, statistics};
use proofmass_physics as physics;
use proofmass_recording as recording;
use proofmass_scenario::{excitation, motion, navigation, sensor};
use proofmass_study as study;
