//! Plain numbers behind the figures and the words of a diagnosis of sweeps.

pub use super::jumps::Jump;
use crate::verdict::Thermal;

/// One sweep as it was read and as both models have it.
#[derive(Debug, Clone, Default)]
pub struct Sweep {
    /// States whether it goes up.
    pub rises: bool,
    /// Its drive.
    pub drive: f64,
    /// Frequency, Hz, of each step.
    pub frequency_hz: Vec<f64>,
    /// X and Y as read.
    pub read: Vec<[f64; 2]>,
    /// The same by the base model.
    pub base: Vec<[f64; 2]>,
    /// The same by the final model, followed through the sweep.
    pub model: Vec<[f64; 2]>,
    /// Errors of the base model and of the final model over the noise.
    pub errors: Vec<[f64; 2]>,
}

/// Frequency of largest amplitude for one drive, and the folds between which two motions are
/// stable.
#[derive(Debug, Clone, Default)]
pub struct Backbone {
    /// Frequency, Hz, and amplitude of the motion of phase quadrature over a range of drives.
    pub spine: Vec<(f64, f64)>,
    /// For each drive of the recording, every stable motion: frequency and amplitude.
    pub branches: Vec<(f64, Vec<(f64, f64)>)>,
}

/// Numbers and typed reasons.
#[derive(Debug, Clone, Default)]
pub struct Detail {
    /// Sweeps in the order taken.
    pub sweeps: Vec<Sweep>,
    /// Resonance of the final model.
    pub backbone: Backbone,
    /// Jumps as read and as predicted.
    pub jumps: Vec<Jump>,
    /// Unit of the reading.
    pub unit: String,
    /// Unit of the drive.
    pub drive_unit: String,
    /// f₀ and width of the final model, Hz.
    pub resonance_hz: [f64; 2],
    /// Harmonics of the motion that were followed.
    pub harmonics: usize,
    /// Laws that would remove part of the error, and not enough of it to be named.
    pub imitations: Vec<String>,
    /// Standard deviation of the noise, and by how much the final model's residual exceeds its
    /// variance.
    pub noise: f64,
    /// Mean square of the final residual over that of the noise, less one.
    pub excess: f64,
    /// Thermomechanical noise, where the model states what it follows from.
    pub thermal: Option<Thermal>,
    /// States whether a quadratic spring would do as well as the softening one that is named.
    pub may_be_quadratic: bool,
}
