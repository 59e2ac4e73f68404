//! What acceleration and tilt errors become in velocity and position.

pub mod closed_form;
pub mod power_law;
