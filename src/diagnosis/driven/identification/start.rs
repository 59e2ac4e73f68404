//! Finds where the base model begins: resonance and damping from the frequency response, or from a
//! ring-down's spectrum.
//!
//! They come from the recording itself; the model file's hints are only more places to begin. Not
//! the fit itself (`fit`).

use std::f64::consts::{PI, TAU};

use crate::driven::base::{BASE, GAIN, OMEGA, ZETA};
use crate::driven::intake::alignment::{Alignment, align};
use crate::driven::intake::data::Data;
use crate::driven::simulation::run::trace;
use crate::driven::simulation::structure::ModelStructure;
use crate::model;
use crate::numerics::moments::mean_sd;
use crate::numerics::{order, spectrum};
use crate::parallel;
use crate::physics::scales::Scales;
use realfft::num_complex::Complex64;

use super::fit::{Fit, fit};
use super::rational_fit::{Rational, rational_fit};

/// Damping ratios on the grid.
const ZETAS: [f64; 7] = [0.01, 0.03, 0.08, 0.2, 0.45, 0.8, 1.5];
/// Natural frequencies on the grid, from the rate over this number to half the rate.
const SLOWEST: f64 = 3000.0;
/// Fineness of the integration of terms while they are being chosen; the models chosen are fitted
/// again, more finely.
const SEARCHING: f64 = 0.5;
/// Fitted from this many of the best places.
const POLISHED: usize = 4;
/// Fraction of a residual's power that a peak of its spectrum must hold to be where the transient
/// rings.
const LEAST_RINGING: f64 = 0.05;
/// Damping ratios to begin with there.
const RINGING_ZETAS: [f64; 3] = [0.003, 0.02, 0.1];
/// The same of a reading that rings for long.
const LONG_RINGING_ZETAS: [f64; 2] = [3e-4, 3e-3];
/// Part of the reading's power that a fit leaves where it has not found the resonance, or where the
/// response or the input is not what the base model takes it for.
pub(crate) const POOR: f64 = 0.05;
/// The same of a reading without an input.
const SPECTRUM_ZETAS: [f64; 4] = [0.003, 0.02, 0.1, 0.4];
/// Fraction by which two frequencies differ that lead to one place.
const SAME_LINE: f64 = 0.01;

/// Sizes before anything is fitted, and the lag between input and reading.
pub fn first_scales(data: &Data) -> Scales {
    let lag = data.input.as_ref().and_then(|i| align(i.samples(), &data.reading, &data.hull));
    Scales { lag_samples: lag.filter(Alignment::is_clear).map_or(0.0, |a| a.lag as f64), ..unaligned(data) }
}

/// The same where input and reading are of one clock: to look for a lag takes longer than all the rest.
pub fn unaligned(data: &Data) -> Scales {
    let reading = &data.reading[data.hull.clone()];
    let (centre, output) = mean_sd(reading);
    let range = reading.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
    let input = data.input.as_ref().map_or(0.0, |i| mean_sd(&i.samples()[data.hull.clone()]).1);
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
        highest_hz: 0.5 * data.rate_hz,
        lines_hz: Vec::new(),
        environment,
        centre,
        fineness: SEARCHING,
        lag_samples: 0.0,
        at_once: false,
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
        Some(input) => {
            let mut places = by_response(data, input.samples());
            places.extend(places.first().and_then(|best| by_spectra(data, input.samples(), best)));
            places
        }
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
    let best_of = |places: &[Place]| {
        let found: Vec<Option<(Fit, Scales)>> = parallel::map(places, begin);
        found.into_iter().flatten().min_by(|(a, _), (b, _)| a.variance.total_cmp(&b.variance))
    };
    let best = best_of(&places)?;
    // Under few lines the response shows little of the resonance; the transient rings at it.
    let ringing = data.input.as_ref().map_or(Vec::new(), |input| {
        let (errors, _) = trace(data, &best.0.structure, &best.0.point, &best.0.run(data, false));
        let mut places = by_ringing(data, input.samples(), &best.0, &errors, &RINGING_ZETAS);
        // A resonance narrower than the input's lines are apart answers at none of them: the reading
        // rings at it, for long.
        let reading = &data.reading[data.hull.clone()];
        if best.0.variance > POOR * mean_sd(reading).1.powi(2) {
            places.extend(by_ringing(data, input.samples(), &best.0, reading, &LONG_RINGING_ZETAS));
        }
        places
    });
    let other = best_of(&ringing).filter(|(fit, _)| fit.variance < best.0.variance);
    Some(other.unwrap_or(best))
}

/// Finds where `values`, the residual of a fit or the reading, ring: at the highest peak of their
/// spectrum, with the gain that answers the loudest line of the input as the fit does. Empty where
/// no peak stands out.
fn by_ringing(data: &Data, input: &[f64], fit: &Fit, values: &[f64], zetas: &[f64]) -> Vec<Place> {
    let Some(driven) = loudest(&input[data.hull.clone()], data.rate_hz) else { return Vec::new() };
    let w = driven.omega;
    let denominator = |omega: f64, zeta: f64| Complex64::new(omega * omega - w * w, 2.0 * zeta * omega * w);
    let answer = fit.point[GAIN] / denominator(fit.point[OMEGA], fit.point[ZETA]);
    let mut lines: Vec<Line> = Vec::new();
    for line in looks(values).filter_map(|look| loudest(look, data.rate_hz)) {
        let is_new = lines.iter().all(|l| (l.omega / line.omega - 1.0).abs() > SAME_LINE);
        if line.fraction > LEAST_RINGING && is_new {
            lines.push(line);
        }
    }
    let place = |line: &Line, zeta: f64| Place {
        gain: (answer * denominator(line.omega, zeta)).re,
        omega: line.omega,
        zeta,
        residual: 1.0,
    };
    lines.iter().flat_map(|line| zetas.iter().map(move |zeta| place(line, *zeta))).collect()
}

/// A ring-down is loudest at its beginning: the whole, and shorter looks that see heavy damping
/// too.
fn looks(values: &[f64]) -> impl Iterator<Item = &[f64]> {
    [1, 4, 16, 64].into_iter().map(|part| &values[..values.len() / part]).filter(|look| look.len() >= 32)
}

/// A peak of a spectrum.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// Angular frequency of the resonance, rad/s.
    omega: f64,
    /// Share of all power that it and two ordinates to each side hold.
    fraction: f64,
}

/// The highest peak of a sequence's spectrum; `None` for a sequence without power.
fn loudest(values: &[f64], rate_hz: f64) -> Option<Line> {
    let spectrum::Density { frequency_hz, density, .. } = spectrum::periodogram(values, rate_hz);
    let total: f64 = density.iter().sum();
    let (at, _) = density.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    let peak = at.saturating_sub(2)..(at + 3).min(density.len());
    let power: f64 = density[peak.clone()].iter().sum();
    // The centre of power is finer than the ordinates.
    let centre = peak.map(|i| density[i] * frequency_hz[i]).sum::<f64>() / power;
    (total > 0.0 && total.is_finite()).then_some(Line { omega: TAU * centre, fraction: power / total })
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

/// Gains, ω₀ in rad/s and ζ at which the reading, whatever is read, answers its input like a resonance; the
/// best one first.
pub(in crate::driven) fn resonances(data: &Data) -> Vec<[f64; 3]> {
    let places = data.input.as_ref().map_or(Vec::new(), |input| by_response(data, input.samples()));
    places.iter().map(|p| [p.gain, p.omega, p.zeta]).collect()
}

fn by_response(data: &Data, input: &[f64]) -> Vec<Place> {
    let (u, y) = (&input[data.hull.clone()], &data.reading[data.hull.clone()]);
    let segment = (y.len() / 6).next_power_of_two().clamp(64, 8192);
    let response = spectrum::response(u, y, data.rate_hz, segment);
    let power = spectrum::welch(u, data.rate_hz, segment);
    let bins = response.frequency_hz.len().min(power.density.len());
    // As displacement answers, with errors of what is read.
    let derivatives = data.observed.output.derivatives();
    let slowest = 1e-3 * TAU * data.rate_hz / segment as f64;
    let (answers, weights): (Vec<Complex64>, Vec<f64>) = (0..bins)
        .map(|i| {
            let w = (TAU * response.frequency_hz[i]).max(slowest);
            let answer = response.gain[i] / Complex64::new(0.0, w).powi(derivatives);
            (answer, power.density[i] * w.powi(2 * derivatives))
        })
        .unzip();
    let total: f64 = (0..bins).map(|i| weights[i] * answers[i].norm_sqr()).sum::<f64>().max(f64::MIN_POSITIVE);
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
                hh += weights[i] * size;
                hy += weights[i] * size * (re * answers[i].re - im * answers[i].im);
            }
            let gain = hy / hh;
            places.push(Place { gain, omega, zeta, residual: 1.0 - hy * hy / hh / total });
        }
        omega *= 1.04;
    }
    polished(places)
}

/// The resonance that the spectra of the fitted range show as a whole, from the best place of a grid
/// on.
fn by_spectra(data: &Data, input: &[f64], best: &Place) -> Option<Place> {
    let from = Rational { gain: best.gain, omega_rad_s: best.omega, zeta: best.zeta };
    let [u, y] = [input, &data.reading].map(|values| &values[data.hull.clone()]);
    let found = rational_fit(u, y, data.rate_hz, from).filter(|found| found.gain != 0.0)?;
    Some(Place { gain: found.gain, omega: found.omega_rad_s, zeta: found.zeta, residual: 1.0 })
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
    let lines = looks(&data.reading[data.hull.clone()]).filter_map(|look| loudest(look, data.rate_hz));
    let place = |line: Line, zeta: f64| Place { gain: 1.0, omega: line.omega, zeta, residual: 0.0 };
    lines.flat_map(|line| SPECTRUM_ZETAS.map(|zeta| place(line, zeta))).collect()
}
