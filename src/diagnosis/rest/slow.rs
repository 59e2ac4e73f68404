//! States what is slow: drift as against noise and lines.

use super::cause::Cause;
use super::channel::{Addition, Channel, Fitted, Term};
use super::spectrum::Law;
use crate::numerics::cosine;

/// Returns whether a term moves over much of the recording.
pub(super) fn is_slow(term: &Term, channel: &Channel) -> bool {
    let count = channel.values.len() as f64;
    match &term.addition {
        Addition::Law(Law::Walk | Law::Flicker) => true,
        Addition::Law(Law::Markov(memory)) => *memory > 0.005 * count,
        Addition::Law(_) => false,
        Addition::Curves(_) if term.cause == Cause::Jump => false,
        Addition::Curves(_) => term.cause != Cause::Sinusoid || term.searched * count < 10.0,
    }
}

/// The slow part in time: every coefficient weighted by the fraction of its power that is not white
/// (Wiener's filter).
pub(super) fn slow_part(fitted: &Fitted) -> Vec<f64> {
    let white = fitted.white().0;
    let mut coefficients = vec![0.0; fitted.residual.len()];
    for (bin, variance) in fitted.bins.iter().zip(&fitted.variances) {
        let share = (1.0 - white / variance).max(0.0);
        let part = bin.from..bin.to;
        coefficients[part.clone()].iter_mut().zip(&fitted.residual[part]).for_each(|(c, r)| *c = share * r);
    }
    cosine::invert(&coefficients)
}
