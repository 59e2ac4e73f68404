//! A second generator of blind cases, written without sight of the solver or of the first
//! generator, whose truth lies mostly outside what the library can state.
//!
//! Families: *to the letter* of a statement, *near* one, *foreign* to all, *null* with noise as
//! noise is. The same recording is also written otherwise (every k-th row, other units, sign, order
//! of columns); verdicts must agree. Motion is integrated in continuous time by an adaptive method
//! with events; how much of an effect can be seen is found by an oracle of its own.
//!
//! Sweeps of a resonator (`stepped`, `swept`, `balance`, `resonance`) are a trial of their own.
//!
//! Imports run `draw` → `wave` → `law` → `readout` → `oscillator` → `motion` → `simulate` →
//! `driven` → `oscillator_base` → `sizing` → `exact` → `near_miss` → `case` → `stated` → `judge` → `run` → `score`.

mod balance;
pub mod case;
pub mod columns;
pub mod draw;
pub mod driven;
pub mod exact;
pub mod integrate;
pub mod judge;
pub mod law;
pub mod linear;
mod masking;
pub mod motion;
pub mod near_miss;
pub mod null;
mod octave;
pub mod oscillator;
pub mod oscillator_base;
mod posed;
pub mod readout;
mod resonance;
pub mod rest;
pub mod run;
pub mod score;
pub mod simulate;
pub mod sizing;
mod stated;
pub mod stepped;
pub mod still;
pub mod swept;
pub mod truth;
pub mod tumble;
pub mod turned;
pub mod unmodelled;
pub mod wave;
