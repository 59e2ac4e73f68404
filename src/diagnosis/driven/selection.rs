//! Which terms a model needs: each candidate fitted and judged on samples that were not fitted,
//! against all others that might do as well.

pub mod base_model;
pub mod coloured_noise;
pub mod earned;
pub mod folds;
pub mod forms;
pub mod held_input;
pub mod held_out;
pub mod identifiability;
pub mod independence;
pub mod input_line;
pub mod judged;
mod kept_back;
mod kept_shape;
pub mod known;
pub mod lattice;
pub mod noise_character;
pub mod noise_scale;
mod other_power;
mod pumped;
pub mod residual_structure;
pub mod rivals;
pub mod round;
mod score_test;
pub mod smooth_course;
pub mod stepwise;
pub mod term_worth;
