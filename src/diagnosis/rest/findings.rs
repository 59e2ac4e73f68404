//! States what is found besides the physics, in sentences.

use super::channel::Channel;
use super::residual::TOLERANCE;
use super::selection::Selection;
use super::telegraph::REPLICAS;

/// Names channels whose residual is no noise as modelled, yet near enough to it.
pub(super) fn within_tolerance() -> String {
    format!(
        "the residual differs significantly from the noise model, but by less than the {:.0} % of its power that \
         counts as a mismatch here",
        100.0 * TOLERANCE
    )
}

/// Every environment column that some channels seem to follow and that is no witness of it.
pub(super) fn no_witness(columns: &[String], channels: &[Channel], selected: &[Selection]) -> Vec<String> {
    let of = |column: &String| {
        let unused = channels.iter().zip(selected).filter(|(_, s)| s.unused().any(|c| c == column));
        let names: Vec<String> = unused.map(|(channel, _)| format!("`{}`", channel.name)).collect();
        (!names.is_empty()).then(|| {
            let names = names.join(", ");
            format!("`{column}` explains {names} no better than a smooth trend does, so it was not considered a cause")
        })
    };
    columns.iter().filter_map(of).collect()
}

/// Returns whether a process named from its spectrum could be hops between two levels, which have
/// the same one.
pub(super) fn popcorn(channel: &Channel, detected: Option<usize>) -> Option<String> {
    let detected = detected?;
    Some(format!(
        "`{}`: hops between two levels (popcorn noise) have the spectrum of `gauss-markov`; as strong and as slow as here they \
         would have shown in {detected} of {REPLICAS} simulated recordings{}",
        channel.name,
        if 10 * detected >= 9 * REPLICAS as usize { ", and none show" } else { ": they are not excluded" }
    ))
}
