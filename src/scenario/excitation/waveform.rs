//! A specific force as a function of time.

/// Specific force along the sensitive axis, shared by all members up to `Sensor::excitation_gain`.
pub trait Waveform: Send + Sync {
    /// f(t), m/s².
    fn specific_force_m_s2(&self, time_s: f64) -> f64;

    /// Returns what the axis feels while it stands still before the motion begins, m/s²: none,
    /// where it is level.
    fn standing_m_s2(&self) -> f64 {
        0.0
    }

    /// Returns what a late reading tells of at first where the run does not begin with a still start, m/s²: the first
    /// force. Vibration is not part of it, for it begins with the run; held, its first value would grow with time.
    fn before_m_s2(&self) -> f64 {
        self.specific_force_m_s2(0.0)
    }
}
