//! One ensemble, ready to integrate: everything a backend needs, in SI units and f64.

use std::sync::Arc;

use super::chained::Chained;
pub use super::integrator::Integrator;
pub use crate::excitation::{MemberSine, Waveform};
use crate::motion::temperature::Temperature;
use crate::numerics::elementary::Real;
use crate::sensor::{Sensor, SensorTerm};

/// Discrete time. A sample is `steps_per_sample` integration steps; a run is a whole number of
/// samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// Integration step h, s.
    pub step_s: f64,
    /// Steps between readings.
    pub steps_per_sample: u32,
    /// Length of the run in samples.
    pub samples: u64,
    /// Samples after which statistics are taken, increasing, 1-based (the last one is usually
    /// `samples`).
    pub report_samples: Vec<u64>,
    /// Number of the first samples that are a still start: the sensor stands still, and at their
    /// end the mean errors of accelerometer and gyro are taken off and the integrals begin. Zero
    /// for an ideal start.
    pub still_samples: u64,
}

impl Clock {
    /// Time between readings, s.
    pub fn sample_s(&self) -> f64 {
        self.step_s * f64::from(self.steps_per_sample)
    }

    /// One over the samples of the still start, 0 without one.
    pub fn still_share(&self) -> f64 {
        if self.still_samples == 0 { 0.0 } else { 1.0 / self.still_samples as f64 }
    }

    /// Length of the run, s, its still start included.
    pub fn duration_s(&self) -> f64 {
        self.samples as f64 * self.sample_s()
    }
}

/// One member as drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Member {
    /// Nominal sensor with the tolerances of its parameters.
    pub sensor: Sensor,
    /// Its own sine, where the study draws one per member.
    pub sine: Option<MemberSine>,
}

/// One ensemble: sensor, excitation, clock and number of members.
#[derive(Clone)]
pub struct Job {
    /// Seed of every random number.
    pub seed: u64,
    /// Number of members.
    pub members: u64,
    /// Discrete time: interval, samples, report times.
    pub clock: Clock,
    /// Draws a member; a pure function of its index.
    pub draw: Arc<dyn Fn(u64) -> Member + Send + Sync>,
    /// Shared excitation.
    pub waveform: Arc<dyn Waveform>,
    /// Integrator of the proof mass, the same for all members.
    pub integrator: Integrator,
    /// Temperature of the sensor; its times count from the end of the still start.
    pub temperature: Arc<Temperature>,
    /// g by which tilt becomes acceleration, m/s².
    pub gravity_m_s2: f64,
    /// Source of the members' random numbers, if these are not those of their index; on the CPU only.
    pub chained: Option<Arc<dyn Chained>>,
}

impl Job {
    /// The tilt, per m/s² of accelerometer error, that levelling by that accelerometer leaves: its
    /// share of gravity hides the error, rad/(m/s²). Zero without gravity.
    pub fn level_rad_per_m_s2(&self) -> f64 {
        if self.gravity_m_s2 == 0.0 { 0.0 } else { 1.0 / self.gravity_m_s2 }
    }

    /// Returns the temperature of the sensor above its reference in the middle of each of `count`
    /// samples from `first` on, K; empty where it stays at its reference.
    pub fn warmer_k<T: Real>(&self, first: u64, count: u64) -> Vec<T> {
        if self.temperature.points.is_empty() {
            return Vec::new();
        }
        let time_s = |n: u64| (n as f64 - self.clock.still_samples as f64 + 0.5) * self.clock.sample_s();
        (first..first + count).map(|n| T::of(self.temperature.above_reference_k(time_s(n)))).collect()
    }

    /// Returns the delay of the readings of the proof masses, s: the first member's, as all have
    /// the same.
    pub fn readout_delay_s(&self) -> f64 {
        (self.draw)(0).sensor.error(SensorTerm::ReadoutDelay)
    }

    /// Steps that the integrator does in a sample, substeps counted.
    pub fn steps_per_sample(&self) -> u64 {
        u64::from(self.clock.steps_per_sample) * u64::from(self.integrator.substeps())
    }

    /// Steps that it does for one member.
    pub fn steps_per_member(&self) -> u64 {
        self.clock.samples.saturating_mul(self.steps_per_sample())
    }

    /// The same over all members: what speeds are stated in.
    pub fn member_steps(&self) -> u64 {
        self.members.saturating_mul(self.steps_per_member())
    }
}
