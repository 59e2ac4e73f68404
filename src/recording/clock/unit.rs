//! Which unit a time column is in: by its heading, by the rate that was given, or by the size of
//! its numbers.

use crate::time_unit::{Basis, TimeUnit, UNITS};

/// Seconds since 1970 in the years 2000 to 2100.
const EPOCH_S: std::ops::Range<f64> = 946_684_800.0..4_102_444_800.0;
/// A clock that counts from 1970 ticks at a rate in this range, Hz.
const PLAUSIBLE_HZ: std::ops::RangeInclusive<f64> = 1e-3..=1e6;
/// Sensors are read at a rate in this range, Hz.
const USUAL_HZ: std::ops::RangeInclusive<f64> = 1.0..=50_000.0;
/// Below this rate in s, Hz, seconds are worth a word where nothing names them.
const SLOW_HZ: f64 = 10.0;

/// Holds what is known of a clock before its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Holds what its heading names.
    pub heading: Option<TimeUnit>,
    /// First stamp, in the clock's unit.
    pub origin: f64,
    /// The usual step from sample to sample, in the file's unit.
    pub step: f64,
    /// The rate that the user gave, Hz.
    pub rate_hz: Option<f64>,
}

/// The unit and how it is known; `Err` holds the two units between which the numbers cannot decide.
pub fn decide(evidence: &Evidence) -> Result<(TimeUnit, Basis), [TimeUnit; 2]> {
    if let Some(unit) = evidence.heading {
        return Ok((unit, Basis::Heading));
    }
    let rate_in = |unit: TimeUnit| 1.0 / (evidence.step * unit.seconds());
    if let Some(rate_hz) = evidence.rate_hz {
        // Where none agrees, seconds are what the message speaks of.
        let agrees = |unit: &TimeUnit| (rate_in(*unit) / rate_hz - 1.0).abs() < 0.05;
        let unit = UNITS.into_iter().find(agrees).unwrap_or(TimeUnit::Second);
        return Ok((unit, if unit == TimeUnit::Second { Basis::Default } else { Basis::Rate }));
    }
    let dated = |unit: &TimeUnit| {
        EPOCH_S.contains(&(evidence.origin * unit.seconds())) && PLAUSIBLE_HZ.contains(&rate_in(*unit))
    };
    if let Some(unit) = UNITS.into_iter().find(dated) {
        return Ok((unit, if unit == TimeUnit::Second { Basis::Default } else { Basis::Epoch }));
    }
    if rate_in(TimeUnit::Second) >= *USUAL_HZ.start() {
        return Ok((
            TimeUnit::Second,
            if rate_in(TimeUnit::Second) < SLOW_HZ { Basis::Magnitude } else { Basis::Default },
        ));
    }
    // Slower than once a second: more likely a smaller unit. How far from 100 Hz, in decades.
    let off = |unit: TimeUnit| (rate_in(unit).log10() - 2.0).abs();
    let mut usual: Vec<TimeUnit> = UNITS.into_iter().filter(|u| USUAL_HZ.contains(&rate_in(*u))).collect();
    usual.sort_by(|a, b| off(*a).total_cmp(&off(*b)));
    match usual[..] {
        [] if PLAUSIBLE_HZ.contains(&rate_in(TimeUnit::Second)) => Ok((TimeUnit::Second, Basis::Magnitude)),
        [] => Err([TimeUnit::Second, TimeUnit::Nanosecond]),
        [near, next, ..] if off(next) - off(near) < 0.9 => Err([near, next]),
        [near, ..] => Ok((near, Basis::Magnitude)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_decide_where_the_heading_does_not() {
        let plain = Evidence { heading: None, origin: 0.0, step: 0.005, rate_hz: None };
        let decided = |evidence: Evidence| decide(&evidence).map(|(unit, _)| unit);
        assert_eq!(decide(&plain), Ok((TimeUnit::Second, Basis::Default)));
        // 200 Hz in each unit, counted from 1970 and from the start.
        for (unit, scale) in UNITS.into_iter().zip([1.0, 1e3, 1e6, 1e9]) {
            for origin in [1.4e9, 0.0] {
                let evidence = Evidence { origin: origin * scale, step: 0.005 * scale, ..plain };
                assert_eq!(decided(evidence), Ok(unit), "{evidence:?}");
            }
        }
        // 1.4 s after the start, in ns: no date, though its number would be one in s.
        assert_eq!(decided(Evidence { origin: 1.4e9, step: 5e6, ..plain }), Ok(TimeUnit::Nanosecond));
        // A rate decides, and so does a heading against all odds.
        let rate = Evidence { step: 1000.0, rate_hz: Some(1.0), ..plain };
        assert_eq!(decide(&rate), Ok((TimeUnit::Millisecond, Basis::Rate)));
        assert_eq!(decided(Evidence { heading: Some(TimeUnit::Second), ..rate }), Ok(TimeUnit::Second));
        // 2 Hz in ms or 2 kHz in µs: nobody knows.
        assert!(decide(&Evidence { step: 500.0, ..plain }).is_err());
    }
}
