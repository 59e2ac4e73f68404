//! The Kalman filter that fuses a gyro's rate with an accelerometer's tilt: two states, tilt and
//! gyro bias.
//!
//! Plain, or with the accelerometer weighted by how far |a| departs from g, or with that and an R
//! adapted to how the innovations scatter. Not for attitude in three axes or with heading.

use nalgebra::{Matrix2, RowVector2, Vector2};

/// Sensor noise and initial uncertainty that the filter assumes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// Time between readings, s.
    pub step_s: f64,
    /// Angle random walk of the gyro, rad/√s.
    pub angle_walk_rad_rts: f64,
    /// Random walk of the gyro's bias, rad/s/√s.
    pub bias_walk_rad_s_rts: f64,
    /// Deviation of one tilt from the accelerometer at rest, rad.
    pub tilt_noise_rad: f64,
    /// Deviation of one component of specific force at rest, m/s².
    pub force_noise_m_s2: f64,
    /// Gravity g, m/s².
    pub gravity_m_s2: f64,
    /// Belief at the start: deviation of tilt, rad, and of bias, rad/s.
    pub start_deviation: [f64; 2],
}

/// Rule for the accelerometer's measurement variance R.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weighting {
    /// Always as at rest: the filter of the paper.
    Plain,
    /// R grows with ||a| − g|.
    Magnitude,
    /// That, and R at least what recent innovations show.
    Adaptive,
}

/// One reading: rate of the tilt by the gyro, tilt by the accelerometer, length of its specific
/// force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Rate of the tilt by the gyro, rad/s.
    pub rate_rad_s: f64,
    /// Tilt by the accelerometer, rad.
    pub tilt_rad: f64,
    /// Magnitude of the accelerometer's reading, m/s².
    pub force_m_s2: f64,
}

/// Result of one update.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Update {
    /// Tilt (rad) and gyro bias (rad/s) after it.
    pub state: Vector2<f64>,
    /// Covariance of tilt and gyro bias after the update.
    pub covariance: Matrix2<f64>,
    /// Kalman gain on tilt and gyro bias.
    pub gain: Vector2<f64>,
    /// Innovation squared over its variance (NIS): mean 1 while the filter's beliefs are true.
    pub nis: f64,
    /// Variance given to the accelerometer's tilt, rad².
    pub tilt_variance_rad2: f64,
}

/// The two-state filter: estimate and covariance.
#[derive(Debug, Clone)]
pub struct Filter {
    model: Model,
    weighting: Weighting,
    state: Vector2<f64>,
    covariance: Matrix2<f64>,
    /// Largest excess of | |a| − g | within the memory, m/s², and its age, s.
    excess: (f64, f64),
    /// Fading mean and variance of the innovations, rad and rad².
    innovations: (f64, f64),
}

/// Memory of the weighting, s: long enough to bridge the moments at which a swinging acceleration
/// passes through zero.
const MEMORY_S: f64 = 0.1;

impl Model {
    /// F: the tilt advances by the rate less the bias.
    pub fn transition(&self) -> Matrix2<f64> {
        Matrix2::new(1.0, -self.step_s, 0.0, 1.0)
    }

    /// H: the accelerometer sees the tilt.
    pub fn observation(&self) -> RowVector2<f64> {
        RowVector2::new(1.0, 0.0)
    }

    /// Q: what one step adds to the uncertainty.
    pub fn process_noise(&self) -> Matrix2<f64> {
        let (angle, bias, h) = (self.angle_walk_rad_rts.powi(2), self.bias_walk_rad_s_rts.powi(2), self.step_s);
        Matrix2::new(angle * h + bias * h.powi(3) / 3.0, -bias * h * h / 2.0, -bias * h * h / 2.0, bias * h)
    }

    /// The covariance before an update that the filter settles to, by doubling (Anderson 1978):
    /// each round squares the number of steps done. Independent of the filter's own recursion.
    pub fn settled_covariance(&self) -> Matrix2<f64> {
        let h = self.observation();
        let mut a = self.transition().transpose();
        let mut g = h.transpose() * h / self.tilt_noise_rad.powi(2);
        let mut p = self.process_noise();
        for _ in 0..40 {
            let Some(inverse) = (Matrix2::identity() + g * p).try_inverse() else { break };
            let next = a.transpose() * p * inverse * a;
            let reach = a * inverse * g * a.transpose();
            a = a * inverse * a;
            (g, p) = (g + reach, p + next);
        }
        p
    }
}

impl Filter {
    /// A filter that starts from a tilt and no bias.
    pub fn new(model: Model, weighting: Weighting, tilt_rad: f64) -> Self {
        let [tilt, bias] = model.start_deviation;
        Self {
            model,
            weighting,
            state: Vector2::new(tilt_rad, 0.0),
            covariance: Matrix2::new(tilt * tilt, 0.0, 0.0, bias * bias),
            excess: (0.0, 0.0),
            innovations: (0.0, 0.0),
        }
    }

    /// Predicts by the gyro, then corrects by the accelerometer.
    pub fn step(&mut self, reading: Reading) -> Update {
        let (f, h) = (self.model.transition(), self.model.observation());
        self.state = f * self.state + Vector2::new(self.model.step_s * reading.rate_rad_s, 0.0);
        self.covariance = f * self.covariance * f.transpose() + self.model.process_noise();
        let innovation = reading.tilt_rad - (h * self.state)[0];
        let believed = (h * self.covariance * h.transpose())[0];
        let tilt_variance_rad2 = self.tilt_variance(reading, innovation);
        let variance = believed + tilt_variance_rad2;
        let gain = self.covariance * h.transpose() / variance;
        self.state += gain * innovation;
        // Joseph's form keeps the covariance symmetric and positive.
        let factor = Matrix2::identity() - gain * h;
        self.covariance = factor * self.covariance * factor.transpose() + gain * gain.transpose() * tilt_variance_rad2;
        let nis = innovation * innovation / variance;
        Update { state: self.state, covariance: self.covariance, gain, nis, tilt_variance_rad2 }
    }

    /// R for this reading.
    fn tilt_variance(&mut self, reading: Reading, innovation: f64) -> f64 {
        let rest = self.model.tilt_noise_rad.powi(2);
        if self.weighting == Weighting::Plain {
            return rest;
        }
        // Beyond four deviations of noise: a sideways acceleration a lengthens the force by a²/2g
        // and tilts it by a/g, so that the square of the tilt is 2(|a| − g)/g.
        let beyond = (reading.force_m_s2 - self.model.gravity_m_s2).abs() - 4.0 * self.model.force_noise_m_s2;
        let (held, age_s) = self.excess;
        let expired = age_s + self.model.step_s > MEMORY_S;
        self.excess =
            if beyond.max(0.0) >= held || expired { (beyond.max(0.0), 0.0) } else { (held, age_s + self.model.step_s) };
        let moved = rest + 2.0 * self.excess.0 / self.model.gravity_m_s2;
        if self.weighting == Weighting::Magnitude {
            return moved;
        }
        // The scatter of the innovations about their mean: a steady innovation is the filter's own
        // error and must be followed, a scattered one is motion. Twelve effective samples scatter
        // by chance up to 4 R.
        let weight = 1.0 - (-self.model.step_s / MEMORY_S).exp();
        let (mean, variance) = self.innovations;
        let away = innovation - mean;
        self.innovations = (mean + weight * away, (1.0 - weight) * (variance + weight * away * away));
        let seen = self.innovations.1;
        if seen > 4.0 * rest { moved.max(seen) } else { moved }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODEL: Model = Model {
        step_s: 0.01,
        angle_walk_rad_rts: 6e-4,
        bias_walk_rad_s_rts: 5e-5,
        tilt_noise_rad: 1.4e-3,
        force_noise_m_s2: 0.014,
        gravity_m_s2: 9.8,
        start_deviation: [0.02, 0.01],
    };

    #[test]
    fn the_recursion_settles_where_doubling_says() {
        let mut filter = Filter::new(MODEL, Weighting::Plain, 0.0);
        let rest = Reading { rate_rad_s: 0.0, tilt_rad: 0.0, force_m_s2: 9.8 };
        for _ in 0..100_000 {
            filter.step(rest);
        }
        let f = MODEL.transition();
        let before = f * filter.covariance * f.transpose() + MODEL.process_noise();
        let settled = MODEL.settled_covariance();
        assert!((before - settled).norm() < 1e-9 * settled.norm(), "{before} {settled}");
    }

    #[test]
    fn at_rest_all_weightings_are_the_same_filter() {
        let run = |weighting| {
            let mut filter = Filter::new(MODEL, weighting, 0.0);
            (0..500).map(|_| filter.step(Reading { rate_rad_s: 0.0, tilt_rad: 1e-4, force_m_s2: 9.81 }).gain[0]).last()
        };
        assert_eq!(run(Weighting::Plain), run(Weighting::Magnitude));
        assert_eq!(run(Weighting::Plain), run(Weighting::Adaptive));
    }
}
