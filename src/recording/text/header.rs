//! The head of a text file: which columns it has, their units, and which of them hold numbers.

use super::preamble::Preamble;
use super::{POINT, Text};
use crate::cells::Cells;
use crate::error::Result;
use crate::finding::Finding;
use crate::format::{self, Cell};
use crate::headings::{self, Headings};
use crate::{trajectory, unit};

/// A table of more columns is none of a recording.
const MOST_COLUMNS: usize = 1 << 20;

impl Text {
    /// Passes the lines before the headings.
    pub(super) fn pass(&mut self, preamble: Option<Preamble>) -> Result<()> {
        let Some(Preamble { lines, headings, .. }) = preamble else { return Ok(()) };
        while self.lines.number() + 1 < headings && self.lines.advance()? {}
        self.findings.push(Finding::Preamble { lines, headings });
        Ok(())
    }

    /// Returns whether a heading names a clock; below the settings of an instrument a unit of time
    /// does too, as there the headings may be the units alone, and LabVIEW's `X_Value`.
    pub fn names_a_clock(&self, heading: &str) -> bool {
        format::names_a_clock(heading) || self.table_width.is_some() && format::is_clock_of_instruments(heading)
    }

    /// The first line that is no comment names the columns; where it holds numbers, the comment
    /// before it may: EuRoC's files begin with `#timestamp [ns],…`.
    pub(super) fn read_header(&mut self) -> Result<Headings> {
        let mut comment = Vec::new();
        loop {
            if !self.lines.advance()? {
                return Err(self.fail("its first line is not a header", "begin with one line that names the columns"));
            }
            match self.lines.line().trim_ascii() {
                [] => {}
                [b'#', ..] => comment = self.lines.line().to_vec(),
                _ => break,
            }
        }
        self.cells.cut(self.lines.line(), self.separator);
        self.width = self.table_width.unwrap_or(self.cells.len()).min(self.cells.len());
        if self.width > MOST_COLUMNS {
            return Err(self.fail(
                format!("line {} has {} cells, more than {MOST_COLUMNS}", self.lines.number(), self.width),
                "a recording is one row per sample and one column per channel: does it lie on its side?",
            ));
        }
        let numbers = |cells: &Cells, line: &[u8]| {
            (0..cells.len()).all(|i| match format::cell(cells.of(line, i)) {
                Cell::Text => false,
                Cell::DecimalComma(_) => self.separator != b',',
                _ => true,
            })
        };
        if !numbers(&self.cells, self.lines.line()) {
            let line = self.lines.line();
            if (0..self.width).any(|i| self.cells.of(line, i).starts_with(b"\"")) {
                return Err(self.open_quote());
            }
            return Ok(Headings::new(&self.cells, self.lines.line(), self.width));
        }
        self.held = true;
        let comment = comment.trim_ascii().strip_prefix(b"#").unwrap_or_default();
        let mut cells = Cells::default();
        cells.cut(comment, self.separator);
        if cells.len() == self.width && self.width > 1 && !numbers(&cells, comment) {
            return Ok(Headings::new(&cells, comment, self.width));
        }
        let line = self.lines.line();
        let row: Vec<f64> = (0..self.width).map(|i| self.number(self.cells.of(line, i)).unwrap_or(f64::NAN)).collect();
        if let Some(kind) = trajectory::recognised(&row) {
            self.findings.push(Finding::TrajectoryRecognised { kind });
            return Ok(Headings::known(kind.columns()));
        }
        self.findings.push(Finding::NoHeader);
        Ok(Headings::counted(self.width))
    }

    /// A row of units below the header: text in every cell that is not empty, and a unit in one at
    /// least.
    pub(super) fn read_units(&mut self) -> Result<()> {
        if !self.held {
            self.held = self.next_line()?;
        }
        if !self.held || self.cells.len() != self.width || self.rows > 0 {
            return Ok(());
        }
        let line = self.lines.line();
        let words: Vec<String> =
            (0..self.width).map(|i| headings::text(self.cells.of(line, i)).trim().to_owned()).collect();
        if !unit::are_units(&words) {
            return Ok(());
        }
        for (unit, word) in self.headings.units.iter_mut().zip(&words) {
            let word = unit::without_brackets(word);
            if !word.is_empty() {
                *unit = Some(word.to_owned());
            }
        }
        self.findings.push(Finding::UnitsRow { line: self.lines.number() });
        self.held = self.next_line()?;
        Ok(())
    }

    /// Returns what the first row holds at a place.
    fn first(&self, place: usize) -> Cell {
        match self.held {
            true if place >= self.cells.len() => Cell::Text,
            true => format::cell(self.cells.of(self.lines.line(), place)),
            false => Cell::Number(0.0),
        }
    }

    /// Returns whether the first row holds a number at a place.
    fn is_numeric(&self, place: usize) -> bool {
        match self.first(place) {
            Cell::Number(_) | Cell::TooLarge => true,
            Cell::DecimalComma(_) => self.separator != b',',
            Cell::Text => false,
        }
    }

    /// Returns whether a place without heading and value lies behind a separator that ends the lines.
    fn is_behind_the_last(&self, place: usize) -> bool {
        let is_blank = || self.held && self.cells.of(self.lines.line(), place).trim_ascii().is_empty();
        place + 1 == self.width && self.headings.names[place].trim().is_empty() && is_blank()
    }

    /// Names the columns that [`Text::numeric_places`] leaves out because they hold no numbers.
    pub(crate) fn note_unread(&mut self) {
        let unread = |place: &usize| !self.is_numeric(*place) && !self.names_a_clock(&self.headings.names[*place]);
        let named = |place: usize| {
            let cell = headings::text(self.cells.of(self.lines.line(), place));
            (headings::shortened(&self.headings.names[place]), headings::shortened(cell.trim()))
        };
        let columns: Vec<(String, String)> = (0..self.width).filter(unread).map(named).collect();
        if !columns.is_empty() {
            self.findings.push(Finding::ColumnsUnread { columns });
        }
    }

    /// Says that no column holds numbers, with a cell as example.
    fn no_numbers(&self) -> String {
        let cells = (0..self.width).filter(|place| !self.names_a_clock(&self.headings.names[*place]));
        let example = cells
            .filter(|place| self.held && *place < self.cells.len())
            .map(|place| (place, headings::text(self.cells.of(self.lines.line(), place))))
            .find(|(_, cell)| !cell.trim().is_empty());
        match example {
            Some((place, cell)) => format!(
                "no column holds numbers: the first cell of `{}` is `{}`",
                headings::shortened(&self.headings.names[place]),
                headings::shortened(cell.trim())
            ),
            None => "no column holds numbers".into(),
        }
    }

    /// Places of the columns that hold numbers and are no clock, by the first row.
    ///
    /// # Errors
    /// None, or more than 64.
    pub fn numeric_places(&self) -> Result<Vec<usize>> {
        let headings = &self.headings;
        let places: Vec<usize> = (0..self.width)
            .filter(|place| self.is_numeric(*place) && !self.names_a_clock(&headings.names[*place]))
            .filter(|place| !self.is_behind_the_last(*place))
            .collect();
        let comma = (0..self.width).any(|place| matches!(self.first(place), Cell::DecimalComma(_)));
        match places.len() {
            0 if comma => Err(self.fail("no column holds numbers", POINT)),
            0 => Err(self
                .fail(self.no_numbers(), "write numbers as digits with a decimal point, and at most a power of ten")),
            1..=64 => Ok(places),
            n => Err(self.fail(format!("it has {n} columns of numbers"), "name the columns wanted")),
        }
    }
}
