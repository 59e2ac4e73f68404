//! What a run shows: figures, tables and one self-contained page.
//!
//! Not for computing anything: it receives finished results. `figure` is the only place that names plotters.

pub mod figure;
pub mod html;
pub mod number;
pub mod table;
