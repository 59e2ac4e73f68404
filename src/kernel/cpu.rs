//! The kernels on the host: 64 members side by side in plain loops that the compiler turns into
//! vector instructions.
//!
//! Twins of `shaders/`: same file names, same order of operations, generic over f32 (the twin) and
//! f64 (the oracle). Not for threads or batches: that is `backend::cpu`.

// Lanes are indexed in plain loops over several arrays at once: the form that the compiler turns
// into vector code.
#![allow(clippy::needless_range_loop)]

mod aiding;
pub(crate) mod cheap_noise;
mod environment;
pub mod flicker;
mod force_errors;
mod general;
pub mod imu;
pub mod lanes;
mod law_lanes;
mod low_pass;
pub mod lyapunov;
pub mod members;
pub mod navigate;
pub mod noise;
pub mod oscillator;
mod own;
pub mod poincare;
pub mod reading;
pub mod reduce;
pub mod simulate;
mod slow;
pub mod stretch;
pub mod sums;
