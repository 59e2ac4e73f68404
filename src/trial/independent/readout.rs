//! From displacement to reading: filters, delays, bends, rails, slow offsets, noise, steps.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::draw::Draw;
use super::law::Course;

/// One thing between the mass and the reading, internal units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "stage")]
#[expect(missing_docs, reason = "the line of a variant says what its fields are")]
pub enum Readout {
    /// Poles at these time constants in a row.
    Poles { taus: Vec<f64> },
    /// y(t) = x(t − τ).
    Delay { tau: f64 },
    /// y = x + k₂x² + k₃x³.
    Bend { k2: f64, k3: f64 },
    /// y = x + size·u.
    Feed { size: f64 },
    /// size·c(t).
    Slow { size: f64, course: Course },
    /// size·e^(−t/τ).
    WarmUp { size: f64, tau: f64 },
    /// Random walk, size per √s.
    Walk { size: f64 },
    /// a·cos 2πft + b·sin 2πft.
    Line { a: f64, b: f64, hz: f64 },
    /// Clips; the noise comes before it when `noisy`.
    Rails { low: f64, high: f64, noisy: bool },
    /// limit·tanh(x/limit).
    Soft { limit: f64 },
    /// Nothing is read within ±size.
    Dead { size: f64 },
    /// Rounds to multiples of a step.
    Round { step: f64 },
    /// An unmeasured signal crosses over: noise in a band, rms size.
    Cross { size: f64, from_hz: f64, to_hz: f64 },
}

impl Readout {
    /// Time constants of its poles.
    pub fn poles(&self) -> &[f64] {
        if let Self::Poles { taus } = self { taus } else { &[] }
    }

    /// Delay of the reading, s.
    pub fn delay_s(&self) -> f64 {
        if let Self::Delay { tau } = self { *tau } else { 0.0 }
    }

    /// The number to scale, where there is one.
    pub fn size_mut(&mut self) -> Option<&mut f64> {
        match self {
            Self::Feed { size }
            | Self::Slow { size, .. }
            | Self::WarmUp { size, .. }
            | Self::Walk { size }
            | Self::Dead { size }
            | Self::Cross { size, .. } => Some(size),
            _ => None,
        }
    }
}

/// Distribution of the readout's noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "law")]
#[expect(missing_docs, reason = "the line of a variant says what its fields are")]
pub enum Noise {
    /// Normal noise.
    Gauss,
    /// Two-sided exponential.
    Laplace,
    /// Student's t.
    Student { freedom: usize },
    /// Normal, its size 1 + more·|y|/rms.
    WithAmplitude { more: f64 },
    /// Normal, its size grows linearly by this factor.
    Growing { factor: f64 },
    /// Normal with a neighbour correlation of first order.
    Coloured { correlation: f64 },
}

impl Noise {
    /// Name of the noise in tables.
    pub fn word(&self) -> String {
        match self {
            Self::Gauss => "normal".into(),
            Self::Laplace => "Laplace".into(),
            Self::Student { freedom } => format!("Student t{freedom}"),
            Self::WithAmplitude { .. } => "grows with amplitude".into(),
            Self::Growing { .. } => "grows with time".into(),
            Self::Coloured { .. } => "slightly coloured".into(),
        }
    }

    /// A series of unit rms in the mean; `signal` over its rms for the law that follows it.
    pub fn series(&self, signal: &[f64], draw: &mut Draw) -> Vec<f64> {
        let n = signal.len();
        let mut values: Vec<f64> = (0..n)
            .map(|_| match self {
                Self::Laplace => draw.sign() * draw.exponential(),
                Self::Student { freedom } => draw.student(*freedom),
                _ => draw.normal(),
            })
            .collect();
        let rms = (signal.iter().map(|s| s * s).sum::<f64>() / n.max(1) as f64).sqrt().max(1e-300);
        match self {
            Self::WithAmplitude { more } => {
                values.iter_mut().zip(signal).for_each(|(v, s)| *v *= 1.0 + more * s.abs() / rms);
            }
            Self::Growing { factor } => {
                values.iter_mut().enumerate().for_each(|(k, v)| *v *= 1.0 + (factor - 1.0) * k as f64 / n as f64);
            }
            Self::Coloured { correlation } => {
                let mut last = values.first().copied().unwrap_or(0.0);
                let fresh = (1.0 - correlation * correlation).sqrt();
                for v in &mut values {
                    last = correlation * last + fresh * *v;
                    *v = last;
                }
            }
            _ => {}
        }
        let size = (values.iter().map(|v| v * v).sum::<f64>() / n.max(1) as f64).sqrt().max(1e-300);
        values.iter_mut().for_each(|v| *v /= size);
        values
    }
}

/// Everything after the analogue filters. `noise` is added where the stages say, `input` is the
/// true input.
pub fn read(stages: &[Readout], signal: &[f64], input: &[f64], noise: &[f64], rate_hz: f64, seed: u64) -> Vec<f64> {
    let mut y = signal.to_vec();
    let mut draw = Draw::new(seed, 0, 21);
    let length_s = y.len() as f64 / rate_hz;
    let mut noisy = false;
    let add_noise = |y: &mut [f64]| y.iter_mut().zip(noise).for_each(|(y, e)| *y += e);
    for stage in stages {
        if matches!(stage, Readout::Round { .. } | Readout::Rails { noisy: true, .. }) && !noisy {
            add_noise(&mut y);
            noisy = true;
        }
        let cross = match stage {
            Readout::Cross { from_hz, to_hz, .. } => Some(
                super::wave::Shape::Lines {
                    count: 40,
                    from_hz: *from_hz,
                    to_hz: *to_hz,
                    of_hz: 0.0,
                    odd_only: false,
                    seed: seed ^ 78,
                }
                .wave(0.0, length_s),
            ),
            _ => None,
        };
        let mut walk = 0.0;
        for (k, y) in y.iter_mut().enumerate() {
            let t = k as f64 / rate_hz;
            match stage {
                Readout::Poles { .. } | Readout::Delay { .. } => {}
                Readout::Bend { k2, k3 } => *y += k2 * *y * *y + k3 * y.powi(3),
                Readout::Feed { size } => *y += size * input.get(k).copied().unwrap_or(0.0),
                Readout::Slow { size, course } => *y += size * course.at(t / length_s),
                Readout::WarmUp { size, tau } => *y += size * (-t / tau).exp(),
                Readout::Walk { size } => {
                    *y += walk;
                    walk += size * draw.normal() / rate_hz.sqrt();
                }
                Readout::Line { a, b, hz } => *y += a * (TAU * hz * t).cos() + b * (TAU * hz * t).sin(),
                Readout::Rails { low, high, .. } => *y = y.clamp(*low, *high),
                Readout::Soft { limit } => *y = limit * (*y / limit).tanh(),
                Readout::Dead { size } => *y -= y.clamp(-size, *size),
                Readout::Round { step } => *y = step * (*y / step).round(),
                Readout::Cross { size, .. } => *y += size * cross.as_ref().map_or(0.0, |w| w.at(t)),
            }
        }
    }
    if !noisy {
        add_noise(&mut y);
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kurtosis(values: &[f64]) -> f64 {
        let n = values.len() as f64;
        let power = |p: i32| values.iter().map(|v| v.powi(p)).sum::<f64>() / n;
        power(4) / power(2).powi(2)
    }

    // Laplace: kurtosis 6. Uniform quantisation error q²/12.
    #[test]
    fn noise_has_its_law_and_rounding_its_variance() {
        let (flat, mut draw) = (vec![0.0; 300_000], Draw::new(3, 0, 0));
        let laplace = Noise::Laplace.series(&flat, &mut draw);
        let normal = Noise::Gauss.series(&flat, &mut draw);
        assert!((kurtosis(&laplace) - 6.0).abs() < 0.3 && (kurtosis(&normal) - 3.0).abs() < 0.1);
        let rounded = read(&[Readout::Round { step: 0.5 }], &normal, &flat, &flat, 1.0, 1);
        let error: f64 = rounded.iter().zip(&normal).map(|(r, n)| (r - n).powi(2)).sum::<f64>() / 3e5;
        assert!((error / (0.25 / 12.0) - 1.0).abs() < 0.02, "{error}");
        // A late noise is not rounded: control.
        let late = read(&[], &flat, &flat, &normal, 1.0, 1);
        assert!((late[5] / 0.5).fract() != 0.0);
    }
}
