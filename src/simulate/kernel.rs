//! The contract between host and device: what a backend is given and what it returns.
//!
//! Not for choosing what to simulate (`study`) nor for looping over batches (`ensemble`).

pub mod cpu;
pub mod fix;
pub mod flicker;
pub mod flight;
pub mod follow;
pub mod force;
pub mod fragment;
pub mod integrator;
pub mod job;
pub mod layout;
pub(crate) mod low_pass;
pub mod member;
pub mod orbit;
pub mod passage;
pub mod source;
