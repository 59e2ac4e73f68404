//! A course in time, or a slow wandering, that an environment column describes as well is
//! indistinguishable from that column.
//!
//! Whether a column acts is asked next to a walk whose strength is free (`shape`), where neither a
//! column that looks like a straight line nor the line itself would gain much. A straight or
//! settling course is named next to the noise that the channel was found to have. Next to that same
//! noise a column, at once or delayed, may do as well: then the recording cannot tell which it is,
//! and other channels of it cannot either.

use super::block_means;
use super::candidate::row;
use super::cause::Cause;
use super::channel::{Addition, Channel, Environment, Fitted, Term};
use super::column::{Column, STRAIGHT};
use super::course::is_course;
use super::decimated;
use super::followed::{lagged, played};
use super::profile::peak;
use super::selection::Selection;
use super::standing::{CLOSE, others};
use crate::control::{Control, Stopped};
use crate::parallel;

/// Returns whether a column could be what it is.
fn may_be_a_column(cause: Cause) -> bool {
    is_course(cause) || matches!(cause, Cause::RandomWalk | Cause::GaussMarkov)
}

/// Gives every term that a column describes as well this rival; `selected` are the channels'.
///
/// # Errors
/// Stopped.
pub(super) fn tie(
    channels: &[Channel],
    selected: &mut [Selection],
    environment: &Environment,
    control: &Control,
) -> Result<(), Stopped> {
    let columns: Vec<Column<'_>> = environment.iter().filter_map(|(name, curve)| Column::of(name, curve)).collect();
    let tied = |i: usize| tied(&channels[i], &selected[i].chosen, &columns, control);
    let found = parallel::map_indices(channels.len(), tied).into_iter().collect::<Result<Vec<_>, Stopped>>()?;
    for (selection, tied) in selected.iter_mut().zip(found) {
        for index in tied {
            let rivals = &mut selection.named[index].rivals;
            rivals.retain(|r| *r != Cause::TemperatureSensitivity);
            rivals.insert(0, Cause::TemperatureSensitivity);
        }
    }
    Ok(())
}

/// Places, among a model's terms, of those that a column describes as well.
fn tied(channel: &Channel, chosen: &Fitted, columns: &[Column<'_>], control: &Control) -> Result<Vec<usize>, Stopped> {
    let mut found = Vec::new();
    for (index, term) in chosen.terms.iter().enumerate().filter(|(_, t)| may_be_a_column(t.cause)) {
        let Some(own) = block_means::term(term, decimated::together(channel.values.len())) else { continue };
        let beside = Beside::of(channel, chosen, index);
        let least = beside.minus_aic(own, row(term.cause).numbers) - CLOSE;
        // A column that is followed already is no rival of what is named next to it.
        let other = |column: &&Column<'_>| !chosen.terms.iter().any(|t| t.follows(column.name()));
        for column in columns.iter().filter(other) {
            control.go_on()?;
            if beside.minus_aic_of(column) > least {
                found.push(index);
                break;
            }
        }
    }
    Ok(found)
}

/// A channel on means and the terms of its model but one.
struct Beside {
    channel: Channel,
    others: Vec<Term>,
}

impl Beside {
    fn of(channel: &Channel, chosen: &Fitted, but: usize) -> Self {
        let together = decimated::together(channel.values.len());
        Self {
            channel: block_means::channel(channel, &channel.values, together),
            others: others(chosen, but).iter().filter_map(|t| block_means::term(t, together)).collect(),
        }
    }

    /// Minus Akaike's information criterion of the model with this term added, which has `numbers`
    /// parameters: larger is better.
    fn minus_aic(&self, term: Term, numbers: f64) -> f64 {
        let terms = self.others.iter().cloned().chain([term]).collect();
        2.0 * (self.channel.fit(terms).log_likelihood() - numbers)
    }

    /// The best of a column along a straight line: at once, with a lag, with play.
    fn minus_aic_of(&self, column: &Column<'_>) -> f64 {
        let straight = |delayed: &[f64], numbers: f64| {
            let addition = Addition::Curves(column.powers(delayed, STRAIGHT));
            self.minus_aic(
                Term { cause: Cause::TemperatureSensitivity, addition, searched: 0.0, column: None },
                numbers,
            )
        };
        let late = |l: f64| straight(&lagged(&column.means, l.exp()), 2.0);
        let loose = |p: f64| straight(&played(&column.means, p.exp()), 2.0);
        let (_, late) = peak(column.lags().map(f64::ln), 8, late);
        let (_, loose) = peak(column.plays().map(f64::ln), 7, loose);
        straight(&column.means, 1.0).max(late).max(loose)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rest::channel::Curve;
    use crate::rest::spectrum::Law;
    use crate::rng::{Philox, Stream};

    const COUNT: usize = 4000;

    fn part(n: usize) -> f64 {
        n as f64 / COUNT as f64
    }

    fn ramp() -> Term {
        let ramp = Addition::Curves(vec![Curve::new((0..COUNT).map(part).collect())]);
        Term { cause: Cause::RateRamp, addition: ramp, searched: 0.0, column: None }
    }

    fn walk() -> Term {
        Term { cause: Cause::RandomWalk, addition: Addition::Law(Law::Walk), searched: 0.0, column: None }
    }

    /// Returns whether this term, named in a channel of a course and white noise, is
    /// indistinguishable from a column.
    fn is_tied(named: Term, at: &dyn Fn(usize) -> f64, column: &dyn Fn(usize) -> f64, member: u64) -> bool {
        let mut rng = Philox::new(37, member, Stream::Host);
        let values: Vec<f64> = (0..COUNT).map(|n| at(n) + rng.normal()).collect();
        let channel = Channel::new("x", &values, 1.0);
        let chosen = channel.fit(vec![named]);
        let curve = Curve::new((0..COUNT).map(column).collect());
        let columns: Vec<Column<'_>> = Column::of("t", &curve).into_iter().collect();
        tied(&channel, &chosen, &columns, &Control::silent()).expect("not stopped") == [0]
    }

    #[test]
    fn a_ramp_is_tied_with_a_column_that_looks_like_one_and_not_with_another() {
        let rising = |n: usize| part(n) + 0.005 * (20.0 * part(n)).sin();
        let swaying = |n: usize| (20.0 * part(n)).sin();
        for member in 0..5 {
            let straight = |n: usize| 2.0 * part(n);
            assert!(is_tied(ramp(), &straight, &rising, member), "{member}: it may be the column");
            assert!(is_tied(ramp(), &|n| 2.0 * rising(n), &rising, member), "{member}: it is the column");
            assert!(!is_tied(ramp(), &straight, &swaying, member), "{member}: the column sways");
        }
    }

    #[test]
    fn a_walk_is_tied_with_a_column_that_does_the_same_late_and_not_where_it_walks() {
        let swaying = |n: usize| (6.0 * part(n)).sin();
        for member in 0..5 {
            // Late by a fifteenth of the recording.
            let late = |n: usize| 0.1 * (6.0 * part(n) - 0.4).sin();
            assert!(is_tied(walk(), &late, &swaying, member), "{member}: it may be the column");
            let mut rng = Philox::new(38, member, Stream::Host);
            let steps = (0..COUNT).scan(0.0, |level, _| {
                *level += 0.02 * rng.normal();
                Some(*level)
            });
            let steps: Vec<f64> = steps.collect();
            assert!(!is_tied(walk(), &|n| steps[n], &swaying, member), "{member}: it walks");
        }
    }
}
