//! The input between its samples: band-limited, straight lines or steps, on the grid that the
//! integrator asks for.

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::OnceLock;

/// Interpolation of the input from one sample to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// Nothing above half the sampling rate: windowed sinc.
    BandLimited,
    /// Linear interpolation between samples.
    Linear,
    /// Each value held until the next.
    Hold,
}

impl Interpolation {
    /// Returns a phrase for messages: how the input runs between its samples.
    pub fn words(self) -> &'static str {
        match self {
            Interpolation::BandLimited => "band-limited",
            Interpolation::Linear => "straight lines",
            Interpolation::Hold => "steps (held)",
        }
    }
}

/// Samples on either side that the windowed sinc looks at; runs keep this far from the ends of a
/// recording.
pub(crate) const REACH: usize = 24;
/// Most integration steps per sample.
pub(crate) const MOST_STEPS: usize = 32;

/// Samples of the input, and denser grids made from them once.
#[derive(Debug, Clone)]
pub struct Input {
    samples: Vec<f64>,
    /// Recordings, and the samples of each that are used; empty where the input is one recording as
    /// a whole.
    pieces: Vec<(Vec<f64>, Range<usize>)>,
    /// Interpolation between samples.
    pub interpolation: Interpolation,
    dense: Vec<OnceLock<Vec<f64>>>,
}

impl Input {
    /// An input with this interpolation.
    pub fn new(samples: Vec<f64>, interpolation: Interpolation) -> Self {
        Self { samples, pieces: Vec::new(), interpolation, dense: (0..=MOST_STEPS).map(|_| OnceLock::new()).collect() }
    }

    /// Parts of several inputs one after another, none of which is interpolated across the end of
    /// its own.
    pub fn joined(pieces: Vec<(Vec<f64>, Range<usize>)>, interpolation: Interpolation) -> Self {
        let samples = pieces.iter().flat_map(|(all, used)| &all[used.clone()]).copied().collect();
        Self { pieces, ..Self::new(samples, interpolation) }
    }

    /// The same samples with another interpolation.
    pub fn gone(self, interpolation: Interpolation) -> Self {
        Self { pieces: self.pieces, ..Self::new(self.samples, interpolation) }
    }

    /// Samples of the input, in its own unit.
    pub fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// Values at every half step for `steps` per sample: index `2·steps·k` is sample k. For a held
    /// input the value at a jump is the one after it; the integrator never asks for the end of an
    /// interval that way (see [`Input::end`]).
    pub fn grid(&self, steps: usize) -> &[f64] {
        let steps = steps.clamp(1, MOST_STEPS);
        self.dense[steps].get_or_init(|| self.densified(2 * steps))
    }

    fn densified(&self, factor: usize) -> Vec<f64> {
        if self.pieces.is_empty() {
            return densify(&self.samples, factor, self.interpolation);
        }
        let of_piece = |(all, used): &(Vec<f64>, Range<usize>)| {
            densify(all, factor, self.interpolation)[used.start * factor..used.end * factor].to_vec()
        };
        self.pieces.iter().flat_map(of_piece).collect()
    }

    /// Returns how far before the end of a step its last value is read, in grid points: 1 for a
    /// held input, whose value at the end still is the one from its beginning.
    pub fn end(&self) -> usize {
        usize::from(self.interpolation == Interpolation::Hold)
    }
}

fn densify(samples: &[f64], factor: usize, interpolation: Interpolation) -> Vec<f64> {
    let n = samples.len();
    let at = |i: isize| samples[i.clamp(0, n as isize - 1) as usize];
    let mut dense = vec![0.0; n * factor];
    for phase in 0..factor {
        let t = phase as f64 / factor as f64;
        let taps: Vec<f64> = match interpolation {
            Interpolation::BandLimited if phase > 0 => kernel(t),
            Interpolation::Linear if phase > 0 => vec![1.0 - t, t],
            _ => vec![1.0],
        };
        let first = if taps.len() > 2 { 1 - REACH as isize } else { 0 };
        for k in 0..n {
            let from = k as isize + first;
            dense[k * factor + phase] = if from >= 0 && from as usize + taps.len() <= n {
                let window = &samples[from as usize..from as usize + taps.len()];
                window.iter().zip(&taps).map(|(s, w)| s * w).sum()
            } else {
                taps.iter().enumerate().map(|(j, w)| w * at(from + j as isize)).sum()
            };
        }
    }
    dense
}

/// Kaiser-windowed sinc (β = 9: side lobes below −90 dB), normalised to pass a constant.
fn kernel(t: f64) -> Vec<f64> {
    let half = REACH as f64;
    let weights: Vec<f64> = (0..2 * REACH)
        .map(|j| {
            let d = t - (j as f64 - (half - 1.0));
            let sinc = if d.abs() < 1e-12 { 1.0 } else { (PI * d).sin() / (PI * d) };
            let edge = 1.0 - (d / half).powi(2);
            if edge <= 0.0 { 0.0 } else { sinc * bessel_i0(9.0 * edge.sqrt()) / bessel_i0(9.0) }
        })
        .collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|w| w / sum).collect()
}

fn bessel_i0(x: f64) -> f64 {
    let mut term = 1.0;
    let mut sum = 1.0;
    for k in 1..60 {
        term *= (0.5 * x / f64::from(k)).powi(2);
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tone_below_nyquist_is_restored_between_samples_and_not_by_straight_lines() {
        let tone = |t: f64| (2.0 * PI * 0.35 * t + 0.3).sin();
        let samples: Vec<f64> = (0..200).map(|k| tone(k as f64)).collect();
        let worst = |how| {
            let input = Input::new(samples.clone(), how);
            let grid = input.grid(2);
            (120..600).map(|i| (grid[i] - tone(i as f64 / 4.0)).abs()).fold(0.0, f64::max)
        };
        assert!(worst(Interpolation::BandLimited) < 1e-4, "{}", worst(Interpolation::BandLimited));
        assert!(worst(Interpolation::Linear) > 0.1);
    }

    #[test]
    fn joined_inputs_keep_what_lies_beyond_their_ends() {
        let tone = |t: f64| (2.0 * PI * 0.35 * t + 0.3).sin();
        let samples: Vec<f64> = (0..200).map(|k| tone(k as f64)).collect();
        let whole = Input::new(samples.clone(), Interpolation::BandLimited);
        let joined = Input::joined(vec![(samples.clone(), 30..60), (samples, 100..150)], Interpolation::BandLimited);
        let (whole, joined) = (whole.grid(3), joined.grid(3));
        assert_eq!(joined, [&whole[6 * 30..6 * 60], &whole[6 * 100..6 * 150]].concat());
    }
}
