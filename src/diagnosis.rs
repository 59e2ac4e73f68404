//! When simulation and recording differ: locate the mismatch, name the physics, model it, show the fit improve.
//!
//! Chain: residual → detection → isolation → identification → selection → verdict. One sub-folder per kind of recording.

pub mod candidate;
pub mod model;
pub mod verdict;
