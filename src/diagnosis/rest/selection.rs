//! Which candidates a channel needs: stepwise forward by likelihood, checked on data held out,
//! pruned backwards.

use super::candidate::row;
use super::candidates_round::{Tried, try_all};
use super::cause::Cause;
use super::channel::{Addition, Channel, Curve, Environment, Fitted, Term};
use super::course::is_course;
use super::jump;
use super::laws::{self, Rivals};
use super::shape::Following;
use super::standing::{self, CLOSE, CLOSE_TO_NOISE, SUPERFLUOUS, Standing, contains, others, prune, removal_p_value};
use super::telegraph;
use crate::control::{Control, Stopped};
use crate::numerics::order;
use crate::remainder::REAL;

/// At most this many effects per channel.
const MOST: usize = 6;
/// At most this many steps of the bias are fitted.
const MOST_STEPS: usize = 2;

/// Holds what a channel needs, and how every candidate did alone.
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

    /// Returns what the chosen model gains over the base in log-likelihood on held-out
    /// coefficients.
    pub(super) fn possible(&self, channel: &Channel) -> f64 {
        self.chosen.held_out(&channel.promised) - self.base.held_out(&channel.promised)
    }
}

/// Holds what a term of the chosen model rests on.
#[derive(Debug, Clone)]
pub(super) struct Named {
    /// Corrected probability that it gains so much by chance.
    pub(super) p_value: f64,
    /// Share of the held-out gain that goes without it.
    pub(super) held_out_gain: f64,
    /// Candidates that do as well in its place, the best first.
    pub(super) rivals: Vec<Cause>,
}

/// Holds what stands next to a channel in the recording.
pub(super) struct Surroundings<'a> {
    /// Environment columns.
    pub(super) columns: &'a Environment,
    /// States how the channel follows each.
    pub(super) following: &'a [Following],
}

/// Selects; `channels` corrects for their number.
///
/// # Errors
/// Stopped.
pub(super) fn select(
    channel: &Channel,
    surroundings: &Surroundings<'_>,
    channels: usize,
    control: &Control,
) -> Result<Selection, Stopped> {
    let as_one = beside(channel, surroundings, channels, control, Vec::new())?;
    let mut steps: Vec<Term> = Vec::new();
    let mut selection = None;
    // A bias that jumps once or twice is fitted in pieces; one that goes on jumping hops, which
    // `telegraph` looks into.
    while steps.len() <= MOST_STEPS {
        let chosen = &selection.as_ref().unwrap_or(&as_one).chosen;
        let Some(step) = jump::missing(channel, chosen, (channels * MOST_STEPS) as f64) else { break };
        steps.push(step);
        if steps.len() <= MOST_STEPS {
            selection = Some(beside(channel, surroundings, channels, control, steps.clone())?);
        }
    }
    let Some(in_pieces) = selection.filter(|_| steps.len() <= MOST_STEPS) else { return Ok(as_one) };
    // Two of many hops may take the place of the course that they hop about.
    let is_lost = |t: &Term| matches!(t.addition, Addition::Curves(_)) && !in_pieces.chosen.has(t.cause);
    let hops = || telegraph::hops(channel, &as_one.chosen).filter(|t| t.about_course && t.hops > MOST_STEPS);
    let hops_about =
        as_one.chosen.terms.iter().any(is_lost) && hops().is_some_and(|t| t.p_value * (channels as f64) < REAL);
    Ok(if hops_about { as_one } else { in_pieces })
}

/// Environment columns by what they tell of a channel.
struct Columns {
    /// More than time does, or nothing yet.
    offered: Vec<(String, Curve)>,
    /// No more than a smooth course in time does.
    set_aside: Vec<String>,
}

/// The shapes in which a channel follows environment columns, next to other terms: before any noise
/// is offered. And which columns may still be offered.
fn followed(
    channel: &Channel,
    surroundings: &Surroundings<'_>,
    mut terms: Vec<Term>,
    correction: f64,
) -> (Fitted, Columns) {
    let first = terms.len();
    let mut columns = Columns { offered: Vec::new(), set_aside: Vec::new() };
    for ((name, column), following) in surroundings.columns.iter().zip(surroundings.following) {
        match following {
            Following::By(term) => terms.push(term.clone()),
            Following::Not => {}
            Following::NoBetterThanTime => {
                columns.set_aside.push(name.clone());
                continue;
            }
        }
        columns.offered.push((name.clone(), column.clone()));
    }
    let mut fitted = channel.fit(terms);
    while let Some(without) = without_the_weakest(channel, &fitted, first, correction) {
        fitted = without;
    }
    (fitted, columns)
}

/// A model without one of its terms from `first` on: the weakest of those that the others make
/// superfluous, else of those that do not serve on stretches they were not fitted to; `None` where
/// all are needed.
fn without_the_weakest(channel: &Channel, fitted: &Fitted, first: usize, correction: f64) -> Option<Fitted> {
    let without = |index: usize| (index, channel.fit(others(fitted, index)));
    let mut all: Vec<(usize, Fitted)> = (first..fitted.terms.len()).map(without).collect();
    // The less is lost without it.
    order::sort_by_key(&mut all, |(_, without)| -without.log_likelihood());
    let is_superfluous = |(index, without): &(usize, Fitted)| {
        removal_p_value(channel, fitted, without, *index, correction) > SUPERFLUOUS
    };
    let serves_not = |(index, _): &(usize, Fitted)| channel.held_out_share(fitted, *index) <= 0.0;
    let weakest = all.iter().position(is_superfluous).or_else(|| all.iter().position(serves_not))?;
    Some(all.swap_remove(weakest).1)
}

/// Selects next to steps of the bias.
fn beside(
    channel: &Channel,
    surroundings: &Surroundings<'_>,
    channels: usize,
    control: &Control,
    steps: Vec<Term>,
) -> Result<Selection, Stopped> {
    let correction = standing::correction(channels);
    let base = channel.fit(Vec::new());
    let (mut current, Columns { offered, set_aside }) = followed(channel, surroundings, steps, correction);
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
            .filter(|t| best.minus_aic() - t.minus_aic() < closeness(best.cause, t.cause))
            .collect();
        order::sort_by_key(&mut close, |t| -t.minus_aic());
        rivals.push((best.cause, close.iter().map(|t| t.cause).collect()));
        current = prune(channel, fitted, correction);
    }
    let (chosen, settled) = laws::settle(channel, current, correction, control)?;
    // What was needed next to the sum selected may not be next to the one settled on.
    let chosen = prune(channel, chosen, correction);
    // Which of the slow laws: of the sums compared. All else: of the round in which it was taken.
    for (cause, own) in settled {
        let before = rivals.iter().rev().find(|r| r.0 == cause).map(|r| r.1.clone()).unwrap_or_default();
        let others = before.into_iter().filter(|r| !laws::SLOW.contains(r));
        rivals.push((cause, own.into_iter().chain(others).collect()));
    }
    let named = named(channel, &base, &chosen, correction, &rivals);
    Ok(Selection { base, chosen, alone, named, set_aside })
}

/// By how much one candidate must be better than another to be told from it.
fn closeness(better: Cause, other: Cause) -> f64 {
    if is_course(better) && laws::SLOW.contains(&other) { CLOSE_TO_NOISE } else { CLOSE }
}

/// Returns what every term of a model rests on.
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
            p_value: removal_p_value(channel, chosen, &without, index, correction).min(1.0),
            held_out_gain,
            rivals: rivals.iter().rev().find(|r| r.0 == term.cause).map(|r| r.1.clone()).unwrap_or_default(),
        }
    };
    (0..chosen.terms.len()).map(each).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    const COUNT: usize = 4096;

    #[test]
    fn of_several_columns_only_those_are_dropped_that_tell_nothing_or_do_not_serve() {
        let slow: Vec<f64> = (0..COUNT).map(|n| (7.0 * n as f64 / COUNT as f64).sin()).collect();
        let fast: Vec<f64> = (0..COUNT).map(|n| (300.0 * n as f64 / COUNT as f64).sin()).collect();
        // Acts on every second of sixteen stretches, and half as much the other way on the others.
        let fitful = |n: usize| if (n * 16 / COUNT).is_multiple_of(2) { fast[n] } else { -0.5 * fast[n] };
        let kept = |second: &dyn Fn(usize) -> f64, seed: u64| -> Vec<usize> {
            let mut rng = Philox::new(seed, 0, Stream::Host);
            let values: Vec<f64> = (0..COUNT).map(|n| slow[n] + second(n) + rng.normal()).collect();
            let channel = Channel::new("x", &values, 1.0);
            let term = |(which, column): (usize, &Vec<f64>)| Term {
                cause: Cause::TemperatureSensitivity,
                addition: Addition::Curves(vec![Curve::new(column.clone())]),
                searched: which as f64,
                column: None,
            };
            let mut fitted = channel.fit([&slow, &fast].into_iter().enumerate().map(term).collect());
            while let Some(without) = without_the_weakest(&channel, &fitted, 0, 9.0) {
                fitted = without;
            }
            fitted.terms.iter().map(|t| t.searched as usize).collect()
        };
        for seed in 40..44 {
            assert_eq!(kept(&|n| fast[n], seed), [0, 1], "{seed}: both act");
            assert_eq!(kept(&|_| 0.0, seed), [0], "{seed}: one tells nothing");
            assert_eq!(kept(&fitful, seed), [0], "{seed}: one does not serve where it was not fitted");
        }
    }
}
