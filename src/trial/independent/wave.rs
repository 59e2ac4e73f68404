//! Inputs as functions of continuous time: sums of sines, sweeps, smooth steps, shock pulses;
//! band-limited or held.
//!
//! Sums of many sines are tabulated at 20 points per shortest period and read by eight-point
//! Lagrange interpolation, whose error is (ωh)⁸·43/8! ≈ 1e-7 of the amplitude: continuous time
//! costs no more than a look-up.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::draw::Draw;

/// A recipe of an input, amplitude about one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
#[expect(missing_docs, reason = "the line of a variant says what its fields are")]
pub enum Shape {
    /// No input: a free ring-down.
    None,
    /// Few sines: amplitude, frequency in Hz, phase in rad.
    Sines { lines: Vec<[f64; 3]> },
    /// Many sines of random phase between two frequencies, all multiples of one (`of_hz`) or, for
    /// zero, anywhere: noise in a band.
    Lines { count: usize, from_hz: f64, to_hz: f64, of_hz: f64, odd_only: bool, seed: u64 },
    /// Frequency goes up exponentially (`exponential`) or linearly and down again, each way in
    /// `length_s`.
    Sweep { from_hz: f64, to_hz: f64, length_s: f64, exponential: bool },
    /// Levels that change at times, each with a smooth edge.
    Steps { at_s: Vec<f64>, levels: Vec<f64>, rise_s: f64 },
    /// Shocks: Gaussian pulses, which rows a few per width apart tell whole; `length_s` is four
    /// standard deviations.
    Shocks { at_s: Vec<f64>, peaks: Vec<f64>, length_s: f64 },
    /// Samples of a file that is played, smooth between them; nothing before and after.
    Played { rate_hz: f64, values: Vec<f64> },
}

/// Samples of silence around a file that is played.
const SILENCE: usize = 40;
/// Points of its table for each of its samples.
const FINER: usize = 4;
/// Samples to each side from which a point between them is made.
const TAPS: usize = 32;

/// An input that can be asked at any time.
#[derive(Debug, Clone)]
#[expect(missing_docs, reason = "the line of a variant says what its fields are")]
pub enum Wave {
    /// Evaluated by the formula of its shape.
    Formula(Shape),
    /// By interpolation in a table that begins at a time and has a step.
    Table { from_s: f64, step_s: f64, values: Vec<f64> },
}

impl Shape {
    /// Highest frequency with noticeable power.
    pub fn highest_hz(&self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Sines { lines } => lines.iter().map(|l| l[1]).fold(0.0, f64::max),
            Self::Lines { to_hz, .. } => *to_hz,
            Self::Sweep { from_hz, to_hz, .. } => from_hz.max(*to_hz),
            Self::Steps { rise_s, .. } => 0.5 / rise_s,
            Self::Shocks { length_s, .. } => 2.8 / length_s,
            Self::Played { rate_hz, .. } => 0.4 * rate_hz,
        }
    }

    /// Name of the shape in tables.
    pub fn word(&self) -> &'static str {
        match self {
            Self::None => "ring-down",
            Self::Sines { lines } if lines.len() == 1 => "single sine",
            Self::Sines { .. } => "two sines",
            Self::Lines { of_hz, odd_only, .. } => match (*of_hz > 0.0, odd_only) {
                (true, true) => "odd multisine",
                (true, false) => "multisine",
                _ => "noise in a band",
            },
            Self::Sweep { .. } => "sweep",
            Self::Steps { .. } => "steps",
            Self::Shocks { .. } => "shocks",
            Self::Played { .. } => "played",
        }
    }

    fn lines(&self) -> Vec<[f64; 3]> {
        let Self::Lines { count, from_hz, to_hz, of_hz, odd_only, seed } = self else { return Vec::new() };
        let mut draw = Draw::new(*seed, 0, 1);
        let amplitude = (2.0 / *count as f64).sqrt();
        let place = |draw: &mut Draw, n: usize| {
            if *of_hz == 0.0 {
                return draw.between(*from_hz, *to_hz);
            }
            let at = from_hz + (to_hz - from_hz) * (n as f64 + 0.5) / *count as f64;
            let order = (at / of_hz).round().max(1.0);
            let order = if *odd_only { 2.0 * ((order - 1.0) / 2.0).round() + 1.0 } else { order };
            (order * of_hz).min(*to_hz)
        };
        (0..*count)
            .map(|n| {
                let frequency = place(&mut draw, n);
                // A band of noise has Rayleigh amplitudes, a multisine flat ones.
                let size = if *of_hz == 0.0 { draw.exponential().sqrt() } else { 1.0 };
                [amplitude * size, frequency, TAU * draw.unit()]
            })
            .collect()
    }

    fn at(&self, t: f64) -> f64 {
        match self {
            Self::None | Self::Lines { .. } | Self::Played { .. } => 0.0,
            Self::Sines { lines } => lines.iter().map(|[a, f, p]| a * (TAU * f * t + p).sin()).sum(),
            Self::Sweep { from_hz, to_hz, length_s, exponential } => {
                let phase = |s: f64| {
                    if *exponential {
                        let k = (to_hz / from_hz).ln() / length_s;
                        TAU * from_hz * ((k * s).exp() - 1.0) / k
                    } else {
                        TAU * (from_hz * s + 0.5 * (to_hz - from_hz) / length_s * s * s)
                    }
                };
                // Up and down: a sweep that jumped back would not be band-limited.
                let (round, s) = ((t / (2.0 * length_s)).floor(), t.rem_euclid(2.0 * length_s));
                let whole = phase(*length_s);
                let here = if s < *length_s { phase(s) } else { 2.0 * whole - phase(2.0 * length_s - s) };
                (2.0 * whole * round + here).sin()
            }
            Self::Steps { at_s, levels, rise_s } => {
                at_s.iter().zip(levels).map(|(at, level)| level * 0.5 * (1.0 + ((t - at) / rise_s).tanh())).sum()
            }
            Self::Shocks { at_s, peaks, length_s } => {
                let pulse = |at: &f64| (-8.0 * ((t - at) / length_s - 0.5).powi(2)).exp();
                at_s.iter().zip(peaks).map(|(at, peak)| peak * pulse(at)).sum()
            }
        }
    }

    /// Ready to be asked between two times.
    pub fn wave(&self, from_s: f64, to_s: f64) -> Wave {
        if let Self::Played { rate_hz, values } = self {
            let step_s = 1.0 / (FINER as f64 * rate_hz);
            return Wave::Table { from_s: -(SILENCE as f64) / rate_hz, step_s, values: finer(values) };
        }
        let lines = self.lines();
        if lines.is_empty() {
            return Wave::Formula(self.clone());
        }
        let step_s = 1.0 / (20.0 * self.highest_hz());
        let from_s = from_s - 8.0 * step_s;
        let count = ((to_s - from_s) / step_s).ceil() as usize + 16;
        let mut values = vec![0.0; count];
        for [amplitude, frequency, phase] in lines {
            // Rotation by a fixed angle; its rounding grows as the square root of the steps, 1e-13
            // here.
            let (mut s, mut c) = (TAU * frequency * from_s + phase).sin_cos();
            let (ds, dc) = (TAU * frequency * step_s).sin_cos();
            for value in &mut values {
                *value += amplitude * s;
                (s, c) = (s * dc + c * ds, c * dc - s * ds);
            }
        }
        Wave::Table { from_s, step_s, values }
    }
}

/// A file that is played, with silence about it, by a sinc in a window of Kaiser's with β = 12 (Kaiser &
/// Schafer, IEEE Trans. ASSP 28, 1980): up to 0.4 of the rate it errs by 2e-6 at most; reading the table adds
/// (ωh)⁸·43/8!, 3e-5 there.
fn finer(values: &[f64]) -> Vec<f64> {
    let bessel = |x: f64| -> f64 {
        let terms = (1..40).scan(1.0, |term, k| {
            *term *= (0.5 * x / f64::from(k)).powi(2);
            Some(*term)
        });
        1.0 + terms.sum::<f64>()
    };
    let tap = |t: f64| {
        let edge = (1.0 - (t / TAPS as f64).powi(2)).max(0.0).sqrt();
        let sinc = if t == 0.0 { 1.0 } else { (std::f64::consts::PI * t).sin() / (std::f64::consts::PI * t) };
        sinc * bessel(12.0 * edge) / bessel(12.0)
    };
    let taps: Vec<f64> = (0..=FINER * TAPS).map(|k| tap(k as f64 / FINER as f64)).collect();
    let point = |n: usize| -> f64 {
        let at = n as isize - (FINER * SILENCE) as isize;
        let nearest = at.div_euclid(FINER as isize);
        let around = nearest - TAPS as isize..=nearest + TAPS as isize + 1;
        let part = |k: isize| -> f64 {
            let value = usize::try_from(k).ok().and_then(|k| values.get(k)).unwrap_or(&0.0);
            taps.get((at - k * FINER as isize).unsigned_abs()).map_or(0.0, |tap| tap * value)
        };
        around.map(part).sum()
    };
    (0..FINER * (values.len() + 2 * SILENCE)).map(point).collect()
}

impl Wave {
    /// Value at a time.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Formula(shape) => shape.at(t),
            Self::Table { from_s, step_s, values } => {
                let place = (t - from_s) / step_s;
                let first = (place.floor() as isize - 3).clamp(0, values.len() as isize - 8) as usize;
                lagrange8(&values[first..first + 8], place - first as f64)
            }
        }
    }
}

/// Interpolates eight equidistant values at a place counted in steps from the first.
fn lagrange8(values: &[f64], place: f64) -> f64 {
    // Barycentric weights of eight equidistant nodes: alternating binomials of 7.
    const WEIGHTS: [f64; 8] = [-1.0, 7.0, -21.0, 35.0, -35.0, 21.0, -7.0, 1.0];
    let (mut above, mut below) = (0.0, 0.0);
    for (n, (value, weight)) in values.iter().zip(WEIGHTS).enumerate() {
        let distance = place - n as f64;
        if distance == 0.0 {
            return *value;
        }
        above += weight / distance * value;
        below += weight / distance;
    }
    above / below
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_reads_as_its_sum_of_sines() {
        let shape = Shape::Lines { count: 30, from_hz: 0.5, to_hz: 9.0, of_hz: 0.1, odd_only: true, seed: 5 };
        let lines = shape.lines();
        let exact = |t: f64| lines.iter().map(|[a, f, p]| a * (TAU * f * t + p).sin()).sum::<f64>();
        let wave = shape.wave(-1.0, 40.0);
        let worst = |wave: &dyn Fn(f64) -> f64| {
            (0..5000).map(|n| -0.9 + 0.008 * f64::from(n)).map(|t| (wave(t) - exact(t)).abs()).fold(0.0, f64::max)
        };
        assert!(worst(&|t| wave.at(t)) < 2e-6, "{}", worst(&|t| wave.at(t)));
        // Control: a table read without interpolation would be seen.
        let Wave::Table { from_s, step_s, values } = &wave else { panic!("many lines make a table") };
        assert!(worst(&|t| values[((t - from_s) / step_s) as usize]) > 1e-2);
        assert!(lines.iter().all(|l| (l[1] / 0.1).round() as usize % 2 == 1), "odd multiples");
    }

    // A sine up to 0.4 of the rate is known between its samples, as `finer` says; one just below half of it is
    // not: control.
    #[test]
    fn a_file_that_is_played_is_smooth_between_its_samples() {
        let rate_hz = 100.0;
        let worst = |hz: f64| {
            let at = |t: f64| (TAU * hz * t).sin();
            let shape = Shape::Played { rate_hz, values: (0..400).map(|n| at(f64::from(n) / rate_hz)).collect() };
            let wave = shape.wave(0.0, 4.0);
            (0..2000).map(|n| 1.0 + 0.001 * f64::from(n)).map(|t| (wave.at(t) - at(t)).abs()).fold(0.0, f64::max)
        };
        assert!(worst(3.0) < 2e-6 && worst(40.0) < 3e-5, "{} {}", worst(3.0), worst(40.0));
        assert!(worst(49.0) > 1e-2, "{}", worst(49.0));
    }

    // Up and down: the phase has no jump and its rate is the frequency, at the turn as well.
    #[test]
    fn a_sweep_turns_without_a_jump_and_a_shock_is_smooth() {
        for exponential in [true, false] {
            let sweep = Shape::Sweep { from_hz: 1.0, to_hz: 5.0, length_s: 7.0, exponential };
            let jump = |h: f64| {
                let steps = (0..40_000).map(|n| h * f64::from(n)).map(|t| (sweep.at(t + h) - sweep.at(t)).abs());
                steps.fold(0.0, f64::max)
            };
            assert!(jump(1e-3) < TAU * 5.0 * 1.01e-3, "{}", jump(1e-3));
            assert!(jump(0.1) > TAU * 5.0 * 1.01e-3, "a jump would be seen: control");
        }
        let shock = Shape::Shocks { at_s: vec![1.0], peaks: vec![2.0], length_s: 0.4 };
        assert!((shock.at(1.2) - 2.0).abs() < 1e-12 && (shock.at(1.3) - 2.0 * (-0.5f64).exp()).abs() < 1e-12);
    }
}
