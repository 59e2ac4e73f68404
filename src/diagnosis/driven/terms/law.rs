//! What a law is to the simulator: a term in the equation of motion, at the readout, or in the noise.
//!
//! A law works on [`LANES`] parameter sets at once, so that a Jacobian or a line search is one pass over the recording.
//! Each family of laws has a file beside this one; `term` lists them all.

use crate::diagnosis::candidate::Candidate;

use super::scales::{Coordinate, Scales};

/// Parameter sets simulated side by side.
pub const LANES: usize = 8;
/// One value per parameter set.
pub type Lanes = [f64; LANES];

/// The base model in every lane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaseLanes {
    /// Gain.
    pub gain: Lanes,
    /// ω₀².
    pub stiffness: Lanes,
    /// 2ζω₀.
    pub damping: Lanes,
}

/// The state at one instant, in every lane.
#[derive(Debug, Clone, Copy)]
pub struct Instant<'a> {
    /// Time from the first sample of the recording.
    pub time_s: f64,
    /// Integration step.
    pub step_s: f64,
    /// Input: for forces late where the reading is late (a delay is applied there), for readings as it is.
    pub input: Lanes,
    /// Displacement.
    pub x: Lanes,
    /// Velocity.
    pub v: Lanes,
    /// The base model.
    pub base: &'a BaseLanes,
    /// Environment columns, less their means.
    pub environment: &'a [f64],
}

/// What a term needs at every step and that does not change during a pass.
pub type Constants = [Lanes; 6];

/// One step that the mass has taken.
#[derive(Debug, Clone, Copy)]
pub struct Stride {
    /// Its length.
    pub step_s: f64,
    /// Displacement before.
    pub x0: Lanes,
    /// Velocity before.
    pub v0: Lanes,
    /// Displacement after.
    pub x1: Lanes,
    /// Velocity after.
    pub v1: Lanes,
    /// Input at its beginning, middle and end.
    pub input: [Lanes; 3],
}

/// Noise that no simulation predicts sample by sample; it enters through the filter's gain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// White force.
    Force,
    /// Random walk of the reading.
    Walk,
}

/// Points in parameter space to look at before a fit.
#[derive(Debug, Clone, PartialEq)]
pub enum Cloud {
    /// All parameters of the term.
    Points(Vec<Vec<f64>>),
    /// The first parameter is a strength that acts nearly in proportion; only the others are looked for.
    Shapes {
        /// A strength at which the effect is clear.
        strength: f64,
        /// The other parameters.
        shapes: Vec<Vec<f64>>,
    },
}

/// What each candidate answers. Empty defaults: a term acts only where it says so.
pub trait Physics {
    /// What the library says of it.
    fn words(&self) -> &'static Candidate;
    /// One per parameter, and one per unknown beginning.
    fn coordinates(&self, scales: &Scales) -> Vec<Coordinate>;
    /// Where to begin; several where the misfit has several valleys.
    fn starts(&self, scales: &Scales) -> Vec<Vec<f64>>;
    /// Where to look before a fit, many points at a time; `None` where the few starts are enough.
    fn cloud(&self, _scales: &Scales) -> Option<Cloud> {
        None
    }
    /// Where else, seen from a fit, its misfit may have another valley.
    fn elsewhere(&self, _p: &[f64], _scales: &Scales) -> Vec<Vec<f64>> {
        Vec::new()
    }
    /// Own state variables.
    fn states(&self) -> usize {
        0
    }
    /// Of its own states, how many begin somewhere that has to be fitted: as many values follow the parameters, in order.
    fn unknown_beginnings(&self) -> usize {
        0
    }
    /// Fastest rate it brings in, so that steps stay short enough.
    fn fastest_rad_s(&self, _parameters: &[f64], _scales: &Scales) -> f64 {
        0.0
    }
    /// Adds to the acceleration, and gives the rates of its own states.
    #[inline(always)]
    fn force(&self, _at: &Instant<'_>, _p: &[Lanes], _own: &[Lanes], _rates: &mut [Lanes], _acceleration: &mut Lanes) {}
    /// Changes the reading.
    #[inline(always)]
    fn reading(&self, _at: &Instant<'_>, _p: &[Lanes], _own: &[Lanes], _y: &mut Lanes) {}
    /// Its own states when the mass begins at `x`, `v`; at rest where nothing is known.
    fn begin(&self, _x: &Lanes, _v: &Lanes, _p: &[Lanes], _own: &mut [Lanes]) {}
    /// What `follow` takes for granted during a pass of steps of this length.
    fn constants(&self, _p: &[Lanes], _step_s: f64) -> Constants {
        [[0.0; LANES]; 6]
    }
    /// Carries its own states over one step of the mass, by exact solution.
    #[inline(always)]
    fn follow(&self, _stride: &Stride, _constants: &Constants, _p: &[Lanes], _own: &mut [Lanes]) {}
    /// Whether `follow` does anything.
    fn follows(&self) -> bool {
        false
    }
    /// Whether its law has a corner, near which the misfit is far from a parabola and integration needs short steps.
    fn has_corner(&self) -> bool {
        false
    }
    /// Whether `force` does anything.
    fn moves(&self) -> bool {
        false
    }
    /// Position in the chain of the readout; `None` where `reading` does nothing.
    fn reads(&self) -> Option<u8> {
        None
    }
    /// Whether parameter 0 is a delay of the input in s.
    fn delays(&self) -> bool {
        false
    }
    /// Whether parameter 0 is dry friction, which the pass switches at its events.
    fn rubs(&self) -> bool {
        false
    }
    /// Whether parameter 0 is the time constant of a low-pass, state 0 its own, through which the displacement is read.
    fn lags(&self) -> bool {
        false
    }
    /// Which noise it is; parameter 0 is then its strength as in `gain`.
    fn noise(&self) -> Option<Noise> {
        None
    }
    /// Whether the term needs an input column.
    fn needs_input(&self) -> bool {
        false
    }
}
