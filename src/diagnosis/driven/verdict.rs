//! What may be said: which terms hold, what is left, where the base model errs, and the public document made of it.

pub mod answer;
pub mod conclude;
pub mod detail;
mod detectable;
pub mod dropped;
pub mod effects;
pub mod findings;
pub mod form;
mod isolation;
mod noise_words;
mod sensor;
pub mod surface;
