//! Noise and drift as they are planted: made from their definitions, not from the laws that are
//! fitted.

use proofmass::rng::Philox;
use rand::{Rng, RngExt as _};
use rand_distr::StandardNormal;

/// White noise of unit size.
pub fn white(count: usize, rng: &mut impl Rng) -> Vec<f64> {
    (0..count).map(|_| rng.sample(StandardNormal)).collect()
}

/// Mean zero, rms `size`.
pub fn sized(mut values: Vec<f64>, size: f64) -> Vec<f64> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let rms = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt();
    values.iter_mut().for_each(|v| *v = (*v - mean) / rms * size);
    values
}

/// So many values of an effect.
pub type Plant = fn(usize, &mut Philox) -> Vec<f64>;

/// A Gauss–Markov process of unit size.
pub fn relaxation(count: usize, memory: f64, rng: &mut Philox) -> Vec<f64> {
    let keep = (-1.0 / memory).exp();
    let mut state: f64 = rng.sample(StandardNormal);
    white(count, rng)
        .into_iter()
        .map(|n| {
            state = keep * state + (1.0 - keep * keep).sqrt() * n;
            state
        })
        .collect()
}

/// A random walk of unit steps.
pub fn walk(count: usize, rng: &mut Philox) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = white(count, rng);
    steps
        .into_iter()
        .map(|n| {
            sum += n;
            sum
        })
        .collect()
}

/// White noise of unit size summed exponent/2 times from the first sample on (Kasdin, Proceedings
/// of the IEEE 83, 1995): its density is (2 sin(ω/2))^−exponent to the letter, at all frequencies.
pub fn fractional(count: usize, exponent: f64, rng: &mut Philox) -> Vec<f64> {
    let mut response = vec![1.0; count];
    for k in 1..count {
        response[k] = response[k - 1] * (k as f64 - 1.0 + 0.5 * exponent) / k as f64;
    }
    let steps = white(count, rng);
    (0..count).map(|n| (0..=n).map(|k| response[k] * steps[n - k]).sum()).collect()
}

/// A sum of relaxations in octaves.
pub fn flicker(count: usize, rng: &mut Philox) -> Vec<f64> {
    let mut out = vec![0.0; count];
    for octave in 0..16 {
        out.iter_mut().zip(relaxation(count, 2f64.powi(octave), rng)).for_each(|(o, v)| *o += v);
    }
    out
}

/// Effects by id, each of the same rms as the white noise or half of it.
pub const PLANTED: [(&str, f64, Plant); 6] = [
    ("rate-ramp", 0.5, |n, _| (0..n).map(|i| i as f64).collect()),
    ("warm-up", 0.7, |n, _| (0..n).map(|i| (-(i as f64) / (0.1 * n as f64)).exp()).collect()),
    ("sinusoid", 0.5, |n, _| (0..n).map(|i| (0.317 * i as f64 + 0.4).sin()).collect()),
    ("random-walk", 2.0, walk),
    ("flicker-noise", 1.5, flicker),
    ("gauss-markov", 1.0, |n, rng| relaxation(n, 60.0, rng)),
];

/// As a filter in a sensor: 16 % of the power is left at the highest frequency.
pub fn smoothed(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|w| 0.7 * w[0] + 0.3 * w[1]).collect()
}
