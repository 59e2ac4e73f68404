//! Rows one by one out of the blocks that a format's reader gives.

use super::clock::stamp::Stamp;
use super::dropped::Reason;
use super::finding::Finding;
use super::format::{self, Cell};
use super::input::{Checksum, Input};
use super::reader::{Block, Reader};
use super::run::Run;
use super::source::FileSummary;
use crate::error::{Error, Result};

/// A table of a binary file, being read.
#[derive(Debug)]
pub struct Table {
    input: Input,
    reader: Box<dyn Reader>,
    /// States whether a checksum is wanted, and the one that is being made since the first row.
    digested: bool,
    checksum: Option<Checksum>,
    block: Block,
    /// States whether its numbers are readings as they are, once that was looked at.
    ordinary: Option<bool>,
    /// Row of the block that is at hand, and whether there is one.
    at: usize,
    /// Rows of the blocks before.
    before: usize,
    begun: bool,
    ended: bool,
    /// Names of the columns, for messages.
    names: Vec<String>,
    /// Bits of the last row of the block before.
    bits: Vec<u64>,
    rounded: Vec<Option<usize>>,
    findings: Vec<Finding>,
}

impl Table {
    /// Rows of a reader whose columns bear these names; `findings` are those of the file.
    pub fn new(input: Input, reader: Box<dyn Reader>, names: Vec<String>, findings: Vec<Finding>) -> Self {
        let width = names.len();
        Self {
            digested: true,
            checksum: None,
            input,
            reader,
            block: Block::new(width),
            ordinary: None,
            at: 0,
            before: 0,
            begun: false,
            ended: false,
            rounded: vec![None; width],
            names,
            bits: Default::default(),
            findings,
        }
    }

    /// For a first look alone: without the checksum.
    pub fn without_checksum(&mut self) {
        self.digested = false;
    }

    /// Size of the file.
    pub fn length_bytes(&self) -> u64 {
        self.input.stored_length()
    }

    /// Returns how far it has been read.
    pub fn bytes_read(&self) -> u64 {
        self.reader.bytes_read()
    }

    /// Goes to the next row; false at the end.
    ///
    /// # Errors
    /// As the reader's.
    #[inline]
    pub fn advance(&mut self) -> Result<bool> {
        if self.begun && self.at + 1 < self.block.rows {
            self.at += 1;
            return Ok(true);
        }
        self.next_block()
    }

    /// Rows that follow, at most this many; none where the next one must be gone to by itself. The
    /// last of them is at hand then.
    pub fn run(&mut self, most: usize) -> Option<Run<'_>> {
        let next = self.at + 1;
        let end = self.block.rows.min(next.saturating_add(most));
        if !self.begun || end <= next || !*self.ordinary.get_or_insert_with(|| is_ordinary(&self.block)) {
            return None;
        }
        self.at = end - 1;
        let Block { stamps, columns, .. } = &self.block;
        Some(Run { first: self.before + next, rows: next..end, stamps, columns, alike: None })
    }

    #[cold]
    fn next_block(&mut self) -> Result<bool> {
        if self.ended {
            return Ok(false);
        }
        if self.begun && self.block.rows > 0 {
            self.keep_bits();
        }
        self.before += self.block.rows;
        if !std::mem::replace(&mut self.begun, true) && self.digested {
            self.checksum = Some(self.input.checksum());
        }
        loop {
            self.block.clear();
            if !self.reader.next(&mut self.block)? {
                (self.ended, self.at) = (true, 0);
                self.block.clear();
                return Ok(false);
            }
            if self.block.rows > 0 {
                break;
            }
        }
        (self.at, self.ordinary) = (0, None);
        for (known, found) in self.rounded.iter_mut().zip(&self.block.rounded) {
            *known = known.or(found.map(|row| self.before + row));
        }
        Ok(true)
    }

    /// The last row of a block, for the first one of the next.
    fn keep_bits(&mut self) {
        let last = self.block.rows - 1;
        self.bits.clear();
        self.bits.extend(self.block.columns.iter().map(|c| c.get(last).map_or(0, |v| v.to_bits())));
    }

    /// Number of the row at hand.
    pub fn row(&self) -> usize {
        self.before + self.at
    }

    /// Time stamp of the row at hand.
    pub fn stamp(&self) -> Stamp {
        self.block.stamps.get(self.at).copied().unwrap_or(Stamp::MISSING)
    }

    /// Returns whether the readings of the row at hand repeat the row before.
    pub fn is_alike(&self) -> bool {
        if self.row() == 0 || self.block.columns.is_empty() {
            return false;
        }
        match self.at.checked_sub(1) {
            Some(before) => self.block.columns.iter().all(|c| c[self.at].to_bits() == c[before].to_bits()),
            None => self.block.columns.iter().zip(&self.bits).all(|(c, b)| c[0].to_bits() == *b),
        }
    }

    /// Writes the row at hand into `values`; a missing reading is NaN.
    ///
    /// # Errors
    /// A number that is larger than any reading.
    #[inline]
    pub fn values(&self, values: &mut [f64]) -> Result<()> {
        for (index, (value, column)) in values.iter_mut().zip(&self.block.columns).enumerate() {
            *value = match format::reading(column[self.at]) {
                Cell::Number(number) => number,
                _ => return Err(self.too_large(index)),
            };
        }
        Ok(())
    }

    #[cold]
    fn too_large(&self, index: usize) -> Error {
        let (value, name) = (self.block.columns[index][self.at], &self.names[index]);
        self.input.fail(
            format!(
                "row {}, `{name}`: {value:e} is larger than any reading: its powers overflow double precision",
                self.row()
            ),
            "check the unit of the column, or use a stretch without it: --from-s, --to-s",
        )
    }

    /// Reads to the end.
    ///
    /// # Errors
    /// As [`Table::advance`].
    pub fn finish(mut self) -> Result<FileSummary> {
        loop {
            self.at = self.block.rows;
            if !self.advance()? {
                break;
            }
        }
        let mut dropped = self.reader.dropped();
        // Rows that are cut short stand behind all others.
        for lost in dropped.iter_mut().filter(|d| d.reason == Reason::CutShort) {
            lost.first_row = self.before;
        }
        let lost: usize = dropped.iter().map(|d| d.rows).sum();
        let mut findings = std::mem::take(&mut self.findings);
        findings.extend(self.reader.findings());
        for (name, row) in self.names.iter().zip(&self.rounded) {
            findings.extend(row.map(|first_row| Finding::BeyondDouble { column: name.clone(), first_row }));
        }
        let (sha256, length_bytes) = match self.checksum {
            Some(checksum) => checksum.finish(&self.input.path)?,
            None if self.digested => self.input.checksum().finish(&self.input.path)?,
            None => (String::new(), self.length_bytes()),
        };
        Ok(FileSummary { sha256, length_bytes, rows: self.before + lost, dropped, findings })
    }
}

/// Returns whether no number of a block is infinite, larger or smaller than any reading, or the
/// zero that has a sign.
fn is_ordinary(block: &Block) -> bool {
    block.columns.iter().all(|column| column.iter().all(|value| format::is_reading(*value)))
}
