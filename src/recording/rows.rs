//! Rows of a recording one by one, in bounded memory, whatever the format: columns by name,
//! numbers, every row counted.
//!
//! Not for clocks or gaps: a missing cell is NaN here.

use std::path::{Path, PathBuf};

use super::clock::stamp::Stamp;
use super::formats::{self, Opened};
use super::memory::Memory;
use super::reader::Choice;
use super::run::Run;
use super::source::FileSummary;
use super::table::Table;
use super::text::Text;
use crate::error::{Error, Result};

/// A recording being read.
#[derive(Debug)]
pub struct Rows {
    body: Body,
    names: Vec<String>,
    units: Vec<Option<String>>,
    /// Heading of the time column.
    time: Option<String>,
    clock_like: Option<String>,
}

#[derive(Debug)]
enum Body {
    Text(Box<Text>),
    Table(Box<Table>),
}

/// Which part and which columns of a file are wanted.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wanted<'a> {
    /// Topic, message or array, where the file has several.
    pub topic: Option<&'a str>,
    /// The time column, which is none of the columns.
    pub time: Option<&'a str>,
    /// Headings, in this order. None: all numeric columns but clocks.
    pub columns: &'a [String],
    /// Read in place of the file.
    pub memory: Option<&'a Memory>,
}

impl Rows {
    /// Opens a file for the columns of these headings, in this order. None named: all numeric
    /// columns but clocks.
    ///
    /// # Errors
    /// A file that no format knows, or a column that is not there; the nearest heading is named.
    pub fn open(path: &Path, columns: &[String]) -> Result<Self> {
        Self::open_wanted(path, &Wanted { columns, ..Wanted::default() })
    }

    /// The same of one topic, with a time column.
    ///
    /// # Errors
    /// As [`Rows::open`], and a topic that is not there or holds no numbers.
    pub fn open_wanted(path: &Path, wanted: &Wanted<'_>) -> Result<Self> {
        let opened = formats::open_in(path, wanted.memory, wanted.topic)?;
        let headings = opened.headings();
        let fail = |path: &PathBuf, (cause, hint): (String, String)| {
            Error::new(format!("could not read {}", path.display()), cause, hint)
        };
        let path: PathBuf = path.into();
        let time = wanted.time.map(|t| headings.place(t)).transpose().map_err(|e| fail(&path, e))?;
        let all = wanted.columns.is_empty();
        let places = if all {
            opened.numeric_places()?
        } else {
            let places: Result<Vec<usize>, _> = wanted.columns.iter().map(|c| headings.place(c)).collect();
            places.map_err(|e| fail(&path, e))?
        };
        // Called as they were asked for, which may leave a unit out.
        let name = |(index, place): (usize, &usize)| {
            let name = if all { &headings.names[*place] } else { &wanted.columns[index] };
            (name.clone(), *place)
        };
        let (names, places): (Vec<String>, Vec<usize>) =
            places.iter().enumerate().map(name).filter(|(_, p)| Some(*p) != time).unzip();
        let units = places.iter().map(|p| headings.units[*p].clone()).collect();
        let clock_like = opened.clock_like().map(str::to_owned);
        let time_heading = time.map(|place| headings.clock_heading(place));
        let choice = Choice { time, places };
        let body = match opened {
            Opened::Text(mut text) => {
                if all {
                    text.note_unread();
                }
                text.choose(names.clone(), choice);
                Body::Text(text)
            }
            Opened::Log { input, log, part, .. } => {
                let findings = log.findings();
                let reader = log.open(part, &choice)?;
                Body::Table(Box::new(Table::new(input, reader, names.clone(), findings)))
            }
        };
        Ok(Self { body, names, units, time: time_heading, clock_like })
    }

    /// For a first look alone: without the checksum.
    pub fn without_checksum(mut self) -> Self {
        match &mut self.body {
            Body::Text(text) => text.without_checksum(),
            Body::Table(table) => table.without_checksum(),
        }
        self
    }

    /// For a look at the clock alone: what takes time only for other columns is left out.
    pub fn stamps_only(mut self) -> Self {
        if let Body::Text(text) = &mut self.body {
            text.stamps_only();
        }
        self
    }

    /// Names of the columns given, in order: as they were asked for, else their headings.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Units of these columns, as the file writes them.
    pub fn units(&self) -> &[Option<String>] {
        &self.units
    }

    /// Heading of the time column, with its unit.
    pub fn time(&self) -> Option<&str> {
        self.time.as_deref()
    }

    /// A heading that looks like a clock, where the file has one.
    pub fn clock_like(&self) -> Option<&str> {
        self.clock_like.as_deref()
    }

    /// Size of the file, for a progress bar.
    pub fn length_bytes(&self) -> u64 {
        match &self.body {
            Body::Text(text) => text.length_bytes(),
            Body::Table(table) => table.length_bytes(),
        }
    }

    /// Returns how far it has been read.
    pub fn bytes_read(&self) -> u64 {
        match &self.body {
            Body::Text(text) => text.bytes_read(),
            Body::Table(table) => table.bytes_read(),
        }
    }

    /// Goes to the next row; false at the end.
    ///
    /// # Errors
    /// A row with too few or too many cells, with its line; the last one may be cut short. Bytes
    /// that are damaged.
    #[inline]
    pub fn advance(&mut self) -> Result<bool> {
        match &mut self.body {
            Body::Text(text) => text.advance(),
            Body::Table(table) => table.advance(),
        }
    }

    /// Passes rows that need no look one by one, at most this many; none where the next row must be
    /// gone to by [`Rows::advance`]. Those that text was asked only stamps of hold no numbers.
    ///
    /// What is said of numbers that are used is noted only where these are `wanted`.
    pub fn run(&mut self, most: usize, wanted: bool) -> Option<Run<'_>> {
        match &mut self.body {
            Body::Text(text) => text.run(most, wanted),
            Body::Table(table) => table.run(most),
        }
    }

    /// Passes the next row whatever it holds; false at the end.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn skip(&mut self) -> Result<bool> {
        match &mut self.body {
            Body::Text(text) => text.skip(),
            Body::Table(table) => table.advance(),
        }
    }

    /// Number of the row at hand, counted from zero after the header.
    #[inline]
    pub fn row(&self) -> usize {
        match &self.body {
            Body::Text(text) => text.row(),
            Body::Table(table) => table.row(),
        }
    }

    /// Time stamp of the row at hand.
    ///
    /// # Errors
    /// A cell that is text, with its line.
    #[inline]
    pub fn stamp(&self) -> Result<Stamp> {
        match &self.body {
            Body::Text(text) => text.stamp(),
            Body::Table(table) => Ok(table.stamp()),
        }
    }

    /// Returns whether the row at hand repeats the one before in every cell but its time stamp.
    #[inline]
    pub fn is_alike(&self) -> bool {
        match &self.body {
            Body::Text(text) => text.is_alike(),
            Body::Table(table) => table.is_alike(),
        }
    }

    /// Writes the row at hand into `values`, as long as [`Rows::names`]; a missing cell is NaN.
    ///
    /// # Errors
    /// A cell that is no number, with its line and column.
    #[inline]
    pub fn values(&mut self, values: &mut [f64]) -> Result<()> {
        match &mut self.body {
            Body::Text(text) => text.values(values),
            Body::Table(table) => table.values(values),
        }
    }

    /// Goes to the next row and reads it; false at the end.
    ///
    /// # Errors
    /// As [`Rows::advance`] and [`Rows::values`].
    pub fn next(&mut self, values: &mut [f64]) -> Result<bool> {
        Ok(self.advance()? && self.values(values).map(|()| true)?)
    }

    /// Reads whatever is left, for the checksum.
    ///
    /// # Errors
    /// When the file cannot be read on.
    pub fn finish(self) -> Result<FileSummary> {
        match self.body {
            Body::Text(text) => text.finish(),
            Body::Table(table) => table.finish(),
        }
    }
}
