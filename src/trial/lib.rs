//! The proof of `diagnosis`: blind trials on recordings in which the missing physics is known, and
//! concealed.
//!
//! A generator of its own (`excitation`, `proof_mass`, `standstill`, `turning`: closed-form inputs,
//! own integrator with 20 or more sub-steps, own parameter ranges) plants effects at a stated size;
//! the truth is sealed (its SHA-256 is printed first) and opened only after the verdicts. The
//! diagnosis receives two files, recording and base model, and nothing else.
//!
//! `independent` is a second generator with families of its own, which shares only plumbing with
//! the first. `planned` records what `plan` proposes. `recording_atlas` says what is found of real
//! recordings, without any truth.
//!
//! Not for fitting: nothing here is used by `diagnosis`, and nothing here calls into its numerics.

#![warn(unreachable_pub)]

pub mod ask;
pub mod blind;
pub mod book;
pub mod campaign;
pub mod case;
pub mod catalogue;
pub mod copy;
pub mod divided;
pub mod driven;
mod envelope;
pub mod equation;
pub mod excerpt;
pub mod excitation;
pub mod independent;
pub mod interval;
pub mod judge;
pub mod like;
pub mod outcome;
pub mod page;
pub mod physics;
pub mod plan;
pub mod planned;
pub mod plant;
mod processor;
pub mod proof_mass;
pub mod readout;
pub mod real;
pub mod recording_atlas;
pub mod refit;
pub mod said;
pub mod scratch;
pub mod seal;
pub mod standstill;
pub mod turning;
pub mod workers;
