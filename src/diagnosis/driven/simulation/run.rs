//! A model run over part of a recording: its innovations at some points, and the states passed
//! through; in one piece, or in windows where the response is chaotic.

use crate::driven::intake::data::Data;
use crate::physics::state::Lanes;

use super::filter::{Keep, States};
pub use super::once::Run;
use super::once::{beginnings, once};
use super::restarted;
use super::structure::ModelStructure;

/// Innovations at up to [`LANES`](crate::physics::state::LANES) points.
pub fn innovations<K: Keep>(
    data: &Data,
    structure: &ModelStructure,
    points: &[Vec<f64>],
    run: &Run,
    keep: &mut K,
) -> Vec<Lanes> {
    data.work.add(run.range.len() * run.steps);
    match &data.windows {
        Some(windows) if !structure.is_noisy() => restarted::innovations(data, structure, points, run, windows, keep),
        _ => once(data, structure, points, run, beginnings(data, structure, points, run), keep),
    }
}

/// Innovations at one point, with the states that were passed through.
pub(crate) fn trace(data: &Data, structure: &ModelStructure, point: &[f64], run: &Run) -> (Vec<f64>, States) {
    let mut states = States::default();
    let lanes = innovations(data, structure, &[point.to_vec()], run, &mut states);
    (lanes.iter().map(|e| e[0]).collect(), states)
}
