//! The shapes in which a reading may follow an environment column: at once, with a lag, with play or
//! with both; straight or bent.
//!
//! They are offered before any noise is, and next to a walk and flicker whose strengths are free: a
//! column that only looks like the drift gains nothing there. What a column explains in some shape
//! is then left to no law of noise, where it tells more than a smooth course in time does
//! (`in_time`). Searched on means of neighbours, fitted on all values.

use super::channel::Term;
use super::column::{Column, POWERS};
use super::decimated::Coarse;
use super::delayed::{Kind, Search};
use super::followed::Delay;
use super::in_time::{Told, beats_time};
use super::standing::ALPHA;
use crate::control::{Control, Stopped};
use crate::numerics::special::chi_squared_survival;

/// Shapes that differ by more than chance, for the correction of a probability.
const SHAPES: f64 = 16.0;

/// States how a channel follows a column.
#[derive(Debug, Clone)]
pub(super) enum Following {
    /// By this term.
    By(Term),
    /// Not beyond chance.
    Not,
    /// A smooth course in time does as well without it: the column is no witness.
    NoBetterThanTime,
}

/// Returns whether the best of all shapes gains so much by chance; `correction` is for all else
/// that is tried.
pub(super) fn is_chance(gain: f64, numbers: f64, correction: f64) -> bool {
    SHAPES * chi_squared_survival(gain, numbers) * correction >= ALPHA
}

/// The term in which a channel follows a column, where it does beyond chance (`correction` for all
/// that is tried).
///
/// # Errors
/// Stopped.
pub(super) fn find(
    coarse: &Coarse,
    column: &Column<'_>,
    correction: f64,
    control: &Control,
) -> Result<Following, Stopped> {
    let mut best: Option<(Told, Delay, Search<'_>)> = None;
    for powers in POWERS {
        for kind in Kind::ALL {
            control.go_on()?;
            let search = Search { coarse, column, powers };
            let delay = search.best(kind);
            let numbers = powers.len() as f64 + delay.numbers();
            let told = Told::of(coarse, column.powers(&delay.of(&column.means), powers), numbers);
            if best.as_ref().is_none_or(|b| told.minus_bic() > b.0.minus_bic()) {
                best = Some((told, delay, search));
            }
        }
    }
    let Some((told, delay, search)) = best else { return Ok(Following::Not) };
    if is_chance(coarse.gain(told.log_likelihood), told.numbers, correction) {
        return Ok(Following::Not);
    }
    control.go_on()?;
    Ok(match beats_time(coarse, &told) {
        true => Following::By(column.term(search.with_intervals(delay), search.powers)),
        false => Following::NoBetterThanTime,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rest::channel::{Addition, Channel, Curve};
    use crate::rest::followed::{lagged, played};
    use crate::rng::{Philox, Stream};

    const COUNT: usize = 12_000;

    fn day(n: usize) -> f64 {
        let t = n as f64 / COUNT as f64;
        25.0 + 2.0 * (9.0 * t).sin() + (23.0 * t + 1.0).sin()
    }

    fn asked(values: &[f64], column: &[f64]) -> Following {
        let curve = Curve::new(column.to_vec());
        let column = Column::of("t", &curve).expect("not constant");
        let coarse = Coarse::of(&Channel::new("x", values, 1.0));
        find(&coarse, &column, 9.0, &Control::silent()).expect("not stopped")
    }

    fn found(at: impl Fn(&[f64]) -> Vec<f64>, member: u64) -> Option<(Delay, usize)> {
        let mut rng = Philox::new(33, member, Stream::Host);
        let column: Vec<f64> = (0..COUNT).map(day).collect();
        let values: Vec<f64> = at(&column).into_iter().map(|v| v + rng.normal()).collect();
        let Following::By(term) = asked(&values, &column) else { return None };
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
            asked(&values, &column)
        };
        for member in 0..3 {
            let power = following(&|n| 40.0 * part(n).powf(1.5), member);
            assert!(matches!(power, Following::NoBetterThanTime), "{member}: a power of time");
            assert!(matches!(following(&|n| column[n], member), Following::By(_)), "{member}: the column");
            assert!(matches!(following(&|_| 0.0, member), Following::Not), "{member}: noise");
        }
    }
}
