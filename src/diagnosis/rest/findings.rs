//! What is found besides the physics, in sentences.

use super::channel::Channel;
use super::residual::TOLERANCE;
use super::telegraph::REPLICAS;

/// Where what is left is no noise as modelled, yet near enough to it.
pub(super) fn within_tolerance() -> String {
    format!(
        "the residual differs significantly from the noise model, but by less than the {:.0} % of its power that \
         counts as a mismatch here",
        100.0 * TOLERANCE
    )
}

/// Whether a process named from its spectrum could be hops between two levels, which have the same
/// one.
pub(super) fn popcorn(channel: &Channel, detected: Option<usize>) -> Option<String> {
    let detected = detected?;
    Some(format!(
        "`{}`: hops between two levels (popcorn noise) have the spectrum of `gauss-markov`; as strong and as slow as here they \
         would have shown in {detected} of {REPLICAS} simulated recordings{}",
        channel.name,
        if 10 * detected >= 9 * REPLICAS as usize { ", and none show" } else { ": they are not excluded" }
    ))
}
