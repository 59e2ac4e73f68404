//! Mathematics without a domain, counter-based random numbers, and what ensembles are summed to.

#![warn(unreachable_pub)]

pub mod numerics;
pub mod rng;
pub mod statistics;
