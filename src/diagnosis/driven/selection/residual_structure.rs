//! Measures how much of a model's innovations, and of their power, can still be predicted. Noise
//! gives nothing away.

use std::f64::consts::TAU;

use crate::detection::{Predictability, structure};
use crate::driven::base::{OMEGA, ZETA};
use crate::driven::identification::fit::Fit;
use crate::driven::intake::data::Data;
use crate::driven::simulation::filter::States;
use crate::driven::simulation::run::trace;
use crate::numerics::moments::mean_sd;
use crate::remainder::{REAL, WHITE};

use super::coloured_noise::{Coloured, Resonance};
use super::noise_scale::{MassMotion, local_scale};

/// Share of the power of noise that may be predicted before it is no longer taken for the sensor's
/// own.
pub(crate) const EVEN: f64 = 0.01;
/// Lags of their own past from which innovations are forecast.
const OWN_LAGS: usize = 24;
/// Fraction of the variance that may stay predictable once the memory of the noise is accounted
/// for: as much as the noise's own strength may ([`EVEN`]), a tenth of the standard deviation.
const SPARED: f64 = 0.01;
/// And the fraction of the structure found before that may remain: an autoregression of third order
/// removes most of what a short memory of the noise causes, and little of what a missing law causes.
const SPARED_PART: f64 = 0.2;
/// Lags over which one-step errors are taken to be correlated.
pub(crate) const MEMORY: usize = 40;

/// Returns how much can still be predicted of a model's innovations, from their past, the input and
/// the state.
pub(crate) fn residual_structure(data: &Data, fit: &Fit) -> Predictability {
    let (innovations, states) = trace(data, &fit.structure, &fit.point, &fit.run(data, true));
    structure(&innovations, OWN_LAGS, &regressors(data, &states))
}

/// Structure that noise alone does not account for, and the memory of that noise.
#[derive(Debug, Clone)]
pub(crate) struct Residual {
    pub(crate) structure: Predictability,
    /// Memory of the readout noise, where it accounts for all that is predictable.
    pub(crate) coloured: Option<Coloured>,
}

/// Measures the same as `residual_structure`, for noise as it is: with a probability that also
/// holds where its strength is uneven, and without what only its own short memory lets one predict.
///
/// Where the innovations look structured, they are also tested weighed by their local scale, and
/// the larger probability counts. Where a memory of a few samples accounts for the structure, it is
/// one of the noise, and what is stated is the structure apart from it.
pub(crate) fn residual_structure_of_noise(data: &Data, fit: &Fit) -> Residual {
    of_noise(data, fit, trace(data, &fit.structure, &fit.point, &fit.run(data, true)))
}

/// Does the same for innovations and states at hand.
pub(crate) fn of_noise(data: &Data, fit: &Fit, (innovations, states): (Vec<f64>, States)) -> Residual {
    let mut known = regressors(data, &states);
    let plain = structure(&innovations, OWN_LAGS, &known);
    if plain.p_value >= WHITE {
        return Residual { structure: plain, coloured: None };
    }
    let motion = MassMotion { x: &states.x, v: &states.v, omega_rad_s: fit.point[OMEGA] };
    let scale = local_scale(&innovations, &motion);
    let weighed = |values: &[f64]| values.iter().zip(&scale).map(|(v, s)| v / s).collect::<Vec<f64>>();
    known.push(vec![1.0; innovations.len()]);
    let known: Vec<Vec<f64>> = known.iter().map(|r| weighed(r)).collect();
    let errors = weighed(&innovations);
    let even = structure(&errors, OWN_LAGS, &known);
    let [p_value, own_p_value] = [plain.p_value.max(even.p_value), plain.own_p_value.max(even.own_p_value)];
    let found = Predictability { p_value, own_p_value, ..plain };
    // With noise inside the model, or starts in the middle, errors have a memory that is not the
    // readout's.
    if p_value >= REAL || fit.structure.is_noisy() || data.windows.is_some() {
        return Residual { structure: found, coloured: None };
    }
    let resonance = Resonance { cycle: TAU / fit.point[OMEGA] * data.rate_hz, zeta: fit.point[ZETA] };
    for coloured in Coloured::of(&errors, resonance) {
        let known: Vec<Vec<f64>> = known.iter().map(|r| coloured.whitened(r)).collect();
        let beside = structure(&coloured.whitened(&errors), OWN_LAGS, &known);
        let is_little = beside.r_squared < SPARED && beside.r_squared < SPARED_PART * found.r_squared;
        if beside.p_value >= REAL || is_little {
            return Residual { structure: beside, coloured: Some(coloured) };
        }
    }
    Residual { structure: found, coloured: None }
}

/// Returns the columns on which innovations are regressed besides their past, row by row.
pub(crate) fn regressors(data: &Data, states: &States) -> Vec<Vec<f64>> {
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

/// Samples per independent one, from the correlations over fewer than this many lags of a sequence
/// about zero.
pub fn correlation(errors: &[f64], lags: usize) -> f64 {
    let total = errors.iter().map(|e| e * e).sum::<f64>().max(1e-300);
    let at = |lag: usize| errors.iter().zip(&errors[lag..]).map(|(a, b)| a * b).sum::<f64>() / total;
    1.0 + (1..lags.min(errors.len() / 4)).map(|lag| 2.0 * at(lag).powi(2)).sum::<f64>()
}
