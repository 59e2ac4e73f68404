//! Chooses the terms that a model needs: each candidate is fitted and judged on samples that were
//! not fitted, against all others that might do as well.

pub mod at_once;
pub mod base_model;
pub mod candidates_round;
pub mod coloured_noise;
mod deferred_linear;
pub mod earned;
mod exponent_forms;
pub mod folds;
pub mod free_forms;
mod heats;
pub mod held_input;
pub mod held_out;
pub mod identifiability;
pub mod independence;
pub mod input_line;
pub mod judged;
pub mod known;
mod lagrange_multiplier;
pub mod noise_character;
pub mod noise_scale;
mod own_sharpness;
mod pumped;
pub mod quantisation_grid;
pub mod residual_structure;
pub mod rivals;
pub mod smooth_course;
pub mod stepwise;
mod stop_or_spring;
pub mod term_worth;
