//! A body without a spring: a stage, an axis, a seismic mass far above its suspension. ω₀ = 0.
//!
//! Nothing pulls it back, so that free simulation integrates every error of the force twice, and an
//! offset of the reading means nothing. Its laws are found where they act, in the force that the
//! measured motion takes (`motion`, `regression`), and its simulations begin anew every second
//! (`windows`). Of the library only laws that do not know a position can act on it. Not for bodies
//! that swing: those are simulated (`simulation`).

pub mod conclusion;
mod low_pass;
pub mod motion;
pub mod noise;
pub mod regression;
pub mod selection;
pub mod windows;

use std::f64::consts::TAU;

use super::identification::fit::{Fit, OMEGA};
use super::intake::data::Data;

/// Turns of the resonance that a recording must hold before a spring is believed.
pub(super) const TURNS: f64 = 5.0;

/// Turns of what was fitted as a resonance where it is slower than a recording can show: the input moves
/// the body about, no spring pulls it back.
pub(super) fn turns_if_free(data: &Data, base: &Fit) -> Option<f64> {
    let longest = data.recordings().iter().map(ExactSizeIterator::len).max().unwrap_or(0) as f64 * data.interval_s();
    let turns = base.point[OMEGA] * longest / TAU;
    (data.input.is_some() && turns < TURNS).then_some(turns)
}
