//! Dead reckoning of errors: what a wrong rate and a wrong acceleration become in tilt, speed and
//! distance (eq. 1 and 2).
//!
//! One horizontal axis; tilt leaks gravity into it. Not for readings: integrating errors keeps
//! every digit.

/// Errors of one member.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Drift {
    /// Tilt error, rad.
    pub tilt_rad: f64,
    /// Speed error, m/s.
    pub speed_m_s: f64,
    /// Distance error, m.
    pub distance_m: f64,
}

impl Drift {
    /// One step of `step_s` during which the accelerometer errs by `acceleration_m_s2` and the gyro
    /// by `rate_rad_s`; exact for errors that are constant over the step. Small angles: g tilt for
    /// g sin tilt.
    #[inline]
    pub fn step(&mut self, acceleration_m_s2: f64, rate_rad_s: f64, gravity_m_s2: f64, step_s: f64) {
        let h = step_s;
        let acceleration = acceleration_m_s2 + gravity_m_s2 * self.tilt_rad;
        let jerk = gravity_m_s2 * rate_rad_s;
        self.distance_m += h * (self.speed_m_s + h * (acceleration / 2.0 + h * jerk / 6.0));
        self.speed_m_s += h * (acceleration + h * jerk / 2.0);
        self.tilt_rad += h * rate_rad_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constant_errors_grow_by_their_powers() {
        let mut drift = Drift::default();
        for _ in 0..1000 {
            drift.step(0.01, 1e-4, 9.8, 0.1);
        }
        let t: f64 = 100.0;
        let expected = 0.5 * 0.01 * t * t + 9.8 * 1e-4 * t.powi(3) / 6.0;
        assert!((drift.distance_m / expected - 1.0).abs() < 1e-12);
    }
}
