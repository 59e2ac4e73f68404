//! Rows as nearly all are: every line as many cells as the headings, every cell wanted a number. A whole piece of them is
//! parsed at once, several pieces at a time.
//!
//! Not for anything else: a piece with a comment, a blank line, a quotation mark or a cell that is no number is left to
//! `text`, line by line, which says what is wrong with it.

use std::ops::Range;

use super::clock::stamp::Stamp;
use super::format::{self, Cell};
use super::reader::Choice;

/// What is known of the rows beforehand.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Between cells; not a blank.
    pub separator: u8,
    /// Cells of a row.
    pub width: usize,
    /// Which of them are wanted.
    pub choice: Choice,
}

/// Rows of a piece.
#[derive(Debug, Clone, Default)]
pub struct Regular {
    /// Where each line lies, without its end.
    pub lines: Vec<Range<u32>>,
    /// Its time stamp, where a clock is chosen.
    pub stamps: Vec<Stamp>,
    /// Where that lies in the line.
    pub times: Vec<Range<u32>>,
    /// Row by row the columns chosen.
    pub values: Vec<f64>,
    /// Row and column of whole numbers that were rounded.
    pub rounded: Vec<(usize, usize)>,
}

impl Layout {
    /// The rows, where all lines are regular ones.
    pub fn regular(&self, bytes: &[u8]) -> Option<Regular> {
        if memchr::memchr(b'"', bytes).is_some() || u32::try_from(bytes.len()).is_err() {
            return None;
        }
        let columns = self.choice.places.len();
        let last = self.choice.places.iter().chain(&self.choice.time).copied().max()?;
        // What becomes of each cell up to the last one that is wanted.
        let mut wanted: Vec<Wanted> = vec![Wanted::Nothing; last + 1];
        for (column, place) in self.choice.places.iter().enumerate() {
            match wanted[*place] {
                Wanted::Nothing => wanted[*place] = Wanted::Value(column),
                // One cell asked for twice is too rare to be fast.
                _ => return None,
            }
        }
        if let Some(place) = self.choice.time {
            match wanted[place] {
                Wanted::Nothing => wanted[place] = Wanted::Stamp,
                _ => return None,
            }
        }
        let mut rows = Regular::default();
        let guess = bytes.len() / bytes.iter().position(|b| *b == b'\n').map_or(bytes.len(), |n| n + 1).max(1) + 1;
        rows.lines.reserve(guess);
        rows.values.reserve(guess * columns);
        let returns = memchr::memchr(b'\r', bytes).is_some();
        let mut start = 0;
        while start < bytes.len() {
            let end = memchr::memchr(b'\n', &bytes[start..]).map_or(bytes.len(), |n| start + n);
            let mut line = &bytes[start..end];
            if returns {
                line = line.strip_suffix(b"\r").unwrap_or(line);
                if memchr::memchr(b'\r', line).is_some() {
                    return None;
                }
            }
            self.row(line, &wanted, &mut rows)?;
            rows.lines.push(start as u32..(start + line.len()) as u32);
            start = end + 1;
        }
        Some(rows)
    }

    #[inline]
    fn row(&self, line: &[u8], wanted: &[Wanted], rows: &mut Regular) -> Option<()> {
        let (columns, row) = (self.choice.places.len(), rows.lines.len());
        let blank = |b: &u8| b.is_ascii_whitespace() && line.trim_ascii().is_empty();
        if line.first().is_none_or(|b| *b == b'#' || blank(b)) {
            return None;
        }
        let first = rows.values.len();
        rows.values.resize(first + columns, 0.0);
        let mut at = 0;
        for (place, wanted) in wanted.iter().enumerate() {
            if place > 0 {
                if line.get(at) != Some(&self.separator) {
                    return None;
                }
                at += 1;
            }
            while line.get(at) == Some(&b' ') {
                at += 1;
            }
            let from = at;
            match wanted {
                Wanted::Value(column) => {
                    let (value, end) = match format::leading_number(&line[from..]) {
                        Some((value, length)) if self.ends(line, from + length) => (value, from + length),
                        _ => {
                            let end = self.end(line, from);
                            let cell = &line[from..end];
                            let value = match format::cell(cell) {
                                Cell::Number(value) => value,
                                Cell::DecimalComma(value) if self.separator != b',' => value,
                                _ => return None,
                            };
                            if format::was_rounded(cell, value) {
                                rows.rounded.push((row, *column));
                            }
                            (value, end)
                        }
                    };
                    rows.values[first + column] = value;
                    at = end;
                }
                Wanted::Stamp => {
                    at = self.end(line, from);
                    rows.stamps.push(Stamp::parse(&line[from..at])?);
                    rows.times.push(from as u32..at as u32);
                }
                Wanted::Nothing => at = self.end(line, from),
            }
        }
        let behind = memchr::memchr_iter(self.separator, &line[at..]).count();
        (wanted.len() + behind == self.width).then_some(())
    }

    #[inline]
    fn ends(&self, line: &[u8], at: usize) -> bool {
        line.get(at).is_none_or(|b| *b == self.separator)
    }

    #[inline]
    fn end(&self, line: &[u8], from: usize) -> usize {
        memchr::memchr(self.separator, &line[from..]).map_or(line.len(), |n| from + n)
    }
}

#[derive(Debug, Clone, Copy)]
enum Wanted {
    Nothing,
    Stamp,
    Value(usize),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(width: usize, time: Option<usize>, places: &[usize]) -> Layout {
        Layout { separator: b',', width, choice: Choice { time, places: places.into() } }
    }

    #[test]
    fn regular_rows_are_read_cell_by_cell() {
        let text = b"0.5,1.25,x,-3\r\n1.5,1e-3,y,\n2.5, 7 ,,123456789.125";
        let rows = layout(4, Some(0), &[3, 1]).regular(text).expect("regular");
        assert_eq!(rows.stamps.iter().map(Stamp::value).collect::<Vec<_>>(), [0.5, 1.5, 2.5]);
        assert_eq!(rows.values[..2], [-3.0, 1.25]);
        assert!(rows.values[2].is_nan(), "an empty cell is a missing reading");
        assert_eq!((rows.values[3], &rows.values[4..]), (1e-3, &[123_456_789.125, 7.0][..]));
        let line = |row: usize| &text[rows.lines[row].start as usize..rows.lines[row].end as usize];
        assert_eq!((line(0), line(2)), (&b"0.5,1.25,x,-3"[..], &b"2.5, 7 ,,123456789.125"[..]));
    }

    #[test]
    fn anything_else_is_left_to_others() {
        let plain = layout(2, None, &[1]);
        assert!(plain.regular(b"1,2\n3,4\n").is_some());
        for other in
            [&b"1,2\n#\n"[..], b"1,2\n\n", b"1,\"2\"\n", b"1,2,3\n", b"1\n", b"1,x\n", b"1,2\r3,4\n", b" \n1,2\n"]
        {
            assert!(plain.regular(other).is_none(), "{}", String::from_utf8_lossy(other));
        }
        assert_eq!(plain.regular(b"1,9007199254740993\n").expect("regular").rounded, [(0, 0)]);
    }
}
