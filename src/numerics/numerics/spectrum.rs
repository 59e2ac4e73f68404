//! Spectra of real sequences: Welch's density, the raw periodogram, and the frequency response
//! between two channels.
//!
//! Densities are one-sided: their integral from 0 to half the rate is the variance. Not for Allan
//! deviations, see `allan`.

use super::fourier;
use crate::numerics::moments::mean;
use realfft::RealToComplex;
use realfft::num_complex::Complex64;
use std::f64::consts::PI;
use std::sync::Arc;

/// A one-sided power spectral density.
#[derive(Debug, Clone, PartialEq)]
pub struct Density {
    /// Frequencies, ascending; zero is left out.
    pub frequency_hz: Vec<f64>,
    /// One-sided density, unit²/Hz, one per frequency.
    pub density: Vec<f64>,
    /// Equivalent number of independent averages: an ordinate varies as χ² with twice as many
    /// degrees of freedom.
    pub averages: f64,
}

/// Frequency response of one channel to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Frequencies, ascending; zero is left out.
    pub frequency_hz: Vec<f64>,
    /// H₁ = S_xy/S_xx, output unit per input unit: unbiased where noise is at the output.
    pub gain: Vec<Complex64>,
    /// |S_xy|²/(S_xx S_yy), 0 to 1.
    pub coherence: Vec<f64>,
    /// Equivalent number of independent averages.
    pub averages: f64,
}

/// Welch's density with Hann windows that overlap by half; each segment loses its mean. `segment`
/// is a number of samples, limited to the length of `values`; fewer than four samples give an empty
/// density.
pub fn welch(values: &[f64], rate_hz: f64, segment: usize) -> Density {
    let Some(mut welch) = Welch::new(segment.min(values.len())) else { return Density::empty() };
    values.iter().for_each(|v| welch.push(*v));
    welch.density(rate_hz)
}

/// Welch's density of a stream.
#[derive(Debug)]
pub struct Welch {
    hann: Windowed,
    segment: Vec<f64>,
    length: usize,
    sum: Vec<f64>,
    count: u32,
}

impl Welch {
    /// With segments of this many samples; `None` for fewer than four.
    pub fn new(length: usize) -> Option<Self> {
        let (segment, sum) = (Vec::with_capacity(length), vec![0.0; length / 2 + 1]);
        Some(Self { hann: Windowed::new(length)?, segment, length, sum, count: 0 })
    }

    /// Adds the next sample.
    pub fn push(&mut self, value: f64) {
        self.segment.push(value);
        if self.segment.len() == self.length {
            for (s, bin) in self.sum.iter_mut().zip(self.hann.transform(&self.segment)) {
                *s += bin.norm_sqr();
            }
            self.count += 1;
            self.segment.drain(..(self.length / 2).max(1));
        }
    }

    /// The recording breaks off here: no segment reaches across.
    pub fn interrupt(&mut self) {
        self.segment.clear();
    }

    /// Returns the density averaged so far; empty before the first whole segment.
    pub fn density(&self, rate_hz: f64) -> Density {
        if self.count == 0 {
            return Density::empty();
        }
        let scale = 2.0 / (rate_hz * self.hann.power * f64::from(self.count));
        let mut density: Vec<f64> = self.sum[1..].iter().map(|s| s * scale).collect();
        halve_nyquist(&mut density, self.length);
        Density { frequency_hz: frequencies(self.length, rate_hz), density, averages: averages(self.count) }
    }
}

/// The periodogram of a sequence without its mean: one average, what a Whittle likelihood wants.
pub fn periodogram(values: &[f64], rate_hz: f64) -> Density {
    let count = values.len();
    if count < 4 {
        return Density::empty();
    }
    let mean = mean(values);
    let mut input: Vec<f64> = values.iter().map(|v| v - mean).collect();
    let fft = fourier::forward(count);
    let mut bins = fft.make_output_vec();
    transform(&fft, &mut input, &mut bins);
    let scale = 2.0 / (rate_hz * count as f64);
    let mut density: Vec<f64> = bins[1..].iter().map(|b| b.norm_sqr() * scale).collect();
    halve_nyquist(&mut density, count);
    Density { frequency_hz: frequencies(count, rate_hz), density, averages: 1.0 }
}

/// The response of `output` to `input` (equally long) by Welch's averages.
pub fn response(input: &[f64], output: &[f64], rate_hz: f64, segment: usize) -> Response {
    let length = input.len().min(output.len());
    let segment = segment.min(length);
    let (Some(mut x), Some(mut y)) = (Windowed::new(segment), Windowed::new(segment)) else {
        return Response { frequency_hz: Vec::new(), gain: Vec::new(), coherence: Vec::new(), averages: 0.0 };
    };
    let bins = segment / 2 + 1;
    let (mut xx, mut yy, mut xy) = (vec![0.0; bins], vec![0.0; bins], vec![Complex64::default(); bins]);
    let mut count = 0;
    for start in starts(length, segment) {
        let (a, b) = (x.transform(&input[start..start + segment]), y.transform(&output[start..start + segment]));
        for bin in 0..bins {
            xx[bin] += a[bin].norm_sqr();
            yy[bin] += b[bin].norm_sqr();
            xy[bin] += a[bin].conj() * b[bin];
        }
        count += 1;
    }
    let ratio = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
    Response {
        frequency_hz: frequencies(segment, rate_hz),
        gain: (1..bins).map(|b| if xx[b] > 0.0 { xy[b] / xx[b] } else { Complex64::default() }).collect(),
        coherence: (1..bins).map(|b| ratio(xy[b].norm_sqr(), xx[b] * yy[b])).collect(),
        averages: averages(count),
    }
}

impl Density {
    fn empty() -> Self {
        Self { frequency_hz: Vec::new(), density: Vec::new(), averages: 0.0 }
    }
}

fn starts(length: usize, segment: usize) -> impl Iterator<Item = usize> {
    (0..=length - segment).step_by((segment / 2).max(1))
}

/// Neighbouring Hann segments that overlap by half correlate by 1/6 (Welch 1967), their powers by
/// its square.
fn averages(segments: u32) -> f64 {
    let n = f64::from(segments);
    n / (1.0 + 2.0 * (n - 1.0) / n / 36.0)
}

fn frequencies(segment: usize, rate_hz: f64) -> Vec<f64> {
    (1..=segment / 2).map(|k| k as f64 * rate_hz / segment as f64).collect()
}

/// The bin at half the rate has no mirror image.
fn halve_nyquist(density: &mut [f64], segment: usize) {
    if segment.is_multiple_of(2)
        && let Some(last) = density.last_mut()
    {
        *last /= 2.0;
    }
}

fn transform(fft: &Arc<dyn RealToComplex<f64>>, input: &mut [f64], output: &mut [Complex64]) {
    // Fails only for buffers of another length than planned, and both were made by the plan.
    if fft.process(input, output).is_err() {
        output.fill(Complex64::default());
    }
}

impl std::fmt::Debug for Windowed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a Hann window of {} samples", self.window.len())
    }
}

struct Windowed {
    window: Vec<f64>,
    power: f64,
    fft: Arc<dyn RealToComplex<f64>>,
    input: Vec<f64>,
    output: Vec<Complex64>,
}

impl Windowed {
    fn new(length: usize) -> Option<Self> {
        if length < 4 {
            return None;
        }
        let window: Vec<f64> = (0..length).map(|i| (PI * (i as f64 + 0.5) / length as f64).sin().powi(2)).collect();
        let power = window.iter().map(|w| w * w).sum();
        let fft = fourier::forward(length);
        Some(Self { window, power, input: fft.make_input_vec(), output: fft.make_output_vec(), fft })
    }

    fn transform(&mut self, values: &[f64]) -> &[Complex64] {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        for ((to, value), weight) in self.input.iter_mut().zip(values).zip(&self.window) {
            *to = (value - mean) * weight;
        }
        transform(&self.fft, &mut self.input, &mut self.output);
        &self.output
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    fn white(count: usize, member: u64) -> Vec<f64> {
        let mut rng = Philox::new(7, member, Stream::Host);
        (0..count).map(|_| rng.normal()).collect()
    }

    #[test]
    fn white_noise_of_unit_variance_has_density_two_over_the_rate() {
        let density = welch(&white(1 << 16, 0), 100.0, 1024);
        let mean = density.density.iter().sum::<f64>() / density.density.len() as f64;
        assert!((mean / 0.02 - 1.0).abs() < 0.03, "{mean}");
        let spread =
            density.density.iter().map(|d| (d / mean - 1.0).powi(2)).sum::<f64>() / density.density.len() as f64;
        assert!((spread * density.averages - 1.0).abs() < 0.3, "ordinates vary as their averages say: {spread}");
    }

    // Parseval's theorem.
    #[test]
    fn the_integral_of_a_periodogram_is_the_variance() {
        for count in [1000, 1001] {
            let values = white(count, 1);
            let mean = values.iter().sum::<f64>() / count as f64;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count as f64;
            let p = periodogram(&values, 50.0);
            let integral = p.density.iter().sum::<f64>() * 50.0 / count as f64;
            assert!((integral / variance - 1.0).abs() < 1e-12, "{count}");
        }
    }

    #[test]
    fn a_delay_and_gain_are_read_from_the_response_and_noise_has_no_coherence() {
        let x = white(1 << 15, 2);
        let y: Vec<f64> = (0..x.len()).map(|i| 3.0 * x[i.saturating_sub(1)]).collect();
        let h = response(&x, &y, 1.0, 256);
        for (f, g) in h.frequency_hz.iter().zip(&h.gain) {
            assert!((g - 3.0 * Complex64::from_polar(1.0, -2.0 * PI * f)).norm() < 0.1, "{f}: {g}");
        }
        assert!(h.coherence.iter().all(|c| *c > 0.99));
        let foreign = response(&x, &white(1 << 15, 3), 1.0, 256);
        assert!(foreign.coherence.iter().sum::<f64>() / 128.0 < 2.0 / foreign.averages);
    }

    #[test]
    fn too_short_is_empty() {
        assert!(welch(&[1.0, 2.0], 1.0, 16).density.is_empty() && periodogram(&[], 1.0).density.is_empty());
        assert!(response(&[], &[], 1.0, 16).gain.is_empty());
    }
}
