//! Dates with a time of day as time stamps, ISO 8601 and RFC 3339: `2026-11-24T23:25:10.125Z`, with
//! a blank in place of `T`, a comma in place of the point, and an offset from UTC.
//!
//! Not for a date without a time, which is no clock of a recording.

/// The whole seconds since 1970 that a cell states, and the digits behind their point; a time
/// without an offset is taken as UTC. `None` for anything else.
pub(super) fn parse(cell: &[u8]) -> Option<(i64, &[u8])> {
    let text = std::str::from_utf8(cell).ok()?;
    let (day, time) = text.split_once(['T', 't', ' '])?;
    let [year, month, date] = numbers(day, '-', [4, 2, 2])?;
    let (time, offset_s) = with_offset(time)?;
    let (time, digits) = time.split_once(['.', ',']).unwrap_or((time, ""));
    let [hour, minute, second] = numbers(time, ':', [2, 2, 2])?;
    // A leap second is the sixtieth.
    let is_real = (1..=12).contains(&month) && (1..=days_of(year, month)).contains(&date);
    if !is_real || hour > 23 || minute > 59 || second > 60 {
        return None;
    }
    let whole = days_since_1970(year, month, date) * 86_400 + hour * 3600 + minute * 60 + second - offset_s;
    Some((whole, digits.as_bytes()))
}

/// A time and its offset from UTC, s: `Z`, `+02:00`, `-0530`, or none.
fn with_offset(time: &str) -> Option<(&str, i64)> {
    if let Some(time) = time.strip_suffix(['Z', 'z']) {
        return Some((time, 0));
    }
    let Some(at) = time.find(['+', '-']) else { return Some((time, 0)) };
    let (time, offset) = time.split_at(at);
    let digits = offset[1..].replace(':', "");
    let [hours, minutes] = match digits.len() {
        2 => [digits.as_str(), "00"],
        4 => [digits.get(..2)?, digits.get(2..)?],
        _ => return None,
    };
    let size = 3600 * number(hours)? + 60 * number(minutes)?;
    Some((time, if offset.starts_with('-') { -size } else { size }))
}

fn number(digits: &str) -> Option<i64> {
    digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse().ok())?
}

/// Three numbers of so many digits each.
fn numbers(text: &str, between: char, digits: [usize; 3]) -> Option<[i64; 3]> {
    let mut parts = text.split(between);
    let mut next = |count: usize| number(parts.next().filter(|part| part.len() == count)?);
    let all = [next(digits[0])?, next(digits[1])?, next(digits[2])?];
    parts.next().is_none().then_some(all)
}

fn is_leap(year: i64) -> bool {
    year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)
}

fn days_of(year: i64, month: i64) -> i64 {
    match month {
        2 => 28 + i64::from(is_leap(year)),
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// Days of the Gregorian calendar.
fn days_since_1970(year: i64, month: i64, date: i64) -> i64 {
    let leaps = |before: i64| (before - 1) / 4 - (before - 1) / 100 + (before - 1) / 400;
    let months: i64 = (1..month).map(|month| days_of(year, month)).sum();
    365 * (year - 1970) + leaps(year) - leaps(1970) + months + date - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seconds by GNU date: `date -u -d 2026-11-24T23:25:10 +%s`.
    #[test]
    fn dates_are_seconds_since_1970() {
        for (text, seconds) in [
            ("1970-01-01T00:00:00Z", (0, "")),
            ("2026-11-24T23:25:10", (1_795_562_710, "")),
            ("2026-11-24 23:25:10.125Z", (1_795_562_710, "125")),
            ("2026-11-24T23:25:10,5+02:00", (1_795_555_510, "5")),
            ("2026-11-24T23:25:10-0530", (1_795_582_510, "")),
            ("2000-02-29T12:00:00Z", (951_825_600, "")),
            ("1969-12-31T23:59:59.5Z", (-1, "5")),
        ] {
            assert_eq!(parse(text.as_bytes()), Some((seconds.0, seconds.1.as_bytes())), "{text}");
        }
    }

    #[test]
    fn what_is_no_date_with_a_time_is_none() {
        for text in [
            "2026-11-24",
            "2026-13-24T00:00:00",
            "2025-02-29T00:00:00",
            "2026-11-24T24:00:00",
            "2026-11-24T23:25",
            "26-11-24T23:25:10",
            "2026-11-24T23:25:10+2",
            "a b",
            "",
        ] {
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
    }
}
