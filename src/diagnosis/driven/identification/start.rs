//! Where the base model begins: resonance and damping from the frequency response, or from a ring-down's spectrum.
//!
//! Found from the recording itself; the model file's hints are only more places to begin. Not the fit itself (`fit`).

use std::f64::consts::{PI, TAU};

use crate::diagnosis::driven::base::{BASE, GAIN, OMEGA, ZETA};
use crate::diagnosis::driven::intake::alignment::{Alignment, align};
use crate::diagnosis::driven::intake::data::Data;
use crate::diagnosis::driven::simulation::structure::ModelStructure;
use crate::diagnosis::model;
use crate::numerics::moments::mean_sd;
use crate::numerics::{order, spectrum};
use crate::parallel;
use crate::physics::scales::Scales;

use super::fit::{Fit, fit};

/// Damping ratios on the grid.
const ZETAS: [f64; 7] = [0.01, 0.03, 0.08, 0.2, 0.45, 0.8, 1.5];
/// Natural frequencies on the grid, from the rate over this number to half the rate.
const SLOWEST: f64 = 3000.0;
/// How finely terms are integrated while they are being chosen; the models chosen are fitted again, more finely.
const SEARCHING: f64 = 0.5;
/// Fitted from this many of the best places.
const POLISHED: usize = 4;

/// Sizes before anything is fitted.
pub fn first_scales(data: &Data) -> Scales {
    let reading = &data.reading[data.hull.clone()];
    let (centre, output) = mean_sd(reading);
    let range = reading.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
    let input = data.input.as_ref().map_or(0.0, |i| mean_sd(&i.samples()[data.hull.clone()]).1);
    let lag = data.input.as_ref().and_then(|i| align(i.samples(), &data.reading, &data.hull));
    let environment = (0..data.environments)
        .map(|e| mean_sd(&data.environment.iter().skip(e).step_by(data.environments).copied().collect::<Vec<_>>()).1)
        .collect();
    Scales {
        output: output.max(1e-300),
        output_range: range,
        velocity: output.max(1e-300),
        input,
        omega_rad_s: 0.1 * data.rate_hz,
        zeta: 0.1,
        gain: 1.0,
        interval_s: data.interval_s(),
        duration_s: data.hull.len() as f64 * data.interval_s(),
        residual: output.max(1e-300),
        lines_hz: Vec::new(),
        environment,
        centre,
        fineness: SEARCHING,
        lag_samples: lag.filter(Alignment::is_clear).map_or(0.0, |a| a.lag as f64),
    }
}

/// A place to begin: gain, ω₀, ζ, and the share of power it leaves unexplained.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    gain: f64,
    omega: f64,
    zeta: f64,
    residual: f64,
}

/// Fits the base model from the best places; `None` where no place leads anywhere.
pub fn base(data: &Data, hints: &model::Start) -> Option<(Fit, Scales)> {
    let scales = first_scales(data);
    let mut places = match &data.input {
        Some(input) => by_response(data, input.samples()),
        None => by_spectrum(data),
    };
    if let Some(hz) = hints.resonance_hz.filter(|f| *f > 0.0 && f.is_finite()) {
        let zeta = hints.damping_ratio.filter(|z| *z > 0.0 && z.is_finite()).unwrap_or(0.1);
        let gain = places.first().map_or(1.0, |p| p.gain * (hz * TAU / p.omega).powi(2));
        places.push(Place { gain, omega: hz * TAU, zeta, residual: 1.0 });
    }
    let mean = mean_sd(&data.reading[data.hull.clone()]).0;
    let structure = ModelStructure::new(&[]);
    let begin = |place: &Place| {
        let mut here = scales.clone();
        here.omega_rad_s = place.omega;
        here.zeta = place.zeta;
        here.gain = if data.input.is_some() { place.gain } else { 1.0 };
        let mut point = vec![0.0; BASE];
        point[..4].copy_from_slice(&[
            if data.input.is_some() { place.gain } else { 0.0 },
            place.omega,
            place.zeta,
            mean,
        ]);
        point[4] = data.reading[data.hull.start] - mean;
        let found = fit(data, &structure, &point, &here, 25)?;
        here.omega_rad_s = found.point[1];
        here.zeta = found.point[2];
        here.gain = if data.input.is_some() { found.point[0] } else { 1.0 };
        Some((found, here))
    };
    let found: Vec<Option<(Fit, Scales)>> = parallel::map(&places, begin);
    found.into_iter().flatten().min_by(|(a, _), (b, _)| a.variance.total_cmp(&b.variance))
}

/// Fits the base model from one place; with the sizes that follow from it.
pub(crate) fn base_from(data: &Data, point: &[f64]) -> Option<(Fit, Scales)> {
    let mut scales = first_scales(data);
    let sized = |scales: &mut Scales, point: &[f64]| {
        (scales.omega_rad_s, scales.zeta) = (point[OMEGA], point[ZETA]);
        scales.gain = if data.input.is_some() { point[GAIN] } else { 1.0 };
    };
    sized(&mut scales, point);
    let found = fit(data, &ModelStructure::new(&[]), point, &scales, 25)?;
    sized(&mut scales, &found.point);
    Some((found, scales))
}

fn by_response(data: &Data, input: &[f64]) -> Vec<Place> {
    let (u, y) = (&input[data.hull.clone()], &data.reading[data.hull.clone()]);
    let segment = (y.len() / 6).next_power_of_two().clamp(64, 8192);
    let response = spectrum::response(u, y, data.rate_hz, segment);
    let power = spectrum::welch(u, data.rate_hz, segment);
    let bins = response.frequency_hz.len().min(power.density.len());
    let total: f64 =
        (0..bins).map(|i| power.density[i] * response.gain[i].norm_sqr()).sum::<f64>().max(f64::MIN_POSITIVE);
    let mut places = Vec::new();
    let mut omega = TAU * data.rate_hz / SLOWEST;
    while omega < 0.98 * PI * data.rate_hz {
        for zeta in ZETAS {
            let (mut hh, mut hy) = (0.0, 0.0);
            for i in 0..bins {
                let w = TAU * response.frequency_hz[i];
                // 1/(ω₀² − w² + 2jζω₀w), and its product with the conjugate response.
                let (re, im) = (omega * omega - w * w, 2.0 * zeta * omega * w);
                let size = 1.0 / (re * re + im * im);
                hh += power.density[i] * size;
                hy += power.density[i] * size * (re * response.gain[i].re - im * response.gain[i].im);
            }
            let gain = hy / hh;
            places.push(Place { gain, omega, zeta, residual: 1.0 - hy * hy / hh / total });
        }
        omega *= 1.04;
    }
    polished(places)
}

/// The best places, no two of them neighbours.
fn polished(mut places: Vec<Place>) -> Vec<Place> {
    places.retain(|p| p.residual.is_finite() && p.gain.is_finite() && p.gain != 0.0);
    order::sort_by_key(&mut places, |p| p.residual);
    let mut chosen: Vec<Place> = Vec::new();
    for p in places {
        let near = |c: &Place| (p.omega / c.omega).ln().abs() < 0.15 && (p.zeta / c.zeta).ln().abs() < 0.8;
        if !chosen.iter().any(near) {
            chosen.push(p);
        }
        if chosen.len() == POLISHED {
            break;
        }
    }
    chosen
}

fn by_spectrum(data: &Data) -> Vec<Place> {
    let y = &data.reading[data.hull.clone()];
    // A ring-down is loudest at its beginning; a shorter look there sees heavy damping too.
    let mut places = Vec::new();
    for length in [y.len(), y.len() / 4, y.len() / 16, y.len() / 64] {
        if length < 32 {
            continue;
        }
        let density = spectrum::periodogram(&y[..length], data.rate_hz);
        let peak = density.density.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, _)) = peak {
            for zeta in [0.003, 0.02, 0.1, 0.4] {
                places.push(Place { gain: 1.0, omega: TAU * density.frequency_hz[i], zeta, residual: 0.0 });
            }
        }
    }
    places
}
