//! An atlas of real recordings: what each set is, what `diagnose`, `allan` and `study` find of it,
//! and whether a random walk is in it.
//!
//! `recipe` lists the sets with source and licence, `measured` holds what is found of a log at rest,
//! `survey` asks, `walk` judges each axis. Not for comparing with a truth: that is what `real` does.

pub mod measured;
pub mod recipe;
pub mod survey;
pub mod walk;
