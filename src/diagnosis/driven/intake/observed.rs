//! Quantity of the mass that is read, and by how much a reading differs from a displacement.

use crate::model::Output;

/// Quantity that is read. Simulations see readings as the displacement of a sine at one frequency, so
/// that sizes of displacement measure whatever is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observed {
    /// Quantity that is read.
    pub output: Output,
    /// Frequency of that sine, rad/s.
    pub omega_rad_s: f64,
    /// States whether the reading follows the input at once: the resonance is far above what was
    /// recorded, and the mass stands where its spring balances the force.
    pub at_once: bool,
}

impl Default for Observed {
    fn default() -> Self {
        Self { output: Output::Displacement, omega_rad_s: 1.0, at_once: false }
    }
}

impl Observed {
    /// Returns the reading of one unit of displacement at that frequency: 1, ω or −ω².
    pub fn per_displacement(self) -> f64 {
        match self.output {
            Output::Displacement => 1.0,
            Output::Velocity => self.omega_rad_s,
            Output::Acceleration => -self.omega_rad_s * self.omega_rad_s,
        }
    }

    /// Returns a reading as the displacement that stands for it.
    pub(crate) fn displacement(self, reading: f64) -> f64 {
        reading / self.per_displacement()
    }
}
