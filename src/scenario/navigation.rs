//! Carries acceleration and tilt errors to velocity and position.

pub mod closed_form;
pub mod dead_reckoning;
pub mod kalman;
pub mod power_law;
pub mod slow;
pub mod tilt;
