//! States what an IMU makes of specific force and rate, and the way back from counts to m/s² and
//! rad/s.
//!
//! Accelerometer, axis i: (y − o)/s = v + k₂v² + k₃v³ + cτ + d(t), v = M f. Its M is upper
//! triangular with ones: the frame is the accelerometer's own, z along its z axis, because
//! gravity's length alone cannot show a rotation of all axes together. Gyro: the same with w = M
//! ω + K f for v; its six off-diagonal M stand against the accelerometer's frame. τ is an
//! environment column; d(t), the slow drift of an offset, is a sum of three cosines over the
//! recording. Not for fitting: see `fit`.

use nalgebra::{Matrix3, Vector3};

/// Number of parameters, fitted or not.
pub(crate) const PARAMETERS: usize = 70;
/// A point in the space of all parameters; zero is "absent" except for offsets and common scales.
pub type Point = [f64; PARAMETERS];
/// Cosines that a slow drift is made of.
pub(super) const DRIFT_TERMS: usize = 3;

/// Holds what changes slowly while it is recorded, at one time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Slow {
    /// τ: the environment column less its mean; zero without one.
    pub covariate: f64,
    /// cos(nπu), n = 1, 2, 3, with u the fraction of the recording that has passed.
    pub cosines: [f64; DRIFT_TERMS],
}

/// Places of the accelerometer's parameters.
pub mod accelerometer {
    use std::ops::Range;
    /// Places of the offsets of x, y and z, counts.
    pub const OFFSET: Range<usize> = 0..3;
    /// Common scale, counts per m/s².
    pub const SCALE: Range<usize> = 3..4;
    /// Scale of y and z over that of x, less one.
    pub const AXIS_SCALE: Range<usize> = 4..6;
    /// M's xy, xz, yz.
    pub const MISALIGNMENT: Range<usize> = 6..9;
    /// k₂ per axis, 1/(m/s²).
    pub const QUADRATIC: Range<usize> = 9..12;
    /// k₃ per axis, 1/(m/s²)².
    pub const CUBIC: Range<usize> = 12..15;
    /// c per axis, m/s² per unit of τ.
    pub const TEMPERATURE: Range<usize> = 15..18;
    /// Slow drift, three cosines of x, then of y and z, m/s².
    pub const DRIFT: Range<usize> = 51..60;
}

/// Places of the gyro's parameters.
pub mod gyro {
    use std::ops::Range;
    /// Places of the offsets of x, y and z, counts.
    pub const OFFSET: Range<usize> = 18..21;
    /// Common scale, counts per rad/s.
    pub const SCALE: Range<usize> = 21..22;
    /// Scale of y and z over that of x, less one.
    pub const AXIS_SCALE: Range<usize> = 22..24;
    /// M's xy, xz, yx, yz, zx, zy.
    pub const MISALIGNMENT: Range<usize> = 24..30;
    /// K by rows, rad/s per m/s².
    pub const G_SENSITIVITY: Range<usize> = 30..39;
    /// k₂ per axis, 1/(rad/s).
    pub const QUADRATIC: Range<usize> = 39..42;
    /// k₃ per axis, 1/(rad/s)².
    pub const CUBIC: Range<usize> = 42..45;
    /// c per axis, rad/s per unit of τ.
    pub const TEMPERATURE: Range<usize> = 45..48;
    /// Rate of the frame itself (the earth), in the first pose's frame, rad/s.
    pub const FRAME_RATE: Range<usize> = 48..51;
    /// Slow drift, three cosines of x, then of y and z, rad/s.
    pub const DRIFT: Range<usize> = 60..69;
    /// States what the gyro's own filter changes in the coning correction: see `turn`.
    pub const CONING: Range<usize> = 69..70;
}

/// Off-diagonal places of the gyro's M in the order of its parameters.
pub(crate) const GYRO_OFF_DIAGONAL: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];

/// Below this slope a reading's curve is treated as if it went on straight: no sensor in use reads
/// a fifth of a change.
const LEAST_SLOPE: f64 = 0.2;

/// One sensor's way from counts to SI, per axis and across axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triad {
    /// Reading at zero input, per axis, counts.
    pub offset: Vector3<f64>,
    /// Counts per m/s² or rad/s, per axis.
    pub scale: Vector3<f64>,
    /// M: rows are sensitive axes in the accelerometer's frame.
    pub alignment: Matrix3<f64>,
    /// Second-order scale error k₂, per axis.
    pub quadratic: Vector3<f64>,
    /// Third-order scale error k₃, per axis.
    pub cubic: Vector3<f64>,
    /// Offset per unit of the environment column, per axis, m/s² or rad/s.
    pub temperature: Vector3<f64>,
    /// d(t): rows are axes, columns cosines.
    pub drift: Matrix3<f64>,
    /// M⁻¹.
    inverse: Matrix3<f64>,
}

impl Triad {
    /// Returns what the reading equation makes of the counts on one axis before its curve is
    /// undone: v + k₂v² + k₃v³.
    pub fn curved(&self, axis: usize, counts: f64, slow: &Slow) -> f64 {
        let drift: f64 = (0..DRIFT_TERMS).map(|n| self.drift[(axis, n)] * slow.cosines[n]).sum();
        (counts - self.offset[axis]) / self.scale[axis] - self.temperature[axis] * slow.covariate - drift
    }

    /// The v for which v + k₂v² + k₃v³ = `curved`, on the branch through zero, and the slope of the
    /// left side there.
    pub fn straightened(&self, axis: usize, curved: f64) -> (f64, f64) {
        let (k2, k3) = (self.quadratic[axis], self.cubic[axis]);
        let slope = |v: f64| 1.0 + 2.0 * k2 * v + 3.0 * k3 * v * v;
        let mut v = curved;
        if k2 == 0.0 && k3 == 0.0 {
            return (v, 1.0);
        }
        // Newton; where the curve turns back there is no solution, and the nearest point that the
        // steps reach stands for it.
        for _ in 0..20 {
            let step = (v + k2 * v * v + k3 * v * v * v - curved) / slope(v).max(LEAST_SLOPE);
            v -= step;
            if step.abs() <= 1e-14 * v.abs() {
                break;
            }
        }
        if v.is_finite() { (v, slope(v).max(LEAST_SLOPE)) } else { (curved, 1.0) }
    }

    /// The reading in SI along the sensitive axes, before alignment is undone.
    pub fn along_axes(&self, counts: Vector3<f64>, slow: &Slow) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.straightened(i, self.curved(i, counts[i], slow)).0)
    }

    /// M⁻¹, from calibrated axes back to the sensor's own.
    pub fn unalign(&self) -> &Matrix3<f64> {
        &self.inverse
    }
}

/// A fitted IMU: turns counts into m/s² and rad/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// The accelerometer: counts to m/s².
    pub accelerometer: Triad,
    /// The gyro: counts to rad/s.
    pub gyro: Triad,
    /// K: rows gyro axes, columns specific force, rad/s per m/s².
    pub g_sensitivity: Matrix3<f64>,
    /// Rate of the frame in the first pose's frame, rad/s.
    pub frame_rate_rad_s: Vector3<f64>,
    /// Change of the coning coefficient by the gyro's filter, in squared sampling intervals.
    pub coning: f64,
}

impl Calibration {
    /// The calibration that a parameter point stands for.
    pub fn from_point(p: &Point) -> Self {
        let three = |r: std::ops::Range<usize>| Vector3::new(p[r.start], p[r.start + 1], p[r.start + 2]);
        let scale = |common: usize, axis: usize| p[common] * Vector3::new(1.0, 1.0 + p[axis], 1.0 + p[axis + 1]);
        let m = &p[accelerometer::MISALIGNMENT];
        let upper = Matrix3::new(1.0, m[0], m[1], 0.0, 1.0, m[2], 0.0, 0.0, 1.0);
        let mut full = Matrix3::identity();
        for ((i, j), value) in GYRO_OFF_DIAGONAL.iter().zip(&p[gyro::MISALIGNMENT]) {
            full[(*i, *j)] = *value;
        }
        let triad = |offset, scale, alignment: Matrix3<f64>, quadratic, cubic, temperature, drift| Triad {
            offset,
            scale,
            alignment,
            quadratic,
            cubic,
            temperature,
            drift,
            inverse: alignment.try_inverse().unwrap_or_else(Matrix3::identity),
        };
        Self {
            accelerometer: triad(
                three(accelerometer::OFFSET),
                scale(accelerometer::SCALE.start, accelerometer::AXIS_SCALE.start),
                upper,
                three(accelerometer::QUADRATIC),
                three(accelerometer::CUBIC),
                three(accelerometer::TEMPERATURE),
                Matrix3::from_row_slice(&p[accelerometer::DRIFT]),
            ),
            gyro: triad(
                three(gyro::OFFSET),
                scale(gyro::SCALE.start, gyro::AXIS_SCALE.start),
                full,
                three(gyro::QUADRATIC),
                three(gyro::CUBIC),
                three(gyro::TEMPERATURE),
                Matrix3::from_row_slice(&p[gyro::DRIFT]),
            ),
            g_sensitivity: Matrix3::from_row_slice(&p[gyro::G_SENSITIVITY]),
            frame_rate_rad_s: three(gyro::FRAME_RATE),
            coning: p[gyro::CONING.start],
        }
    }

    /// Specific force in the accelerometer's frame, m/s². `slow` is what changed slowly by then.
    pub fn specific_force_m_s2(&self, counts: [f64; 3], slow: &Slow) -> Vector3<f64> {
        self.accelerometer.inverse * self.accelerometer.along_axes(counts.into(), slow)
    }

    /// Angular rate in the accelerometer's frame, rad/s, free of what the specific force does to
    /// the gyro.
    pub fn rate_rad_s(&self, counts: [f64; 3], specific_force_m_s2: &Vector3<f64>, slow: &Slow) -> Vector3<f64> {
        self.gyro.inverse * (self.gyro.along_axes(counts.into(), slow) - self.g_sensitivity * specific_force_m_s2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_come_back_as_the_force_and_rate_that_made_them() {
        let mut p = [0.0; PARAMETERS];
        p[..9].copy_from_slice(&[100.0, -20.0, 7.0, 400.0, 0.01, -0.02, 0.01, -0.02, 0.03]);
        p[18..30].copy_from_slice(&[5.0, 6.0, 7.0, 4800.0, 0.01, 0.02, 0.01, 0.02, -0.03, 0.04, 0.05, -0.06]);
        p[30..39].copy_from_slice(&[1e-4; 9]);
        let c = Calibration::from_point(&p);
        let (force, rate) = (Vector3::new(1.0, -2.0, 9.0), Vector3::new(0.3, -0.2, 1.1));
        let a = c.accelerometer.offset + c.accelerometer.scale.component_mul(&(c.accelerometer.alignment * force));
        let g = c.gyro.offset + c.gyro.scale.component_mul(&(c.gyro.alignment * rate + c.g_sensitivity * force));
        let back = c.specific_force_m_s2(a.into(), &Slow::default());
        assert!((back - force).norm() < 1e-12);
        assert!((c.rate_rad_s(g.into(), &back, &Slow::default()) - rate).norm() < 1e-12);
    }

    #[test]
    fn a_curved_reading_is_undone_exactly_and_one_without_an_inverse_stays_finite() {
        let mut p = [0.0; PARAMETERS];
        (p[accelerometer::SCALE.start], p[gyro::SCALE.start]) = (1.0, 1.0);
        (p[accelerometer::QUADRATIC.start], p[accelerometer::CUBIC.start]) = (3e-3, -4e-4);
        let triad = Calibration::from_point(&p).accelerometer;
        for v in [-9.8, -3.0, 0.0, 0.1, 9.8f64] {
            let counts = v + 3e-3 * v * v - 4e-4 * v * v * v;
            assert!((triad.along_axes(Vector3::repeat(counts), &Slow::default()).x - v).abs() < 1e-12);
        }
        // This curve turns back at v = −5, where it reads −2.5.
        p[accelerometer::QUADRATIC.start] = 0.1;
        p[accelerometer::CUBIC.start] = 0.0;
        let triad = Calibration::from_point(&p).accelerometer;
        assert!(triad.along_axes(Vector3::repeat(-9.8), &Slow::default()).x.is_finite());
    }
}
