//! Rows of a text file one by one, in bounded memory: headings found, cells read as numbers, every
//! row counted.
//!
//! A row is a line that is neither blank nor a comment, after the header and a row of units. Not
//! for clocks or gaps: a missing cell is NaN here.

mod header;
mod preamble;

use std::path::PathBuf;

use super::cells::Cells;
use super::clock::stamp::Stamp;
use super::dropped::{Reason, Tally};
use super::finding::Finding;
use super::format::{self, Cell};
use super::headings::Headings;
use super::input::Input;
use super::lines::Lines;
use super::pack::Pack;
use super::reader::Choice;
use super::regular::Layout;
use super::run::Run;
use super::source::FileSummary;
use crate::error::{Error, Result};

/// Files of more than this are parsed ahead, bytes.
const LONG_BYTES: u64 = 1 << 20;

/// A text file being read.
#[derive(Debug)]
pub struct Text {
    path: PathBuf,
    lines: Lines,
    separator: u8,
    cells: Cells,
    /// States where the time stamp of the row before lies in its line.
    time_before: std::ops::Range<usize>,
    /// Other cells are not parsed beforehand.
    stamps_only: bool,
    /// The line at hand is a row that was not given yet.
    held: bool,
    headings: Headings,
    names: Vec<String>,
    /// Place in the row of each column wanted, and of the time column.
    choice: Choice,
    width: usize,
    /// Number of rows handed on.
    rows: usize,
    dropped: Tally,
    /// Cells of its rows, where its headings stand below lines that were left out.
    table_width: Option<usize>,
    /// Per column, the first row with a whole number that was rounded.
    rounded: Vec<Option<usize>>,
    skipped: (u64, u64),
    /// Holds what was found in its first lines.
    findings: Vec<Finding>,
}

impl Text {
    /// Opens a file and reads its headings.
    ///
    /// # Errors
    /// A file that is no table.
    pub fn open(input: Input, pack: Pack) -> Result<Self> {
        let path = input.path.clone();
        let mut lines = Lines::open(input, pack)?;
        let format = format::sniff(&path, lines.head()?)?;
        let preamble = preamble::find(&lines.head()?[format.skip..], format.separator)
            .map_err(|(cause, hint)| Error::new(format!("could not read {}", path.display()), cause, hint))?;
        lines.skip(format.skip);
        let mut text = Self {
            path,
            lines,
            separator: preamble.map_or(format.separator, |p| p.separator),
            cells: Cells::default(),
            time_before: 0..0,
            stamps_only: false,
            held: false,
            headings: Headings::counted(0),
            names: Vec::new(),
            choice: Choice::default(),
            width: 0,
            rows: 0,
            dropped: Tally::default(),
            table_width: preamble.map(|p| p.width),
            rounded: Vec::new(),
            skipped: (0, 0),
            findings: Vec::new(),
        };
        text.pass(preamble)?;
        text.headings = text.read_header()?;
        text.read_units()?;
        Ok(text)
    }

    /// Headings of its columns.
    pub fn headings(&self) -> &Headings {
        &self.headings
    }

    /// Chooses columns, which go by these names from here on.
    pub fn choose(&mut self, names: Vec<String>, choice: Choice) {
        self.rounded = vec![None; choice.places.len()];
        (self.names, self.choice) = (names, choice);
    }

    /// For a first look alone: without the checksum.
    pub fn without_checksum(&mut self) {
        self.lines.without_checksum();
    }

    /// For a look at the clock alone: other cells are not parsed beforehand.
    pub fn stamps_only(&mut self) {
        self.stamps_only = true;
    }

    /// The number in a cell; `None` where there is none.
    fn number(&self, cell: &[u8]) -> Option<f64> {
        match format::cell(cell) {
            Cell::Number(value) => Some(value),
            Cell::DecimalComma(value) if self.separator != b',' => Some(value),
            _ => None,
        }
    }

    /// Size of the file, for a progress bar.
    pub fn length_bytes(&self) -> u64 {
        self.lines.length_bytes()
    }

    /// Returns how far it has been read.
    pub fn bytes_read(&self) -> u64 {
        self.lines.bytes_read()
    }

    /// Goes to the next row; false at the end.
    ///
    /// # Errors
    /// A row with too few or too many cells, with its line; the last one may be cut short.
    pub fn advance(&mut self) -> Result<bool> {
        if self.rows > 0 {
            self.time_before = self.time_place();
            self.lines.keep();
        } else {
            self.lines.begin();
            self.parse_ahead();
        }
        if !std::mem::take(&mut self.held) && !self.next_line()? {
            return Ok(false);
        }
        self.rows += 1;
        if self.lines.regular().is_some() {
            return Ok(true);
        }
        let got = self.cells.len();
        if got == self.width {
            return Ok(true);
        }
        let (line, quotes) = (self.lines.number(), self.lines.line().iter().filter(|b| **b == b'"').count());
        if got < self.width && !self.next_line()? {
            self.dropped.add(Reason::CutShort, self.rows - 1);
            return Ok(false);
        }
        let need = self.width;
        if quotes % 2 == 1 {
            return Err(self.fail(
                format!("a quotation mark in line {line} is not closed in that line, which has {got} cells, the header {need}"),
                "remove it, or close it",
            ));
        }
        Err(self.fail(
            format!("line {line} has {got} cells, the header {need}"),
            "every row needs as many cells as the header; was the log interrupted, or is the decimal sign a comma?",
        ))
    }

    /// Rows of a long file are parsed beforehand, where no blank separates their cells.
    fn parse_ahead(&mut self) {
        let long = self.lines.length_bytes() > LONG_BYTES;
        if long && self.separator != b' ' {
            let places = if self.stamps_only { Vec::new() } else { self.choice.places.clone() };
            let choice = Choice { time: self.choice.time, places };
            if let Some(layout) = Layout::new(self.separator, self.width, &choice) {
                self.lines.parse(layout);
            }
        }
    }

    /// Rows that follow, at most this many; none where the next one must be gone to by itself. The
    /// last of them is at hand then.
    pub fn run(&mut self, most: usize, wanted: bool) -> Option<Run<'_>> {
        let before = self.rows;
        let (regular, rows) = self.lines.pass(most)?;
        self.rows += rows.len();
        for (row, column) in regular.rounded.iter().filter(|(row, _)| wanted && rows.contains(row)) {
            self.rounded[*column].get_or_insert(before + row - rows.start);
        }
        let (stamps, columns, alike) = (&regular.stamps, &regular.columns, Some(&regular.alike[..]));
        Some(Run { first: before, rows, stamps, columns, alike })
    }

    /// Returns where the time stamp lies in the line at hand.
    #[inline]
    fn time_place(&self) -> std::ops::Range<usize> {
        match (self.choice.time, self.lines.regular()) {
            (None, _) => 0..0,
            (Some(_), Some((regular, row))) => {
                regular.times.get(row).map_or(0..0, |t| t.start as usize..t.end as usize)
            }
            (Some(time), None) => self.cells.place(time),
        }
    }

    /// Passes the next row whatever it holds; false at the end.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn skip(&mut self) -> Result<bool> {
        if self.rows == 0 {
            self.parse_ahead();
        }
        let some = std::mem::take(&mut self.held) || self.next_line()?;
        self.rows += usize::from(some);
        Ok(some)
    }

    /// Reads the next line that is a row and cuts it; false at the end.
    fn next_line(&mut self) -> Result<bool> {
        let mut skipped = (0, 0);
        while self.lines.advance()? {
            if self.lines.regular().is_some() {
                self.count_skipped(skipped);
                return Ok(true);
            }
            let line = self.lines.line();
            let first = line.first().copied();
            if first == Some(b'#') || (first.is_none_or(|b| b.is_ascii_whitespace()) && line.trim_ascii().is_empty()) {
                skipped = (skipped.0 + 1, if skipped.0 == 0 { self.lines.number() } else { skipped.1 });
                continue;
            }
            self.cells.cut(line, self.separator);
            self.count_skipped(skipped);
            return Ok(true);
        }
        Ok(false)
    }

    /// Lines skipped before a row; those behind the last row do not matter, nor those right behind
    /// the header.
    fn count_skipped(&mut self, (lines, first): (u64, u64)) {
        if lines > 0 && self.rows > 0 {
            self.skipped = (self.skipped.0 + lines, if self.skipped.0 == 0 { first } else { self.skipped.1 });
        }
    }

    /// Number of the row at hand, counted from zero after the header.
    pub fn row(&self) -> usize {
        self.rows.saturating_sub(1)
    }

    /// Time stamp of the row at hand.
    ///
    /// # Errors
    /// A cell that is text, with its line.
    pub fn stamp(&self) -> Result<Stamp> {
        if let Some((regular, row)) = self.lines.regular() {
            return Ok(regular.stamps.get(row).copied().unwrap_or(Stamp::MISSING));
        }
        let place = self.choice.time.unwrap_or_default();
        Stamp::parse(self.cells.of(self.lines.line(), place)).ok_or_else(|| self.no_number(place))
    }

    /// Returns whether the row at hand repeats the one before in every cell but its time stamp.
    pub fn is_alike(&self) -> bool {
        let (line, here) = (self.lines.line(), self.time_place());
        let (before, there) = (self.lines.kept(), &self.time_before);
        let ends = |line: &[u8], place: &std::ops::Range<usize>| line.len() - place.end;
        here.start == there.start
            && ends(line, &here) == ends(before, there)
            && line[..here.start] == before[..there.start]
            && line[here.end..] == before[there.end..]
    }

    /// Writes the row at hand into `values`, as long as the names; a missing cell is NaN.
    ///
    /// # Errors
    /// A cell that is no number, with its line and column.
    pub fn values(&mut self, values: &mut [f64]) -> Result<()> {
        if let Some((regular, row)) = self.lines.regular() {
            if regular.columns.len() == values.len() {
                values.iter_mut().zip(&regular.columns).for_each(|(value, column)| *value = column[row]);
                for (_, column) in regular.rounded.iter().filter(|(at, _)| *at == row) {
                    self.rounded[*column].get_or_insert(self.rows - 1);
                }
                return Ok(());
            }
            self.cells.cut(self.lines.line(), self.separator);
        }
        for (index, (value, place)) in values.iter_mut().zip(&self.choice.places).enumerate() {
            let cell = self.cells.of(self.lines.line(), *place);
            *value = match self.number(cell) {
                Some(number) => number,
                None => return Err(self.no_number(*place)),
            };
            if self.rounded[index].is_none() && format::was_rounded(cell, *value) {
                self.rounded[index] = Some(self.rows - 1);
            }
        }
        Ok(())
    }

    fn no_number(&self, place: usize) -> Error {
        let line = self.lines.number();
        let cell = self.cells.of(self.lines.line(), place);
        let text = String::from_utf8_lossy(cell).into_owned();
        if text.starts_with('"') {
            return self.open_quote();
        }
        let (what, hint) = match format::cell(cell) {
            Cell::TooLarge => (
                "is larger than any reading: its powers overflow double precision",
                "check the exponent and the unit of the column",
            ),
            Cell::DecimalComma(_) => ("is not a number", POINT),
            _ if self.headings.names.get(place).is_some_and(|name| *name == text.trim()) => {
                ("is the heading of its column again", "delete this line; two logs in one file are two recordings")
            }
            _ if is_time_of_day(&text) => (
                "is a time of day without its date",
                "write it as seconds, or with its date, e.g. 2026-11-24T22:13:20.5",
            ),
            _ if line == 2 => (
                "is not a number",
                "one header line and one line of units are read; if this is a further one, delete it",
            ),
            _ => ("is not a number", "leave missing numbers empty; name other columns if this one is text"),
        };
        self.fail(format!("line {line}, column {}: `{}` {what}", place + 1, super::headings::shortened(&text)), hint)
    }

    /// A cell of the line at hand that begins with a quotation mark and has none at its end.
    fn open_quote(&self) -> Error {
        let cause = format!("a quotation mark in line {} is not closed in that line", self.lines.number());
        self.fail(cause, "remove it, or close it")
    }

    fn fail(&self, cause: impl Into<String>, hint: impl Into<String>) -> Error {
        Error::new(format!("could not read {}", self.path.display()), cause, hint)
    }

    /// Reads whatever is left for the checksum.
    ///
    /// # Errors
    /// When the file cannot be read on.
    pub fn finish(mut self) -> Result<FileSummary> {
        while self.skip()? {}
        let mut findings = self.findings;
        if self.skipped.0 > 0 {
            findings.push(Finding::SkippedLines { lines: self.skipped.0, first_line: self.skipped.1 });
        }
        for (name, row) in self.names.iter().zip(&self.rounded) {
            findings.extend(row.map(|first_row| Finding::BeyondDouble { column: name.clone(), first_row }));
        }
        let (sha256, length_bytes) = self.lines.finish()?;
        Ok(FileSummary { sha256, length_bytes, rows: self.rows, dropped: self.dropped.all(), findings })
    }
}

/// States what to do about decimal commas.
const POINT: &str = "write numbers with a decimal point, or separate the cells by semicolons or tabs";

/// Returns whether a cell holds hours, minutes and perhaps seconds, parted by colons.
fn is_time_of_day(text: &str) -> bool {
    let parts: Vec<&str> = text.trim().split(':').collect();
    let is_number = |part: &&str| part.starts_with(|c: char| c.is_ascii_digit()) && part.parse::<f64>().is_ok();
    matches!(parts.len(), 2 | 3) && parts.iter().all(is_number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_of_day_has_two_or_three_numbers() {
        assert!(["22:13:20.000149", " 7:05", "00:00:00"].into_iter().all(is_time_of_day));
        assert!(!["22", "a:b:c", "1:2:3:4", "t:1", "12:", "-1:2"].into_iter().any(is_time_of_day));
    }
}
