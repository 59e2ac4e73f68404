//! From the mechanical signal to the column in the file: delay, nonlinearity, additive
//! disturbances, noise, rails, steps.

use std::f64::consts::TAU;

use super::physics::{Physics, Scales, Term};
use proofmass_numerics::rng::{Philox, Stream};

/// The signal on a fine grid and how to read it.
#[derive(Debug, Clone)]
pub struct Tap<'a> {
    /// Signal, one value per integration step.
    pub signal: &'a [f64],
    /// Steps before the first sample.
    pub lead: usize,
    /// Fine-grid steps per sample.
    pub substeps: usize,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Input at the samples.
    pub input: &'a [f64],
}

/// Noise of the readout itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// White, standard deviation per sample.
    pub deviation: f64,
    /// Seed of all the readout's random numbers.
    pub seed: u64,
}

/// Reads the signal at a time in steps, by the cubic through four neighbours.
fn between(signal: &[f64], place: f64) -> f64 {
    let last = signal.len() as f64 - 1.0;
    let place = place.clamp(0.0, last);
    let base = (place.floor() as isize - 1).clamp(0, signal.len() as isize - 4) as usize;
    let f = place - base as f64;
    let [a, b, c, d] = [signal[base], signal[base + 1], signal[base + 2], signal[base + 3]];
    let (f1, f2, f3) = (f - 1.0, f - 2.0, f - 3.0);
    -a * f1 * f2 * f3 / 6.0 + b * f * f2 * f3 / 2.0 - c * f * f1 * f3 / 2.0 + d * f * f1 * f2 / 6.0
}

/// The output column, one reading per sample.
pub fn read(tap: &Tap<'_>, terms: &[Term], scales: &Scales, offset: f64, noise: Noise) -> Vec<f64> {
    let steps_per_s = tap.rate_hz * tap.substeps as f64;
    let mut walk_rng = Philox::new(noise.seed, 1, Stream::Host);
    let mut noise_rng = Philox::new(noise.seed, 2, Stream::Host);
    let mut walk = 0.0;
    (0..tap.input.len())
        .map(|n| {
            let t = n as f64 / tap.rate_hz;
            let place = (tap.lead + n * tap.substeps) as f64;
            let late: f64 = terms
                .iter()
                .map(|term| match term.physics {
                    Physics::ReadoutDelay => term.value(scales),
                    Physics::ClockWander => {
                        term.amplitude / scales.omega_rad_s * (TAU * term.shape[0] * t / scales.duration_s).sin()
                    }
                    _ => 0.0,
                })
                .sum();
            let mut y = if late == 0.0 {
                tap.signal[tap.lead + n * tap.substeps]
            } else {
                between(tap.signal, place - late * steps_per_s)
            };
            let bent: f64 = terms
                .iter()
                .filter(|term| term.physics == Physics::ReadoutNonlinearity)
                .map(|term| {
                    let [a2, a3] = [0, 1].map(|i| term.parameters(scales)[i].1);
                    a2 * y * y + a3 * y * y * y
                })
                .sum();
            y += bent + offset;
            for term in terms {
                let a = term.value(scales);
                let [p, q] = term.shape;
                y += match term.physics {
                    Physics::Feedthrough => a * tap.input[n],
                    Physics::BiasDrift => a * t,
                    Physics::WarmUp => a * (-t / (p * scales.duration_s)).exp(),
                    Physics::PeriodicDisturbance => a * (TAU * p * t + q).sin(),
                    Physics::BiasRandomWalk => {
                        walk += a / tap.rate_hz.sqrt() * walk_rng.normal();
                        walk
                    }
                    _ => 0.0,
                };
            }
            y += noise.deviation * noise_rng.normal();
            for term in terms {
                let a = term.value(scales);
                let side = term.shape[1];
                match term.physics {
                    Physics::ReadoutSaturation => {
                        let high = if side >= 0.0 { offset + a } else { f64::INFINITY };
                        let low = if side <= 0.0 { offset - a } else { f64::NEG_INFINITY };
                        y = y.clamp(low, high);
                    }
                    Physics::ReadoutQuantisation => y = (y / a).round() * a,
                    _ => {}
                }
            }
            y
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_reads_the_past() {
        let signal: Vec<f64> = (0..4000).map(|k| (k as f64 * 0.01).sin()).collect();
        let input = vec![0.0; 150];
        let tap = Tap { signal: &signal, lead: 500, substeps: 20, rate_hz: 5.0, input: &input };
        let scales = Scales {
            x: 1.0,
            peak: 1.0,
            v: 1.0,
            u: 1.0,
            duration_s: 30.0,
            omega_rad_s: 1.0,
            damping_rad_s: 0.1,
            gain: 1.0,
        };
        let delay = Term { physics: Physics::ReadoutDelay, amplitude: 0.123, shape: [0.0; 2] };
        let read = read(&tap, &[delay], &scales, 0.5, Noise { deviation: 0.0, seed: 1 });
        for (n, y) in read.iter().enumerate() {
            // One step is 0.01 s of signal time: 100 steps per s, the delay 0.123 s is 12.3 steps.
            let expected = 0.5 + ((500 + 20 * n) as f64 * 0.01 - 0.123).sin();
            assert!((y - expected).abs() < 1e-9, "{n}: {y} {expected}");
        }
    }
}
