//! Channels of one sensor share their physics: a name that only some need is given up where another channel's serves.
//!
//! Each channel is judged alone first (`selection`). A weak effect is then sometimes taken for a look-alike in one channel
//! of three; that look-alike has to be better by the price of a name of its own. Only names that leave noise in their own
//! channel are given to others. Not a joint fit: strengths differ freely.

use super::channel::Channel;
use super::check::{TOLERANCE, remainder};
use super::selection::{self, ALPHA, Environment, Selected, Standing, Tried, others, try_all};
use crate::parallel;

/// Twice the log-likelihood that a name must gain over one that another channel bears. Before any data each of the nine
/// candidates is as likely as another, and one that is at work in a neighbour is the likelier by far: 2 ln 9 and a factor
/// of ten for the latter.
const PRICE: f64 = 9.0;

/// Goes through the channels once; `selected` are theirs.
pub(super) fn agree(channels: &[Channel], selected: &mut [Selected], environment: &Environment) {
    let needed: Vec<bool> = selected.iter().map(|s| !s.fitted.terms.is_empty()).collect();
    if needed.iter().filter(|n| **n).count() < 2 {
        return;
    }
    let count = channels.len() as f64;
    let noise = |c: &Channel, s: &Selected| remainder(c, &s.fitted, TOLERANCE).p_value * count >= ALPHA;
    let described: Vec<bool> =
        parallel::map_indices(channels.len(), |i| needed[i] && noise(&channels[i], &selected[i]));
    for i in 0..channels.len() {
        let mut index = 0;
        while index < selected[i].fitted.terms.len() {
            settle(channels, selected, &described, environment, (i, index));
            index += 1;
        }
    }
}

/// In how many channels an id stands and leaves noise; in the one that is judged it counts anyway.
fn bearers(selected: &[Selected], described: &[bool], judged: usize, id: &str) -> usize {
    let stands = |i: usize| selected[i].fitted.has(id) && (described[i] || i == judged);
    (0..selected.len()).filter(|i| stands(*i)).count()
}

/// Judges one term of one channel by what its neighbours bear.
fn settle(
    channels: &[Channel],
    selected: &mut [Selected],
    described: &[bool],
    environment: &Environment,
    (i, index): (usize, usize),
) {
    let bearers = |selected: &[Selected], id: &str| bearers(selected, described, i, id);
    let id = selected[i].fitted.terms[index].id;
    let own = bearers(selected, id);
    let common = |other: &str| other != id && bearers(selected, other) > own && !selected[i].fitted.has(other);
    if !selected.iter().any(|s| s.fitted.terms.iter().any(|t| common(t.id))) {
        // Where neighbours bear the name and not its rival, they have decided between the two.
        let decided: Vec<&str> =
            selected[i].evidence[index].2.iter().copied().filter(|r| bearers(selected, r) == 0).collect();
        if own > 1 {
            selected[i].evidence[index].2.retain(|r| !decided.contains(r));
        }
        return;
    }
    let channel = &channels[i];
    let correction = selection::correction(channels.len());
    let without = channel.fit(others(&selected[i].fitted, index));
    let shared = |t: &Standing| common(t.id) && t.counts(correction);
    let Tried { standings, best } = try_all(channel, &without, environment, shared);
    let Some(mine) = standings.iter().find(|t| t.id == id).map(Standing::merit) else { return };
    let Some((theirs, fitted)) = best else { return };
    let better_by = mine - theirs.merit() - PRICE;
    if better_by < 0.0 {
        let fitted = selection::prune(channel, fitted, correction);
        let evidence = selection::evidence(channel, &selected[i].base, &fitted, correction, &Vec::new());
        (selected[i].fitted, selected[i].evidence) = (fitted, evidence);
    } else if better_by < selection::CLOSE && !selected[i].evidence[index].2.contains(&theirs.id) {
        selected[i].evidence[index].2.insert(0, theirs.id);
    }
}
