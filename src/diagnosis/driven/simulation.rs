//! A model run over a recording: base and terms step by step, corrected by the readings where noise
//! terms ask for it.

mod acting;
mod balance;
pub mod filter;
mod force;
pub mod gain;
pub mod mover;
mod once;
mod propagator;
pub mod restarted;
pub mod run;
mod step;
pub mod structure;
