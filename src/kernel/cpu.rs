//! The kernels on the host: 64 members side by side in plain loops that the compiler turns into
//! vector instructions.
//!
//! Twins of `shaders/`: same file names, same order of operations, generic over f32 (the twin) and
//! f64 (the oracle). Not for threads or batches: that is `backend::cpu`.

// Lanes are indexed in plain loops over several arrays at once: the form that the compiler turns
// into vector code.
#![allow(clippy::needless_range_loop)]

mod acting;
mod felt;
mod fix;
pub mod flicker;
mod follow;
mod general;
pub mod imu;
pub mod lanes;
mod low_pass;
pub mod lyapunov;
pub mod members;
pub mod navigate;
pub mod noise;
pub mod oscillator;
pub mod poincare;
pub mod reading;
pub mod reduce;
pub mod simulate;
mod slow;
pub(crate) mod small;
pub mod stretch;
pub mod sums;
