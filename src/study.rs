//! study.toml → Study → Job: what the user asks, checked, in SI units, with its tolerances.
//!
//! Not for running anything: `ensemble` integrates the job, `drift` makes the answer of it.

pub mod number;
