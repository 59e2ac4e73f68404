//! What a run shows: figures, tables and one self-contained page.
//!
//! Not for computing anything: it receives finished results. `figure` is the only place that names
//! plotters.

pub mod allan;
pub mod bench;
pub mod diagnosis;
pub mod figure;
mod grouped;
pub mod html;
pub mod inspection;
pub mod map;
pub mod paper;
pub mod require;
pub mod strapdown;
pub mod study;
pub mod sweep;
pub mod table;
pub mod trial;
