//! A sensor at rest as the second generator has it: slow processes on white noise, filters, knocks.

use std::f64::consts::{LN_2, PI, TAU};
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::columns::table;
use super::draw::Draw;
use super::readout::Noise;
use super::truth::Parameter;

/// One process. `size` is in units of the white noise per sample and is what is scaled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "process")]
#[expect(missing_docs, reason = "the line of a variant says what its fields are")]
pub enum Process {
    /// Density ∝ f^−alpha; for alpha = 1 one-sided size²/(πf): bias instability `size`.
    Flicker { size: f64, alpha: f64 },
    /// Random walk, size per √s.
    Walk { size: f64 },
    /// First-order Gauss–Markov, standard deviation size, correlation time in s.
    GaussMarkov { size: f64, tau: f64 },
    /// ±size that switches at random, `dwell` s apart in the mean.
    Popcorn { size: f64, dwell: f64 },
    /// size·(t/T)^p, T the length of the recording.
    Drift { size: f64, p: f64 },
    /// size·e^(−t/τ).
    WarmUp { size: f64, tau: f64 },
    /// size·(e^(−t/τ) + part·e^(−t/(ratio·τ))).
    TwoSpeeds { size: f64, tau: f64, part: f64, ratio: f64 },
    /// Sine whose frequency changes by `chirp` of itself over the recording.
    Sine { size: f64, hz: f64, phase: f64, chirp: f64 },
    /// size per unit of temperature; `square` adds a parabola, `lag` in s follows late, `play` in
    /// units of temperature.
    Temperature { size: f64, square: f64, lag: f64, play: f64 },
    /// One step at a part of the recording.
    Jump { size: f64, at: f64 },
}

/// Holds what a chip does to the white noise before it is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "filter")]
#[expect(missing_docs, reason = "the line of a variant says what its fields are")]
pub enum Filter {
    /// White noise as drawn.
    None,
    /// Mean of this many samples.
    Mean { taps: usize },
    /// Two equal poles, neighbour correlation of each.
    TwoPoles { pole: f64 },
}

/// Recipe of a static recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Still {
    /// Seed of what is random in it.
    pub seed: u64,
    /// Rows per second.
    pub rate_hz: f64,
    /// Number of rows in the recording.
    pub rows: usize,
    /// White noise per sample of each channel, column units.
    pub sigma: Vec<f64>,
    /// Mean of each channel.
    pub mean: Vec<f64>,
    /// Processes, each with its weight in every channel.
    pub processes: Vec<(Process, Vec<f64>)>,
    /// Law of the white noise.
    pub noise: Noise,
    /// On-chip filter.
    pub filter: Filter,
    /// Step of the reading; zero when written in full.
    pub step: f64,
    /// Knocks: part of the recording, rows, height in σ.
    pub knocks: Vec<[f64; 3]>,
    /// States whether the temperature column is written.
    pub temperature: bool,
    /// The promised density over the true one, where the data sheet is given.
    pub promised: Option<f64>,
    /// Unit of the channels, as stated in model.toml.
    pub unit: String,
    /// Headings of the channels.
    pub headings: Vec<String>,
}

/// A first-order Gauss–Markov series of unit variance from its stationary law.
fn gauss_markov(rows: usize, correlation: f64, draw: &mut Draw) -> Vec<f64> {
    let (mut value, fresh) = (draw.normal(), (1.0 - correlation * correlation).max(0.0).sqrt());
    (0..rows)
        .map(|_| {
            let now = value;
            value = correlation * value + fresh * draw.normal();
            now
        })
        .collect()
}

/// Correlation times, in rows, and sizes of the Gauss–Markov terms that noise ∝ f^−alpha is made
/// of: an octave apart from the sample to twenty times the recording. For alpha = 1 their sum has
/// the density size²/(πf): each has variance ln 2/π (Σ 4τ/(1 + (ωτ)²) → 1/(f·ln 2)).
pub(crate) fn relaxations(rows: usize, alpha: f64) -> impl Iterator<Item = [f64; 2]> {
    let octaves = ((20.0 * rows as f64).log2().ceil() as i32).max(1);
    (-2..=octaves).map(move |k| {
        let tau = 2f64.powi(k);
        [tau, (LN_2 / PI * tau.powf(alpha - 1.0)).sqrt()]
    })
}

/// Noise ∝ f^−alpha.
pub(crate) fn flicker(rows: usize, alpha: f64, draw: &mut Draw) -> Vec<f64> {
    let mut sum = vec![0.0; rows];
    for [tau, size] in relaxations(rows, alpha) {
        let series = gauss_markov(rows, (-1.0 / tau).exp(), draw);
        sum.iter_mut().zip(series).for_each(|(s, v)| *s += size * v);
    }
    sum
}

impl Still {
    /// Temperature at each row: a room that breathes, a device that warms.
    pub fn temperatures(&self) -> Vec<f64> {
        let mut draw = Draw::new(self.seed, 0, 41);
        let (rise, tau) = (draw.between(1.0, 8.0), draw.between(0.1, 0.6));
        let (swing, periods, phase) = (draw.between(0.5, 3.0), draw.between(0.7, 4.0), TAU * draw.unit());
        (0..self.rows)
            .map(|n| {
                let part = n as f64 / self.rows as f64;
                22.0 + rise * (1.0 - (-part / tau).exp()) + swing * (TAU * periods * part + phase).sin()
            })
            .collect()
    }

    /// A process of unit size, at each row.
    fn course(&self, process: &Process, purpose: u64) -> Vec<f64> {
        let (rows, dt) = (self.rows, 1.0 / self.rate_hz);
        let length_s = rows as f64 * dt;
        let mut draw = Draw::new(self.seed, purpose, 42);
        let of_time = |f: &dyn Fn(f64) -> f64| (0..rows).map(|n| f(n as f64 * dt)).collect::<Vec<f64>>();
        match *process {
            Process::Flicker { alpha, .. } => flicker(rows, alpha, &mut draw),
            Process::Walk { .. } => {
                let mut value = 0.0;
                let mut next = || {
                    value += dt.sqrt() * draw.normal();
                    value
                };
                (0..rows).map(|_| next()).collect()
            }
            Process::GaussMarkov { tau, .. } => gauss_markov(rows, (-dt / tau).exp(), &mut draw),
            Process::Popcorn { dwell, .. } => {
                let (mut sign, mut until) = (draw.sign(), dwell * draw.exponential());
                let mut values = Vec::with_capacity(rows);
                for n in 0..rows {
                    while n as f64 * dt > until {
                        sign = -sign;
                        until += dwell * draw.exponential();
                    }
                    values.push(sign);
                }
                values
            }
            Process::Drift { p, .. } => of_time(&|t| (t / length_s).powf(p)),
            Process::WarmUp { tau, .. } => of_time(&|t| (-t / tau).exp()),
            Process::TwoSpeeds { tau, part, ratio, .. } => {
                of_time(&|t| (-t / tau).exp() + part * (-t / (ratio * tau)).exp())
            }
            Process::Sine { hz, phase, chirp, .. } => {
                of_time(&|t| (TAU * hz * t * (1.0 + 0.5 * chirp * t / length_s) + phase).sin())
            }
            Process::Temperature { square, lag, play, .. } => {
                let t = self.temperatures();
                let (mut late, mut held) = (t[0], t[0]);
                t.iter()
                    .map(|now| {
                        late += if lag > 0.0 { (now - late) * (1.0 - (-dt / lag).exp()) } else { now - late };
                        held = if play > 0.0 { held.clamp(late - play, late + play) } else { late };
                        let above = held - 22.0;
                        above + square * above * above
                    })
                    .collect()
            }
            Process::Jump { at, .. } => of_time(&|t| f64::from(u8::from(t > at * length_s))),
        }
    }

    /// Returns what the n-th process does to a channel, in units of its σ.
    pub fn effect(&self, n: usize, channel: usize) -> Vec<f64> {
        let (process, weights) = &self.processes[n];
        // Random processes of different channels are apart; known courses are common.
        let purpose = 100 * n as u64 + if process.is_random() { channel as u64 } else { 0 };
        let size = process.size() * weights[channel];
        if size == 0.0 {
            return vec![0.0; self.rows];
        }
        self.course(process, purpose).iter().map(|v| size * v).collect()
    }

    /// Readings of a channel.
    pub fn readings(&self, channel: usize) -> Vec<f64> {
        let mut draw = Draw::new(self.seed, channel as u64, 43);
        let flat = vec![0.0; self.rows];
        let mut white = self.noise.series(&flat, &mut draw);
        self.filter.apply(&mut white);
        for n in 0..self.processes.len() {
            white.iter_mut().zip(self.effect(n, channel)).for_each(|(w, e)| *w += e);
        }
        for [part, rows, height] in &self.knocks {
            let first = (part * self.rows as f64) as usize;
            for (k, w) in white.iter_mut().skip(first).take(*rows as usize).enumerate() {
                *w += height * (-(k as f64) / 3.0).exp() * if k % 2 == 0 { 1.0 } else { -1.0 };
            }
        }
        let (sigma, mean) = (self.sigma[channel], self.mean[channel]);
        let round = |v: f64| if self.step > 0.0 { self.step * (v / self.step).round() } else { v };
        white.iter().map(|w| round(mean + sigma * w)).collect()
    }

    /// Intervals are held against these.
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut found = Vec::new();
        let length_s = self.rows as f64 / self.rate_hz;
        for (channel, heading) in self.headings.iter().enumerate() {
            let mut add = |id: &str, name: &str, value: f64| {
                found.push(Parameter { id: id.into(), channel: Some(heading.clone()), name: name.into(), value });
            };
            for (process, weights) in &self.processes {
                let size = process.size() * weights[channel] * self.sigma[channel];
                if size == 0.0 {
                    continue;
                }
                match *process {
                    Process::Flicker { alpha: 1.0, .. } => add("flicker-noise", "B", size.abs()),
                    Process::Walk { .. } => add("random-walk", "K", size.abs()),
                    Process::GaussMarkov { tau, .. } => {
                        add("gauss-markov", "sigma", size.abs());
                        add("gauss-markov", "T", tau);
                    }
                    Process::Drift { p: 1.0, .. } => add("rate-ramp", "rate", size / length_s),
                    Process::WarmUp { tau, .. } => {
                        add("warm-up", "amplitude", size);
                        add("warm-up", "T", tau);
                    }
                    Process::Sine { hz, chirp: 0.0, .. } => {
                        add("sinusoid", "amplitude", size.abs());
                        add("sinusoid", "frequency", hz);
                    }
                    Process::Temperature { square, lag, play, .. } if square == 0.0 && lag == 0.0 && play == 0.0 => {
                        add("temperature-sensitivity", "slope", size);
                    }
                    _ => {}
                }
            }
            if self.promised.is_some_and(|p| p != 1.0) {
                add("white-noise", "density", self.sigma[channel] * (2.0 / self.rate_hz).sqrt());
            }
            if self.step > 0.0 {
                add("quantisation-noise", "step", self.step);
            }
        }
        found
    }

    /// Texts of recording.csv and model.toml.
    pub fn texts(&self) -> [String; 2] {
        let readings: Vec<Vec<f64>> = (0..self.sigma.len()).map(|c| self.readings(c)).collect();
        let mut columns: Vec<(&str, &[f64])> =
            self.headings.iter().zip(&readings).map(|(h, r)| (h.as_str(), r.as_slice())).collect();
        let mut model = format!(
            "kind = \"static\"\nrate_hz = {}\nunit = {:?}\n[columns]\nchannels = {:?}\n",
            self.rate_hz, self.unit, self.headings
        );
        let temperatures = if self.temperature { self.temperatures() } else { Vec::new() };
        if self.temperature {
            columns.push(("temp_C", &temperatures));
            model += "environment = [\"temp_C\"]\n";
        }
        if let Some(over) = self.promised {
            let density = over * self.sigma[0] * (2.0 / self.rate_hz).sqrt();
            let _ = write!(model, "[noise]\ndensity = {density:e}\n");
        }
        [table(&columns), model]
    }
}

impl Process {
    /// The number that scales the process.
    pub fn size(&self) -> f64 {
        let mut copy = *self;
        *copy.size_mut()
    }

    /// The number to scale.
    pub fn size_mut(&mut self) -> &mut f64 {
        match self {
            Self::Flicker { size, .. }
            | Self::Walk { size }
            | Self::GaussMarkov { size, .. }
            | Self::Popcorn { size, .. }
            | Self::Drift { size, .. }
            | Self::WarmUp { size, .. }
            | Self::TwoSpeeds { size, .. }
            | Self::Sine { size, .. }
            | Self::Temperature { size, .. }
            | Self::Jump { size, .. } => size,
        }
    }

    /// Returns whether it has no course that could be known.
    pub fn is_random(&self) -> bool {
        matches!(self, Self::Flicker { .. } | Self::Walk { .. } | Self::GaussMarkov { .. } | Self::Popcorn { .. })
    }
}

impl Filter {
    /// Filters to unit rms.
    fn apply(&self, values: &mut [f64]) {
        match *self {
            Self::None => return,
            Self::Mean { taps } => {
                let fresh = values.to_vec();
                for (n, v) in values.iter_mut().enumerate() {
                    *v = fresh[n.saturating_sub(taps - 1)..=n].iter().sum::<f64>();
                }
            }
            Self::TwoPoles { pole } => {
                for _ in 0..2 {
                    let mut last = 0.0;
                    for v in values.iter_mut() {
                        last = pole * last + *v;
                        *v = last;
                    }
                }
            }
        }
        let rms = super::driven::rms(values).max(1e-300);
        values.iter_mut().for_each(|v| *v /= rms);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Allan deviation of flicker noise: √(2 ln 2/π)·B = 0.664 B at any averaging time well inside
    // the recording.
    #[test]
    fn flicker_has_its_allan_floor_and_a_walk_does_not() {
        let mut draw = Draw::new(2, 0, 0);
        let values = flicker(1 << 18, 1.0, &mut draw);
        let allan = |values: &[f64], m: usize| {
            let means: Vec<f64> = values.chunks_exact(m).map(|c| c.iter().sum::<f64>() / m as f64).collect();
            (means.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>() / (2 * (means.len() - 1)) as f64).sqrt()
        };
        for m in [32, 256, 2048] {
            assert!((allan(&values, m) / 0.664 - 1.0).abs() < 0.08, "{m}: {}", allan(&values, m));
        }
        let steep = flicker(1 << 18, 1.3, &mut draw);
        assert!(allan(&steep, 2048) / allan(&steep, 32) > 1.4, "steeper noise rises: control");
    }
}
