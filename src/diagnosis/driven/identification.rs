//! A model's parameters: where to begin, the fit, how sure it is, and whether another minimum lies
//! deeper.

pub mod chaos;
pub mod fit;
pub mod interval;
pub mod local_minima;
pub mod profile;
mod rational_fit;
pub mod refined_scales;
pub mod settled_shift;
pub mod start;
pub mod start_search;
pub mod step_length;
