//! Tests whether the residual depends on anything known: the sensor's own noise does not depend on what the
//! sensor is doing.

use crate::driven::selection::residual_structure::regressors;
use crate::driven::simulated::system::System;
use crate::driven::simulation::filter::States;
use crate::engine::evidence::{Gain, gain};
use crate::engine::fit::Fitted;
use crate::engine::kind::{Kind, Linearised};
use crate::engine::linear::Products;
use crate::numerics::moments::mean_sd;

/// Gains from forecasting the residual by input, state and time, in blocks that the forecast was not fitted to;
/// `None` where the forecast cannot be solved. `noise`: variance of a row.
pub(super) fn foretold(system: &System, model: &Fitted, passed: &States, noise: f64) -> Option<Gain> {
    let layout = system.layout();
    let counted = |column: Vec<f64>| -> Option<Vec<f64>> {
        let size = mean_sd(&column).1;
        let is_known = size > 0.0 && column.iter().all(|v| v.is_finite());
        is_known.then(|| column.iter().zip(&layout.counts).map(|(v, c)| if *c { v / size } else { 0.0 }).collect())
    };
    let known = regressors(&system.rows.data, passed).into_iter().filter_map(counted);
    let shared: Vec<Vec<f64>> = model.model.shared.iter().cloned().chain(known).collect();
    let mut held = model.at_bound.clone();
    held.resize(shared.len(), false);
    let forecast = Linearised { shared, ..model.model.clone() };
    let held_out = Products::of(layout, &forecast, &held).left_out(layout, &forecast)?.residual;
    let error = held_out.iter().map(|e| e * e).sum();
    Some(gain(layout, model, &Fitted { held_out, error, ..model.clone() }, noise))
}
