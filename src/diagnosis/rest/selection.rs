//! Which candidates a channel needs: stepwise forward by likelihood, checked on data held out,
//! pruned backwards.

use super::candidate::row;
use super::cause::Cause;
use super::channel::{Addition, Channel, Curve, Environment, Fitted, Term};
use super::jump;
use super::laws::{self, Rivals};
use super::round::{Tried, try_all};
use super::shape::{self, Following};
use super::standing::{self, CLOSE, Standing, contains, others, prune, worth};
use crate::control::{Control, Stopped};
use crate::numerics::order;

/// At most this many effects per channel.
const MOST: usize = 6;
/// At most this many steps of the bias are fitted.
const MOST_STEPS: usize = 2;

/// What a channel needs, and how every candidate did alone.
pub(super) struct Selection {
    pub(super) base: Fitted,
    pub(super) chosen: Fitted,
    /// Every candidate alone, added to the base.
    pub(super) alone: Vec<Standing>,
    /// The terms of the chosen model, in its order.
    pub(super) named: Vec<Named>,
    /// Columns that tell no more than a smooth course in time does.
    pub(super) set_aside: Vec<String>,
}

impl Selection {
    /// Columns that were set aside and that no term follows.
    pub(super) fn unused(&self) -> impl Iterator<Item = &str> {
        let used = |name: &str| self.chosen.terms.iter().any(|t| t.follows(name));
        self.set_aside.iter().map(String::as_str).filter(move |name| !used(name))
    }

    /// What the chosen model gains over the base in log-likelihood on held-out coefficients.
    pub(super) fn possible(&self, channel: &Channel) -> f64 {
        self.chosen.held_out(&channel.promised) - self.base.held_out(&channel.promised)
    }
}

/// What a term of the chosen model rests on.
#[derive(Debug, Clone)]
pub(super) struct Named {
    /// Corrected probability that it gains so much by chance.
    pub(super) p_value: f64,
    /// Share of the held-out gain that goes without it.
    pub(super) held_out_gain: f64,
    /// Candidates that do as well in its place, the best first.
    pub(super) rivals: Vec<Cause>,
}

/// Selects; `channels` corrects for their number.
///
/// # Errors
/// Stopped.
pub(super) fn select(
    channel: &Channel,
    environment: &Environment,
    channels: usize,
    control: &Control,
) -> Result<Selection, Stopped> {
    let as_one = beside(channel, environment, channels, control, Vec::new())?;
    let mut steps: Vec<Term> = Vec::new();
    let mut selection = None;
    // A bias that jumps once or twice is fitted in pieces; one that goes on jumping hops, which
    // `telegraph` looks into.
    while steps.len() <= MOST_STEPS {
        let chosen = &selection.as_ref().unwrap_or(&as_one).chosen;
        let Some(step) = jump::missing(channel, chosen, (channels * MOST_STEPS) as f64) else { break };
        steps.push(step);
        if steps.len() <= MOST_STEPS {
            selection = Some(beside(channel, environment, channels, control, steps.clone())?);
        }
    }
    Ok(selection.filter(|_| steps.len() <= MOST_STEPS).unwrap_or(as_one))
}

/// Environment columns by what they tell of a channel.
struct Columns {
    /// More than time does, or nothing yet.
    offered: Vec<(String, Curve)>,
    /// No more than a smooth course in time does.
    set_aside: Vec<String>,
}

/// The shapes in which a channel follows environment columns, beside other terms: before any noise
/// is offered. And which columns may still be offered.
fn followed(channel: &Channel, environment: &Environment, mut terms: Vec<Term>, correction: f64) -> (Fitted, Columns) {
    let before = terms.clone();
    let (mut offered, mut set_aside) = (Vec::new(), Vec::new());
    for (name, column) in environment {
        match shape::find(channel, name, column, correction) {
            Following::By(term) => terms.push(term),
            Following::Not => {}
            Following::NoBetterThanTime => {
                set_aside.push(name.clone());
                continue;
            }
        }
        offered.push((name.clone(), column.clone()));
    }
    let fitted = channel.fit(terms);
    let serves = |index: usize| channel.held_out_share(&fitted, index) > 0.0;
    let serve = (before.len()..fitted.terms.len()).all(serves);
    (if serve { fitted } else { channel.fit(before) }, Columns { offered, set_aside })
}

/// Selects beside steps of the bias.
fn beside(
    channel: &Channel,
    environment: &Environment,
    channels: usize,
    control: &Control,
    steps: Vec<Term>,
) -> Result<Selection, Stopped> {
    let correction = standing::correction(channels);
    let base = channel.fit(Vec::new());
    let (mut current, Columns { offered, set_aside }) = followed(channel, environment, steps, correction);
    let environment = &offered[..];
    let mut alone = match current.terms.is_empty() {
        true => Vec::new(),
        false => try_all(channel, &base, environment, control, |_| false)?.standings,
    };
    let mut rivals: Rivals = Vec::new();
    for _ in 0..MOST {
        let Tried { standings, best } = try_all(channel, &current, environment, control, |t| t.counts(correction))?;
        if alone.is_empty() {
            alone.clone_from(&standings);
        }
        let Some((best, fitted)) = best else { break };
        let mut close: Vec<Standing> = standings
            .into_iter()
            .filter(|t| t.cause != best.cause && row(t.cause).entry.is_some() && !contains(t.cause, best.cause))
            .filter(|t| best.merit() - t.merit() < CLOSE)
            .collect();
        order::sort_by_key(&mut close, |t| -t.merit());
        rivals.push((best.cause, close.iter().map(|t| t.cause).collect()));
        current = prune(channel, fitted, correction);
    }
    let (chosen, settled) = laws::settle(channel, current, correction, control)?;
    // Which of the slow laws: of the sums compared. All else: of the round in which it was taken.
    for (cause, own) in settled {
        let before = rivals.iter().rev().find(|r| r.0 == cause).map(|r| r.1.clone()).unwrap_or_default();
        let others = before.into_iter().filter(|r| !laws::SLOW.contains(r));
        rivals.push((cause, own.into_iter().chain(others).collect()));
    }
    let named = named(channel, &base, &chosen, correction, &rivals);
    Ok(Selection { base, chosen, alone, named, set_aside })
}

/// What every term of a model rests on.
pub(super) fn named(channel: &Channel, base: &Fitted, chosen: &Fitted, correction: f64, rivals: &Rivals) -> Vec<Named> {
    let full = chosen.held_out(&channel.promised);
    let possible = (full - base.held_out(&channel.promised)).max(f64::MIN_POSITIVE);
    let each = |index: usize| {
        let without = channel.fit(others(chosen, index));
        let term = &chosen.terms[index];
        let held_out_gain = match term.addition {
            Addition::Law(_) => ((full - without.held_out(&channel.promised)) / possible).clamp(0.0, 1.0),
            Addition::Curves(_) => channel.held_out_share(chosen, index),
        };
        Named {
            p_value: worth(channel, chosen, &without, index, correction).min(1.0),
            held_out_gain,
            rivals: rivals.iter().rev().find(|r| r.0 == term.cause).map(|r| r.1.clone()).unwrap_or_default(),
        }
    };
    (0..chosen.terms.len()).map(each).collect()
}
