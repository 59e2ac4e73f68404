//! States how often an experiment that `plan` proposes decides what a first recording left open, as it
//! promised: sensors with one law, recorded so that laws stay tied, are recorded again as proposed.
//!
//! Equations, integration, units and noise are those of `independent`; the truth is sealed. What is judged
//! is the way of a user: recording → verdict.json → plan → experiment → recording → verdict.
//!
//! Imports run `pair` → `line` → `ask` → `run` → `score`.

pub mod ask;
pub mod line;
pub mod pair;
pub mod run;
pub mod score;
