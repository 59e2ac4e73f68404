//! How channels follow environment columns: each by itself, and with a lag that all of them share.
//!
//! What a housing delays, it delays for every sensor in it. So a lag that is too faint to be told from each channel's own
//! noise is looked for once more in all of them together, with one time constant and a strength of its own for each. The
//! rules are those of one channel (`shape`): beyond chance, and more than any smooth course in time tells.

use super::cause::Cause;
use super::channel::{Addition, Channel, Curve, Environment, Term};
use super::followed::{Delay, Followed};
use super::profile::profile;
use super::shape::{self, Course, Following, LAGS, PENALTY, SHAPES, STRAIGHT, Search};
use super::standing::{self, ALPHA};
use crate::numerics::special::chi_squared_survival;
use crate::parallel;

/// How every channel follows every column: by channel, then by column.
pub(super) fn find(channels: &[Channel], environment: &Environment) -> Vec<Vec<Following>> {
    let correction = standing::correction(channels.len());
    let alone = |channel: &Channel| -> Vec<Following> {
        environment.iter().map(|(name, column)| shape::find(channel, name, column, correction)).collect()
    };
    let mut all = parallel::map(channels, alone);
    for (place, (name, column)) in environment.iter().enumerate() {
        if all.iter().all(|of| matches!(of[place], Following::By(_))) {
            continue;
        }
        for (of, term) in all.iter_mut().zip(together(channels, name, column, correction)) {
            match (&of[place], term) {
                (Following::By(_), _) | (_, None) => {}
                (_, Some(term)) => of[place] = Following::By(term),
            }
        }
    }
    all
}

/// The terms of the channels that follow a column with one lag; none where all of them together do not beyond chance,
/// and `None` for a channel that has no part in it.
fn together(channels: &[Channel], name: &str, column: &Curve, correction: f64) -> Vec<Option<Term>> {
    let none = vec![None; channels.len()];
    let searches: Option<Vec<Search>> = channels.iter().map(|channel| Search::of(channel, column)).collect();
    let Some(searches) = searches.filter(|searches| searches.len() > 1) else { return none };
    let count = searches[0].environment.len();
    let late = |samples: f64| -> Vec<f64> { parallel::map(&searches, |s| s.following(s.late(samples))) };
    let (lag, _) = profile(LAGS.map(|part| (part * count as f64).ln()), 8, |l: f64| late(l.exp()).iter().sum());
    let lag = lag.map(f64::exp);
    let gains: Vec<f64> = searches.iter().zip(late(lag.value)).map(|(s, with)| 2.0 * (with - s.alone())).collect();
    let gain: f64 = gains.iter().sum();
    let numbers = searches.len() as f64 + 1.0;
    if SHAPES * chi_squared_survival(gain.max(0.0), numbers) * correction >= ALPHA || !beats_time(&searches, lag.value)
    {
        return none;
    }
    let term = |(search, gain): (&Search, &f64)| {
        let samples = lag.map(|means| means * search.together as f64);
        let curves = shape::powers(&shape::lagged(&column.values, samples.value), search.unit, STRAIGHT);
        let column = Followed { column: name.into(), delay: Delay::Lag(samples), unit: search.unit, powers: STRAIGHT };
        let cause = Cause::TemperatureSensitivity;
        let term = Term { cause, addition: Addition::Curves(curves), searched: 0.0, column: Some(column) };
        (*gain > PENALTY).then_some(term)
    };
    searches.iter().zip(&gains).map(term).collect()
}

/// Whether a column with this lag tells more of the channels than a smooth course in time of each, or something beside it.
fn beats_time(searches: &[Search], lag: f64) -> bool {
    let courses: Vec<(f64, Course)> =
        parallel::map(searches, |s| shape::best_in_time(s.environment.len(), &|curves| s.following(curves)));
    let in_time: f64 = courses.iter().map(|(merit, _)| merit).sum();
    let merit = |s: &Search, (curves, numbers): &Course| {
        let all = s.late(lag).into_iter().chain(curves.iter().cloned()).collect();
        2.0 * s.following(all) - PENALTY * (1.0 + numbers)
    };
    let by_column: f64 = searches.iter().map(|s| merit(s, &(Vec::new(), 0.0))).sum();
    let both = || -> f64 { searches.iter().zip(&courses).map(|(s, (_, course))| merit(s, course)).sum() };
    // The lag is one number for all of them.
    by_column - PENALTY > in_time || both() - PENALTY > in_time + PENALTY
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    const COUNT: usize = 4000;

    fn day(n: usize) -> f64 {
        let t = n as f64 / COUNT as f64;
        25.0 + 2.0 * (9.0 * t).sin() + (23.0 * t + 1.0).sin()
    }

    /// Three channels of white noise of one unit, with this of a column that each follows late.
    fn three(strengths: [f64; 3], seed: u64) -> Vec<Vec<Following>> {
        let column: Vec<f64> = (0..COUNT).map(day).collect();
        let late = shape::lagged(&column, 300.0);
        let channel = |(i, strength): (usize, f64)| {
            let mut rng = Philox::new(seed, i as u64, Stream::Host);
            let values: Vec<f64> = late.iter().map(|v| strength * v + rng.normal()).collect();
            Channel::new("x", &values, 1.0)
        };
        let channels: Vec<Channel> = strengths.into_iter().enumerate().map(channel).collect();
        find(&channels, &[("t".to_owned(), Curve::new(column))])
    }

    fn lag(following: &Following) -> Option<f64> {
        match following {
            Following::By(Term { column: Some(Followed { delay: Delay::Lag(lag), .. }), .. }) => Some(lag.value),
            _ => None,
        }
    }

    #[test]
    fn a_lag_too_faint_for_each_channel_is_found_in_all_of_them() {
        const FAINT: f64 = 0.07;
        let (mut shared, mut apart) = (0, 0);
        for seed in 70..76 {
            let all = three([FAINT; 3], seed);
            let found = all.iter().filter_map(|of| lag(&of[0])).filter(|lag| (100.0..900.0).contains(lag)).count();
            shared += found;
            // Control: the same in one channel, beside two that follow nothing.
            let one = three([FAINT, 0.0, 0.0], seed);
            apart += usize::from(matches!(one[0][0], Following::By(_)));
            assert!(one[1..].iter().all(|of| !matches!(of[0], Following::By(_))), "{seed}: they follow nothing");
        }
        assert!(shared >= 14 && apart <= 3, "{shared} of 18 together, {apart} of 6 alone");
    }

    #[test]
    fn noise_follows_nothing_together_and_neither_do_courses_in_time() {
        for seed in 80..84 {
            assert!(three([0.0; 3], seed).iter().all(|of| !matches!(of[0], Following::By(_))), "{seed}: noise");
            // A smooth column, and channels that each settle in their own time.
            let part = |n: usize| n as f64 / COUNT as f64;
            let column: Vec<f64> = (0..COUNT).map(|n| 25.0 - 5.0 * (-3.0 * part(n)).exp()).collect();
            let channel = |i: usize| {
                let mut rng = Philox::new(seed, i as u64, Stream::Host);
                let values: Vec<f64> = (0..COUNT).map(|n| part(n).powf(0.5 + i as f64) + rng.normal()).collect();
                Channel::new("x", &values, 1.0)
            };
            let channels: Vec<Channel> = (0..3).map(channel).collect();
            let all = find(&channels, &[("t".to_owned(), Curve::new(column))]);
            assert!(all.iter().all(|of| !matches!(of[0], Following::By(_))), "{seed}: courses in time");
        }
    }
}
