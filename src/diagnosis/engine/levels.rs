//! The levels that decide what is said, for every kind, each with its calibration.

/// Standard errors by which a name's gain on samples that were not fitted must exceed zero. Chance
/// reaches it once in three million for one law and independent blocks; of 60 decays of white and
/// coloured noise and under force noise, none did. The reserve is for blocks that are not independent.
pub(crate) const NAME: f64 = 5.0;
/// Part of the excess error that a name must remove from the model without it. Below it, laws of
/// the library stand in for each other's inexactness on real recordings (`roll_decay`).
pub(crate) const LEAST_SHARE: f64 = 0.01;
/// Standard deviations by which a strength must differ from zero: its 95 % interval excludes zero.
pub(crate) const CLEAR: f64 = 1.96;
/// Part of the base model's excess error that all names must remove together. Unmodelled physics is
/// imitated to between 50 and 91 % by laws that it is not.
pub(crate) const TOGETHER: f64 = 0.9;
/// Standard errors below which two sets of laws are equally good: 5 % by chance.
pub(crate) const TIE: f64 = 2.0;
/// Standard errors from which on a law with its exponent free is named next to the stated one: chance reaches it
/// once in 370 times.
pub(crate) const BENT: f64 = 3.0;
/// Part of the excess error that the best set itself leaves by which an equally good set may leave
/// more: what is known to lack something cannot be told from what lacks half as much again. At the
/// noise only [`TIE`] decides.
pub(crate) const INEXACT: f64 = 0.5;
/// Part of what a set of laws removes by which it may be inexact: a pendulum departs from its cubic spring
/// by x²/20, 5 % of what that does at 1 rad, and what takes that up, 1/400 of the power, is no further law.
pub(crate) const EXACT: f64 = 1.0 / 400.0;
/// Times that the error may grow when segments are joined: beyond it the joined simulation has lost the
/// motion.
pub(crate) const FOLLOWED: f64 = 3.0;
/// Part of the noise's variance by which its own measurement may be wrong: an excess below it is at
/// the noise. Measurements by differences and by repetition agree within it.
pub(crate) const AT_NOISE: f64 = 0.1;
/// Part of the noise's variance from which on an excess that is no chance is more than faint.
pub(crate) const FAINT: f64 = 0.3;
/// Effective number of blocks below which scatter between blocks says nothing.
pub(crate) const FEWEST_BLOCKS: f64 = 3.0;
