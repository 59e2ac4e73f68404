//! The sensor with and without the named physics: what a study can run, and what it cannot express.

use crate::sensor::Sensor;

/// A sine that the cost is stated under.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vibration {
    /// Amplitude, m/s².
    pub amplitude_m_s2: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

/// The loop closed: a sensor in SI units before and after the diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct Repair {
    /// The base model as fitted alone.
    pub before: Sensor,
    /// With the named physics, all fitted together.
    pub after: Sensor,
    /// How the recording's units became metres and m/s², in a sentence: "1 V of input is taken as 1 m/s²".
    pub relation: String,
    /// Named terms that a study cannot run; written as comments.
    pub not_expressible: Vec<String>,
    /// As strong as the recording's own excitation, so that the sensor is used where it was identified.
    pub vibration: Vibration,
    /// Drift that the omission costs, computed by the kind itself because no study expresses the term.
    pub own_cost: Vec<Cost>,
}

/// Position error when the physics is left out of the sensor's model.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Cost {
    /// What is left out, e.g. "cubic-stiffness".
    pub of: String,
    /// Under what: "5 m/s² at 3 Hz".
    pub under: String,
    /// Position error after 10 s, m.
    pub position_10_s_m: f64,
    /// Position error after 60 s, m.
    pub position_60_s_m: f64,
    /// How it was computed, in a few words.
    pub basis: String,
}
