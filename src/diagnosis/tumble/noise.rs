//! States how far a sensor's mean over a still pose, or its integral over a move, may err by noise
//! alone.
//!
//! Measured inside the poses only, so that no mismatch between poses can pass for noise, and split
//! into white noise and flicker with the Allan variance σ²(τ) = N²/τ + (2 ln 2/π) B² (IEEE 952,
//! annex C): see `flicker`. A reading whose noise is finer than its step errs by up to half a step
//! in the whole of a pose, however long: see `rounding`.

use std::f64::consts::PI;
use std::ops::Range;

use super::flicker;
use crate::numerics::order;

/// Noise of one axis in its own unit u: N in u·√s, B in u.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AxisNoise {
    /// White level as a random-walk coefficient.
    pub random_walk: f64,
    /// Bias instability B (flicker), u.
    pub bias_instability: f64,
    /// Length of the whole recording: flicker between poses grows with it.
    pub record_s: f64,
    /// Variance of a pose's mean about the truth that rounding leaves at any length, u².
    pub rounding: f64,
}

impl AxisNoise {
    /// Both terms of the axes of one sensor, from what happens inside the poses.
    pub fn inside(columns: &[&[f64]], poses: &[Range<usize>], rate_hz: f64) -> Vec<Self> {
        let roundings: Vec<Rounding> = columns.iter().map(|c| Rounding::inside(c, poses)).collect();
        // A reading that repeats itself may show no noise; what rounding adds to a sample is there.
        let floor = |r: &Rounding| r.step * r.step / 12.0 / rate_hz;
        let axes: Vec<(Vec<&[f64]>, f64)> = columns
            .iter()
            .zip(&roundings)
            .map(|(c, r)| (poses.iter().map(|p| &c[p.clone()]).collect(), floor(r)))
            .collect();
        let laws = flicker::levels(&axes, rate_hz);
        let of = |((column, rounding), (white, flicker)): ((&&[f64], &Rounding), (f64, f64))| Self {
            random_walk: white.sqrt(),
            bias_instability: (flicker * PI).sqrt(),
            record_s: column.len() as f64 / rate_hz,
            rounding: rounding.of_mean,
        };
        columns.iter().zip(&roundings).zip(laws).map(of).collect()
    }

    /// Variance of a mean over `length_s` about the recording's mean: white noise, and flicker from
    /// the record's length down to that of the pose.
    pub fn mean_variance(&self, length_s: f64) -> f64 {
        let octaves = (self.record_s / length_s).max(1.0).ln();
        self.random_walk.powi(2) / length_s + self.bias_instability.powi(2) / PI * octaves + self.rounding
    }

    /// Variance of an integral over `length_s`, in (u·s)².
    pub fn integral_variance(&self, length_s: f64) -> f64 {
        // In motion the reading sweeps over many steps, so that rounding averages out as the white
        // noise does.
        (self.mean_variance(length_s) - self.rounding) * length_s * length_s
    }
}

/// Holds what rounding to a step does to a reading at rest.
struct Rounding {
    /// Variance of a long mean about the truth, over all places between two steps.
    of_mean: f64,
    /// The step q; zero where none is seen.
    step: f64,
}

impl Rounding {
    /// From the values inside the poses, where a coarse reading repeats itself.
    fn inside(values: &[f64], poses: &[Range<usize>]) -> Self {
        let none = Self { of_mean: 0.0, step: 0.0 };
        let inside = || poses.iter().map(|p| &values[p.clone()]);
        let changes = || inside().flat_map(|v| v.windows(2).map(|w| (w[1] - w[0]).abs()));
        // The moves sweep over every step, also where a quiet axis repeats one value in all poses.
        let everywhere = values.windows(2).map(|w| (w[1] - w[0]).abs());
        let q = everywhere.filter(|c| *c > 0.0).fold(f64::INFINITY, f64::min);
        let (count, repeats) = changes().fold((0usize, 0usize), |(n, r), c| (n + 1, r + usize::from(c == 0.0)));
        let on_grid = || changes().all(|c| (c / q - (c / q).round()).abs() < 0.05);
        if !q.is_finite() || 20 * repeats < count || !on_grid() {
            return none;
        }
        let scatter = |v: &[f64]| {
            let mean = v.iter().sum::<f64>() / v.len().max(1) as f64;
            v.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / v.len().max(1) as f64
        };
        // Less the top tenth, as a pose may have slipped.
        let mut within: Vec<f64> = inside().map(scatter).collect();
        order::sort(&mut within);
        let mean_of = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
        let within = mean_of(&within[..within.len() - within.len() / 10]) / (q * q);
        Self { of_mean: q * q * of_mean(noise_before_rounding(within)), step: q }
    }
}

/// Variance of the mean of rounded values about the truth, in squared steps, when noise of standard
/// deviation `sigma` (steps) precedes the rounding: Σ exp(−4π²k²σ²)/(2π²k²), which is 1/12 without
/// noise. Source: the Fourier series of the rounding error; Widrow & Kollár, Quantization Noise,
/// Cambridge 2008, chapter 5.
fn of_mean(sigma: f64) -> f64 {
    if sigma <= 0.0 {
        return 1.0 / 12.0;
    }
    (1..=2000).map(|k| (PI * f64::from(k)).powi(2)).map(|k| (-4.0 * k * sigma * sigma).exp() / (2.0 * k)).sum()
}

/// The noise (steps) that leaves this variance within a pose, σ² + 1/12 − `of_mean(σ)`, by
/// bisection.
fn noise_before_rounding(within: f64) -> f64 {
    let (mut low, mut high) = (0.0, within.sqrt() + 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if middle * middle + 1.0 / 12.0 - of_mean(middle) < within { low = middle } else { high = middle }
    }
    low
}

/// Standard error of a pose's mean from the scatter of eight batches: shows a pose that was not
/// still.
pub(super) fn batch_error(values: &[f64]) -> f64 {
    const BATCHES: usize = 8;
    let m = values.len() / BATCHES;
    if m == 0 {
        return 0.0;
    }
    let means: Vec<f64> = values.chunks_exact(m).take(BATCHES).map(|c| c.iter().sum::<f64>() / m as f64).collect();
    let mean = means.iter().sum::<f64>() / BATCHES as f64;
    let variance = means.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (BATCHES - 1) as f64;
    (variance / BATCHES as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Uniform};

    use super::*;
    use crate::rng::{Philox, Stream};

    /// The mean of a rounded pose errs as the series says, from no noise at all to noise of a step,
    /// and the finder of the noise gets it from the rounded values alone.
    #[test]
    fn the_mean_of_a_rounded_pose_errs_as_the_series_says() {
        let places = Uniform::new(-500.0, 500.0).expect("a range");
        for sigma in [0.0, 0.1, 0.2, 0.3, 0.5] {
            let mut rng = Philox::new(8, (sigma * 100.0) as u64, Stream::Host);
            // A move first: it shows the step also where the poses show none.
            let mut values: Vec<f64> = (0..50).map(|n| 7.0 * f64::from(n)).collect();
            let (mut poses, mut errors) = (Vec::new(), 0.0);
            for _ in 0..400 {
                let place: f64 = places.sample(&mut rng);
                let start = values.len();
                values.extend((0..400).map(|_| (place + sigma * rng.normal()).round() * 7.0));
                poses.push(start..values.len());
                errors += (values[start..].iter().sum::<f64>() / 400.0 - 7.0 * place).powi(2) / 400.0;
            }
            let noise = AxisNoise::inside(&[&values], &poses, 100.0)[0];
            let expected = 49.0 * (of_mean(sigma) + (sigma * sigma + 1.0 / 12.0 - of_mean(sigma)) / 400.0);
            assert!((errors / expected - 1.0).abs() < 0.25, "law at {sigma}: {errors} {expected}");
            let claimed = noise.mean_variance(4.0);
            assert!((claimed / errors).ln().abs() < 0.5, "claimed at {sigma}: {errors} {claimed}");
        }
    }

    #[test]
    fn white_noise_is_measured_in_spite_of_steps_between_poses_and_one_pose_that_slips() {
        let mut rng = Philox::new(3, 0, Stream::Host);
        let mut values: Vec<f64> = (0..20_000).map(|_| rng.normal()).collect();
        let poses: Vec<Range<usize>> = (0..20).map(|k| k * 1000..k * 1000 + 800).collect();
        for (k, pose) in poses.iter().enumerate() {
            values[pose.clone()].iter_mut().for_each(|v| *v += 50.0 * k as f64);
        }
        values[400..800].iter_mut().for_each(|v| *v += 10.0);
        let noise = AxisNoise::inside(&[&values], &poses, 100.0)[0];
        // σ = N√f: one per sample at 100 Hz is N = 0.1.
        assert!((noise.random_walk - 0.1).abs() < 0.01, "{noise:?}");
        assert!(noise.mean_variance(8.0).sqrt() < 0.06, "{noise:?}");
    }
}
