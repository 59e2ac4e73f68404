//! Options of an ensemble, as the caller wants it run.

use crate::backend::cpu::Precision;
use crate::control::Control;

/// The backend to integrate on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Choice {
    /// A hardware GPU if present and the ensemble is large enough to benefit, else the CPU.
    #[default]
    Auto,
    /// Any GPU adapter, including software ones.
    Gpu,
    /// The lanes of the CPU.
    Cpu,
}

impl Choice {
    /// Every choice.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Gpu, Self::Cpu];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Gpu => "gpu",
            Self::Cpu => "cpu",
        }
    }
}

/// Device, precision and batches of a run.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Device to integrate on.
    pub backend: Choice,
    /// Precision; f64 means the CPU.
    pub precision: Precision,
    /// Members per batch, where the backend's own choice is not wanted (a multiple of 256).
    pub batch_members: Option<u64>,
    /// Watcher that sees progress and may stop the run.
    pub control: Control,
}
