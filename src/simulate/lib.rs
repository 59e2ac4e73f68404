//! Monte Carlo ensembles of inertial sensors: the kernels, on CPU lanes and on GPUs, and the studies
//! that run on them.
//! The order of its modules stands in the table of the facade.

#![warn(unreachable_pub)]

pub mod backend;
pub mod decision;
pub mod drift;
pub mod ensemble;
pub mod kernel;
pub mod strapdown;
pub mod study;
pub mod validation;

// The crates below, under the names by which files here call them.
use proofmass_base::{
    columns, control, document, error, number, numerics, output, parallel, rng, shard, signal, statistics, units,
};
use proofmass_physics::{self as physics, dynamics};
use proofmass_recording as recording;
use proofmass_scenario::{excitation, motion, navigation, sensor};
