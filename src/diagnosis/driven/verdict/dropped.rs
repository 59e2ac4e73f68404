//! States why a term has no name, and what was left undone.

use crate::driven::selection::known::Known;

/// Reason why a term that was in the model has no name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dropped {
    /// One of its parameters lies at the end of what its name allows.
    AtBound,
    /// The interval of its strength holds zero.
    MayBeNothing,
    /// It makes the prediction of the test samples worse.
    Worsens,
    /// It is no resonance next to the one modelled: it takes that one's place, or has no peak of
    /// its own.
    NoSecondResonance,
    /// It is a noise term, but known signals explain part of what it absorbs in the innovations, or
    /// predict its power.
    Dependent {
        /// Known quantity that predicts it.
        by: Known,
        /// Part of its degrees of freedom, or of the variance of its power, %.
        percent: u8,
        /// States whether it is the variance of its power.
        is_power: bool,
    },
    /// It is a random walk, but a smooth trend describes what it stands for better.
    SmoothCourse,
    /// It is noise of the readout, with a memory of a few samples.
    Coloured,
    /// It is an oscillation at a line of the input, or where a law that bends would mix the lines.
    FollowsInput,
    /// It is too small next to the other terms to be distinguished from their inexactness.
    WithinInexactness,
    /// It does something only together with another that it can be mistaken for.
    Twin,
    /// It does not bring the residual to the noise.
    StandIn,
}

/// Work that was left out because its budget was spent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeftOut {
    /// Profiles of laws with a corner: their intervals are those of a parabola.
    Profiles,
    /// Weighing the terms again after one was dropped that made the prediction worse.
    WeighingAgain,
}
