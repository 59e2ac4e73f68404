//! Adds what readings take from the temperature and from stamps that come late, and where a gyro's
//! range ends: errors that follow the run, the same law for all members with numbers of their own.
//!
//! A reading that is stamped τ late was taken τ earlier: its error is −τ times the rate of change
//! of what it reads. A clock that gains d on the true time stamps the reading at time t by d t
//! late.

use nalgebra::Vector3;

use crate::sensor::error_law::full_scale;

/// One member's numbers, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Follow {
    /// Change per kelvin of the accelerometers' biases (m/s²) and scale factors (1), and of the
    /// gyros' (rad/s and 1).
    pub per_kelvin: [[f64; 3]; 4],
    /// Delay of the stamps, s.
    pub late_s: f64,
    /// Standard deviation of how late a single sample is, s: drawn for each, the same for all axes.
    pub jitter_s: f64,
    /// Gain of the stamps on the true time from the end of the still start on, 1.
    pub drift: f64,
    /// Largest magnitude that each gyro reads, rad/s; infinity for none.
    pub gyro_range_rad_s: [f64; 3],
}

/// Numbers of a [`Follow`] as the kernels take them.
pub const FOLLOWED: usize = 18;

impl Follow {
    /// Row by row, the times, and the ranges.
    pub fn numbers(&self) -> [f64; FOLLOWED] {
        let times = [self.late_s, self.jitter_s, self.drift];
        let ranges = self.gyro_range_rad_s.map(full_scale);
        std::array::from_fn(|i| match i {
            0..12 => self.per_kelvin[i / 3][i % 3],
            12..15 => times[i - 12],
            _ => ranges[i - 15],
        })
    }

    /// Mean reading errors of accelerometers and gyros that stand still with this force and rate,
    /// so much warmer than the reference.
    pub fn standing(&self, [force, rate]: [Vector3<f64>; 2], warmer_k: f64) -> [Vector3<f64>; 2] {
        let [bias, scale, gyro_bias, gyro_scale] = self.per_kelvin.map(Vector3::from);
        [(bias + scale.component_mul(&force)) * warmer_k, (gyro_bias + gyro_scale.component_mul(&rate)) * warmer_k]
    }
}
