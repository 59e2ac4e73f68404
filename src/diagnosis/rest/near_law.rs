//! A drift whose spectrum is a power law f^−α gets one name, that of the law with the nearest whole
//! exponent.
//!
//! A sum of flicker, a walk and a memory absorbs what one law near 1/f or 1/f² leaves: the second
//! and third names would be given for the freedom of the first. Where one law of free exponent does
//! as well as the sum with fewer numbers, it stands for all of it, if it leaves noise; its name
//! carries the exponent. Whether the exponent is the library's is for `departure`.

use super::candidate::{Placed, row};
use super::cause::Cause;
use super::channel::{Addition, Channel, Fitted, Term};
use super::departure::{Departure, Of, Ruling};
use super::effects::{Basis, Found};
use super::laws::slow_laws;
use super::profile::Profiled;
use super::residual::{TOLERANCE, residual};
use super::selection::Selection;
use super::spectrum::Law;
use super::standing::{correction, removal_p_value};
use crate::remainder::REAL;
use crate::verdict::{Estimate, Evidence};

/// States how far from a whole exponent a law may be and still have its name: half way to the next.
const HALF_WAY: f64 = 0.5;

/// The law whose whole exponent is nearest.
fn nearest(exponent: f64) -> Option<(Cause, Law)> {
    let near = |whole: f64| (exponent - whole).abs() <= HALF_WAY;
    if near(1.0) {
        Some((Cause::FlickerNoise, Law::Flicker))
    } else if near(2.0) {
        Some((Cause::RandomWalk, Law::Walk))
    } else {
        None
    }
}

/// Returns whether an end of the exponent's interval is nearer to another law's.
fn may_be_another(cause: Cause, ci95: [f64; 2]) -> bool {
    ci95.iter().any(|end| nearest(*end).is_some_and(|(other, _)| other != cause))
}

/// The one slow law of a channel that may as well be a power law, and the laws that this one is
/// near, nearest first: the name is one of several, and never said alone.
pub(super) fn ties(chosen: &Fitted, departure: &Departure) -> Option<(Cause, Vec<Cause>)> {
    let exponent = departure.exponent.filter(|_| departure.of == Of::Spectrum && departure.ruling == Ruling::Open)?;
    let [own] = slow_laws(chosen)[..] else { return None };
    Some((own, others(own, exponent)))
}

/// Laws other than this one that an exponent or an end of its interval is near, nearest first.
fn others(own: Cause, exponent: Profiled) -> Vec<Cause> {
    let mut near: Vec<Cause> = Vec::new();
    for value in [exponent.value, exponent.ci95[0], exponent.ci95[1]] {
        near.extend(nearest(value).map(|(cause, _)| cause).filter(|c| *c != own && !near.contains(c)));
    }
    near
}

/// One channel among those judged.
pub(super) struct Judged<'a> {
    pub(super) place: usize,
    pub(super) channel: &'a Channel,
    pub(super) selection: &'a Selection,
    pub(super) departure: &'a Departure,
    /// Of all channels.
    pub(super) count: usize,
}

/// The one effect that stands for all slow laws of a channel; `None` where they stand as they are.
pub(super) fn one_for_all(of: &Judged<'_>) -> Option<Found> {
    let Judged { place, channel, selection, departure, count } = *of;
    let chosen = &selection.chosen;
    let exponent = departure.exponent.filter(|_| departure.of == Of::Spectrum)?;
    let (cause, law) = nearest(exponent.value)?;
    // An exponent that may as well be nearer to another law's has the name of neither.
    if departure.ruling == Ruling::Refuted && may_be_another(cause, exponent.ci95) {
        return None;
    }
    let slow = slow_laws(chosen);
    let open = departure.ruling == Ruling::Open;
    // One whole law that may hold keeps its name as it is; so does a memory that does better.
    if open
        && !departure.takes.courses
        && slow.len() == 1
        && (slow[0] != Cause::GaussMarkov || departure.better_by < 0.0)
    {
        return None;
    }
    let rest: Vec<Term> = chosen.terms.iter().filter(|t| !departure.concerns(t.cause)).cloned().collect();
    let with = |law: Law| -> Fitted {
        let term = Term { cause, addition: Addition::Law(law), searched: 0.0, column: None };
        channel.fit(rest.iter().cloned().chain([term]).collect())
    };
    let free = with(Law::Power(exponent.value));
    if residual(channel, &free, TOLERANCE).p_value * (count as f64) < REAL {
        return None;
    }
    let index = rest.len();
    let without = channel.fit(rest.clone());
    let whole = with(law);
    let mut parameters = (row(cause).parameters)(&Placed { channel, fitted: &whole, index });
    let ci95 = exponent.ci95;
    parameters.push(Estimate { name: "exponent".into(), value: exponent.value, unit: "1".into(), ci95 });
    let all = free.held_out(&channel.promised);
    let possible = all - selection.base.held_out(&channel.promised);
    let own = all - without.held_out(&channel.promised);
    let replaced = chosen.terms.iter().map(|t| t.cause).find(|c| departure.concerns(*c) && *c != cause);
    let near = others(cause, exponent).into_iter().filter(|c| Some(*c) != replaced);
    Some(Found {
        cause,
        channels: vec![place],
        parameters,
        evidence: Evidence {
            held_out_gain: (own / possible.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0),
            p_value: removal_p_value(channel, &free, &without, index, correction(count)).min(1.0),
        },
        rivals: if open { replaced.into_iter().chain(near).collect() } else { Vec::new() },
        basis: Basis::Exponent,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rest::departure::Takes;

    #[test]
    fn a_law_that_may_be_a_power_law_ties_with_those_that_this_is_near() {
        let rows: Vec<f64> = (0..512).map(|n| f64::from(n * 7919 % 512) / 512.0).collect();
        let channel = Channel::new("x", &rows, 1.0);
        let chosen =
            |cause, law| channel.fit(vec![Term { cause, addition: Addition::Law(law), searched: 0.0, column: None }]);
        let open = |value, ci95| Departure {
            ruling: Ruling::Open,
            of: Of::Spectrum,
            exponent: Some(Profiled { value, ci95 }),
            better_by: -1.0,
            takes: Takes { courses: false, noise: true, slow_lines: false },
        };
        let memory = chosen(Cause::GaussMarkov, Law::Markov(30.0));
        let flicker = chosen(Cause::FlickerNoise, Law::Flicker);
        let tied = |of: &Fitted, departure: &Departure| ties(of, departure).map(|t| t.1);
        assert_eq!(tied(&memory, &open(1.3, [1.1, 1.45])), Some(vec![Cause::FlickerNoise]));
        assert_eq!(tied(&memory, &open(1.6, [1.3, 1.9])), Some(vec![Cause::RandomWalk, Cause::FlickerNoise]));
        assert_eq!(tied(&flicker, &open(1.3, [1.1, 1.6])), Some(vec![Cause::RandomWalk]));
        assert_eq!(tied(&flicker, &open(1.2, [1.1, 1.4])), Some(Vec::new()), "near its own alone: control");
        let refuted = Departure { ruling: Ruling::Refuted, ..open(1.3, [1.1, 1.45]) };
        assert_eq!(tied(&memory, &refuted), None, "what is refuted is no tie: control");
    }

    // Half way from 1/f to 1/f² lies 1.5: an interval on both sides of it says neither. Beyond 2.5
    // there is no law that it could be mistaken for.
    #[test]
    fn an_interval_that_reaches_half_way_to_another_law_may_be_either() {
        assert!(may_be_another(Cause::RandomWalk, [1.34, 1.7]) && may_be_another(Cause::FlickerNoise, [1.2, 1.51]));
        assert!(!may_be_another(Cause::FlickerNoise, [1.23, 1.47]) && !may_be_another(Cause::RandomWalk, [1.75, 2.61]));
    }
}
