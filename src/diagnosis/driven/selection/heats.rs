//! Fits of one model from several starts: all run a first heat, and only the best runs on.

use crate::driven::identification::fit::{Fit, fit};
use crate::driven::intake::data::Data;
use crate::driven::simulation::structure::ModelStructure;
use crate::parallel;
use crate::physics::scales::Scales;

use super::earned::ITERATIONS;

/// Iterations after which the laggards are left behind.
pub(super) const HEAT: usize = 3;

/// The best of fits from these starts; `None` where the model breaks down at all of them.
pub(super) fn best_of(data: &Data, starts: &[(ModelStructure, Vec<f64>)], scales: &Scales) -> Option<Fit> {
    let first = if starts.len() > 1 { HEAT } else { ITERATIONS };
    let all = parallel::filter_map(starts, |(structure, point)| fit(data, structure, point, scales, first));
    let best = all.into_iter().min_by(|a, b| a.variance.total_cmp(&b.variance))?;
    if best.converged || starts.len() == 1 {
        return Some(best);
    }
    fit(data, &best.structure, &best.point, scales, ITERATIONS).or(Some(best))
}
