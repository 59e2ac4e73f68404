//! Rows that follow one another and need no look one by one: column by column, as they lie in
//! memory.

use std::ops::Range;

use super::clock::stamp::Stamp;

/// Some rows of a piece of a file, all read; a missing number is NaN.
#[derive(Debug, Clone)]
pub struct Run<'a> {
    /// Number of the first row, counted from zero after the header.
    pub first: usize,
    /// States where they lie in the piece; never its first row, as [`Run::is_alike`] looks at the
    /// row before.
    pub rows: Range<usize>,
    /// Time stamps of the piece's rows; empty where no clock was chosen.
    pub stamps: &'a [Stamp],
    /// Per column chosen, the numbers of the piece's rows; a missing one is NaN.
    pub columns: &'a [Vec<f64>],
    /// States whether rows of the piece repeat the one before, where the text tells.
    pub alike: Option<&'a [bool]>,
}

impl Run<'_> {
    /// Time stamp of a row of the piece.
    #[inline]
    pub fn stamp(&self, row: usize) -> Stamp {
        self.stamps.get(row).copied().unwrap_or(Stamp::MISSING)
    }

    /// Returns whether a row of the piece repeats the one before in every cell but its time stamp.
    #[inline]
    pub fn is_alike(&self, row: usize) -> bool {
        match self.alike {
            Some(alike) => alike.get(row).is_some_and(|a| *a),
            None => {
                let same = |column: &Vec<f64>| column[row].to_bits() == column[row - 1].to_bits();
                !self.columns.is_empty() && self.columns.iter().all(same)
            }
        }
    }
}
