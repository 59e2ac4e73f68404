//! Gives a law what it acts on: the state of the mass at one instant, one step that it has taken,
//! and how many are simulated at once.
//!
//! A law is written for one mass; [`Instants`] holds the same quantities of N masses side by side,
//! from which `side_by_side` feeds it lane by lane. Units are the caller's (see
//! [`super::dimension`]).

/// Parameter sets that the diagnosis simulates side by side.
pub const LANES: usize = 8;
/// One value per parameter set.
pub type Lanes = [f64; LANES];
/// Most values of one law: its parameters and the unknown initial values of its states.
pub const MOST_VALUES: usize = 6;
/// Most states of laws that act on the mass, together: they go through the stages of a step with
/// it.
pub const MOST_STAGED: usize = 3;

/// Values of one law for N masses; zeros where it has fewer.
pub type Values<T, const N: usize> = [[T; N]; MOST_VALUES];
/// States of one law for N masses; it uses the first of them.
pub type Staged<T, const N: usize> = [[T; N]; MOST_STAGED];

/// The base model of N masses: x″ + 2ζω₀x′ + ω₀²x = gain · input.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Base<T, const N: usize> {
    /// Force per unit mass for one unit of input.
    pub gain: [T; N],
    /// ω₀², 1/s².
    pub stiffness: [T; N],
    /// 2ζω₀, 1/s.
    pub damping: [T; N],
}

/// The base model of the diagnosis.
pub type BaseLanes = Base<f64, LANES>;

/// State of one mass at one instant.
#[derive(Debug, Clone, Copy, Default)]
pub struct Instant<'a, T> {
    /// Time since the recording or the run began.
    pub time: T,
    /// Length of the integration step; 0 where a law must not be smoothed over one.
    pub step: T,
    /// Input: for forces late where the reading is late (a delay is applied there), for readings as
    /// it is.
    pub input: T,
    /// Displacement of the mass, in the unit of the model.
    pub x: T,
    /// Velocity of the mass, the same unit per second.
    pub v: T,
    /// Gain of the base model.
    pub gain: T,
    /// ω₀² of the base model.
    pub stiffness: T,
    /// Environment columns, less their means.
    pub environment: &'a [f64],
}

/// N masses at one instant; fields as in [`Instant`]. Rows begin on lines of the cache, as vectors are
/// stored and read again at every stage of a step.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs, reason = "the fields are those of `Instant`")]
#[repr(C, align(64))]
pub struct Instants<'a, T, const N: usize> {
    pub input: [T; N],
    pub x: [T; N],
    pub v: [T; N],
    pub time: T,
    pub step: T,
    pub base: &'a Base<T, N>,
    pub environment: &'a [f64],
}

impl<T: Copy, const N: usize> Instants<'_, T, N> {
    /// State of mass `l`.
    #[inline(always)]
    pub fn lane(&self, l: usize) -> Instant<'_, T> {
        Instant {
            time: self.time,
            step: self.step,
            input: self.input[l],
            x: self.x[l],
            v: self.v[l],
            gain: self.base.gain[l],
            stiffness: self.base.stiffness[l],
            environment: self.environment,
        }
    }
}

/// Numbers that a law needs at every step of a pass and that does not change during it.
pub type Constants = [Lanes; 6];

/// One step of the masses: states before and after, and the input.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub struct Stride {
    /// Displacement at the beginning of the step.
    pub x0: Lanes,
    /// Velocity at the beginning of the step.
    pub v0: Lanes,
    /// Displacement at the end of the step.
    pub x1: Lanes,
    /// Velocity at the end of the step.
    pub v1: Lanes,
    /// Input at its beginning, middle and end.
    pub input: [Lanes; 3],
    /// Length of the step, s.
    pub step_s: f64,
}
