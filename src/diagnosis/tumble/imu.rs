//! The recording as this kind sees it: six columns, still poses, moves between them, and how noisy
//! each is.

use std::ops::Range;

use nalgebra::Vector3;

use super::calibration::{DRIFT_TERMS, Slow};
use super::noise::{AxisNoise, batch_error};

/// Six columns of counts on a uniform clock.
#[derive(Debug, Clone)]
pub struct Imu<'a> {
    /// Sampling rate of all columns, Hz.
    pub rate_hz: f64,
    /// Rates x, y, z, counts; `None` where the accelerometer was recorded alone.
    pub gyro: Option<[&'a [f64]; 3]>,
    /// Specific forces x, y, z, counts.
    pub accelerometer: [&'a [f64]; 3],
    /// τ per sample: an environment column less its mean; `None` without one.
    pub covariate: Option<Vec<f64>>,
    /// Magnitude of gravity at the place of recording, m/s².
    pub gravity_m_s2: f64,
}

/// Means over one still pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Samples of the pose, half-open.
    pub samples: Range<usize>,
    /// Mean specific force, counts.
    pub accelerometer: Vector3<f64>,
    /// Mean of the gyro, counts.
    pub gyro: Vector3<f64>,
    /// Variance of the means by noise, counts².
    pub accelerometer_variance: Vector3<f64>,
    /// Variance of the means by noise, counts².
    pub gyro_variance: Vector3<f64>,
    /// Holds what changes slowly, mean over the samples.
    pub slow: Slow,
    /// States whether it is fitted and judged; one that disagrees with all others is not.
    pub counts: bool,
}

/// Poses, moves and noise: what is fitted.
#[derive(Debug, Clone)]
pub struct Observed<'a> {
    /// The recording in counts.
    pub imu: Imu<'a>,
    /// The poses, in order of time.
    pub poses: Vec<Pose>,
    /// Counts per m/s² by which noise in counts becomes noise in SI; fixed, so that a fit cannot
    /// gain by inflating its noise.
    pub accelerometer_scale: f64,
    /// Counts per rad/s, likewise.
    pub gyro_scale: f64,
    /// Factor from the readings of accelerometer and gyro to SI, where the file states their unit.
    pub told: [Option<f64>; 2],
    /// Noise of the accelerometer's axes, counts.
    pub accelerometer_noise: [AxisNoise; 3],
    /// Noise of the gyro's axes, counts.
    pub gyro_noise: [AxisNoise; 3],
}

impl<'a> Imu<'a> {
    /// Returns what changes slowly, at one sample.
    pub fn slow_at(&self, sample: usize) -> Slow {
        let samples = self.accelerometer[0].len().max(1);
        let first = (std::f64::consts::PI * (sample as f64 + 0.5) / samples as f64).cos();
        let second = 2.0 * first * first - 1.0;
        let cosines: [f64; DRIFT_TERMS] = [first, second, first * (2.0 * second - 1.0)];
        Slow { covariate: self.covariate.as_ref().map_or(0.0, |c| c[sample]), cosines }
    }

    /// One sample of the gyro, counts.
    pub fn gyro_at(&self, sample: usize) -> Vector3<f64> {
        self.gyro.map_or(Vector3::zeros(), |gyro| Vector3::from_fn(|i, _| gyro[i][sample]))
    }

    /// One sample of the accelerometer, counts.
    pub fn accelerometer_at(&self, sample: usize) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.accelerometer[i][sample])
    }

    /// Means and noise in the poses.
    pub fn observe(self, poses: &[Range<usize>]) -> Observed<'a> {
        let noise = |columns: &[&[f64]; 3]| -> [AxisNoise; 3] {
            let found = AxisNoise::inside(columns, poses, self.rate_hz);
            std::array::from_fn(|axis| found[axis])
        };
        let accelerometer_noise = noise(&self.accelerometer);
        let gyro_noise = self.gyro.as_ref().map_or([AxisNoise::default(); 3], noise);
        let poses = poses.iter().map(|samples| {
            let mean = |c: &[f64]| c[samples.clone()].iter().sum::<f64>() / samples.len().max(1) as f64;
            let over = |of: &dyn Fn(&Slow) -> f64| {
                samples.clone().map(|k| of(&self.slow_at(k))).sum::<f64>() / samples.len().max(1) as f64
            };
            Pose {
                accelerometer: Vector3::from_fn(|i, _| mean(self.accelerometer[i])),
                gyro: self.gyro.map_or(Vector3::zeros(), |gyro| Vector3::from_fn(|i, _| mean(gyro[i]))),
                accelerometer_variance: Vector3::zeros(),
                gyro_variance: Vector3::zeros(),
                slow: Slow {
                    covariate: over(&|s| s.covariate),
                    cosines: std::array::from_fn(|n| over(&|s| s.cosines[n])),
                },
                samples: samples.clone(),
                counts: true,
            }
        });
        let poses = poses.collect();
        let (imu, told) = (self, [None; 2]);
        let mut observed =
            Observed { imu, poses, accelerometer_scale: 1.0, gyro_scale: 1.0, told, accelerometer_noise, gyro_noise };
        observed.weigh();
        observed
    }
}

impl Observed<'_> {
    /// Variance of each pose's means by the noise as it is known now.
    pub fn weigh(&mut self) {
        let imu = &self.imu;
        let of = |columns: &[&[f64]; 3], noise: &[AxisNoise; 3], samples: &Range<usize>| {
            let length_s = samples.len() as f64 / imu.rate_hz;
            Vector3::from_fn(|i, _| {
                let (expected, own) =
                    (noise[i].mean_variance(length_s), batch_error(&columns[i][samples.clone()]).powi(2));
                // Batches scatter by chance (7 degrees of freedom: a factor 3.5 is one in a
                // thousand); beyond that the pose was not still, and counts for less.
                if own > 3.5 * expected { own } else { expected }
            })
        };
        for pose in &mut self.poses {
            pose.accelerometer_variance = of(&imu.accelerometer, &self.accelerometer_noise, &pose.samples);
            pose.gyro_variance =
                imu.gyro.as_ref().map_or(Vector3::zeros(), |gyro| of(gyro, &self.gyro_noise, &pose.samples));
        }
    }

    /// Poses that are fitted and judged.
    pub fn counting(&self) -> usize {
        self.poses.iter().filter(|p| p.counts).count()
    }

    /// The middle of a pose, s.
    pub fn middle_s(&self, pose: usize) -> f64 {
        let samples = &self.poses[pose].samples;
        0.5 * (samples.start + samples.end) as f64 / self.imu.rate_hz
    }
}
