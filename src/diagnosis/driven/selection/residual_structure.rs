//! What a model leaves: how much of its innovations, and of their power, can still be predicted.
//! Noise gives nothing away.

use crate::diagnosis::detection::{Structure, structure};
use crate::diagnosis::driven::base::OMEGA;
use crate::diagnosis::driven::identification::fit::Fit;
use crate::diagnosis::driven::intake::data::Data;
use crate::diagnosis::driven::simulation::filter::States;
use crate::diagnosis::driven::simulation::run::trace;
use crate::diagnosis::remainder::WHITE;
use crate::numerics::moments::mean_sd;

use super::noise_scale::{MassMotion, local_scale};

/// Share of the power of noise that may be predicted before it is no longer taken for the sensor's
/// own.
pub(crate) const EVEN: f64 = 0.01;
/// Lags of their own past from which innovations are forecast.
const OWN_LAGS: usize = 24;
/// Lags over which one-step errors are taken to be correlated.
pub(crate) const MEMORY: usize = 40;

/// How much can still be predicted of a model's innovations, from their past, the input and the
/// state.
pub(crate) fn residual_structure(data: &Data, fit: &Fit) -> Structure {
    let (innovations, states) = trace(data, &fit.structure, &fit.point, &fit.run(data, true));
    structure(&innovations, OWN_LAGS, &regressors(data, &states))
}

/// As `residual_structure`, with a probability that also holds for noise of uneven strength: where
/// the innovations look structured, they are also tested weighed by their local scale, and the
/// larger probability counts.
pub(crate) fn residual_structure_evenly(data: &Data, fit: &Fit) -> Structure {
    let (innovations, states) = trace(data, &fit.structure, &fit.point, &fit.run(data, true));
    let mut known = regressors(data, &states);
    let plain = structure(&innovations, OWN_LAGS, &known);
    if plain.p_value >= WHITE {
        return plain;
    }
    let motion = MassMotion { x: &states.x, v: &states.v, omega_rad_s: fit.point[OMEGA] };
    let scale = local_scale(&innovations, &motion);
    let weighed = |values: &[f64]| values.iter().zip(&scale).map(|(v, s)| v / s).collect::<Vec<f64>>();
    known.push(vec![1.0; innovations.len()]);
    let known: Vec<Vec<f64>> = known.iter().map(|r| weighed(r)).collect();
    let even = structure(&weighed(&innovations), OWN_LAGS, &known);
    let [p_value, own_p_value] = [plain.p_value.max(even.p_value), plain.own_p_value.max(even.own_p_value)];
    Structure { p_value, own_p_value, ..plain }
}

/// What innovations are regressed on besides their past, row by row.
fn regressors(data: &Data, states: &States) -> Vec<Vec<f64>> {
    let (x, v) = (&states.x, &states.v);
    let product = |f: &dyn Fn(f64, f64) -> f64| x.iter().zip(v).map(|(x, v)| f(*x, *v)).collect::<Vec<f64>>();
    let scale = mean_sd(v).1 / mean_sd(x).1.max(1e-300);
    let s = scale.max(1e-300);
    let mut regressors: Vec<Vec<f64>> = vec![
        product(&|x, _| x),
        product(&|_, v| v),
        product(&|x, _| x * x),
        product(&|x, v| x * v / s),
        product(&|_, v| v * v / s / s),
        product(&|x, _| x * x * x),
        product(&|x, v| x * x * v / s),
        product(&|x, v| x * v * v / s / s),
        product(&|_, v| v * v * v / s / s / s),
        product(&|x, _| x.abs()),
        product(&|_, v| v.abs()),
        product(&|_, v| v.signum()),
        product(&|x, _| x.signum()),
        product(&|_, v| v.abs() * v / s / s),
        product(&|x, _| x.abs() * x),
        product(&|x, _| x * x * x * x),
        product(&|x, _| x * x * x * x * x),
    ];
    regressors.push((0..x.len()).map(|k| k as f64).collect());
    regressors.push((0..x.len()).map(|k| (k as f64 / x.len() as f64 - 0.5).powi(2)).collect());
    if let Some(input) = &data.input {
        let u = input.samples();
        for lag in -3isize..=20 {
            let at = |k: usize| u[(k as isize - lag).clamp(0, u.len() as isize - 1) as usize];
            regressors.push(data.hull.clone().map(at).collect());
        }
        regressors.push(data.hull.clone().map(|k| u[k] * u[k]).collect());
    }
    regressors
}

/// How much of the innovations' *power* can be predicted from the input, the state and time: noise
/// that belongs to the sensor does not know what the sensor is doing.
pub(crate) fn power_structure(data: &Data, fit: &Fit) -> Structure {
    let (innovations, states) = trace(data, &fit.structure, &fit.point, &fit.run(data, true));
    let size = innovations.iter().map(|e| e * e).sum::<f64>() / innovations.len().max(1) as f64;
    // Limited, so that single outliers do not speak for the rest.
    let power: Vec<f64> = innovations.iter().map(|e| (e * e / size.max(1e-300)).min(12.0)).collect();
    let mut regressors = vec![
        states.x.iter().map(|x| x * x).collect::<Vec<f64>>(),
        states.v.iter().map(|v| v * v).collect(),
        states.x.iter().map(|x| x.abs()).collect(),
        states.x.clone(),
        states.v.clone(),
    ];
    let n = power.len() as f64;
    for k in 1..=4 {
        regressors.push((0..power.len()).map(|i| (std::f64::consts::PI * k as f64 * i as f64 / n).cos()).collect());
    }
    if let Some(input) = &data.input {
        regressors.push(data.hull.clone().map(|k| input.samples()[k].powi(2)).collect());
    }
    structure(&power, 4, &regressors)
}

/// Samples per independent one, from the correlations over fewer than this many lags of a sequence
/// about zero.
pub fn correlation(errors: &[f64], lags: usize) -> f64 {
    let total = errors.iter().map(|e| e * e).sum::<f64>().max(1e-300);
    let at = |lag: usize| errors.iter().zip(&errors[lag..]).map(|(a, b)| a * b).sum::<f64>() / total;
    1.0 + (1..lags.min(errors.len() / 4)).map(|lag| 2.0 * at(lag).powi(2)).sum::<f64>()
}
