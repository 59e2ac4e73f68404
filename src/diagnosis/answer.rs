//! States what a diagnosis found, whatever the kind of recording: numbers and typed reasons. The
//! words, and with them the public document, are made in `report::diagnosis`.

use super::candidate::Kind;
use super::repair::Repair;
use super::standing::Ranked;
use super::trace::Step;
use super::verdict::{
    DependsOn, Detectable, Effect, Estimate, Fit, Outcome, RecordingInfo, StateCell, Stretch, Whiteness,
};
use super::{driven, response, rest, trajectory, tumble};

/// The result of a diagnosis, before it is put into words.
#[derive(Debug, Clone)]
pub struct Answer {
    /// Kind of recording that was diagnosed.
    pub kind: Kind,
    /// The verdict, one of four.
    pub outcome: Outcome,
    /// File, size and rate of the recording.
    pub recording: RecordingInfo,
    /// The base model's own numbers, fitted together with the named effects; empty where a kind
    /// does not give them.
    pub base: Vec<Estimate>,
    /// Named effects, strongest first.
    pub effects: Vec<Effect>,
    /// Location of the mismatch.
    pub places: Places,
    /// Errors before and after repair, on fitted and held-out samples.
    pub fit: Fit,
    /// States whether the residual of the final model is white.
    pub residual_after: Whiteness,
    /// Found in the file and survived, in sentences.
    pub findings: Vec<String>,
    /// Every candidate that was tried, best first, named or not.
    pub ranking: Vec<Ranked>,
    /// Holds what each rule that acted changed, in their order; driven recordings only.
    pub trace: Vec<Step>,
    /// The sensor with and without the named physics, for a study and for the cost in metres.
    /// `None` where nothing a study could run came out, e.g. when the base model could not be
    /// fitted.
    pub repair: Option<Repair>,
    /// Holds what only this kind of recording has: numbers behind its figures, reasons behind its
    /// words.
    pub detail: Detail,
}

/// Location of the mismatch, after false-discovery control.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Places {
    /// Stretches of time, s, from the first sample used.
    pub time_s: Vec<Stretch>,
    /// Bands of frequency, Hz.
    pub frequency_hz: Vec<Stretch>,
    /// In state (amplitude), output unit; at rest averaging time in s.
    pub state: Vec<Stretch>,
    /// In the plane of displacement and velocity, strongest first; driven recordings only.
    pub state_cells: Vec<StateCell>,
    /// Quantity on which the residual of the final model depends most.
    pub argument: Option<DependsOn>,
}

/// Holds what each kind keeps for its figures and its own paragraphs.
#[derive(Debug, Clone)]
pub enum Detail {
    /// Input and output of one proof mass.
    Driven(Box<driven::verdict::detail::Detail>),
    /// A sensor at rest.
    Static(Box<rest::detail::Detail>),
    /// An IMU in many still poses.
    Tumble(Box<tumble::detail::Detail>),
    /// An IMU in motion.
    Trajectory(Box<trajectory::detail::Detail>),
    /// Sweeps of a resonator.
    Response(Box<response::detail::Detail>),
}

impl Detail {
    /// Returns what would have been named: of driven recordings where nothing is. At rest, in poses
    /// and in motion it is not worked out.
    pub fn detectable(&self) -> &[Detectable] {
        match self {
            Self::Driven(detail) => &detail.detectable,
            Self::Static(_) | Self::Tumble(_) | Self::Trajectory(_) | Self::Response(_) => &[],
        }
    }
}
