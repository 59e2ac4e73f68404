//! States what is slow: drift as against noise and lines.

use super::cause::Cause;
use super::channel::{Addition, Channel, Term};
use super::spectrum::Law;

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
