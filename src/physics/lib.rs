//! The laws that a proof mass, its readout and its noise may follow next to the linear oscillator,
//! one file each.
//!
//! A law's file holds what the library says of it (statement, equation, reference), its parameters
//! (name, unit, the signs and ranges that physics allows, where a fit begins, the key in a study),
//! the law itself, its WGSL, and a test problem with a known answer. From these are derived: the
//! filter of the diagnosis and the search for its start values, the general integrator of studies
//! on CPU and GPU, study keys and their checks, the repaired sensor, the cost of leaving a law out,
//! and `proofmass candidates`. The trial's equations of motion (`trial::equation`) stay apart on
//! purpose: they judge these.
//!
//! # To add a law
//!
//! 1. Write `physics/<id with underscores>.rs`: a `CANDIDATE`, a type, `impl Law` for it. A force
//!    needs `force`, and `rates` where it has states; a change of the reading needs `reading`; the
//!    role says which. Write it once, for one mass and any number type. Test it against a closed
//!    form (see `test_problem`).
//! 2. Add it to the list in [`library`], where candidates are named in public order, and its `mod`
//!    line here.
//! 3. Where a study shall run it, give it a `study` key per parameter, with a slot that no other
//!    has, and `wgsl`.
//! 4. Plant it in the trial: its own equation in `trial::equation`, which must not use this one.
//!
//! Tests then hold it against the trial's equation, in f64, in f32 and on the GPU
//! (tests/suite/laws.rs).

#![warn(unreachable_pub)]

pub mod asymmetric_stiffness;
pub mod bias_drift;
pub mod bias_random_walk;
pub mod candidate;
pub mod coefficients;
pub mod coulomb_friction;
pub mod coupled_mode;
pub mod creeping_friction;
pub mod cubic_stiffness;
pub mod dimension;
pub mod drive_nonlinearity;
pub mod dynamics;
pub mod end_stop;
pub mod feedthrough;
pub mod force_noise;
pub mod free_form;
pub mod free_oscillator;
pub mod hysteresis;
pub mod input_highpass;
pub mod input_lag;
pub mod law;
pub mod library;
pub mod one_sided_stop;
pub mod parasitic_mode;
pub mod periodic_disturbance;
pub mod power;
pub mod power_law_damping;
pub mod power_law_stiffness;
pub mod pumped_stiffness;
pub mod quadratic_damping;
pub mod quadratic_stiffness;
pub mod readout_delay;
pub mod readout_highpass;
pub mod readout_lowpass;
pub mod readout_nonlinearity;
pub mod readout_quantisation;
pub mod readout_saturation;
pub mod ringing_mode;
pub mod scales;
pub mod shaped_friction;
pub mod side_by_side;
pub mod signature;
pub mod squeeze_film_damping;
pub mod state;
pub mod stiffness_drift;
pub mod study;
#[cfg(test)]
mod test_problem;
pub mod warm_stiffness;
pub mod warm_up;

// The crates below, under the names by which files here call them.
use proofmass_base::{control, units};
use proofmass_numerics::{numerics, rng};
