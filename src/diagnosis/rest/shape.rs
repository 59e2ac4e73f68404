//! The shapes in which a reading may follow an environment column: at once, with a lag, with play;
//! straight or bent.
//!
//! They are offered before any noise is, and beside a walk and flicker whose strengths are free: a
//! column that only looks like the drift gains nothing there. What a column explains in some shape
//! is then left to no law of noise. A column that is itself smooth can be bent to any smooth drift:
//! it is a witness only where it tells more than a smooth course in time does. Searched on means of
//! neighbours, fitted on all values.

use super::blocks;
use super::cause::Cause;
use super::channel::{Addition, Channel, Curve, Term};
use super::course::{EXPONENTS, course, smooth};
use super::followed::{Delay, Followed};
use super::profile::profile;
use super::spectrum::Law;
use super::standing::ALPHA;
use crate::numerics::moments::mean_sd;
use crate::numerics::special::chi_squared_survival;

/// Values that shapes are searched on, at most.
const MOST: usize = 4096;
/// Twice the log-likelihood that a number of the shape must gain: Schwarz's for [`MOST`] values.
const PENALTY: f64 = 8.3;
/// Lags that are tried, as parts of the recording; shorter than the first is none.
const LAGS: [f64; 2] = [0.002, 0.3];
/// Half widths of play that are tried, as parts of the column's range.
const PLAYS: [f64; 2] = [0.01, 0.4];
/// Powers of the column that are tried together: a square or a cube only where it is needed.
const POWERS: [&[i32]; 4] = [&[1], &[1, 2], &[1, 3], &[1, 2, 3]];
/// Time constants of a settling that are tried, as parts of the recording.
const SETTLING: [f64; 2] = [0.01, 2.0];
/// Shapes that differ by more than chance, for the correction of a probability.
const SHAPES: f64 = 10.0;

/// After a first-order lag of this many samples, settled at the beginning.
fn lagged(column: &[f64], samples: f64) -> Vec<f64> {
    let keep = (-1.0 / samples).exp();
    let mut state = column.first().copied().unwrap_or(0.0);
    let step = |v: &f64| {
        state = keep * state + (1.0 - keep) * v;
        state
    };
    column.iter().map(step).collect()
}

/// After play of so wide a half.
fn played(column: &[f64], half: f64) -> Vec<f64> {
    let mut state = column.first().copied().unwrap_or(0.0);
    let step = |v: &f64| {
        state = state.clamp(v - half, v + half);
        state
    };
    column.iter().map(step).collect()
}

/// Powers of values about their mean in units of `unit`.
fn powers(values: &[f64], unit: f64, of: &[i32]) -> Vec<Curve> {
    let (mean, _) = mean_sd(values);
    let power = |p: &i32| Curve::new(values.iter().map(|v| ((v - mean) / unit).powi(*p)).collect());
    of.iter().map(power).collect()
}

/// How a channel follows a column.
pub(super) enum Following {
    /// By this term.
    By(Term),
    /// Not beyond chance.
    Not,
    /// A smooth course in time does as well without it: the column is no witness.
    NoBetterThanTime,
}

/// The term in which a channel follows a column, where it does beyond chance (`correction` for all
/// that is tried).
pub(super) fn find(channel: &Channel, name: &str, column: &Curve, correction: f64) -> Following {
    let together = channel.values.len().div_ceil(MOST);
    let own = blocks::channel(channel, &channel.values, together);
    let environment = blocks::means(&column.values, together);
    let (_, unit) = mean_sd(&environment);
    if unit.is_nan() || unit <= 0.0 {
        return Following::Not;
    }
    let range = environment.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(*v), h.max(*v)]);
    let noise = [(Cause::RandomWalk, Law::Walk), (Cause::FlickerNoise, Law::Flicker)].map(|(cause, law)| Term {
        cause,
        addition: Addition::Law(law),
        searched: 0.0,
        column: None,
    });
    let following = |curves: Vec<Curve>| {
        let cause = Cause::TemperatureSensitivity;
        let term = Term { cause, addition: Addition::Curves(curves), searched: 0.0, column: None };
        own.fit(noise.iter().cloned().chain([term]).collect()).log_likelihood()
    };
    let count = environment.len() as f64;
    let late = |samples: f64| following(powers(&lagged(&environment, samples), unit, POWERS[0]));
    let loose = |half: f64| following(powers(&played(&environment, half), unit, POWERS[0]));
    let (lag, _) = profile(LAGS.map(|p| (p * count).ln()), 8, |l: f64| late(l.exp()));
    let (play, _) = profile(PLAYS.map(|p| (p * (range[1] - range[0])).ln()), 7, |p: f64| loose(p.exp()));
    let (lag, play) = (lag.map(f64::exp), play.map(f64::exp));
    let delayed = |delay: Delay| match delay {
        Delay::None => environment.clone(),
        Delay::Lag(lag) => lagged(&environment, lag.value),
        Delay::Play(play) => played(&environment, play.value),
    };
    let mut best: Option<(f64, f64, Delay, &'static [i32], f64)> = None;
    for delay in [Delay::None, Delay::Lag(lag), Delay::Play(play)] {
        let curve = delayed(delay);
        for of in POWERS {
            let numbers = of.len() as f64 + if delay == Delay::None { 0.0 } else { 1.0 };
            let log_likelihood = following(powers(&curve, unit, of));
            let merit = 2.0 * log_likelihood - PENALTY * numbers;
            if best.is_none_or(|b| merit > b.0) {
                best = Some((merit, log_likelihood, delay, of, numbers));
            }
        }
    }
    let Some((merit, log_likelihood, delay, of, numbers)) = best else { return Following::Not };
    let gain = 2.0 * (log_likelihood - own.fit(noise.to_vec()).log_likelihood());
    if SHAPES * chi_squared_survival(gain.max(0.0), numbers) * correction >= ALPHA {
        return Following::Not;
    }
    let (in_time, course) = best_in_time(environment.len(), &following);
    if in_time > merit {
        // Both may act: then the column still tells what no course of time does.
        let curves = powers(&delayed(delay), unit, of).into_iter().chain(course.0).collect();
        let both = 2.0 * following(curves) - PENALTY * (numbers + course.1);
        if both < in_time + PENALTY {
            return Following::NoBetterThanTime;
        }
    }
    let samples = together as f64;
    let delay = match delay {
        Delay::Lag(lag) => Delay::Lag(lag.map(|v| v * samples)),
        other => other,
    };
    let full = match delay {
        Delay::None => column.values.to_vec(),
        Delay::Lag(lag) => lagged(&column.values, lag.value),
        Delay::Play(play) => played(&column.values, play.value),
    };
    Following::By(Term {
        cause: Cause::TemperatureSensitivity,
        addition: Addition::Curves(powers(&full, unit, of)),
        searched: 0.0,
        column: Some(Followed { column: name.into(), delay, unit, powers: of }),
    })
}

/// A course in time with its numbers.
type Course = (Vec<Curve>, f64);

/// The smooth course in time of most merit: a power of time, a settling, a kinked line, a
/// polynomial of time or of its logarithm.
fn best_in_time(count: usize, following: &dyn Fn(Vec<Curve>) -> f64) -> (f64, Course) {
    let power = |p: f64| vec![course(count, |u| u.powf(p.exp()))];
    let settling = |part: f64| vec![course(count, |u| (-u / part.exp()).exp())];
    let (p, _) = profile(EXPONENTS.map(f64::ln), 12, |p| following(power(p)));
    let (part, _) = profile(SETTLING.map(f64::ln), 12, |part| following(settling(part)));
    let all = [(vec![course(count, |u| u)], 1.0), (power(p.value), 2.0), (settling(part.value), 2.0)];
    let judged = all
        .into_iter()
        .chain(smooth(count))
        .map(|(curves, numbers)| (2.0 * following(curves.clone()) - PENALTY * numbers, (curves, numbers)));
    judged.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::NEG_INFINITY, (Vec::new(), 0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    const COUNT: usize = 12_000;

    fn day(n: usize) -> f64 {
        let t = n as f64 / COUNT as f64;
        25.0 + 2.0 * (9.0 * t).sin() + (23.0 * t + 1.0).sin()
    }

    fn found(at: impl Fn(&[f64]) -> Vec<f64>, member: u64) -> Option<(Delay, usize)> {
        let mut rng = Philox::new(33, member, Stream::Host);
        let column: Vec<f64> = (0..COUNT).map(day).collect();
        let values: Vec<f64> = at(&column).into_iter().map(|v| v + rng.normal()).collect();
        let found = find(&Channel::new("x", &values, 1.0), "t", &Curve::new(column), 9.0);
        let Following::By(term) = found else { return None };
        let Addition::Curves(curves) = &term.addition else { return None };
        Some((term.column?.delay, curves.len()))
    }

    #[test]
    fn every_shape_is_found_as_itself_and_a_walk_follows_nothing() {
        for member in 0..5 {
            assert_eq!(found(|c| c.to_vec(), member), Some((Delay::None, 1)));
            let bent = found(|c| c.iter().map(|v| (v - 24.0).powi(2)).collect(), member);
            assert_eq!(bent, Some((Delay::None, 2)));
            let late = found(|c| lagged(c, 400.0), member);
            let lag = late.and_then(|l| if let (Delay::Lag(lag), 1) = l { Some(lag.value) } else { None });
            assert!(lag.is_some_and(|l| (300.0..520.0).contains(&l)), "{late:?}");
            let loose = found(|c| played(c, 0.8).into_iter().map(|v| 2.0 * v).collect(), member);
            let play = loose.and_then(|l| if let (Delay::Play(play), 1) = l { Some(play.value) } else { None });
            assert!(play.is_some_and(|p| (0.7..0.9).contains(&p)), "{loose:?}");
            let mut rng = Philox::new(34, member, Stream::Host);
            let mut sum = 0.0;
            let walk: Vec<f64> = (0..COUNT)
                .map(|_| {
                    sum += 0.05 * rng.normal();
                    sum
                })
                .collect();
            assert_eq!(found(|_| walk.clone(), member), None, "a walk");
        }
    }

    #[test]
    fn a_smooth_column_is_no_witness_of_a_course_in_time_and_is_one_of_itself() {
        let part = |n: usize| n as f64 / COUNT as f64;
        let column: Vec<f64> =
            (0..COUNT).map(|n| 25.0 - 5.0 * (-3.0 * part(n)).exp() + (4.0 * part(n)).sin()).collect();
        let following = |at: &dyn Fn(usize) -> f64, member: u64| {
            let mut rng = Philox::new(35, member, Stream::Host);
            let values: Vec<f64> = (0..COUNT).map(|n| at(n) + rng.normal()).collect();
            find(&Channel::new("x", &values, 1.0), "t", &Curve::new(column.clone()), 9.0)
        };
        for member in 0..3 {
            let power = following(&|n| 40.0 * part(n).powf(1.5), member);
            assert!(matches!(power, Following::NoBetterThanTime), "{member}: a power of time");
            assert!(matches!(following(&|n| column[n], member), Following::By(_)), "{member}: the column");
            assert!(matches!(following(&|_| 0.0, member), Following::Not), "{member}: noise");
        }
    }
}
