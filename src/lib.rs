//! proofmass: how far will this inertial sensor drift, which error is to blame, and what physics does the model leave out?
//!
//! Two flows, one simulator.
//!
//! ```text
//! study.toml → Study → Job (sensor × excitation × tolerances) → Backend (gpu | cpu, one kernel contract)
//!            → Partials → Statistics → Report
//! recording  → Recording → base model → Residual → Detection → Isolation → Candidates → Identification
//!            → Selection → Verdict → Report (and an augmented model, which a study can run)
//! ```

pub mod cli;
pub mod diagnosis;
pub mod document;
pub mod error;
pub mod kernel;
pub mod progress;
pub mod recording;
pub mod report;
pub mod rng;
pub mod sensor;
pub mod units;
