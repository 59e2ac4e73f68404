//! Channels of one sensor share their physics: a name that only some need is given up where another
//! channel's serves.
//!
//! Each channel is judged alone first (`selection`). A weak effect is then sometimes taken for a
//! look-alike in one channel of three; that look-alike must win by the penalty of one more name.
//! Only names that leave nothing but noise in their channel are given to others. Not a joint fit:
//! strengths differ freely.

use crate::control::{Control, Stopped};

use super::candidates_round::{Tried, try_all};
use super::cause::Cause;
use super::channel::{Channel, Environment};
use super::residual::{TOLERANCE, residual};
use super::selection::{self, Selection};
use super::standing::{self, CLOSE, Standing, others, prune};
use crate::parallel;
use crate::remainder::REAL;

/// Twice the log-likelihood that a name must gain over one that another channel bears. Before any
/// data each of the nine candidates is as likely as another, and one that is at work in a neighbour
/// is the likelier by far: 2 ln 9 and a factor of ten for the latter.
const PENALTY: f64 = 9.0;

/// Goes through the channels once; `selected` are theirs.
///
/// # Errors
/// Stopped.
pub(super) fn agree(
    channels: &[Channel],
    selected: &mut [Selection],
    environment: &Environment,
    control: &Control,
) -> Result<(), Stopped> {
    let needed: Vec<bool> = selected.iter().map(|s| !s.chosen.terms.is_empty()).collect();
    if needed.iter().filter(|n| **n).count() < 2 {
        return Ok(());
    }
    let count = channels.len() as f64;
    let noise = |c: &Channel, s: &Selection| residual(c, &s.chosen, TOLERANCE).p_value * count >= REAL;
    let described: Vec<bool> =
        parallel::map_indices(channels.len(), |i| needed[i] && noise(&channels[i], &selected[i]));
    for i in 0..channels.len() {
        let mut index = 0;
        while index < selected[i].chosen.terms.len() {
            settle(channels, selected, &described, (environment, control), (i, index))?;
            index += 1;
        }
    }
    Ok(())
}

/// In how many channels a cause stands and leaves noise; in the one that is judged it counts
/// anyway.
fn bearers(selected: &[Selection], described: &[bool], judged: usize, cause: Cause) -> usize {
    let stands = |i: usize| selected[i].chosen.has(cause) && (described[i] || i == judged);
    (0..selected.len()).filter(|i| stands(*i)).count()
}

/// Returns whether a cause stands without a rival in a channel that it leaves with noise.
fn is_sure(selected: &[Selection], described: &[bool], cause: Cause) -> bool {
    let sure =
        |s: &Selection| s.chosen.terms.iter().zip(&s.named).any(|(t, n)| t.cause == cause && n.rivals.is_empty());
    selected.iter().zip(described).any(|(s, described)| *described && sure(s))
}

/// Judges one term of one channel by what its neighbours bear.
fn settle(
    channels: &[Channel],
    selected: &mut [Selection],
    described: &[bool],
    (environment, control): (&Environment, &Control),
    (i, index): (usize, usize),
) -> Result<(), Stopped> {
    let bearers = |selected: &[Selection], cause: Cause| bearers(selected, described, i, cause);
    let cause = selected[i].chosen.terms[index].cause;
    let own = bearers(selected, cause);
    // A name that ties with one that a neighbour bears beyond doubt yields to as many.
    let yields = |other: Cause| selected[i].named[index].rivals.contains(&other) && is_sure(selected, described, other);
    let common = |other: Cause| {
        let as_many = own + usize::from(!yields(other));
        other != cause && bearers(selected, other) >= as_many && !selected[i].chosen.has(other)
    };
    if !selected.iter().any(|s| s.chosen.terms.iter().any(|t| common(t.cause))) {
        // Where neighbours bear the name and not its rival, they have decided between the two.
        let decided: Vec<Cause> =
            selected[i].named[index].rivals.iter().copied().filter(|r| bearers(selected, *r) == 0).collect();
        if own > 1 {
            selected[i].named[index].rivals.retain(|r| !decided.contains(r));
        }
        return Ok(());
    }
    let channel = &channels[i];
    let correction = standing::correction(channels.len());
    let without = channel.fit(others(&selected[i].chosen, index));
    let shared = |t: &Standing| common(t.cause) && t.counts(correction);
    let Tried { standings, best } = try_all(channel, &without, environment, control, shared)?;
    let Some(mine) = standings.iter().find(|t| t.cause == cause).map(Standing::minus_aic) else { return Ok(()) };
    let Some((theirs, fitted)) = best else { return Ok(()) };
    let better_by = mine - theirs.minus_aic() - PENALTY;
    if better_by < 0.0 {
        let chosen = prune(channel, fitted, correction);
        let named = selection::named(channel, &selected[i].base, &chosen, correction, &Vec::new());
        (selected[i].chosen, selected[i].named) = (chosen, named);
    } else if better_by < CLOSE && !selected[i].named[index].rivals.contains(&theirs.cause) {
        selected[i].named[index].rivals.insert(0, theirs.cause);
    }
    Ok(())
}
