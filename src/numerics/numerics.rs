//! Pure mathematics without a domain. Nothing here knows what a sensor is.

pub mod allan;
pub mod banded;
pub mod butterworth;
pub mod cosine;
pub mod elementary;
pub mod exponential;
pub mod fourier;
pub mod golden;
pub mod lagrange;
pub mod least_squares;
pub mod legendre;
pub mod log_time;
pub mod moments;
pub mod non_negative;
pub mod order;
mod recent;
pub mod special;
pub mod spectrum;
