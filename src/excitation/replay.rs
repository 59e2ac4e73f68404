//! A recorded acceleration played back, linear between its samples.

use super::Waveform;

/// Samples on a uniform clock that starts at t = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Replay {
    /// Specific force at k / `rate_hz`, m/s².
    pub samples_m_s2: Vec<f64>,
    /// Sampling rate of the recording.
    pub rate_hz: f64,
}

impl Replay {
    /// Time of the last sample, s.
    pub fn length_s(&self) -> f64 {
        self.samples_m_s2.len().saturating_sub(1) as f64 / self.rate_hz
    }
}

impl Waveform for Replay {
    /// Linear between samples; outside the recording its first or last value.
    fn specific_force_m_s2(&self, time_s: f64) -> f64 {
        let place = (time_s * self.rate_hz).max(0.0);
        let before = place.floor() as usize;
        match (self.samples_m_s2.get(before), self.samples_m_s2.get(before + 1)) {
            (Some(a), Some(b)) => a + (b - a) * (place - before as f64),
            _ => self.samples_m_s2.last().copied().unwrap_or(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_passes_through_its_samples_and_halfway_between_them() {
        let replay = Replay { samples_m_s2: vec![0.0, 1.0, -1.0], rate_hz: 10.0 };
        let at = |t| replay.specific_force_m_s2(t);
        assert_eq!([at(0.0), at(0.05), at(0.1), at(0.15), at(0.2), at(9.0)], [0.0, 0.5, 1.0, 0.0, -1.0, -1.0]);
        assert_eq!(replay.length_s(), 0.2);
    }
}
