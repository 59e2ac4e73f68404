//! The recording as this kind sees it: six columns, still poses, moves between them, and how noisy each is.

use std::ops::Range;

use nalgebra::Vector3;

use super::noise::{AxisNoise, batch_error};

/// Six columns of counts on a uniform clock.
#[derive(Debug, Clone)]
pub struct Imu<'a> {
    /// Sampling rate.
    pub rate_hz: f64,
    /// Rates x, y, z, counts.
    pub gyro: [&'a [f64]; 3],
    /// Specific forces x, y, z, counts.
    pub accelerometer: [&'a [f64]; 3],
    /// τ per sample: a temperature column less its mean, or time in minutes from the middle.
    pub covariate: Vec<f64>,
    /// |g| where it was recorded.
    pub gravity_m_s2: f64,
}

/// What was measured in one still pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Samples.
    pub samples: Range<usize>,
    /// Mean specific force, counts.
    pub accelerometer: Vector3<f64>,
    /// Mean rate, counts.
    pub gyro: Vector3<f64>,
    /// Variance of the means by noise, counts².
    pub accelerometer_variance: Vector3<f64>,
    /// Variance of the means by noise, counts².
    pub gyro_variance: Vector3<f64>,
    /// Mean τ.
    pub covariate: f64,
}

/// Poses, moves and noise: what is fitted.
#[derive(Debug, Clone)]
pub struct Observed<'a> {
    /// The recording.
    pub imu: Imu<'a>,
    /// In order of time.
    pub poses: Vec<Pose>,
    /// Counts per m/s² by which noise in counts becomes noise in SI; fixed, so that a fit cannot gain by inflating its noise.
    pub accelerometer_scale: f64,
    /// Counts per rad/s, likewise.
    pub gyro_scale: f64,
    /// Noise of the accelerometer's axes, counts.
    pub accelerometer_noise: [AxisNoise; 3],
    /// Noise of the gyro's axes, counts.
    pub gyro_noise: [AxisNoise; 3],
}

impl<'a> Imu<'a> {
    /// τ when no temperature was recorded: minutes from the middle of the recording.
    pub fn minutes(samples: usize, rate_hz: f64) -> Vec<f64> {
        let middle = samples as f64 / 2.0;
        (0..samples).map(|k| (k as f64 - middle) / rate_hz / 60.0).collect()
    }

    /// One sample of the gyro, counts.
    pub fn gyro_at(&self, sample: usize) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.gyro[i][sample])
    }

    /// One sample of the accelerometer, counts.
    pub fn accelerometer_at(&self, sample: usize) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.accelerometer[i][sample])
    }

    /// Means and noise in the poses.
    pub fn observe(self, poses: &[Range<usize>]) -> Observed<'a> {
        let noise = |columns: &[&[f64]; 3]| columns.map(|c| AxisNoise::inside(c, poses, self.rate_hz));
        let (accelerometer_noise, gyro_noise) = (noise(&self.accelerometer), noise(&self.gyro));
        let poses = poses
            .iter()
            .map(|samples| {
                let length_s = samples.len() as f64 / self.rate_hz;
                let mean = |c: &[f64]| c[samples.clone()].iter().sum::<f64>() / samples.len().max(1) as f64;
                let variance = |columns: &[&[f64]; 3], noise: &[AxisNoise; 3]| {
                    Vector3::from_fn(|i, _| {
                        let (expected, own) =
                            (noise[i].mean_variance(length_s), batch_error(&columns[i][samples.clone()]).powi(2));
                        // Batches scatter by chance (7 degrees of freedom: a factor 3.5 is one in a thousand);
                        // beyond that the pose was not still, and counts for less.
                        if own > 3.5 * expected { own } else { expected }
                    })
                };
                Pose {
                    accelerometer: Vector3::from_fn(|i, _| mean(self.accelerometer[i])),
                    gyro: Vector3::from_fn(|i, _| mean(self.gyro[i])),
                    accelerometer_variance: variance(&self.accelerometer, &accelerometer_noise),
                    gyro_variance: variance(&self.gyro, &gyro_noise),
                    covariate: mean(&self.covariate),
                    samples: samples.clone(),
                }
            })
            .collect();
        Observed { imu: self, poses, accelerometer_scale: 1.0, gyro_scale: 1.0, accelerometer_noise, gyro_noise }
    }
}
