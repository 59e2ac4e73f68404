//! One ensemble, ready to integrate: everything a backend needs, in SI units and f64.

use std::sync::Arc;

pub use super::integrator::Integrator;
pub use crate::excitation::{MemberSine, Waveform};
use crate::sensor::Sensor;
pub use crate::statistics::QUANTITIES;

/// Discrete time. A sample is `steps_per_sample` integration steps; a run is a whole number of samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// Integration step h, s.
    pub step_s: f64,
    /// Steps between readings.
    pub steps_per_sample: u32,
    /// Length of the run in samples.
    pub samples: u64,
    /// Samples after which statistics are taken, increasing, 1-based (the last one is usually `samples`).
    pub report_samples: Vec<u64>,
}

/// One member as drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Member {
    /// Its sensor.
    pub sensor: Sensor,
    /// Its own sine, where the study draws one per member.
    pub sine: Option<MemberSine>,
}

/// One ensemble.
#[derive(Clone)]
pub struct Job {
    /// Seed of every random number.
    pub seed: u64,
    /// Number of members.
    pub members: u64,
    /// Discrete time.
    pub clock: Clock,
    /// Draws a member; a pure function of its index.
    pub draw: Arc<dyn Fn(u64) -> Member + Send + Sync>,
    /// Shared excitation.
    pub waveform: Arc<dyn Waveform>,
    /// How the proof mass is stepped, the same for all members.
    pub integrator: Integrator,
    /// g by which tilt becomes acceleration, m/s².
    pub gravity_m_s2: f64,
}
