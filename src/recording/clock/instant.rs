//! A moment on a clock that several files may share, so that their stamps can be laid next to each
//! other.

use super::stamp::Stamp;
use crate::time_unit::TimeUnit;

/// Whole seconds and the rest: a date of our time keeps its nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    whole_s: i64,
    /// Not negative, below one.
    rest_s: f64,
}

/// Stamps that are dates of our time, by their size: from here on, in this unit.
const DATES: [(f64, TimeUnit); 3] =
    [(1e17, TimeUnit::Nanosecond), (1e14, TimeUnit::Microsecond), (1e11, TimeUnit::Millisecond)];

impl Instant {
    /// The zero of every clock.
    pub const ZERO: Self = Self { whole_s: 0, rest_s: 0.0 };

    /// Returns what a stamp in this unit says.
    pub fn new(stamp: Stamp, unit: TimeUnit) -> Self {
        let (whole_s, rest_s) = stamp.seconds(unit);
        Self { whole_s, rest_s }
    }

    /// Time since another instant, s.
    pub fn since(&self, origin: &Self) -> f64 {
        (self.whole_s - origin.whole_s) as f64 + (self.rest_s - origin.rest_s)
    }
}

/// The unit of stamps whose heading does not say it: what makes a date of our time of this one,
/// else seconds.
pub fn unit_by_size(stamp: &Stamp) -> TimeUnit {
    let size = stamp.value().abs();
    DATES.iter().find(|(from, _)| size >= *from).map_or(TimeUnit::Second, |(_, unit)| *unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_in_different_units_meet_on_one_clock() {
        let at = |text: &str, unit| Instant::new(Stamp::parse(text.as_bytes()).expect("a stamp"), unit);
        let nanoseconds = at("1403715523912143104", TimeUnit::Nanosecond);
        let seconds = at("1403715523.912143", TimeUnit::Second);
        assert!((nanoseconds.since(&seconds) - 1.04e-7).abs() < 1e-12);
        assert_eq!(at("-1500", TimeUnit::Millisecond).since(&at("0", TimeUnit::Second)), -1.5);
        assert_eq!(unit_by_size(&Stamp::of_integer(1_403_715_523_912_143_104)), TimeUnit::Nanosecond);
        assert_eq!(unit_by_size(&Stamp::of_integer(1_403_715_523)), TimeUnit::Second);
    }
}
