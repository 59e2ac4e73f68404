//! Rows as nearly all are: every line as many cells as the headings, every cell wanted a number. A
//! whole piece of them is parsed at once, several pieces at a time.
//!
//! Not for anything else: a piece with a comment, a blank line, a quotation mark or a cell that is
//! no number is left to `text`, line by line, which says what is wrong with it.

use std::ops::Range;

use super::clock::stamp::Stamp;
use super::decimal;
use super::format::{self, Cell};
use super::reader::Choice;

/// Holds what is known of the rows beforehand.
#[derive(Debug, Clone)]
pub struct Layout {
    separator: u8,
    /// Cells of a row.
    width: usize,
    /// Holds what becomes of each cell up to the last one that is wanted.
    wanted: Vec<Wanted>,
    columns: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Wanted {
    Nothing,
    Stamp,
    Value(usize),
}

/// Rows of a piece.
#[derive(Debug, Clone, Default)]
pub struct Regular {
    /// States where each line lies, without its end.
    pub lines: Vec<Range<u32>>,
    /// Its time stamp, where a clock is chosen.
    pub stamps: Vec<Stamp>,
    /// States where that lies in the line.
    pub times: Vec<Range<u32>>,
    /// States whether it repeats the line before in every cell but its time stamp; not told of the
    /// first one, nor without a clock.
    pub alike: Vec<bool>,
    /// Per column chosen, its numbers.
    pub columns: Vec<Vec<f64>>,
    /// Row and column of whole numbers that were rounded.
    pub rounded: Vec<(usize, usize)>,
}

impl Regular {
    fn clear(&mut self, columns: usize) {
        self.lines.clear();
        self.stamps.clear();
        self.times.clear();
        self.alike.clear();
        self.columns.resize(columns, Vec::new());
        self.columns.iter_mut().for_each(Vec::clear);
        self.rounded.clear();
    }

    /// Returns whether a row repeats the one before in every cell but its time stamp.
    #[inline]
    fn is_alike(&self, bytes: &[u8], row: usize) -> bool {
        let part = |row: usize| {
            let (line, time) = (&self.lines[row], &self.times[row]);
            let line = &bytes[line.start as usize..line.end as usize];
            (&line[..time.start as usize], &line[time.end as usize..])
        };
        let ((front, back), (front_before, back_before)) = (part(row), part(row - 1));
        back.len() == back_before.len() && back == back_before && front == front_before
    }
}

impl Layout {
    /// Of rows with this many cells, and a separator that is no blank. `None` where no cell is
    /// wanted, or one twice, which is too rare to be fast.
    pub fn new(separator: u8, width: usize, choice: &Choice) -> Option<Self> {
        let last = choice.places.iter().chain(&choice.time).copied().max()?;
        let mut wanted = vec![Wanted::Nothing; last + 1];
        let values = choice.places.iter().enumerate().map(|(column, place)| (*place, Wanted::Value(column)));
        for (place, what) in values.chain(choice.time.map(|place| (place, Wanted::Stamp))) {
            if std::mem::replace(&mut wanted[place], what) != Wanted::Nothing {
                return None;
            }
        }
        Some(Self { separator, width, wanted, columns: choice.places.len() })
    }

    /// Reads the rows; false where some line is no regular one, and then what was read is not to be
    /// used.
    pub fn read(&self, bytes: &[u8], rows: &mut Regular) -> bool {
        rows.clear(self.columns);
        if memchr::memchr(b'"', bytes).is_some() || u32::try_from(bytes.len()).is_err() {
            return false;
        }
        let (mut start, mut returns) = (0, 0);
        while start < bytes.len() {
            let Some(end) = self.row(bytes, start, rows) else { return false };
            rows.lines.push(start as u32..end as u32);
            let returned = usize::from(bytes.get(end) == Some(&b'\r'));
            returns += returned;
            start = end + returned + 1;
        }
        if !rows.stamps.is_empty() {
            rows.alike.push(false);
            for row in 1..rows.lines.len() {
                let alike = rows.is_alike(bytes, row);
                rows.alike.push(alike);
            }
        }
        // A return that does not end a line together with a feed would end one by itself.
        memchr::memchr_iter(b'\r', bytes).count() == returns
    }

    /// Reads one row: where its line ends.
    #[inline]
    fn row(&self, bytes: &[u8], start: usize, rows: &mut Regular) -> Option<usize> {
        if bytes[start] == b'#' || (bytes[start].is_ascii_whitespace() && is_blank(&bytes[start..])) {
            return None;
        }
        let mut at = start;
        for (place, wanted) in self.wanted.iter().enumerate() {
            if place > 0 {
                if bytes.get(at) != Some(&self.separator) {
                    return None;
                }
                at += 1;
            }
            while bytes.get(at) == Some(&b' ') {
                at += 1;
            }
            let from = at;
            at = match wanted {
                Wanted::Value(column) => {
                    let (value, end) = match decimal::leading_number(&bytes[from..]) {
                        Some((value, length)) if self.ends(bytes, from + length) => (value, from + length),
                        _ => self.any(bytes, from, *column, rows)?,
                    };
                    // Minus zero is zero, as where cells are read one by one.
                    rows.columns[*column].push(value + 0.0);
                    end
                }
                Wanted::Stamp => {
                    let (stamp, end) = match Stamp::leading(&bytes[from..]) {
                        Some((stamp, length)) if self.ends(bytes, from + length) => (stamp, from + length),
                        _ => {
                            let end = self.end(bytes, from);
                            (Stamp::parse(&bytes[from..end])?, end)
                        }
                    };
                    rows.stamps.push(stamp);
                    rows.times.push((from - start) as u32..(end - start) as u32);
                    end
                }
                Wanted::Nothing => self.end(bytes, from),
            };
        }
        let end =
            if is_end_of_line(bytes, at) { at } else { end_of_line(bytes, at, memchr::memchr(b'\n', &bytes[at..])) };
        let behind = if end == at { 0 } else { memchr::memchr_iter(self.separator, &bytes[at..end]).count() };
        (self.wanted.len() + behind == self.width).then_some(end)
    }

    /// A number that is no plain one, and where its cell ends.
    #[cold]
    fn any(&self, bytes: &[u8], from: usize, column: usize, rows: &mut Regular) -> Option<(f64, usize)> {
        let end = self.end(bytes, from);
        let cell = &bytes[from..end];
        let value = match format::cell(cell) {
            Cell::Number(value) => value,
            Cell::DecimalComma(value) if self.separator != b',' => value,
            _ => return None,
        };
        if format::was_rounded(cell, value) {
            rows.rounded.push((rows.lines.len(), column));
        }
        Some((value, end))
    }

    /// Returns whether a cell ends here.
    #[inline]
    fn ends(&self, bytes: &[u8], at: usize) -> bool {
        bytes.get(at) == Some(&self.separator) || is_end_of_line(bytes, at)
    }

    /// Returns where the cell ends that this place belongs to.
    #[inline]
    fn end(&self, bytes: &[u8], from: usize) -> usize {
        match memchr::memchr2(self.separator, b'\n', &bytes[from..]) {
            Some(n) if bytes[from + n] == self.separator => from + n,
            end => end_of_line(bytes, from, end),
        }
    }
}

#[inline]
fn is_end_of_line(bytes: &[u8], at: usize) -> bool {
    match bytes.get(at) {
        None | Some(b'\n') => true,
        Some(b'\r') => matches!(bytes.get(at + 1), None | Some(b'\n')),
        _ => false,
    }
}

/// The end of a line whose feed is so far behind a place of it, without a return before that.
#[inline]
fn end_of_line(bytes: &[u8], from: usize, feed: Option<usize>) -> usize {
    let end = feed.map_or(bytes.len(), |n| from + n);
    if bytes[from..end].ends_with(b"\r") { end - 1 } else { end }
}

/// Returns whether the line that bytes begin with is.
fn is_blank(bytes: &[u8]) -> bool {
    bytes[..end_of_line(bytes, 0, memchr::memchr(b'\n', bytes))].trim_ascii().is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8], width: usize, time: Option<usize>, places: &[usize]) -> Option<Regular> {
        let layout = Layout::new(b',', width, &Choice { time, places: places.into() }).expect("a layout");
        let mut rows = Regular::default();
        layout.read(text, &mut rows).then_some(rows)
    }

    #[test]
    fn regular_rows_are_read_cell_by_cell() {
        let text = b"0.5,1.25,x,-3\r\n1.5,1e-3,y,\n2.5, 7 ,,123456789.125";
        let rows = read(text, 4, Some(0), &[3, 1]).expect("regular");
        assert_eq!(rows.stamps.iter().map(Stamp::value).collect::<Vec<_>>(), [0.5, 1.5, 2.5]);
        assert!(rows.columns[0][1].is_nan(), "an empty cell is a missing reading");
        assert_eq!((rows.columns[0][0], rows.columns[0][2]), (-3.0, 123_456_789.125));
        assert_eq!(rows.columns[1], [1.25, 1e-3, 7.0]);
        let line = |row: usize| &text[rows.lines[row].start as usize..rows.lines[row].end as usize];
        assert_eq!((line(0), line(2)), (&b"0.5,1.25,x,-3"[..], &b"2.5, 7 ,,123456789.125"[..]));
    }

    #[test]
    fn rows_that_repeat_the_one_before_in_all_but_their_stamp_are_told() {
        let alike = |text: &[u8]| read(text, 3, Some(1), &[0]).expect("regular").alike;
        assert_eq!(alike(b"1,0.5,2\n1,0.75,2\n1,1,3\n2,1.25,3\n2,1.25,3\n"), [false, true, false, false, true]);
        assert_eq!(alike(b"1,0.5,2\r\n1,10.5,2\r\n1,1.5,\r\n"), [false, true, false]);
    }

    #[test]
    fn anything_else_is_left_to_others() {
        let plain = |text: &[u8]| read(text, 2, None, &[1]);
        assert!(plain(b"1,2\n3,4\n").is_some() && plain(b"1,2\r\n3,4\r\n").is_some() && plain(b"1,2\n3,4\r").is_some());
        for other in [
            &b"1,2\n#\n"[..],
            b"1,2\n\n",
            b"1,2\r\n\r\n",
            b"1,\"2\"\n",
            b"1,2,3\n",
            b"1\n",
            b"1,x\n",
            b"1,2\r3,4\n",
            b"1,2\r\r\n",
            b"1\r,2\n",
            b" \n1,2\n",
            b"1\n,2\n",
            b"1,2;\n",
        ] {
            assert!(plain(other).is_none(), "{}", String::from_utf8_lossy(other));
        }
        assert_eq!(plain(b"1,9007199254740993\n").expect("regular").rounded, [(0, 0)]);
        assert!(Layout::new(b',', 2, &Choice { time: Some(1), places: vec![1] }).is_none(), "one cell asked for twice");
    }
}
