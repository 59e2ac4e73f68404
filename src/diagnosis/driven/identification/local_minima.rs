//! Looks for a better fit elsewhere where a law of the model has a corner: a stop that is rarely
//! touched looks much the same harder and further away, or softer and nearer, with a ridge between
//! that no descent crosses.
//!
//! Asked once, for the model that was chosen; not for where a search begins (`start_search`).

use crate::driven::intake::data::Data;
use crate::parallel;
use crate::physics::scales::Scales;

use super::fit::{Fit, fit};

/// Log-likelihood that another valley must gain before the first is left.
const DEEPER: f64 = 2.0;
/// Iterations of a fit from there.
const ITERATIONS: usize = 20;

/// The best of a fit and of fits begun where its terms say that they may be mistaken for
/// themselves.
pub(crate) fn deepest(data: &Data, found: Fit, scales: &Scales) -> Fit {
    let rows = found.linear.residual.len() as f64;
    let starts: Vec<Vec<f64>> = found
        .structure
        .terms
        .iter()
        .enumerate()
        .flat_map(|(i, term)| {
            let first = found.structure.first[i];
            let elsewhere = term.elsewhere(found.structure.of(i, &found.point), scales);
            let point = &found.point;
            elsewhere.into_iter().map(move |values| {
                let mut point = point.clone();
                point[first..first + values.len()].copy_from_slice(&values);
                point
            })
        })
        .collect();
    let others: Vec<Fit> =
        parallel::filter_map(&starts, |start| fit(data, &found.structure, start, scales, ITERATIONS));
    let best = others.into_iter().min_by(|a, b| a.variance.total_cmp(&b.variance));
    match best {
        Some(best) if 0.5 * rows * (found.variance / best.variance).ln() > DEEPER => best,
        _ => found,
    }
}
