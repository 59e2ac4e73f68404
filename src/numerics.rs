//! Pure f64 mathematics without a domain.

pub mod special;
pub mod spectrum;
