//! A line cut into cells. A quotation mark never reaches beyond its line: one that is not closed
//! there is a character like any other.

use std::ops::Range;

/// States where the cells of a line lie; room is kept from line to line.
#[derive(Debug, Clone, Default)]
pub struct Cells {
    places: Vec<Range<u32>>,
}

impl Cells {
    /// Cuts a line (shorter than 4 GB, which `lines` sees to) at every separator outside quotation
    /// marks.
    ///
    /// With a blank as separator, blanks and tabs in a row are one, and none begins or ends a line.
    pub fn cut(&mut self, line: &[u8], separator: u8) {
        self.places.clear();
        if separator == b' ' {
            return self.cut_blanks(line);
        }
        if memchr::memchr(b'"', line).is_some() {
            return self.cut_quoted(line, separator);
        }
        let mut start = 0;
        for end in memchr::memchr_iter(separator, line) {
            self.places.push(start..end as u32);
            start = end as u32 + 1;
        }
        self.places.push(start..line.len() as u32);
    }

    fn cut_blanks(&mut self, line: &[u8]) {
        let mut start = None;
        for (i, byte) in line.iter().enumerate() {
            match (byte.is_ascii_whitespace(), start) {
                (false, None) => start = Some(i),
                (true, Some(from)) => {
                    self.places.push(from as u32..i as u32);
                    start = None;
                }
                _ => {}
            }
        }
        self.places.extend(start.map(|from| from as u32..line.len() as u32));
    }

    fn cut_quoted(&mut self, line: &[u8], separator: u8) {
        let mut start = 0;
        loop {
            let (cell, next) = match quoted(line, start, separator) {
                Some(found) => found,
                None => {
                    let end = memchr::memchr(separator, &line[start..]).map_or(line.len(), |i| start + i);
                    (start..end, end)
                }
            };
            self.places.push(cell.start as u32..cell.end as u32);
            if next >= line.len() {
                return;
            }
            start = next + 1;
        }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Returns whether no line was cut yet.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Returns where a cell lies in its line, without quotation marks around it; empty where there
    /// is none.
    pub fn place(&self, index: usize) -> Range<usize> {
        self.places.get(index).map_or(0..0, |p| p.start as usize..p.end as usize)
    }

    /// A cell of the line that was cut.
    pub fn of<'a>(&self, line: &'a [u8], index: usize) -> &'a [u8] {
        line.get(self.place(index)).unwrap_or_default()
    }
}

/// The cell between quotation marks that begins at `start`, and the separator behind it; `None`
/// where no cell is quoted there from end to end.
fn quoted(line: &[u8], start: usize, separator: u8) -> Option<(Range<usize>, usize)> {
    let blank = |i: &usize| line[*i] == b' ';
    let open = (start..line.len()).find(|i| !blank(i)).filter(|i| line[*i] == b'"')?;
    let mut close = open + 1;
    loop {
        close += memchr::memchr(b'"', line.get(close..)?)?;
        // A doubled mark stands for itself.
        if line.get(close + 1) != Some(&b'"') {
            break;
        }
        close += 2;
    }
    let next = (close + 1..line.len()).find(|i| !blank(i)).unwrap_or(line.len());
    (next == line.len() || line[next] == separator).then_some((open + 1..close, next))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(line: &str) -> Vec<&str> {
        let mut cells = Cells::default();
        cells.cut(line.as_bytes(), b',');
        (0..cells.len()).map(|i| std::str::from_utf8(cells.of(line.as_bytes(), i)).expect("text")).collect()
    }

    #[test]
    fn quoted_cells_hold_separators_and_stray_marks_hold_nothing() {
        assert_eq!(cut("1,2,3"), ["1", "2", "3"]);
        assert_eq!(cut(""), [""]);
        assert_eq!(cut("1,,"), ["1", "", ""]);
        assert_eq!(cut("1,\"a, b\", \"c\" ,\"\""), ["1", "a, b", "c", ""]);
        assert_eq!(cut("\"say \"\"so\"\"\",2"), ["say \"\"so\"\"", "2"]);
        // Not closed, closed too early, or within a cell: each mark is a character.
        assert_eq!(cut("1,\"bumped"), ["1", "\"bumped"]);
        assert_eq!(cut("1,\"bumped, hard"), ["1", "\"bumped", " hard"]);
        assert_eq!(cut("1,\"a\"b,2"), ["1", "\"a\"b", "2"]);
        assert_eq!(cut("5\",6\""), ["5\"", "6\""]);
        assert_eq!(cut("\""), ["\""]);
    }
}
