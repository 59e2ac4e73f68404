//! Starts for strong nonlinearity: where a model errs by much of the output, its free simulation runs out of step with the
//! recording and the misfit is full of valleys. Held to the readings from sample to sample, it has few.
//!
//! Not a fit of noise: the noise that holds the model is thought up, and gone when the start is found.

use super::fit::{Data, Fit, Search, Shape};
use super::noise::Force;
use super::term::{Scales, Term};

/// Share of the output's power that a model must miss for its free simulation to be out of step.
const OUT_OF_STEP: f64 = 0.01;
/// Displacement that the thought-up force causes, over the noise of the readings: first held fast, then more loosely.
const HOLDS: [f64; 3] = [100.0, 10.0, 1.0];
/// Iterations of each.
const ITERATIONS: usize = 4;

/// Whether a model's free simulation is out of step.
pub fn is_due(model: &Fit, scales: &Scales) -> bool {
    !model.shape.is_noisy() && model.variance > OUT_OF_STEP * scales.output * scales.output
}

/// Where a fit of this shape should begin, found by holding the model to the readings less and less from this point;
/// `None` where it breaks down.
pub fn guided(data: &Data, shape: &Shape, point: &[f64], scales: &Scales) -> Option<Vec<f64>> {
    let mut terms = shape.terms.clone();
    terms.push(Term::ForceNoise(Force));
    let held = Shape::new(&terms);
    let mut point = point.to_vec();
    for hold in HOLDS {
        let mut begin = point.clone();
        begin.push(hold);
        let mut search = Search::all(data, &held, &begin, scales);
        search.free.retain(|i| *i < shape.parameters);
        point = search.point(&search.minimise(ITERATIONS)?.z);
        point.truncate(shape.parameters);
    }
    Some(point)
}
