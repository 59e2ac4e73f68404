//! Decides whether an environment column tells more of a channel than a smooth course in time does.
//!
//! A column that is itself smooth can be bent to any smooth drift: it is a witness only where it
//! tells more.

use super::channel::Curve;
use super::course::{EXPONENTS, course, smooth};
use super::decimated::{Coarse, PENALTY};
use super::profile::peak;

/// Time constants of a settling that are tried, as parts of the recording.
const SETTLING: [f64; 2] = [0.01, 2.0];

/// Holds what curves tell of a channel, and what they cost.
#[derive(Debug, Clone)]
pub(super) struct Told {
    pub(super) curves: Vec<Curve>,
    /// Log-likelihood next to them.
    pub(super) log_likelihood: f64,
    /// Free numbers, searched ones included; a part of one where channels share it.
    pub(super) numbers: f64,
}

impl Told {
    pub(super) fn of(coarse: &Coarse, curves: Vec<Curve>, numbers: f64) -> Self {
        Self { log_likelihood: coarse.with(curves.clone()), curves, numbers }
    }

    /// Minus Schwarz's information criterion: larger is better.
    pub(super) fn minus_bic(&self) -> f64 {
        2.0 * self.log_likelihood - PENALTY * self.numbers
    }
}

/// Returns whether what a column tells is more than a smooth course in time does, or is so next to
/// that course: both may act.
pub(super) fn beats_time(coarse: &Coarse, by_column: &Told) -> bool {
    let Some(in_time) = best(coarse) else { return true };
    if by_column.minus_bic() >= in_time.minus_bic() {
        return true;
    }
    let curves = by_column.curves.iter().chain(&in_time.curves).cloned().collect();
    let both = Told::of(coarse, curves, by_column.numbers + in_time.numbers);
    both.minus_bic() >= in_time.minus_bic() + PENALTY
}

/// The smooth course in time of the largest criterion: a power of time, a settling, a kinked line, a
/// polynomial of time or of its logarithm.
fn best(coarse: &Coarse) -> Option<Told> {
    let count = coarse.count();
    let power = |p: f64| vec![course(count, |u| u.powf(p.exp()))];
    let settling = |part: f64| vec![course(count, |u| (-u / part.exp()).exp())];
    let (p, _) = peak(EXPONENTS.map(f64::ln), 12, |p| coarse.with(power(p)));
    let (part, _) = peak(SETTLING.map(f64::ln), 12, |part| coarse.with(settling(part)));
    let all = [(vec![course(count, |u| u)], 1.0), (power(p), 2.0), (settling(part), 2.0)];
    let told = all.into_iter().chain(smooth(count)).map(|(curves, numbers)| Told::of(coarse, curves, numbers));
    told.max_by(|a, b| a.minus_bic().total_cmp(&b.minus_bic()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rest::channel::Channel;
    use crate::rng::{Philox, Stream};

    const COUNT: usize = 4000;

    fn part(n: usize) -> f64 {
        n as f64 / COUNT as f64
    }

    /// A temperature that settles and sways.
    fn day(n: usize) -> f64 {
        2.0 * (-4.0 * part(n)).exp() + (15.0 * part(n)).sin()
    }

    /// Returns whether a column that a channel may follow beats time, where the channel is this and
    /// noise.
    fn beats(at: &dyn Fn(usize) -> f64, column: &dyn Fn(usize) -> f64, member: u64) -> bool {
        let mut rng = Philox::new(36, member, Stream::Host);
        let values: Vec<f64> = (0..COUNT).map(|n| at(n) + rng.normal()).collect();
        let coarse = Coarse::of(&Channel::new("x", &values, 1.0));
        let by_column = Told::of(&coarse, vec![Curve::new((0..COUNT).map(column).collect())], 1.0);
        beats_time(&coarse, &by_column)
    }

    #[test]
    fn a_column_beats_time_where_it_acts_alone_or_beside_a_course_and_not_where_only_time_does() {
        for member in 0..4 {
            assert!(beats(&day, &day, member), "{member}: the column acts");
            assert!(beats(&|n| day(n) + 4.0 * part(n), &day, member), "{member}: so it does beside a ramp");
            assert!(!beats(&|n| 4.0 * part(n), &day, member), "{member}: a ramp alone");
            assert!(!beats(&|n| 4.0 * part(n).sqrt(), &day, member), "{member}: a root of time alone");
            // A column that is a course in time tells no less than that course: it may act.
            assert!(beats(&|n| 4.0 * part(n), &part, member), "{member}: a straight column");
        }
    }
}
