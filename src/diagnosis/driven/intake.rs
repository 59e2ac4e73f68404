//! Prepares what fits see from a recording: its columns, gaps and glitches mended, the input
//! aligned, the samples shared out among fitting and judging.

pub mod alignment;
pub mod data;
mod defects;
pub mod dependence;
pub mod excerpt;
mod holes;
pub mod input;
pub mod lines;
pub mod notes;
pub mod observed;
pub mod prepare;
pub mod reading_noise;
pub(crate) mod refusal;
pub mod several;
pub(crate) mod shift;
pub mod stretches;
pub mod windows;
pub mod work;
