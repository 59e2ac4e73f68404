//! Experiments that limits allow: the shape of the input, its level, its length, and its samples.

use std::f64::consts::TAU;

use rand::RngExt;

use crate::rng::{Philox, Stream};

use super::limits::{Limits, Way};

/// Parts of the largest input that are tried where the level may vary.
const LEVELS: [f64; 3] = [1.0, 0.5, 0.25];
/// Rungs of a ladder.
const RUNGS: usize = 8;
/// Most lines of a multisine.
const LINES: usize = 200;
/// Samples of an edge, so that nothing of a step lies above half the sampling rate.
const EDGE: f64 = 6.0;

/// The shape of an input.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(missing_docs, reason = "the line of a variant says what its fields are")]
pub enum Shape {
    /// One sine.
    Sine { hz: f64 },
    /// Sines from one frequency to another, whose amplitude goes up in equal rungs to the level.
    Levels { from_hz: f64, to_hz: f64 },
    /// Sines of one amplitude, from one frequency to another in equal ratios.
    Frequencies { from_hz: f64, to_hz: f64 },
    /// A sine whose frequency rises exponentially.
    Chirp { from_hz: f64, to_hz: f64 },
    /// Many sines at once, of equal amplitude and random phases.
    Multisine { from_hz: f64, to_hz: f64 },
    /// Steps between plus and minus the level, each so long.
    Steps { every_s: f64 },
}

/// One experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Experiment {
    /// Shape of the input.
    pub shape: Shape,
    /// Its largest value.
    pub level: f64,
    /// Length, s.
    pub seconds: f64,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
}

impl Shape {
    fn way(&self) -> Way {
        match self {
            Self::Sine { .. } => Way::Sine,
            Self::Levels { .. } | Self::Frequencies { .. } => Way::SineLadder,
            Self::Chirp { .. } => Way::Chirp,
            Self::Multisine { .. } => Way::Multisine,
            Self::Steps { .. } => Way::Step,
        }
    }
}

/// The band of the limits, or the one about a resonance that the rate allows.
pub fn band_hz(limits: &Limits, resonance_hz: f64) -> [f64; 2] {
    let high = (3.0 * resonance_hz).min(0.4 * limits.rate_hz);
    limits.band_hz.unwrap_or([(0.1 * resonance_hz).min(0.5 * high), high])
}

/// Shapes with their levels for a sensor of this resonance; the broadband multisine, by which the others
/// are measured, is [`broadband`].
pub fn all(limits: &Limits, resonance_hz: f64, zeta: f64) -> Vec<(Shape, f64)> {
    let [low, high] = band_hz(limits, resonance_hz);
    let within = |hz: f64| hz.clamp(low, high);
    // Three half-widths to each side hold what a resonance does; of a well damped one, an octave.
    let width = (1.0 + 3.0 * zeta).min(2.0);
    let [below, above] = [within(resonance_hz / width), within(resonance_hz * width)];
    let mut shapes: Vec<Shape> =
        [0.5, 1.0 / width, 1.0, width].map(|r| Shape::Sine { hz: within(r * resonance_hz) }).to_vec();
    for [from_hz, to_hz] in [[low, high], [below, above]].into_iter().filter(|[a, b]| a < b) {
        shapes.push(Shape::Levels { from_hz, to_hz });
        shapes.push(Shape::Frequencies { from_hz, to_hz });
        shapes.push(Shape::Chirp { from_hz, to_hz });
        shapes.push(Shape::Multisine { from_hz, to_hz });
    }
    shapes.push(Shape::Steps { every_s: 5.0 / resonance_hz });
    shapes.retain(|shape| limits.vary.contains(&shape.way()));
    let levels = if limits.vary.contains(&Way::Level) { &LEVELS[..] } else { &LEVELS[..1] };
    let levels = levels.iter().map(|part| part * limits.largest_input_m_s2);
    levels.flat_map(|level| shapes.iter().map(move |shape| (*shape, level))).collect()
}

/// The multisine over the whole band at the largest input.
pub fn broadband(limits: &Limits, resonance_hz: f64) -> (Shape, f64) {
    let [from_hz, to_hz] = band_hz(limits, resonance_hz);
    (Shape::Multisine { from_hz, to_hz }, limits.largest_input_m_s2)
}

impl Experiment {
    /// Number of samples.
    pub fn samples(&self) -> usize {
        (self.seconds * self.rate_hz).round() as usize
    }

    /// The input, sample by sample.
    pub fn input(&self) -> Vec<f64> {
        let (count, dt) = (self.samples(), 1.0 / self.rate_hz);
        let part = |k: usize| k as f64 / count.max(1) as f64;
        let rung = |k: usize| ((part(k) * RUNGS as f64) as usize).min(RUNGS - 1) as f64;
        let stepped = |k, from_hz: f64, to_hz: f64| from_hz * (to_hz / from_hz).powf(rung(k) / (RUNGS - 1) as f64);
        let mut phase = 0.0;
        let mut swept = |hz: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let turned = |k| {
                let now = f64::sin(phase);
                phase += TAU * hz(k) * dt;
                now
            };
            (0..count).map(turned).collect()
        };
        let mut values = match self.shape {
            Shape::Sine { hz } => swept(&|_| hz),
            Shape::Levels { from_hz, to_hz } => {
                let level = |k| (rung(k) + 1.0) / RUNGS as f64;
                swept(&|k| stepped(k, from_hz, to_hz)).iter().enumerate().map(|(k, v)| level(k) * v).collect()
            }
            Shape::Frequencies { from_hz, to_hz } => swept(&|k| stepped(k, from_hz, to_hz)),
            Shape::Chirp { from_hz, to_hz } => swept(&|k| from_hz * (to_hz / from_hz).powf(part(k))),
            Shape::Multisine { from_hz, to_hz } => self.multisine(from_hz, to_hz),
            Shape::Steps { every_s } => {
                let edge = EDGE * dt;
                let at = |t: f64| {
                    ((t / every_s * std::f64::consts::PI).sin() * every_s / (edge * std::f64::consts::PI)).tanh()
                };
                (0..count).map(|k| at(k as f64 * dt)).collect()
            }
        };
        let peak = values.iter().fold(0.0f64, |a, v| a.max(v.abs())).max(1e-300);
        values.iter_mut().for_each(|v| *v *= self.level / peak);
        values
    }

    /// Lines at multiples of one over the length, as many as fit, with phases that are always the same.
    fn multisine(&self, from_hz: f64, to_hz: f64) -> Vec<f64> {
        let (count, dt) = (self.samples(), 1.0 / self.rate_hz);
        let lines = (((to_hz - from_hz) * self.seconds) as usize).clamp(2, LINES);
        let mut rng = Philox::new(lines as u64, 0, Stream::Host);
        let mut values = vec![0.0; count];
        for line in 0..lines {
            let hz = from_hz + (to_hz - from_hz) * (line as f64 + 0.5) / lines as f64;
            let hz = (hz * self.seconds).round().max(1.0) / self.seconds;
            let begin = TAU * rng.random::<f64>();
            let (mut s, mut c) = begin.sin_cos();
            let (ds, dc) = (TAU * hz * dt).sin_cos();
            for value in &mut values {
                *value += s;
                (s, c) = (s * dc + c * ds, c * dc - s * ds);
            }
        }
        values
    }

    /// The file to play: time and input, a row a sample.
    pub fn csv(&self) -> String {
        let row = |(k, u): (usize, &f64)| format!("{},{u:.9e}\n", k as f64 / self.rate_hz);
        "t_s,input_m_s2\n".to_owned() + &self.input().iter().enumerate().map(row).collect::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_experiment_keeps_to_its_limits() {
        let text = "largest_input_m_s2 = 3.0\nrate_hz = 100.0\nlongest_s = 20.0\nband_hz = [1.0, 20.0]\n";
        let limits = Limits::parse("limits.toml", text).expect("these limits are possible");
        let all = all(&limits, 5.0, 0.02);
        assert!(all.len() > 20, "{}", all.len());
        for (shape, level) in all {
            let input = Experiment { shape, level, seconds: 20.0, rate_hz: 100.0 }.input();
            let peak = input.iter().fold(0.0f64, |a, v| a.max(v.abs()));
            assert!(input.len() == 2000 && (peak - level).abs() < 1e-9 && level <= 3.0, "{shape:?} {peak}");
        }
    }
}
