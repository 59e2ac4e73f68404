//! States what noise makes of a column that cannot have acted: the same column, begun at another
//! time or run backwards.
//!
//! Its likeness to the readings is chance, and it shows two things that no law of a single channel
//! does: how large a gain becomes by chance where the noise is not quite what the laws say, and how
//! much of it channels gain together because they share noise. Tried on what the true column
//! leaves.

use super::column::{Column, STRAIGHT};
use super::decimated::Coarse;
use super::followed::lagged;
use super::profile::peak;
use crate::control::{Control, Stopped};
use crate::numerics::moments::mean_sd;
use crate::parallel;

/// Beginnings that are tried, as sixteenths of the recording: on the column and its mirror image
/// one after the other, so that no shift makes a jump, and none is nearer than a quarter to the
/// true one. The sixteenth is the column backwards.
const BEGINNINGS: std::ops::RangeInclusive<usize> = 4..=28;

/// Gains of channels by columns that cannot have acted.
pub(super) struct Otherwise {
    /// The largest of all channels together.
    pub(super) most: f64,
    /// States how many times more their sum varies than that of as many independent gains; at least
    /// one.
    pub(super) together: f64,
}

impl Otherwise {
    /// Returns what channels gain, with one lag for all of them, by a column that cannot have
    /// acted.
    ///
    /// # Errors
    /// Stopped.
    pub(super) fn of(channels: &[Coarse], column: &Column<'_>, control: &Control) -> Result<Self, Stopped> {
        let mut all: Vec<Vec<f64>> = Vec::new();
        for beginning in BEGINNINGS {
            control.go_on()?;
            let other = begun_at(&column.means, beginning * column.means.len() / 16);
            let gains = |lag: f64| -> Vec<f64> {
                let curves = column.powers(&lagged(&other, lag), STRAIGHT);
                parallel::map(channels, |c| c.gain(c.with(curves.clone())))
            };
            let (lag, _) = peak(column.lags().map(f64::ln), 8, |l: f64| gains(l.exp()).iter().sum());
            all.push(gains(lag.exp()));
        }
        let sums: Vec<f64> = all.iter().map(|gains| gains.iter().sum()).collect();
        let variance = |values: &[f64]| mean_sd(values).1.powi(2);
        let of_each = (0..channels.len()).map(|c| variance(&all.iter().map(|gains| gains[c]).collect::<Vec<_>>()));
        let apart: f64 = of_each.sum();
        Ok(Self {
            most: sums.iter().copied().fold(0.0, f64::max),
            together: if apart > 0.0 { (variance(&sums) / apart).max(1.0) } else { 1.0 },
        })
    }
}

/// A column and its mirror image in turn, from another value on.
fn begun_at(column: &[f64], first: usize) -> Vec<f64> {
    let count = column.len();
    let at = |n: usize| if n < count { column[n] } else { column[2 * count - 1 - n] };
    (0..count).map(|n| at((first + n) % (2 * count))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rest::channel::{Channel, Curve};
    use crate::rng::{Philox, Stream};

    #[test]
    fn a_column_begun_elsewhere_has_no_jump_and_half_way_it_runs_backwards() {
        let column: Vec<f64> = (0..100).map(f64::from).collect();
        assert_eq!(begun_at(&column, 0), column);
        assert!(begun_at(&column, 100).iter().eq(column.iter().rev()));
        assert!((0..200).all(|first| begun_at(&column, first).windows(2).all(|w| (w[1] - w[0]).abs() <= 1.0)));
    }

    #[test]
    fn gains_of_channels_that_share_their_noise_vary_together_and_others_do_not() {
        const COUNT: usize = 2000;
        let part = |n: usize| n as f64 / COUNT as f64;
        let curve = Curve::new((0..COUNT).map(|n| (19.0 * part(n)).sin() + (43.0 * part(n)).cos()).collect());
        let column = Column::of("t", &curve).expect("not constant");
        let walk = |rng: &mut Philox| -> Vec<f64> {
            let mut sum = 0.0;
            let step = |_| {
                sum += 0.1 * rng.normal();
                sum
            };
            (0..COUNT).map(step).collect()
        };
        let together = |shared: bool, member: u64| {
            let walks: Vec<Vec<f64>> =
                (0..3).map(|i| walk(&mut Philox::new(38, 10 * member + i, Stream::Host))).collect();
            let channel = |i: usize| {
                let mut rng = Philox::new(39, 10 * member + i as u64, Stream::Host);
                let values: Vec<f64> =
                    walks[if shared { 0 } else { i }].iter().map(|w| w + 0.3 * rng.normal()).collect();
                Coarse::of(&Channel::new("x", &values, 1.0))
            };
            let channels: Vec<Coarse> = (0..3).map(channel).collect();
            Otherwise::of(&channels, &column, &Control::silent()).expect("not stopped").together
        };
        for member in 0..4 {
            let (own, common) = (together(false, member), together(true, member));
            assert!(own < 2.0 && common > 2.2, "{member}: {own} of their own, {common} with one walk");
        }
    }
}
