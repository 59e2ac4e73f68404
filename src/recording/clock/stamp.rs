//! A time stamp as it is printed: whole units and the rest, so that 19 digits keep their precision.

use super::date;
use crate::decimal;
use crate::format::{self, Cell};
use crate::time_unit::TimeUnit;

/// A time stamp in the file's unit, exact to 1e-16 of a unit whatever its size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stamp {
    whole: i64,
    /// Not negative, below one.
    fraction: f64,
    /// Digits behind the point.
    decimals: u8,
}

/// Beyond, whole numbers of 64 bits end.
const LARGEST: f64 = 9e18;

impl Stamp {
    /// Stands for a row without a stamp.
    pub const MISSING: Self = Self { whole: 0, fraction: f64::NAN, decimals: u8::MAX };

    /// Reads a cell: `None` for text, NaN in the fraction for a missing stamp. The decimal sign may
    /// be a comma.
    pub fn parse(cell: &[u8]) -> Option<Self> {
        let cell = cell.trim_ascii();
        plain(cell).or_else(|| date::parse(cell).and_then(|(whole, digits)| Self::of_parts(whole, digits))).or_else(
            || {
                let value = match format::cell(cell) {
                    Cell::Number(value) | Cell::DecimalComma(value) => value,
                    _ => return None,
                };
                (value.is_nan() || value.abs() < LARGEST).then(|| Self::of_float(value))
            },
        )
    }

    /// The stamp that bytes begin with, and its length, where it is digits with at most one point;
    /// `None` for anything else.
    #[inline]
    pub fn leading(bytes: &[u8]) -> Option<(Self, usize)> {
        let (whole, rest, decimals, length) = decimal::leading_parts(bytes)?;
        let fraction = rest as f64 / decimal::ten(decimals);
        let stamp = Self { whole: whole as i64, fraction, decimals: decimals as u8 };
        (fraction < 1.0).then_some((stamp, length))
    }

    /// Stamp of whole units and the digits behind the point.
    fn of_parts(whole: i64, digits: &[u8]) -> Option<Self> {
        if digits.is_empty() {
            return Some(Self::of_integer(whole));
        }
        let text = [&b"0."[..], digits].concat();
        let fraction = plain(&text)?;
        Some(Self { whole: whole.checked_add(fraction.whole)?, ..fraction })
    }

    /// Stamp of a whole number.
    pub fn of_integer(whole: i64) -> Self {
        Self { whole, fraction: 0.0, decimals: 0 }
    }

    /// A double, which is missing where it is no number or too large.
    pub fn of_float(value: f64) -> Self {
        let whole = value.floor();
        // A float this large has no digits to lose; NaN is not below it.
        if whole.abs() < LARGEST {
            Self { whole: whole as i64, fraction: value - whole, decimals: u8::MAX }
        } else {
            Self::MISSING
        }
    }

    /// Returns whether there is a number.
    pub fn is_missing(&self) -> bool {
        self.fraction.is_nan()
    }

    /// Time since another stamp, in the file's unit.
    #[inline]
    pub fn since(&self, origin: &Self) -> f64 {
        let whole = match self.whole.checked_sub(origin.whole) {
            Some(whole) => whole as f64,
            None => (i128::from(self.whole) - i128::from(origin.whole)) as f64,
        };
        whole + (self.fraction - origin.fraction)
    }

    /// Whole seconds, and the rest below one, of a stamp in this unit.
    pub fn seconds(&self, unit: TimeUnit) -> (i64, f64) {
        let each = (1.0 / unit.seconds()).round() as i64;
        (self.whole.div_euclid(each), (self.whole.rem_euclid(each) as f64 + self.fraction) / each as f64)
    }

    /// Nearest double-precision number.
    pub fn value(&self) -> f64 {
        self.whole as f64 + self.fraction
    }

    /// The step of its last digit, in the file's unit; none where it is not printed plainly.
    pub fn last_digit(&self) -> Option<f64> {
        (self.decimals <= 18).then(|| 0.1f64.powi(i32::from(self.decimals)))
    }
}

/// Digits with at most one point and a sign.
fn plain(cell: &[u8]) -> Option<Stamp> {
    let (negative, digits) = match cell {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, cell),
    };
    let point = digits.iter().position(|b| *b == b'.' || *b == b',');
    let (front, back) = match point {
        Some(place) => (&digits[..place], &digits[place + 1..]),
        None => (digits, &digits[..0]),
    };
    if (front.is_empty() && back.is_empty()) || front.len() > 18 + 1 || back.len() > 18 {
        return None;
    }
    let number = |digits: &[u8]| {
        digits.iter().try_fold(0i64, |sum, digit| {
            let digit = digit.is_ascii_digit().then(|| i64::from(digit - b'0'))?;
            sum.checked_mul(10)?.checked_add(digit)
        })
    };
    let (whole, rest) = (number(front)?, number(back)?);
    let decimals = back.len() as u8;
    let fraction = rest as f64 / 10f64.powi(i32::from(decimals));
    // 18 nines round up to one.
    let (whole, fraction) = if fraction < 1.0 { (whole, fraction) } else { (whole.checked_add(1)?, 0.0) };
    let (whole, fraction) = match (negative, fraction > 0.0) {
        (false, _) => (whole, fraction),
        (true, false) => (-whole, 0.0),
        (true, true) => (-whole - 1, 1.0 - fraction),
    };
    Some(Stamp { whole, fraction, decimals })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamp(text: &str) -> Stamp {
        Stamp::parse(text.as_bytes()).unwrap_or_else(|| unreachable!("{text}"))
    }

    #[test]
    fn nineteen_digits_keep_their_last_one() {
        let (first, next) = (stamp("1403715523912143104"), stamp("1403715523912143105"));
        assert_eq!((next.since(&first), first.value() == next.value()), (1.0, true), "a double cannot tell them apart");
        assert!((stamp("1403715523.917143040").since(&stamp("1403715523.912143104")) - 0.004_999_936).abs() < 1e-15);
        assert_eq!(stamp("9223372036854775807").since(&stamp("-9223372036854775807")), 2f64.powi(64));
    }

    #[test]
    fn a_leading_stamp_is_the_one_that_is_parsed() {
        let texts = ["0.005000", "24999.995000", "7", "7.", ".25", "1403715523.912143104", "99999999999999999"];
        for text in texts {
            let behind = format!("{text},1234567.25,8");
            let (found, length) = Stamp::leading(behind.as_bytes()).unwrap_or_else(|| unreachable!("{text}"));
            assert_eq!((found, length), (stamp(text), text.len()), "{text}");
            assert_ne!(found, stamp(&format!("{text}1")), "another stamp is told from it");
        }
        for text in ["-1.5", "1403715523912143104", "0.999999999999999999", "", "noon"] {
            assert_eq!(Stamp::leading(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn stamps_are_read_as_they_are_written() {
        for (text, value) in
            [("-0.25", -0.25), (" 12 ", 12.0), ("+3.5", 3.5), (".5", 0.5), ("7.", 7.0), ("1.5e-3", 0.0015)]
        {
            assert_eq!(stamp(text).value(), value, "{text}");
        }
        assert!(["", "nan", "NULL"].iter().all(|t| stamp(t).is_missing()));
        let (date, plain) = (stamp("2026-11-24T23:25:10.125Z"), stamp("1795562710.125"));
        assert_eq!((date.since(&plain), date.last_digit()), (0.0, plain.last_digit()));
        assert!(Stamp::parse(b"2026-11-24T23:25:10.x").is_none());
        assert!(["noon", "12:30", ".", "1e300", "--1"].iter().all(|t| Stamp::parse(t.as_bytes()).is_none()));
        assert_eq!((stamp("0.010").last_digit(), stamp("1e-2").last_digit()), (Some(0.1f64.powi(3)), None));
    }
}
