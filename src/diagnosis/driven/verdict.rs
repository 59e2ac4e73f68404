//! States what the diagnosis concludes: which terms hold, the residual, where the base model errs,
//! and the public document made of it.

pub mod answer;
pub mod asked;
pub(in crate::driven) mod by_simulation;
pub mod conclude;
pub mod detail;
mod detectable;
mod draft;
pub mod dropped;
pub mod effects;
pub mod findings;
pub mod form;
pub(in crate::driven) mod isolation;
mod naming_rules;
pub(in crate::driven) mod noise_words;
mod objection;
pub(in crate::driven) mod of_class;
mod product;
mod readout_memory;
pub(in crate::driven) mod residual_tests;
mod second_resonance;
mod sensitivity;
pub(in crate::driven) mod sensor;
mod stated;
pub mod surface;
mod unexplained;
