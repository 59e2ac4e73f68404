//! What the sensor is subjected to: specific force along the sensitive axis as a function of time.
//!
//! One shape per file. Not for the sensor's answer (`sensor`, `kernel`), and not for reading files: a replay is handed its
//! samples by `study`.

pub mod multisine;
pub mod random;
pub mod rectangle;
pub mod replay;
pub mod shock;
pub mod sine;
pub mod sweep;

use crate::units::key::{Key, Sign};

/// The size of an excitation, where it is drawn per member; its unit is that of the key it was read from.
pub const SIZE: Key = Key::new(26, "excitation.amplitude", "excitation amplitude", "", 1.0, Sign::Any);
/// Frequency of a member's own sine.
pub const FREQUENCY: Key = Key::new(27, "excitation.frequency_hz", "excitation frequency", "Hz", 1.0, Sign::Positive);
/// Phase of a member's own sine.
pub const PHASE: Key = Key::new(28, "excitation.phase_rad", "excitation phase", "rad", 1.0, Sign::Any);

/// Specific force along the sensitive axis, shared by all members up to `Sensor::excitation_gain`.
pub trait Waveform: Send + Sync {
    /// f(t), m/s².
    fn specific_force_m_s2(&self, time_s: f64) -> f64;
}

/// A sine whose amplitude, frequency and phase are drawn per member; added to the shared waveform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MemberSine {
    /// Amplitude, m/s².
    pub amplitude_m_s2: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Phase at t = 0, rad.
    pub phase_rad: f64,
}

/// Nothing moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest;

impl Waveform for Rest {
    fn specific_force_m_s2(&self, _time_s: f64) -> f64 {
        0.0
    }
}
