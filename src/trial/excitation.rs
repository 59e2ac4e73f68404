//! Inputs in closed form: a value at any time, so that the generator never interpolates samples.
//!
//! Phases and frequencies follow from a seed; the document that holds the truth stays small.

use std::f64::consts::TAU;

use rand::RngExt;
use serde::{Deserialize, Serialize};

use proofmass_numerics::rng::{Philox, Stream};

/// Holds what drives the proof mass, in the input's unit. Time zero is the first recorded sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Excitation {
    /// Nothing: a free ring-down.
    None,
    /// Equally spaced lines of equal amplitude with random phases.
    Multisine(Lines),
    /// Lines at random frequencies with Rayleigh amplitudes: a band-limited Gaussian signal.
    Random(Lines),
    /// A sine whose frequency rises linearly.
    Sweep {
        /// Amplitude, in the unit of the input.
        amplitude: f64,
        /// Frequency at time zero.
        from_hz: f64,
        /// Frequency at the end.
        to_hz: f64,
        /// Length of the sweep, s.
        duration_s: f64,
    },
    /// A recorded input, taken as band-limited between its samples.
    Recorded {
        /// From time zero on.
        samples: Vec<f64>,
        /// Sampling rate, Hz.
        rate_hz: f64,
    },
}

/// A sum of sines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lines {
    /// Root mean square at full envelope.
    pub rms: f64,
    /// Lowest frequency, Hz.
    pub from_hz: f64,
    /// Highest frequency, Hz.
    pub to_hz: f64,
    /// Number of lines.
    pub count: usize,
    /// Envelope at time zero; it rises linearly to one at `duration_s`.
    pub envelope_start: f64,
    /// Length of the recording, s.
    pub duration_s: f64,
    /// Of phases and, for a random signal, frequencies and amplitudes.
    pub seed: u64,
}

/// One sine: frequency in rad/s, amplitude, phase.
type Line = [f64; 3];

impl Lines {
    fn expand(&self, random: bool) -> Vec<Line> {
        let mut rng = Philox::new(self.seed, 0, Stream::Excitation);
        let mut lines: Vec<Line> = (0..self.count)
            .map(|k| {
                let place = if random { rng.random::<f64>() } else { k as f64 / (self.count.max(2) - 1) as f64 };
                let amplitude = if random { (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt() } else { 1.0 };
                [TAU * (self.from_hz + place * (self.to_hz - self.from_hz)), amplitude, TAU * rng.random::<f64>()]
            })
            .collect();
        let power: f64 = lines.iter().map(|l| l[1] * l[1] / 2.0).sum();
        lines.iter_mut().for_each(|l| l[1] *= self.rms / power.sqrt());
        lines
    }

    fn envelope(&self, t_s: f64) -> f64 {
        // Before time zero the envelope keeps its first value, so that the run-in has the
        // recording's amplitude.
        self.envelope_start + (1.0 - self.envelope_start) * (t_s / self.duration_s).max(0.0)
    }
}

impl Excitation {
    /// Multiplies the amplitude.
    pub fn scale(&mut self, by: f64) {
        match self {
            Self::None => {}
            Self::Multisine(lines) | Self::Random(lines) => lines.rms *= by,
            Self::Sweep { amplitude, .. } => *amplitude *= by,
            Self::Recorded { samples, .. } => samples.iter_mut().for_each(|u| *u *= by),
        }
    }

    /// Values at `start_s + k·step_s` for k < `count`; sines advance by rotation, renewed from
    /// their phase every 64 steps.
    pub fn tabulate(&self, start_s: f64, step_s: f64, count: usize) -> Vec<f64> {
        let (spec, lines) = match self {
            Self::None => return vec![0.0; count],
            Self::Recorded { samples, rate_hz } => {
                return (0..count).map(|k| band_limited(samples, (start_s + k as f64 * step_s) * rate_hz)).collect();
            }
            Self::Multisine(spec) => (spec, spec.expand(false)),
            Self::Random(spec) => (spec, spec.expand(true)),
            Self::Sweep { amplitude, from_hz, to_hz, duration_s } => {
                let phase = |t: f64| TAU * (from_hz * t + (to_hz - from_hz) * t * t / (2.0 * duration_s));
                return (0..count).map(|k| amplitude * phase(start_s + k as f64 * step_s).sin()).collect();
            }
        };
        let mut values = vec![0.0; count];
        for [omega, amplitude, phase] in lines {
            let (turn_sin, turn_cos) = (omega * step_s).sin_cos();
            for (block, chunk) in values.chunks_mut(64).enumerate() {
                let angle = omega * (start_s + (block * 64) as f64 * step_s) + phase;
                let (mut sine, mut cosine) = (amplitude * angle.sin(), amplitude * angle.cos());
                for value in chunk {
                    *value += sine;
                    (sine, cosine) = (sine * turn_cos + cosine * turn_sin, cosine * turn_cos - sine * turn_sin);
                }
            }
        }
        for (k, value) in values.iter_mut().enumerate() {
            *value *= spec.envelope(start_s + k as f64 * step_s);
        }
        values
    }
}

/// Samples on either side that the interpolation looks at.
const REACH: isize = 16;

/// Between samples by a sinc under a Hann window; beyond the ends the last value holds.
fn band_limited(samples: &[f64], place: f64) -> f64 {
    let nearest = place.round();
    if (place - nearest).abs() < 1e-9 {
        return samples[(nearest.max(0.0) as usize).min(samples.len() - 1)];
    }
    let base = place.floor() as isize;
    // sin π(place − k) alternates in sign from tap to tap: one sine serves them all.
    let sine = (std::f64::consts::PI * (place - base as f64)).sin();
    let mut sum = 0.0;
    let mut weights = 0.0;
    for k in base - REACH + 1..=base + REACH {
        let distance = place - k as f64;
        let sign = if (k - base) % 2 == 0 { 1.0 } else { -1.0 };
        let window = 0.5 + 0.5 * (std::f64::consts::PI * distance / REACH as f64).cos();
        let weight = sign * sine / (std::f64::consts::PI * distance) * window;
        sum += weight * samples[k.clamp(0, samples.len() as isize - 1) as usize];
        weights += weight;
    }
    sum / weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_the_sum_of_its_sines_and_has_the_rms_asked_for() {
        let spec =
            Lines { rms: 2.0, from_hz: 1.0, to_hz: 40.0, count: 40, envelope_start: 1.0, duration_s: 10.0, seed: 3 };
        let table = Excitation::Multisine(spec.clone()).tabulate(-0.5, 1e-3, 10_000);
        let direct = |t: f64| -> f64 { spec.expand(false).iter().map(|l| l[1] * (l[0] * t + l[2]).sin()).sum() };
        for k in [0, 63, 64, 9_999] {
            assert!((table[k] - direct(-0.5 + k as f64 * 1e-3)).abs() < 1e-10);
        }
        let rms = (table.iter().map(|v| v * v).sum::<f64>() / 1e4).sqrt();
        assert!((rms - 2.0).abs() < 1e-9, "whole periods of every line: {rms}");
    }

    // Error of a 32-tap Hann-windowed sinc at 0.3 of the rate, measured 1e-4: below every noise a
    // recording has.
    #[test]
    fn a_recorded_sine_is_found_again_between_its_samples() {
        let samples: Vec<f64> = (0..400).map(|n| (TAU * 0.3 * n as f64).sin()).collect();
        let table = Excitation::Recorded { samples, rate_hz: 10.0 }.tabulate(10.0, 0.01, 1000);
        for (k, value) in table.iter().enumerate() {
            let expected = (TAU * 3.0 * (10.0 + k as f64 * 0.01)).sin();
            assert!((value - expected).abs() < 1e-3, "{k}: {value} {expected}");
        }
    }
}
