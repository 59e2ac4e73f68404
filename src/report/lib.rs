//! Shows what a run gives: figures, tables and one self-contained page.
//!
//! Not for computing anything: it receives finished results. `figure` is the only place that names
//! plotters.

#![warn(unreachable_pub)]

pub mod allan;
pub mod check;
pub mod diagnosis;
pub mod figure;
mod grouped;
pub mod html;
pub mod inspection;
pub mod log;
pub mod plan;
pub mod require;
pub mod signature;
pub mod strapdown;
pub mod study;
pub mod sweep;
pub mod table;
