//! Sensors at rest: three channels of white noise, and slow or coloured things planted into some of
//! them.
//!
//! Each process is made from its own definition (a walk is a sum, flicker a sum of relaxations,
//! temperature a smooth curve), not with the sensor models that the tool fits.

use std::f64::consts::TAU;

use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

use super::catalogue::catalogue;
use super::plant::{log_uniform, sign, uniform};
use proofmass_numerics::rng::{Philox, Stream};

catalogue! {
    /// Holds what can be planted at rest: white level off the datasheet's, rounding, 1/f, a running
    /// sum of white noise, a straight line, first-order coloured noise, a pickup, an exponential
    /// settling, all channels following a temperature.
    Slow
    library {
        WhiteNoise,
        QuantisationNoise,
        FlickerNoise,
        RandomWalk,
        RateRamp,
        GaussMarkov,
        Sinusoid,
        WarmUp,
        TemperatureSensitivity,
    }
    foreign {
        BurstNoise = "a bias that jumps between two levels now and then (popcorn noise)",
        BiasJump = "a bias that changes once, suddenly",
        SparseSpikes = "rare single readings far off",
        SweptPickup = "a pickup whose frequency runs through the band",
        GrowingNoise = "a white noise that grows during the recording",
    }
}

use Slow::*;

/// A slow or coloured process planted into channels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Process {
    /// Kind of process.
    pub slow: Slow,
    /// rms about its mean over the white noise; the step over the white noise for quantisation; the
    /// factor on the promised level for white noise.
    pub size: f64,
    /// Time constant in s (Gauss–Markov, warm-up), mean dwell in s (burst), frequency in Hz
    /// (sinusoid; the lowest of a sweep), instant in s (jump); else unused.
    pub scale: f64,
    /// Signed share per channel; zero where a channel is untouched.
    pub channels: [f64; 3],
}

/// The numbers of a case at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Still {
    /// Seed of every process in the case.
    pub seed: u64,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Number of rows.
    pub samples: usize,
    /// Standard deviation of the white noise per channel.
    pub white: [f64; 3],
    /// Constant reading of each channel.
    pub bias: [f64; 3],
    /// Planted processes.
    pub planted: Vec<Process>,
    /// States whether the model states the datasheet's density (then the smallest channel's is
    /// stated, all being equal).
    pub promised: bool,
    /// States whether the temperature is given as a column.
    pub temperature_given: bool,
}

/// Columns as the file will hold them.
#[derive(Debug, Clone, PartialEq)]
pub struct Channels {
    /// Readings of the three channels.
    pub readings: [Vec<f64>; 3],
    /// Temperature column, °C, where it is given.
    pub temperature: Option<Vec<f64>>,
}

/// Mean zero and rms one.
fn normalise(values: &mut [f64]) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let rms = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt().max(f64::MIN_POSITIVE);
    values.iter_mut().for_each(|v| *v = (*v - mean) / rms);
}

/// First-order noise with unit variance from its stationary law.
fn relaxation(rng: &mut Philox, samples: usize, steps: f64) -> Vec<f64> {
    let keep = (-1.0 / steps).exp();
    let mut state = rng.normal();
    (0..samples)
        .map(|_| {
            let now = state;
            state = keep * state + (1.0 - keep * keep).sqrt() * rng.normal();
            now
        })
        .collect()
}

impl Process {
    /// rms of what it adds over the white noise, in the channel that shows it most.
    pub fn visible(&self) -> f64 {
        let most = self.channels.iter().fold(0.0f64, |m, c| m.max(c.abs()));
        match self.slow {
            WhiteNoise => (self.size * self.size - 1.0).abs().sqrt(),
            QuantisationNoise => self.size / 12f64.sqrt(),
            _ => self.size * most,
        }
    }
}

impl Still {
    /// A sensor with nothing planted.
    pub fn bare(rng: &mut impl Rng, samples: usize) -> Self {
        let level = log_uniform(rng, 1e-4, 1e-1);
        Self {
            seed: rng.random(),
            rate_hz: log_uniform(rng, 10.0, 400.0),
            samples,
            white: [level; 3],
            bias: [0, 1, 2].map(|_| level * uniform(rng, -30.0, 30.0)),
            planted: Vec::new(),
            promised: rng.random::<f64>() < 0.3,
            temperature_given: false,
        }
    }

    /// Plants a process of the size asked (see [`Process::size`]).
    pub fn plant(&mut self, rng: &mut impl Rng, slow: Slow, size: f64) {
        let duration_s = self.samples as f64 / self.rate_hz;
        let scale = match slow {
            GaussMarkov => log_uniform(rng, 30.0, 1000.0) / self.rate_hz,
            WarmUp => duration_s * log_uniform(rng, 0.03, 0.3),
            Sinusoid => self.rate_hz * log_uniform(rng, 1e-3, 0.4),
            BurstNoise => duration_s / uniform(rng, 5.0, 20.0),
            BiasJump => duration_s * uniform(rng, 0.25, 0.75),
            SweptPickup => self.rate_hz * log_uniform(rng, 1e-3, 0.1),
            _ => 0.0,
        };
        let everywhere = matches!(slow, TemperatureSensitivity | WhiteNoise | QuantisationNoise);
        let mut channels = [0.0; 3].map(|_: f64| if everywhere || rng.random::<f64>() < 0.6 { sign(rng) } else { 0.0 });
        if channels.iter().all(|c| *c == 0.0) {
            channels[0] = 1.0;
        }
        if slow == TemperatureSensitivity {
            // Axes differ in how strongly they follow.
            channels = channels.map(|c| c * uniform(rng, 0.6, 1.0));
        }
        if slow == WhiteNoise {
            self.promised = true;
        }
        self.planted.push(Process { slow, size, scale, channels });
    }

    /// A smooth day: slow sines with random phases, rms one.
    fn temperature(&self) -> Vec<f64> {
        let mut rng = Philox::new(self.seed, 77, Stream::Host);
        let waves: Vec<[f64; 3]> = (0..4)
            .map(|k| [1.0 / (1 + k) as f64, rng.random_range(0.5..1.2) * (1 + k) as f64, TAU * rng.random::<f64>()])
            .collect();
        let mut curve: Vec<f64> = (0..self.samples)
            .map(|n| n as f64 / self.samples as f64)
            .map(|t| waves.iter().map(|[a, f, phase]| a * (TAU * f * t + phase).sin()).sum())
            .collect();
        normalise(&mut curve);
        curve
    }

    /// A process in one channel, in units of the white noise.
    fn realise(&self, process: &Process, channel: usize, temperature: &[f64]) -> Vec<f64> {
        let mut rng = Philox::new(self.seed, 10 + channel as u64, Stream::Host);
        let n = self.samples;
        let mut values: Vec<f64> = match process.slow {
            WhiteNoise | QuantisationNoise => return vec![0.0; n],
            FlickerNoise => {
                // Relaxations an octave apart, from one sample to four records, have a spectrum 1/f
                // in between.
                let octaves = (4.0 * n as f64).log2().ceil() as i32;
                let parts: Vec<Vec<f64>> = (0..octaves).map(|k| relaxation(&mut rng, n, 2f64.powi(k))).collect();
                (0..n).map(|i| parts.iter().map(|p| p[i]).sum()).collect()
            }
            RandomWalk => {
                let mut sum = 0.0;
                (0..n)
                    .map(|_| {
                        sum += rng.normal();
                        sum
                    })
                    .collect()
            }
            RateRamp => (0..n).map(|i| i as f64).collect(),
            GaussMarkov => relaxation(&mut rng, n, process.scale * self.rate_hz),
            Sinusoid => {
                let phase = TAU * rng.random::<f64>();
                (0..n).map(|i| (TAU * process.scale * i as f64 / self.rate_hz + phase).sin()).collect()
            }
            WarmUp => (0..n).map(|i| (-(i as f64) / (process.scale * self.rate_hz)).exp()).collect(),
            TemperatureSensitivity => temperature.to_vec(),
            BurstNoise | BiasJump | SparseSpikes | SweptPickup | GrowingNoise => self.strange(process, &mut rng),
        };
        normalise(&mut values);
        let strength = process.size * process.channels[channel];
        values.iter_mut().for_each(|v| *v *= strength);
        values
    }

    /// Processes that no candidate describes.
    fn strange(&self, process: &Process, rng: &mut Philox) -> Vec<f64> {
        let n = self.samples;
        let place = process.scale * self.rate_hz;
        let mut level = 1.0;
        let mut phase = TAU * rng.random::<f64>();
        (0..n)
            .map(|i| match process.slow {
                BurstNoise => {
                    // Memoryless: the dwell at either level is exponential.
                    if rng.random::<f64>() < 1.0 / place {
                        level = -level;
                    }
                    level
                }
                BiasJump => f64::from(u8::from(i as f64 > place)),
                SparseSpikes if rng.random::<f64>() < 0.003 => sign(rng) * uniform(rng, 0.5, 1.0),
                SweptPickup => {
                    let frequency = process.scale * (1.0 + 3.0 * i as f64 / n as f64);
                    phase += TAU * frequency / self.rate_hz;
                    phase.sin()
                }
                GrowingNoise => i as f64 / n as f64 * rng.normal(),
                _ => 0.0,
            })
            .collect()
    }

    /// One-sided density that the model promises, unit/√Hz.
    pub fn promised_density(&self) -> Option<f64> {
        self.promised.then(|| self.white[0] * (2.0 / self.rate_hz).sqrt())
    }

    /// Simulates the recording.
    pub fn render(&self) -> Channels {
        let temperature = self.temperature();
        let louder: f64 = self.planted.iter().filter(|p| p.slow == WhiteNoise).map(|p| p.size).product();
        let readings = [0, 1, 2].map(|channel| {
            let mut rng = Philox::new(self.seed, channel as u64, Stream::Host);
            let mut values: Vec<f64> = (0..self.samples).map(|_| louder * rng.normal()).collect();
            for process in &self.planted {
                let added = self.realise(process, channel, &temperature);
                values.iter_mut().zip(added).for_each(|(v, a)| *v += a);
            }
            let step = self.planted.iter().find(|p| p.slow == QuantisationNoise).map(|p| p.size * self.white[channel]);
            let reading = |v: f64| self.bias[channel] + self.white[channel] * v;
            match step {
                Some(step) => values.into_iter().map(|v| (reading(v) / step).round() * step).collect(),
                None => values.into_iter().map(reading).collect(),
            }
        });
        let column = || temperature.iter().map(|t| 27.0 + 2.0 * t).collect();
        Channels { readings, temperature: self.temperature_given.then(column) }
    }

    /// Physical values of a process in one channel, by the library's symbols, where the law has
    /// one.
    pub fn parameters(&self, process: &Process, channel: usize) -> Vec<(&'static str, f64)> {
        let sigma = self.white[channel] * process.size * process.channels[channel].abs();
        match process.slow {
            WhiteNoise => vec![("density", self.white[channel] * process.size * (2.0 / self.rate_hz).sqrt())],
            QuantisationNoise => vec![("step", self.white[channel] * process.size)],
            RateRamp => {
                let duration_s = self.samples as f64 / self.rate_hz;
                let rate = self.white[channel] * process.size * process.channels[channel] * 12f64.sqrt() / duration_s;
                vec![("rate", rate)]
            }
            Sinusoid => vec![("amplitude", sigma * 2f64.sqrt()), ("frequency", process.scale)],
            TemperatureSensitivity if self.temperature_given => {
                vec![("slope", self.white[channel] * process.size * process.channels[channel] / 2.0)]
            }
            _ => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Bias instability B of a sum of relaxations an octave apart, each of variance q: B² = π q/ln
    // 2, because a one-sided spectrum h/f has Allan variance 2 ln 2 h and B is defined by 2 ln 2
    // B²/π.
    fn bias_instability(variance_per_octave: f64) -> f64 {
        (std::f64::consts::PI * variance_per_octave / std::f64::consts::LN_2).sqrt()
    }

    fn allan_deviation(values: &[f64], length: usize) -> f64 {
        let means: Vec<f64> = values.chunks_exact(length).map(|c| c.iter().sum::<f64>() / length as f64).collect();
        let sum: f64 = means.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
        (sum / (2.0 * (means.len() - 1) as f64)).sqrt()
    }

    // Allan deviation of flicker noise is 0.664 B at every averaging time (IEEE 952); of a walk it
    // grows as √τ.
    #[test]
    fn flicker_is_flat_at_its_law_and_a_walk_rises_by_its_root() {
        let mut rng = Philox::new(4, 0, Stream::Host);
        let n = 1 << 19;
        let parts: Vec<Vec<f64>> = (0..22).map(|k| relaxation(&mut rng, n, 2f64.powi(k))).collect();
        let flicker: Vec<f64> = (0..n).map(|i| parts.iter().map(|p| p[i]).sum()).collect();
        let law = 0.664 * bias_instability(1.0);
        for length in [32, 256, 2048] {
            let got = allan_deviation(&flicker, length);
            assert!((got / law - 1.0).abs() < 0.12, "{length}: {got} {law}");
        }
        let mut sum = 0.0;
        let walk: Vec<f64> = (0..n)
            .map(|_| {
                sum += rng.normal();
                sum
            })
            .collect();
        let ratio = allan_deviation(&walk, 1024) / allan_deviation(&walk, 64);
        assert!((ratio / 4.0 - 1.0).abs() < 0.15, "{ratio}");
    }

    #[test]
    fn a_process_has_the_size_asked() {
        let mut rng = Philox::new(9, 0, Stream::Host);
        for &slow in Slow::LIBRARY.iter().chain(Slow::FOREIGN) {
            let bare = Still::bare(&mut rng, 4000);
            let mut with = bare.clone();
            with.plant(&mut rng, slow, 2.0);
            let (before, after) = (bare.render(), with.render());
            let touched = (0..3).find(|c| with.planted[0].channels[*c] != 0.0).expect("one channel at least");
            let difference: Vec<f64> = before.readings[touched]
                .iter()
                .zip(&after.readings[touched])
                .map(|(a, b)| (b - a) / bare.white[0])
                .collect();
            let rms = (difference.iter().map(|d| d * d).sum::<f64>() / 4000.0).sqrt();
            let expected = match slow {
                WhiteNoise => 1.0,
                QuantisationNoise => 2.0 / 12f64.sqrt(),
                _ => 2.0 * with.planted[0].channels[touched].abs(),
            };
            assert!((rms / expected - 1.0).abs() < 0.06, "{slow:?}: {rms} {expected}");
        }
    }
}
