//! States what kind of text file this is: its separator, whether it has a header, and what it is
//! when it is no table at all.

use std::path::Path;

use super::cells::Cells;
use super::decimal;
use super::roles;
use super::time_unit::TimeUnit;
use crate::error::{Error, Result};

/// States how cells are separated and whether the first row names them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Format {
    pub separator: u8,
    /// Bytes of a byte-order mark to skip.
    pub skip: usize,
}

/// Judges a file by its first bytes.
///
/// # Errors
/// Empty files, UTF-16 and binary content, each by its own sentence.
pub(super) fn sniff(path: &Path, head: &[u8]) -> Result<Format> {
    let fail = |cause: &str, hint: &str| Err(Error::new(format!("could not read {}", path.display()), cause, hint));
    match head {
        [] => return fail("the file is empty", "was the recording stopped before it was written?"),
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => return fail("this is UTF-32 text", "save it as UTF-8 CSV"),
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => return fail("this is UTF-16 text", "save it as UTF-8 CSV"),
        _ => {}
    }
    for (name, width) in [("UTF-32", 4), ("UTF-16", 2)] {
        if is_wide_text(head, width) {
            return fail(&format!("this is {name} text without a byte-order mark"), "save it as UTF-8 CSV");
        }
    }
    if head.contains(&0) {
        return fail(
            "this is binary data of an unknown format",
            "supported are text (CSV), Touchstone, .npy, .npz, .mat, Parquet, Arrow, ROS 1 bags, MCAP, .db3, ULog and DataFlash; \
            is it one of these, and is the beginning of the file intact?",
        );
    }
    let skip = if head.starts_with(&[0xef, 0xbb, 0xbf]) { 3 } else { 0 };
    let mut lines = head[skip..]
        .split(|b| *b == b'\n' || *b == b'\r')
        .filter(|l| !l.trim_ascii().is_empty() && !l.trim_ascii_start().starts_with(b"#"));
    let Some(first) = lines.next() else {
        return fail("the file holds no row", "a recording is a header and one row per sample");
    };
    // The second line may hold units.
    let second = lines.next();
    Ok(Format { separator: separator(first, lines.next().or(second).unwrap_or(first)), skip })
}

/// Returns whether these are characters of Latin-1, each in so many bytes of which all but its
/// first or its last are zero.
fn is_wide_text(head: &[u8], width: usize) -> bool {
    let is_letter = |b: u8| matches!(b, b' '..=b'~' | 0xa0.. | b'\t' | b'\n' | b'\r');
    [0, width - 1].into_iter().any(|place| {
        let mut characters = head.chunks_exact(width).peekable();
        characters.peek().is_some()
            && characters.all(|c| c.iter().enumerate().all(|(i, b)| if i == place { is_letter(*b) } else { *b == 0 }))
    })
}

/// Returns what stands between the cells: judged by the first line, and by a later one where a
/// comma may be a decimal sign.
fn separator(first: &[u8], later: &[u8]) -> u8 {
    let count = |line: &[u8], separator: u8| line.iter().filter(|b| **b == separator).count();
    let mut cells = Cells::default();
    let mut numbers = |line: &[u8], separator: u8| {
        cells.cut(line, separator);
        let number =
            |i: usize| matches!(cell(cells.of(line, i)), Cell::Number(_) | Cell::TooLarge | Cell::DecimalComma(_));
        if (0..cells.len()).all(number) { cells.len() } else { 0 }
    };
    let stronger = [b';', b'\t'].into_iter().find(|s| count(first, *s) > 0 && numbers(later, *s) > 1);
    if let Some(separator) = stronger {
        return separator;
    }
    let strongest = [b',', b';', b'\t'].into_iter().any(|s| count(first, s) > 0);
    let blanks = numbers(later, b' ');
    if blanks > 1 && (!strongest || count(later, b',') > 0 && numbers(first, b' ') == blanks) {
        return b' ';
    }
    // On a tie the first wins: a comma.
    [b',', b';', b'\t'].into_iter().rev().max_by_key(|s| count(first, *s)).unwrap_or(b',')
}

/// No reading in any unit is larger: the powers of it that a fit takes must stay finite.
const LARGEST: f64 = 1e50;
/// Anything smaller is zero, for the same reason.
const SMALLEST: f64 = 1e-50;

/// Holds what a cell holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell {
    /// A number; NaN where it is missing: empty, infinite, or one of the usual words for that.
    Number(f64),
    /// A number larger than any reading.
    TooLarge,
    /// A number with a comma for its point, as one with a point.
    DecimalComma(f64),
    /// Neither a number nor empty.
    Text,
}

/// A number as a reading: what is smaller than any is zero, what is infinite is missing.
#[inline]
pub fn reading(value: f64) -> Cell {
    match value.abs() {
        size if size <= LARGEST => Cell::Number(if size < SMALLEST { 0.0 } else { value }),
        size if size.is_finite() => Cell::TooLarge,
        _ => Cell::Number(f64::NAN),
    }
}

#[inline]
fn plain(cell: &[u8]) -> Option<f64> {
    decimal::leading_number(cell).filter(|(_, length)| *length == cell.len()).map(|(value, _)| value)
}

/// Returns whether [`reading`] leaves a number as it is, or it is missing.
#[inline]
pub(super) fn is_reading(value: f64) -> bool {
    let size = value.abs();
    (SMALLEST..=LARGEST).contains(&size) || value.to_bits() == 0 || value.is_nan()
}

/// Reads a cell.
#[inline]
pub fn cell(cell: &[u8]) -> Cell {
    match plain(cell) {
        Some(value) => reading(value),
        None => any(cell),
    }
}

/// Reads a cell that is no plain number.
fn any(cell: &[u8]) -> Cell {
    let Ok(text) = std::str::from_utf8(cell.trim_ascii()) else { return Cell::Text };
    if let Ok(value) = text.parse::<f64>() {
        return reading(value);
    }
    // Blanks beyond ASCII are too rare to be looked for in every cell.
    let trimmed = text.trim();
    if trimmed.len() < text.len() {
        return self::cell(trimmed.as_bytes());
    }
    let missing = ["", "na", "n/a", "null", "none", "-", "#n/a"];
    if missing.contains(&text.to_ascii_lowercase().as_str()) {
        return Cell::Number(f64::NAN);
    }
    if let Some(value) = fortran(text).or_else(|| grouped(text, '.')) {
        return reading(value);
    }
    let comma = if text.contains(',') { text.replacen(',', ".", 1).parse::<f64>().ok() } else { None };
    match comma.or_else(|| grouped(text, ',')).map(reading) {
        Some(Cell::Number(value)) => Cell::DecimalComma(value),
        Some(other) => other,
        None => Cell::Text,
    }
}

/// A number with Fortran's exponent of double precision: `1.5D-03`.
fn fortran(text: &str) -> Option<f64> {
    let at = text.find(['d', 'D']).filter(|at| text[..*at].ends_with(|c: char| c.is_ascii_digit() || c == '.'))?;
    format!("{}e{}", &text[..at], &text[at + 1..]).parse().ok()
}

/// A number whose thousands are apart and whose decimals stand behind `sign`: `1.234,50` and
/// `1 234,5` where that is a comma, `1,234.50` where it is a point. `1.234` alone could be either,
/// and is none here.
fn grouped(text: &str, sign: char) -> Option<f64> {
    let (whole, decimals) = text.split_once(sign)?;
    let digits = whole.trim_start_matches(['-', '+']);
    let separator = digits.chars().find(|c| !c.is_ascii_digit())?;
    if separator == sign || !".,' \u{2019}\u{a0}\u{202f}\u{2009}".contains(separator) || whole.len() - digits.len() > 1
    {
        return None;
    }
    let groups: Vec<&str> = digits.split(separator).collect();
    let is_digits = |group: &str| group.bytes().all(|b| b.is_ascii_digit());
    let all_of_three = groups[1..].iter().all(|group| group.len() == 3 && is_digits(group));
    let leads = (1..=3).contains(&groups[0].len()) && is_digits(groups[0]);
    if !all_of_three || !leads || decimals.is_empty() || !is_digits(decimals) {
        return None;
    }
    format!("{}{}.{decimals}", if whole.starts_with('-') { "-" } else { "" }, groups.concat()).parse().ok()
}

/// A cell as a number; `None` when it is text, or beyond any reading; NaN where it is missing.
pub fn number(text: &[u8]) -> Option<f64> {
    if let Cell::Number(value) = cell(text) { Some(value) } else { None }
}

/// Returns whether a number was a whole one that double precision had to round.
pub(super) fn was_rounded(cell: &[u8], value: f64) -> bool {
    // Sixteen digits are the fewest of which that is true.
    cell.len() > 15
        && value.abs() >= 2f64.powi(53)
        && std::str::from_utf8(cell).is_ok_and(|t| t.trim().parse::<i128>().is_ok_and(|exact| exact != value as i128))
}

/// Returns whether a heading names a clock, so that it is no channel.
pub(super) fn names_a_clock(heading: &str) -> bool {
    if roles::has_unit_of_surroundings(heading) {
        return false;
    }
    let heading = heading.to_ascii_lowercase();
    let stem = heading.split(['_', ' ', '(', '[', '/', '.']).next().unwrap_or_default();
    let stem = stem.trim_start_matches(['#', '%']);
    matches!(
        stem,
        "t" | "time"
            | "timestamp"
            | "zeit"
            | "stamp"
            | "epoch"
            | "timeus"
            | "timems"
            | "sampletimefine"
            | "date"
            | "datetime"
            | "seq"
            | "index"
            | "sample"
            | "row"
    )
}

/// Returns whether a heading is the clock of an instrument: a unit of time and nothing else, as
/// `Second`, or LabVIEW's `X_Value`.
pub(super) fn is_clock_of_instruments(heading: &str) -> bool {
    let is_unit = heading.chars().all(char::is_alphabetic) && TimeUnit::of_heading(heading).is_some();
    is_unit || heading.eq_ignore_ascii_case("x_value")
}

/// Returns whether a heading that names a clock counts rows instead, or writes dates.
pub(super) fn counts_rows(heading: &str) -> bool {
    let heading = heading.to_ascii_lowercase();
    let stem = heading.split(['_', ' ', '(', '[', '/', '.']).next().unwrap_or_default();
    matches!(stem, "date" | "datetime" | "seq" | "index" | "sample" | "row")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_marks_and_strangers_are_told_apart() {
        let sniff = |text: &[u8]| sniff(Path::new("log.csv"), text);
        assert_eq!(sniff(b"a,b\n1,2\n").expect("comma").separator, b',');
        assert_eq!(sniff(b"\xef\xbb\xbfa;b\r\n1;2\r\n").expect("semicolon"), Format { separator: b';', skip: 3 });
        assert_eq!(sniff(b"# made by x, y\na\tb\n").expect("tab").separator, b'\t');
        assert_eq!(sniff(b"t;a\n0,0;1,5\n0,1;2,5\n").expect("decimal comma").separator, b';');
        assert_eq!(sniff(b"0,0;1,5\n0,1;2,5\n").expect("no header").separator, b';');
        assert_eq!(sniff(b"# t x\n0.0 1.5\n 0.1  2.5\n").expect("blanks").separator, b' ');
        assert_eq!(sniff(b"0,0 1,5\n0,1  2,5\n").expect("decimal comma and blanks").separator, b' ');
        assert_eq!(sniff(b"one two\n1.5\n2.5\n").expect("one column").separator, b',');
        assert_eq!(sniff(b"a, b\n1, 2\n2, 3\n").expect("comma and blank").separator, b',');
        let wide = |width: usize, place: usize| {
            let character = |b: u8| (0..width).map(move |i| if i == place { b } else { 0 });
            b"a,b\n1,2\n".iter().flat_map(|b| character(*b)).collect::<Vec<u8>>()
        };
        let cause = |text: &[u8]| sniff(text).expect_err("no table").cause;
        for (width, place, words) in [(2, 0, "UTF-16"), (2, 1, "UTF-16"), (4, 0, "UTF-32"), (4, 3, "UTF-32")] {
            assert!(cause(&wide(width, place)).contains(words), "{words}");
        }
        assert!(cause(&[&[0xff, 0xfe, 0, 0], &wide(4, 0)[..]].concat()).contains("UTF-32"));
        assert!(cause(b"a\0b\0\x01\0").contains("binary"));
        for stranger in [&b""[..], b"\xff\xfea\0", b"a\0b", b"\n\n"] {
            assert!(sniff(stranger).is_err(), "{stranger:?}");
        }
    }

    #[test]
    fn cells_are_numbers_missing_or_text() {
        assert_eq!(number(b" 1.5e-3 "), Some(1.5e-3));
        assert!(number(b"").is_some_and(f64::is_nan) && number(b"NaN").is_some_and(f64::is_nan));
        assert!(number(b"inf").is_some_and(f64::is_nan), "an infinite reading is a missing one");
        assert_eq!((number(b"1,5"), number(b"1e300"), number(b"1e-300")), (None, None, Some(0.0)));
        assert_eq!(number(b"\xff"), None);
        assert_eq!(
            (number(b"1.5D-03"), number(b"-2d2"), number(b"2D"), number(b"d2")),
            (Some(1.5e-3), Some(-200.0), None, None)
        );
        for (text, value) in [("1.234,50", 1234.5), ("-1 234,5", -1234.5), ("1.234.567,0", 1_234_567.0)] {
            assert_eq!(cell(text.as_bytes()), Cell::DecimalComma(value), "{text}");
        }
        assert_eq!(
            [cell(b"1,234.50"), cell("12\u{a0}345.5".as_bytes())],
            [Cell::Number(1234.5), Cell::Number(12_345.5)]
        );
        for text in
            ["1.23,5", "1.2345,6", "1.234,5,6", "1 234", "1.234.567", "0x1F", "12.34.567,8", "1..234,5", "--1.234,5"]
        {
            assert_eq!(cell(text.as_bytes()), Cell::Text, "{text}");
        }
        assert_eq!(
            [cell(b"1e300"), cell(b"1,5"), cell(b"1,5,2")],
            [Cell::TooLarge, Cell::DecimalComma(1.5), Cell::Text]
        );
        let rounded = |text: &[u8]| was_rounded(text, number(text).unwrap_or_default());
        assert!(rounded(b"9007199254740993") && !rounded(b"9007199254740992") && !rounded(b"1e300"));
    }

    /// The standard library rounds correctly.
    #[test]
    fn plain_numbers_are_rounded_as_the_library_rounds_them() {
        let mut state = 1u64;
        for _ in 0..100_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let digits = format!("{}", state >> (state % 50));
            let at = (state >> 20) as usize % (digits.len() + 1);
            let text = format!("{}{}.{}", if state.is_multiple_of(3) { "-" } else { "" }, &digits[..at], &digits[at..]);
            let library = text.parse::<f64>().expect("a number");
            assert!(plain(text.as_bytes()).is_none_or(|v| v.to_bits() == library.to_bits()), "{text}");
        }
        assert_eq!(
            [plain(b"1.5"), plain(b"."), plain(b"-"), plain(b""), plain(b"1.2.3")],
            [Some(1.5), None, None, None, None]
        );
        assert_eq!([plain(b"5."), plain(b".5"), plain(b"9007199254740993")], [Some(5.0), Some(0.5), None]);
    }

    #[test]
    fn clocks_are_recognised_by_name() {
        assert!(["t", "t_s", "Time [s]", "timestamp", "Zeit [s]"].into_iter().all(names_a_clock));
        assert!(!["temp", "ax", "tilt", "temperature_c", "T [°C]", "T_C", "T (K)"].into_iter().any(names_a_clock));
        assert!(["Second", "s", "ms", "X_Value"].into_iter().all(is_clock_of_instruments));
        assert!(!is_clock_of_instruments("x_s"));
    }
}
