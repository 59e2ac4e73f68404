//! Rows of a CSV file one by one, in bounded memory: headings found, cells read as numbers, every row counted.
//!
//! A row is a line that is neither blank nor a comment, after the header. Not for clocks or gaps: a missing cell is NaN here.

use std::path::{Path, PathBuf};

use super::cells::Cells;
use super::clock::stamp::Stamp;
use super::dropped::{Dropped, Reason, Tally};
use super::finding::Finding;
use super::format::{self, Cell};
use super::headings::Headings;
use super::lines::Lines;
use crate::error::{Error, Result};

pub use super::lines::open;

/// A CSV file being read.
#[derive(Debug)]
pub struct Rows {
    path: PathBuf,
    lines: Lines,
    separator: u8,
    cells: Cells,
    /// The row before, and where its time stamp lies.
    before: (Vec<u8>, std::ops::Range<usize>),
    /// The line at hand is a row that was not given yet.
    held: bool,
    names: Vec<String>,
    /// Place in the row of each column wanted.
    places: Vec<usize>,
    /// Heading and place of the time column.
    time: Option<(String, usize)>,
    width: usize,
    /// Rows given.
    rows: usize,
    dropped: Tally,
    /// Per column, the first row with a whole number that was rounded.
    rounded: Vec<Option<usize>>,
    skipped: (u64, u64),
    no_header: bool,
    clock_like: Option<String>,
}

/// What is known of a file once it has been read to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// SHA-256 of all its bytes, hexadecimal.
    pub sha256: String,
    /// Size of the file, bytes.
    pub length_bytes: u64,
    /// Rows in the file, those cut short included.
    pub rows: usize,
    /// Rows that were not given.
    pub dropped: Vec<Dropped>,
    /// What was found and survived.
    pub findings: Vec<Finding>,
}

impl Rows {
    /// Opens a file for the columns of these headings, in this order. None named: all numeric columns but clocks.
    ///
    /// # Errors
    /// A file that is no table, or a column that is not there; the nearest heading is named.
    pub fn open(path: &Path, columns: &[String]) -> Result<Self> {
        Self::open_timed(path, None, columns)
    }

    /// The same with a time column, which is none of the columns.
    ///
    /// # Errors
    /// As [`Rows::open`].
    pub fn open_timed(path: &Path, time: Option<&str>, columns: &[String]) -> Result<Self> {
        let mut lines = Lines::open(path)?;
        let format = format::sniff(path, lines.head()?)?;
        lines.skip(format.skip);
        let mut rows = Self {
            path: path.into(),
            lines,
            separator: format.separator,
            cells: Cells::default(),
            before: Default::default(),
            held: false,
            names: Vec::new(),
            places: Vec::new(),
            time: None,
            width: 0,
            rows: 0,
            dropped: Tally::default(),
            rounded: Vec::new(),
            skipped: (0, 0),
            no_header: false,
            clock_like: None,
        };
        let headings = rows.read_header()?;
        rows.clock_like = headings.names.iter().find(|n| format::names_a_clock(n)).cloned();
        if let Some(time) = time {
            let place = headings.place(time).map_err(|(cause, hint)| rows.fail(cause, hint))?;
            rows.time = Some((headings.names[place].clone(), place));
        }
        let clock = rows.time.as_ref().map(|t| t.1);
        rows.places = if columns.is_empty() {
            rows.numeric_places(&headings)?
        } else {
            let places: Result<Vec<usize>, _> = columns.iter().map(|c| headings.place(c)).collect();
            places.map_err(|(cause, hint)| rows.fail(cause, hint))?
        };
        // Called as they were asked for, which may leave a unit out.
        let asked = columns.iter().cloned().zip(rows.places.iter().copied());
        let found = rows.places.iter().map(|p| (headings.names[*p].clone(), *p));
        let all: Vec<(String, usize)> = if columns.is_empty() { found.collect() } else { asked.collect() };
        (rows.names, rows.places) = all.into_iter().filter(|(_, p)| Some(*p) != clock).unzip();
        rows.rounded = vec![None; rows.places.len()];
        Ok(rows)
    }

    /// The first line that is no comment names the columns; where it holds numbers, the comment before it may: EuRoC's files
    /// begin with `#timestamp [ns],…`.
    fn read_header(&mut self) -> Result<Headings> {
        let mut comment = Vec::new();
        loop {
            if !self.lines.advance()? {
                return Err(self.fail("its first line is no header", "begin with one line that names the columns"));
            }
            match self.lines.line().trim_ascii() {
                [] => {}
                [b'#', ..] => self.lines.put_aside(&mut comment),
                _ => break,
            }
        }
        self.cells.cut(self.lines.line(), self.separator);
        self.width = self.cells.len();
        let numbers = |cells: &Cells, line: &[u8]| {
            (0..cells.len()).all(|i| !matches!(format::cell(cells.of(line, i)), Cell::Text | Cell::DecimalComma))
        };
        if !numbers(&self.cells, self.lines.line()) {
            let line = self.lines.line();
            if (0..self.width).any(|i| self.cells.of(line, i).starts_with(b"\"")) {
                return Err(self.open_quote());
            }
            return Ok(Headings::new(&self.cells, self.lines.line()));
        }
        self.held = true;
        let comment = comment.trim_ascii().strip_prefix(b"#").unwrap_or_default();
        let mut cells = Cells::default();
        cells.cut(comment, self.separator);
        if cells.len() == self.width && self.width > 1 && !numbers(&cells, comment) {
            return Ok(Headings::new(&cells, comment));
        }
        self.no_header = true;
        Ok(Headings::counted(self.width))
    }

    fn numeric_places(&mut self, headings: &Headings) -> Result<Vec<usize>> {
        if !self.held {
            self.held = self.next_line()?;
        }
        let kind = |place: usize| match self.held {
            true if place >= self.cells.len() => Cell::Text,
            true => format::cell(self.cells.of(self.lines.line(), place)),
            false => Cell::Number(0.0),
        };
        let numeric = |p: &usize| matches!(kind(*p), Cell::Number(_) | Cell::TooLarge);
        let places: Vec<usize> =
            (0..self.width).filter(|p| numeric(p) && !format::names_a_clock(&headings.names[*p])).collect();
        let comma = (0..self.width).any(|p| kind(p) == Cell::DecimalComma);
        match places.len() {
            0 => Err(self.fail("no column holds numbers", if comma { POINT } else { "name the columns wanted" })),
            1..=64 => Ok(places),
            n => Err(self.fail(format!("it has {n} columns of numbers"), "name the columns wanted")),
        }
    }

    /// For a first look alone: without the checksum.
    pub fn without_checksum(mut self) -> Self {
        self.lines.without_checksum();
        self
    }

    /// Names of the columns given, in order: as they were asked for, else their headings.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Heading of the time column.
    pub fn time(&self) -> Option<&str> {
        self.time.as_ref().map(|t| t.0.as_str())
    }

    /// A heading that looks like a clock, where the file has one.
    pub fn clock_like(&self) -> Option<&str> {
        self.clock_like.as_deref()
    }

    /// Size of the file, for a progress bar.
    pub fn length_bytes(&self) -> u64 {
        self.lines.length_bytes()
    }

    /// How far it has been read.
    pub fn bytes_read(&self) -> u64 {
        self.lines.bytes_read()
    }

    /// Goes to the next row; false at the end.
    ///
    /// # Errors
    /// A row with too few or too many cells, with its line; the last one may be cut short.
    pub fn advance(&mut self) -> Result<bool> {
        if self.rows > 0 {
            self.before.1 = self.time.as_ref().map_or(0..0, |t| self.cells.place(t.1));
            self.lines.put_aside(&mut self.before.0);
        }
        if !std::mem::take(&mut self.held) && !self.next_line()? {
            return Ok(false);
        }
        self.rows += 1;
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

    /// Passes the next row whatever it holds; false at the end.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn skip(&mut self) -> Result<bool> {
        let some = std::mem::take(&mut self.held) || self.next_line()?;
        self.rows += usize::from(some);
        Ok(some)
    }

    /// Reads the next line that is a row and cuts it; false at the end.
    fn next_line(&mut self) -> Result<bool> {
        let mut skipped = (0, 0);
        while self.lines.advance()? {
            let line = self.lines.line();
            let first = line.first().copied();
            if first == Some(b'#') || (first.is_none_or(|b| b.is_ascii_whitespace()) && line.trim_ascii().is_empty()) {
                skipped = (skipped.0 + 1, if skipped.0 == 0 { self.lines.number() } else { skipped.1 });
                continue;
            }
            self.cells.cut(line, self.separator);
            // Those behind the last row do not matter, nor those right behind the header.
            if skipped.0 > 0 && self.rows > 0 {
                self.skipped =
                    (self.skipped.0 + skipped.0, if self.skipped.0 == 0 { skipped.1 } else { self.skipped.1 });
            }
            return Ok(true);
        }
        Ok(false)
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
        let place = self.time.as_ref().map_or(0, |t| t.1);
        Stamp::parse(self.cells.of(self.lines.line(), place)).ok_or_else(|| self.no_number(place))
    }

    /// Whether the row at hand repeats the one before in every cell but its time stamp.
    pub fn is_alike(&self) -> bool {
        let (line, here) = (self.lines.line(), self.time.as_ref().map_or(0..0, |t| self.cells.place(t.1)));
        let (before, there) = (&self.before.0, &self.before.1);
        let ends = |line: &[u8], place: &std::ops::Range<usize>| line.len() - place.end;
        here.start == there.start
            && ends(line, &here) == ends(before, there)
            && line[..here.start] == before[..there.start]
            && line[here.end..] == before[there.end..]
    }

    /// Writes the row at hand into `values`, as long as [`Rows::names`]; a missing cell is NaN.
    ///
    /// # Errors
    /// A cell that is no number, with its line and column.
    pub fn values(&mut self, values: &mut [f64]) -> Result<()> {
        for (index, (value, place)) in values.iter_mut().zip(&self.places).enumerate() {
            let cell = self.cells.of(self.lines.line(), *place);
            *value = match format::number(cell) {
                Some(number) => number,
                None => return Err(self.no_number(*place)),
            };
            if self.rounded[index].is_none() && format::was_rounded(cell, *value) {
                self.rounded[index] = Some(self.rows - 1);
            }
        }
        Ok(())
    }

    /// Goes to the next row and reads it; false at the end.
    ///
    /// # Errors
    /// As [`Rows::advance`] and [`Rows::values`].
    pub fn next(&mut self, values: &mut [f64]) -> Result<bool> {
        Ok(self.advance()? && self.values(values).map(|()| true)?)
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
                "is larger than any reading: powers of it leave double precision",
                "check the exponent and the unit of the column",
            ),
            Cell::DecimalComma => ("is no number", POINT),
            _ if line == 2 => {
                ("is no number", "one line of headings is read; if this is a second one (units), delete it")
            }
            _ => ("is no number", "leave missing numbers empty; name other columns if this one is text"),
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
    pub fn finish(mut self) -> Result<Source> {
        while self.skip()? {}
        let mut findings = Vec::new();
        if self.no_header {
            findings.push(Finding::NoHeader);
        }
        if self.skipped.0 > 0 {
            findings.push(Finding::SkippedLines { lines: self.skipped.0, first_line: self.skipped.1 });
        }
        for (name, row) in self.names.iter().zip(&self.rounded) {
            findings.extend(row.map(|first_row| Finding::BeyondDouble { column: name.clone(), first_row }));
        }
        let length_bytes = self.lines.bytes_read();
        let sha256 = self.lines.finish()?;
        Ok(Source { sha256, length_bytes, rows: self.rows, dropped: self.dropped.all(), findings })
    }
}

/// What to do about decimal commas.
const POINT: &str = "write numbers with a decimal point, not a comma";
