//! Columns of a Parquet table side by side, handed on row by row of all.

use super::column::{BLOCK, Column, Held, damaged};
use super::physical::DAMAGED;
use crate::budget::Budget;
use crate::error::Result;
use crate::input::Input;
use crate::reader::{Block, Reader};

/// Columns side by side.
#[derive(Debug)]
pub(super) struct Columns {
    input: Input,
    columns: Vec<Column>,
    budget: Budget,
    bytes_read: u64,
}

impl Columns {
    /// At their first row.
    pub(super) fn new(input: Input, columns: Vec<Column>) -> Self {
        let budget = Budget::of(input.length());
        Self { input, columns, budget, bytes_read: 0 }
    }
}

impl Reader for Columns {
    fn next(&mut self, block: &mut Block) -> Result<bool> {
        let mut held: u64 = self.columns.iter().map(Column::held).sum();
        for column in &mut self.columns {
            let before = column.at;
            let by_others = held - column.held();
            column.load(&self.input, Held { budget: &mut self.budget, by_others })?;
            held = by_others + column.held();
            self.bytes_read += column.at.saturating_sub(before);
        }
        let waiting = || self.columns.iter().map(Column::waiting);
        let count = waiting().min().unwrap_or(0).min(BLOCK);
        if count == 0 {
            return match waiting().max() {
                Some(0) | None => Ok(false),
                Some(_) => Err(self.input.fail("expected columns of one length, found a shorter one", DAMAGED)),
            };
        }
        for column in &mut self.columns {
            let (page_at, encoding) = column.place();
            column.give(count, block).ok_or_else(|| damaged(&self.input, page_at, encoding))?;
        }
        block.rows = count;
        Ok(true)
    }

    fn bytes_read(&self) -> u64 {
        self.bytes_read.min(self.input.length())
    }
}
