//! Decides how finely a model that has been found must be integrated before its numbers are stated:
//! measured on the model itself, against the finest integration that would ever be used.
//!
//! Not for the search, which takes a fixed and coarser measure (`start`).

use crate::driven::intake::data::Data;
use crate::driven::simulation::filter::Nothing;
use crate::driven::simulation::run::{Run, innovations};
use crate::numerics::least_squares::Linear;
use crate::physics::library::Term;
use crate::physics::scales::Scales;

use super::fit::Fit;

/// Steps turn the terms' fastest rate by a quarter of a radian over this: tried in this order.
const TRIED: [f64; 9] = [0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0];
/// The finest for laws without a corner, whose errors are of fourth order; a corner's are of
/// second.
const SMOOTH: f64 = 2.0;
/// Part of its standard deviation, all parameters taken together, by which integration may move the
/// answer.
const SHIFT: f64 = 0.2;
/// Share of the innovations' variance that it may make up: a tenth of the smallest gain that earns
/// a name.
const SHARE: f64 = 5e-4;

/// The coarsest measure at which neither the parameters nor the innovations differ from those of
/// the finest by more than they may. `fit` must have been fitted to this data.
pub(crate) fn enough(data: &Data, fit: &Fit, scales: &Scales) -> f64 {
    let steps = |fineness: f64| fit.structure.steps(&fit.point, &Scales { fineness, ..scales.clone() });
    let errors = |fineness: f64| -> Vec<f64> {
        let run = Run { range: data.hull.clone(), steps: steps(fineness), corrected: true };
        let lanes = innovations(data, &fit.structure, std::slice::from_ref(&fit.point), &run, &mut Nothing);
        data.train.iter().flat_map(|r| r.clone()).map(|k| lanes[k - data.hull.start][0]).collect()
    };
    coarsest(&fit.structure.terms, steps, errors, &fit.linear.columns, fit.variance)
}

/// The same for any simulation of these terms: `steps` and `errors` give its steps per sample and its residual
/// at a measure, `columns` the derivatives of the residual, `variance` its mean square.
pub(crate) fn coarsest(
    terms: &[Term],
    steps: impl Fn(f64) -> usize,
    errors: impl Fn(f64) -> Vec<f64>,
    columns: &[Vec<f64>],
    variance: f64,
) -> f64 {
    let corner = terms.iter().any(|t| t.has_corner() && t.role().acts_on_mass());
    let finest = if corner { TRIED[TRIED.len() - 1] } else { SMOOTH };
    let mut reference = None;
    for fineness in TRIED {
        if steps(fineness) == steps(finest) {
            return fineness;
        }
        let reference = reference.get_or_insert_with(|| errors(finest));
        let off: Vec<f64> = errors(fineness).iter().zip(reference.iter()).map(|(a, b)| a - b).collect();
        let linear = Linear { residual: off, columns: columns.to_vec() };
        let normal = linear.normal();
        // What the parameters would absorb of the difference is what it moves them by.
        let taken_up = normal.sum - normal.predicted();
        let rows = linear.residual.len() as f64;
        if taken_up < SHIFT * SHIFT * variance && normal.sum < SHARE * rows * variance {
            return fineness;
        }
    }
    finest
}
