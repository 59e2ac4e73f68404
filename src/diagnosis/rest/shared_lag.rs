//! States how channels follow environment columns: each by itself, then those that follow nothing
//! by themselves with one lag for all.
//!
//! What a housing delays, it delays for every sensor in it. A lag too faint to be seen above the
//! noise of one channel is fitted to all silent channels together: one time constant, and one gain
//! per channel. A channel that follows a column by itself is left out, because its evidence would
//! count for channels that follow nothing. The lag must beat the other shapes by the penalty of a
//! parameter, and shifted copies of the same column; in each channel it must beat that channel's
//! own courses in time; and separate lags must not fit significantly better. A channel is named
//! only if its own gain is significant.

use super::cause::Cause;
use super::channel::{Channel, Curve, Environment, Term};
use super::column::{Column, POWERS, STRAIGHT};
use super::decimated::{Coarse, PENALTY};
use super::followed::{Delay, lagged, played};
use super::in_time::{Told, beats_time};
use super::profile::{peak, profile};
use super::shape::{self, Following, is_chance};
use super::shift_null::Otherwise;
use super::standing::{self, SUPERFLUOUS, probability};
use crate::control::{Control, Stopped};
use crate::numerics::special::chi_squared_survival;
use crate::parallel;

/// Returns how every channel follows every column: by channel, then by column.
///
/// # Errors
/// Stopped.
pub(super) fn find(
    channels: &[Channel],
    environment: &Environment,
    control: &Control,
) -> Result<Vec<Vec<Following>>, Stopped> {
    if environment.is_empty() {
        return Ok(vec![Vec::new(); channels.len()]);
    }
    let coarse: Vec<Coarse> = parallel::map(channels, Coarse::of);
    let columns: Vec<Option<Column<'_>>> = environment.iter().map(|(name, curve)| Column::of(name, curve)).collect();
    let correction = standing::correction(channels.len());
    let alone = |channel: &Coarse| -> Result<Vec<Following>, Stopped> {
        let by = |column: &Option<Column<'_>>| match column {
            Some(column) => shape::find(channel, column, correction, control),
            None => Ok(Following::Not),
        };
        columns.iter().map(by).collect()
    };
    let mut all = parallel::map(&coarse, alone).into_iter().collect::<Result<Vec<_>, Stopped>>()?;
    for (place, column) in columns.iter().enumerate() {
        let Some(column) = column else { continue };
        let silent = |i: &usize| matches!(all[*i][place], Following::Not);
        let members: Vec<Member<'_>> =
            (0..coarse.len()).filter(silent).map(|i| Member { place: i, coarse: &coarse[i] }).collect();
        let pool = Pool { column, asked: members.len(), correction, control };
        for (channel, term) in pool.together(members)? {
            all[channel][place] = Following::By(term);
        }
    }
    Ok(all)
}

/// A channel that follows nothing by itself.
#[derive(Clone, Copy)]
struct Member<'a> {
    /// Among all channels.
    place: usize,
    coarse: &'a Coarse,
}

/// Holds what silent channels may follow together.
struct Pool<'a> {
    column: &'a Column<'a>,
    /// States how many channels are silent.
    asked: usize,
    /// For all that is tried.
    correction: f64,
    control: &'a Control,
}

impl Pool<'_> {
    /// The terms of the channels that follow the column with one lag, by their places; none where
    /// they do not.
    fn together(&self, mut members: Vec<Member<'_>>) -> Result<Vec<(usize, Term)>, Stopped> {
        while members.len() > 1 {
            self.control.go_on()?;
            let (lag, _) = peak(self.column.lags().map(f64::ln), 8, |l: f64| self.sum(&members, &self.late(l.exp())));
            let curves = self.late(lag.exp());
            let told = self.each(&members, &curves);
            self.control.go_on()?;
            let gains: Vec<f64> = members.iter().zip(&told).map(|(m, t)| m.coarse.gain(*t)).collect();
            // Channels that stay were picked among all that were asked.
            if is_chance(gains.iter().sum(), self.asked as f64 + 1.0, self.correction) {
                break;
            }
            // The lag is one number for all of them.
            let numbers = 1.0 + 1.0 / members.len() as f64;
            let asked: Vec<(Member<'_>, f64)> = members.iter().copied().zip(told).collect();
            let stay = parallel::map(&asked, |(m, log_likelihood)| {
                beats_time(m.coarse, &Told { curves: curves.clone(), log_likelihood: *log_likelihood, numbers })
            });
            if stay.iter().all(|stays| *stays) {
                return self.judged(&members, &gains);
            }
            members = members.into_iter().zip(stay).filter(|(_, stays)| *stays).map(|(m, _)| m).collect();
        }
        Ok(Vec::new())
    }

    /// The terms of those channels that each need the lag, where it is a lag, and one for all, and
    /// no chance.
    fn judged(&self, members: &[Member<'_>], gains: &[f64]) -> Result<Vec<(usize, Term)>, Stopped> {
        let needs = |(m, gain): &(&Member<'_>, &f64)| {
            probability(Cause::TemperatureSensitivity, **gain, &m.coarse.channel) * self.correction <= SUPERFLUOUS
        };
        let needed: Vec<usize> = members.iter().zip(gains).filter(needs).map(|(m, _)| m.place).collect();
        // What one channel alone has is not shared.
        if needed.len() < 2 {
            return Ok(Vec::new());
        }
        self.control.go_on()?;
        let bounds = self.column.lags();
        let at = |lag: f64| self.sum(members, &self.late(lag));
        let (lag, late) = profile(bounds.map(f64::ln), 8, |l: f64| at(l.exp()));
        let lag = lag.map(f64::exp);
        // An interval that ends on a bound holds following at once, or another law.
        let is_inside = lag.ci95[0] > bounds[0] && lag.ci95[1] < bounds[1];
        let is_shared = is_inside && self.is_late(members, late) && self.is_one(members, late);
        self.control.go_on()?;
        if !is_shared {
            return Ok(Vec::new());
        }
        let curves = self.late(lag.value);
        let left: Vec<Coarse> = parallel::map(members, |m| m.coarse.without(curves.clone()));
        let chance = Otherwise::of(&left, self.column, self.control)?;
        let numbers = (self.asked as f64 + 1.0) / chance.together;
        let gain: f64 = gains.iter().sum();
        if gain <= chance.most || is_chance(gain / chance.together, numbers, self.correction) {
            return Ok(Vec::new());
        }
        let term = self.column.term(Delay::Lag(lag), STRAIGHT);
        Ok(needed.into_iter().map(|place| (place, term.clone())).collect())
    }

    /// Returns whether a lag beats every other shape that a channel is offered: what follows at
    /// once by what a number costs, and play, which has as many numbers as a lag, as it is (so
    /// `shape` does too).
    fn is_late(&self, members: &[Member<'_>], late: f64) -> bool {
        let Self { column, .. } = self;
        let at_once = |of: &&[i32]| {
            let more = members.len() as f64 * (of.len() as f64 - 1.0);
            2.0 * self.sum(members, &column.powers(&column.means, of)) - PENALTY * more
        };
        let loose = |p: f64| self.sum(members, &column.powers(&played(&column.means, p.exp()), STRAIGHT));
        let (_, loose) = peak(column.plays().map(f64::ln), 7, loose);
        POWERS.iter().map(at_once).all(|other| 2.0 * late > other + PENALTY) && late > loose
    }

    /// Returns whether channels have one lag: lags of their own gain no more than chance.
    fn is_one(&self, members: &[Member<'_>], late: f64) -> bool {
        let own =
            |m: &Member<'_>| peak(self.column.lags().map(f64::ln), 8, |l: f64| m.coarse.with(self.late(l.exp()))).1;
        let apart: f64 = parallel::map(members, own).iter().sum();
        let gain = (2.0 * (apart - late)).max(0.0);
        chi_squared_survival(gain, members.len() as f64 - 1.0) > SUPERFLUOUS
    }

    /// Log-likelihood of every channel next to curves; nothing is worked out once stopped.
    fn each(&self, members: &[Member<'_>], curves: &[Curve]) -> Vec<f64> {
        let of = |m: &Member<'_>| match self.control.cancelled() {
            true => f64::NEG_INFINITY,
            false => m.coarse.with(curves.to_vec()),
        };
        parallel::map(members, of)
    }

    /// Log-likelihood of all channels next to curves.
    fn sum(&self, members: &[Member<'_>], curves: &[Curve]) -> f64 {
        self.each(members, curves).iter().sum()
    }

    /// The column after a lag, in means.
    fn late(&self, lag: f64) -> Vec<Curve> {
        self.column.powers(&lagged(&self.column.means, lag), STRAIGHT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{Stage, Watcher};
    use crate::rest::followed::Followed;
    use crate::rng::{Philox, Stream};

    const COUNT: usize = 4000;
    /// Of a unit of noise, per unit of the column: too little for a channel alone.
    const FAINT: f64 = 0.1;
    const STRONG: f64 = 1.0;
    /// In samples.
    const LAG: f64 = 300.0;

    fn day(n: usize) -> f64 {
        let t = n as f64 / COUNT as f64;
        25.0 + 2.0 * (9.0 * t).sin() + (23.0 * t + 1.0).sin()
    }

    fn late(lag: f64, strength: f64) -> Vec<f64> {
        let column: Vec<f64> = (0..COUNT).map(day).collect();
        lagged(&column, lag).iter().map(|v| strength * v).collect()
    }

    fn nothing() -> Vec<f64> {
        vec![0.0; COUNT]
    }

    fn walk(size: f64, seed: u64) -> Vec<f64> {
        let mut rng = Philox::new(seed, 9, Stream::Host);
        let mut sum = 0.0;
        let step = |_| {
            sum += size * rng.normal();
            sum
        };
        (0..COUNT).map(step).collect()
    }

    /// Returns how channels of these courses and white noise of one unit follow the column; a lag
    /// in samples.
    fn followed(courses: [Vec<f64>; 3], seed: u64) -> [Option<f64>; 3] {
        let channel = |(i, course): (usize, &Vec<f64>)| {
            let mut rng = Philox::new(seed, i as u64, Stream::Host);
            let values: Vec<f64> = course.iter().map(|v| v + rng.normal()).collect();
            Channel::new("x", &values, 1.0)
        };
        let channels: Vec<Channel> = courses.iter().enumerate().map(channel).collect();
        let column = Curve::new((0..COUNT).map(day).collect());
        let all = find(&channels, &[("t".to_owned(), column)], &Control::silent()).expect("not stopped");
        let lag = |of: &Vec<Following>| match &of[0] {
            Following::By(Term { column: Some(Followed { delay: Delay::Lag(lag), .. }), .. }) => Some(lag.value),
            _ => None,
        };
        [0, 1, 2].map(|i| lag(&all[i]))
    }

    #[test]
    fn a_lag_too_faint_for_each_channel_is_found_in_all_of_them() {
        let (mut shared, mut apart) = (0, 0);
        for seed in 70..78 {
            let all = followed([0, 1, 2].map(|_| late(LAG, FAINT)), seed);
            assert!(all.iter().flatten().all(|lag| (100.0..900.0).contains(lag)), "{seed}: {all:?}");
            shared += all.iter().flatten().count();
            // Control: the same in one channel, next to two that follow nothing.
            let one = followed([late(LAG, FAINT), nothing(), nothing()], seed);
            apart += usize::from(one[0].is_some());
            assert_eq!(one[1..], [None, None], "{seed}: they follow nothing");
        }
        assert!(shared >= 12 && apart <= 1, "{shared} of 24 together, {apart} of 8 alone");
    }

    #[test]
    fn a_channel_that_follows_by_itself_opens_no_gate_for_others() {
        let ramp: Vec<f64> = (0..COUNT).map(|n| 2.0 * n as f64 / COUNT as f64).collect();
        for seed in 80..85 {
            for other in [nothing(), ramp.clone()] {
                let [strong, one, two] = followed([late(LAG, STRONG), other, nothing()], seed);
                assert!(strong.is_some_and(|lag| (250.0..350.0).contains(&lag)), "{seed}: {strong:?}");
                assert_eq!([one, two], [None, None], "{seed}: nothing and a course in time");
            }
            // Control: where all are strong, all follow.
            let all = followed([0, 1, 2].map(|_| late(LAG, STRONG)), seed);
            assert!(all.iter().all(Option::is_some), "{seed}: {all:?}");
        }
    }

    #[test]
    fn a_walk_in_all_channels_is_no_lag() {
        for seed in 90..98 {
            let common = walk(0.03, seed);
            let all = followed([0, 1, 2].map(|_| common.clone()), seed);
            assert_eq!(all, [None; 3], "{seed}");
        }
    }

    #[test]
    fn what_follows_at_once_is_not_late() {
        for seed in 60..66 {
            let at_once = followed([0, 1, 2].map(|_| (0..COUNT).map(|n| FAINT * day(n)).collect()), seed);
            assert_eq!(at_once, [None; 3], "{seed}");
        }
    }

    #[test]
    fn lags_that_differ_are_not_one_and_equal_ones_are() {
        let curve = Curve::new((0..COUNT).map(day).collect());
        let column = Column::of("t", &curve).expect("not constant");
        let control = Control::silent();
        let pool = Pool { column: &column, asked: 3, correction: 27.0, control: &control };
        let is_one = |lags: [f64; 3], seed: u64| {
            let channel = |i: usize| {
                let mut rng = Philox::new(seed, i as u64, Stream::Host);
                let values: Vec<f64> = late(lags[i], 0.3).iter().map(|v| v + rng.normal()).collect();
                Coarse::of(&Channel::new("x", &values, 1.0))
            };
            let coarse = [0, 1, 2].map(channel);
            let members = [0, 1, 2].map(|i| Member { place: i, coarse: &coarse[i] });
            let (_, best) = peak(column.lags().map(f64::ln), 8, |l: f64| pool.sum(&members, &pool.late(l.exp())));
            pool.is_one(&members, best)
        };
        let equal = (50..58).filter(|seed| is_one([LAG; 3], *seed)).count();
        let unequal = (50..58).filter(|seed| is_one([50.0, LAG, 900.0], *seed)).count();
        assert!(equal >= 6 && unequal == 0, "{equal} of 8 equal ones, {unequal} of 8 unequal ones");
    }

    #[test]
    fn it_stops_when_asked() {
        struct Impatient;
        impl Watcher for Impatient {
            fn stopped_by(&self) -> Option<&'static str> {
                Some("a test")
            }
            fn begin(&self, _: &str, _: u64) -> Box<dyn Stage> {
                unreachable!("no stage is begun")
            }
            fn remark(&self, _: &str) {}
        }
        let channels = [0, 1].map(|_| Channel::new("x", &walk(1.0, 1), 1.0));
        let environment = [("t".to_owned(), Curve::new((0..COUNT).map(day).collect()))];
        assert!(find(&channels, &environment, &Control::new(Impatient)).is_err());
        assert!(find(&channels, &environment, &Control::silent()).is_ok());
    }
}
