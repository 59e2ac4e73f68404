//! Asks what a recording can know of a sensor, and whether several recordings know the same.
//!
//! Chain: parameter → information → run; besides → run; spread → agreement → at_rest → study. Nothing here knows a kind of recording:
//! each kind hands over an [`Estimate`](parameter::Estimate) of its full linear model, and `check`
//! puts the questions. Not for naming what a model leaves out: see the kinds.

pub mod agreement;
mod at_rest;
pub mod besides;
pub mod information;
pub mod parameter;
pub mod run;
pub mod spread;
pub mod study;
