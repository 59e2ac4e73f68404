//! States how well a candidate does against a model without it, and what each term of a model is
//! worth next to the others.

use super::candidate::row;
use super::cause::Cause;
use super::channel::{Channel, Fitted, Term};

/// Corrected probability below which a candidate counts.
pub(super) const ALPHA: f64 = 0.004;
/// Candidates tried per channel.
const TRIED: f64 = 9.0;
/// Candidates whose criteria differ by less are indistinguishable: so much chance does to a
/// difference of likelihoods.
pub(super) const CLOSE: f64 = 4.0;
/// The margin of a ramp or a settling over a walk or a flicker. In a simulation of both noises from faint to strong
/// (4096 samples, 4000 draws of each size) a ramp or an exponential led by more in one or two of a thousand draws of
/// the worst size.
pub(super) const CLOSE_TO_NOISE: f64 = 14.0;
/// Corrected probability above which a term is superfluous next to the others.
pub(super) const SUPERFLUOUS: f64 = 0.05;

/// States how well a candidate did.
#[derive(Debug, Clone, Copy)]
pub(super) struct Standing {
    pub(super) cause: Cause,
    /// Twice the gain in log-likelihood.
    pub(super) gain: f64,
    /// Of that gain by chance, the search for its time constant or frequency included; not yet
    /// corrected for the number of candidates.
    pub(super) p_value: f64,
    /// Holds what it gains on data that were not fitted.
    pub(super) held_out: HeldOut,
}

/// Holds what a candidate gains on data that were not fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum HeldOut {
    /// A law: log-likelihood of each half of the coefficients under laws fitted to the other.
    LogLikelihood(f64),
    /// A curve: share of the mean square on every second of sixteen stretches, fitted to the
    /// others.
    MeanSquare(f64),
}

impl HeldOut {
    pub(super) fn is_better(self) -> bool {
        match self {
            Self::LogLikelihood(gain) | Self::MeanSquare(gain) => gain > 0.0,
        }
    }

    /// Returns it as a share: of the mean square, or of the `possible` gain in log-likelihood; none
    /// of nothing.
    pub(super) fn share_of(self, possible: f64) -> f64 {
        match self {
            Self::LogLikelihood(gain) if possible > 0.0 => (gain / possible).clamp(-1.0, 1.0),
            Self::LogLikelihood(_) => 0.0,
            Self::MeanSquare(fraction) => fraction,
        }
    }
}

impl Standing {
    /// Akaike's criterion, turned so that more is better.
    pub(super) fn minus_aic(&self) -> f64 {
        self.gain - 2.0 * row(self.cause).numbers
    }

    pub(super) fn counts(&self, correction: f64) -> bool {
        self.p_value * correction < ALPHA && self.held_out.is_better()
    }
}

/// Returns what every probability of a channel is multiplied by when `channels` are judged.
pub(super) fn correction(channels: usize) -> f64 {
    TRIED * channels as f64
}

/// Returns whether the richer candidate imitates the simpler one at the edge of its range: then the
/// simpler one is preferred.
pub(super) fn contains(richer: Cause, simpler: Cause) -> bool {
    row(richer).imitates.contains(&simpler)
}

/// The terms of a model without one.
pub(super) fn others(fitted: &Fitted, index: usize) -> Vec<Term> {
    fitted.terms.iter().enumerate().filter(|(i, _)| *i != index).map(|(_, t)| t.clone()).collect()
}

/// Of a gain at least this large by chance.
pub(super) fn probability(cause: Cause, gain: f64, channel: &Channel) -> f64 {
    (row(cause).chance)(gain.max(0.0), channel.values.len() as f64).min(1.0)
}

/// Corrected probability, by chance, of what a model gains by one of its terms.
pub(super) fn removal_p_value(
    channel: &Channel,
    fitted: &Fitted,
    without: &Fitted,
    index: usize,
    correction: f64,
) -> f64 {
    probability(fitted.terms[index].cause, fitted.gain_over(without, index), channel) * correction
}

/// Drops what the others have made superfluous.
pub(super) fn prune(channel: &Channel, mut fitted: Fitted, correction: f64) -> Fitted {
    loop {
        let superfluous = (0..fitted.terms.len()).find_map(|index| {
            let without = channel.fit(others(&fitted, index));
            (removal_p_value(channel, &fitted, &without, index, correction) > SUPERFLUOUS).then_some(without)
        });
        match superfluous {
            Some(without) => fitted = without,
            None => return fitted,
        }
    }
}

/// Returns whether a model would be worse, by more than chance, without any one of its terms.
pub(super) fn needs_all(channel: &Channel, fitted: &Fitted, correction: f64) -> bool {
    (0..fitted.terms.len()).all(|index| {
        let without = channel.fit(others(fitted, index));
        removal_p_value(channel, fitted, &without, index, correction) < ALPHA
    })
}
