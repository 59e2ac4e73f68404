//! Bounds on the work that a file may ask for: bytes held and unpacked, values given, entries
//! visited.
//!
//! A few bytes can claim any number of rows, and tables that point at one another any number of
//! visits. Every reader charges what a file claims before it allocates or loops.

use super::input::Input;
use crate::error::{Error, Result};

/// No part of a file is larger when it is decompressed: files are read part by part, and one must
/// fit in memory.
pub const LARGEST_BYTES: u64 = 256 << 20;
/// Bytes that the parts of one file may hold at a time: pages and batches of all its columns.
const MOST_HELD_BYTES: u64 = 4 * LARGEST_BYTES;
/// Values of one page, or of one column in a batch: as doubles they fill the largest part.
pub(super) const MOST_VALUES: u64 = LARGEST_BYTES / 8;
/// Values that a file of any size may give.
const VALUES: u64 = 2 * MOST_VALUES;
/// Values that each of its bytes may stand for beyond those: what is packed best, runs of one
/// number in pages of a million, stays below by a factor of two.
const VALUES_PER_BYTE: u64 = 1 << 14;
/// Bytes of its description (names, fields, types, metadata) that are looked at, each as often as
/// something points to it.
const VISITS: u64 = 1 << 24;
/// States what an entry of such a description takes next to its name: an array, a topic, a column.
pub const ENTRY_BYTES: usize = 64;
/// Bytes that a file of any size may become when it is unpacked.
const HARMLESS_BYTES: u64 = 64 << 20;
/// No log shrinks to less than this part of its size; what does is made to exhaust a disk, or a
/// reader that meets one part again and again.
const MOST_EXPANSION: u64 = 1000;

/// Returns the bytes that so many of a file may become in all.
pub(super) fn most_unpacked(bytes: u64) -> u64 {
    HARMLESS_BYTES.saturating_add(bytes.saturating_mul(MOST_EXPANSION))
}

/// Work that a file has asked for.
#[derive(Debug, Clone)]
pub struct Budget {
    most_values: u64,
    values: u64,
    most_unpacked: u64,
    unpacked: u64,
    visits: u64,
}

/// More was asked for than a file may.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spent {
    what: &'static str,
    most: u64,
}

impl Budget {
    /// Returns the budget of a file of this length, bytes.
    pub fn of(length_bytes: u64) -> Self {
        let most_values = VALUES.saturating_add(length_bytes.saturating_mul(VALUES_PER_BYTE));
        Self { most_values, values: 0, most_unpacked: most_unpacked(length_bytes), unpacked: 0, visits: 0 }
    }

    /// Checks the bytes that are held once more are allocated.
    ///
    /// # Errors
    /// More than the parts of a file may hold at a time.
    pub fn held(&self, bytes: u64) -> Result<(), Spent> {
        charge(&mut 0, bytes, MOST_HELD_BYTES, "bytes in memory")
    }

    /// Charges rows of so many columns that one part claims to have.
    ///
    /// # Errors
    /// More than a part may have, or than the bytes of the file can stand for.
    pub fn rows(&mut self, count: u64, columns: usize) -> Result<(), Spent> {
        charge(&mut 0, count, MOST_VALUES, "values of a column in one part")?;
        charge(&mut self.values, count.saturating_mul(columns as u64), self.most_values, "values")
    }

    /// Charges bytes that are unpacked, or read once more.
    ///
    /// # Errors
    /// More than the bytes of the file can have been.
    pub fn unpacked(&mut self, bytes: u64) -> Result<(), Spent> {
        charge(&mut self.unpacked, bytes, self.most_unpacked, "bytes when it is unpacked")
    }

    /// Charges a look at an entry of the description of a file, by its bytes.
    ///
    /// # Errors
    /// More than any description needs.
    pub fn visit(&mut self, bytes: usize) -> Result<(), Spent> {
        charge(&mut self.visits, bytes as u64, VISITS, "bytes of description")
    }
}

fn charge(taken: &mut u64, asked: u64, most: u64, what: &'static str) -> Result<(), Spent> {
    *taken = taken.checked_add(asked).filter(|sum| *sum <= most).ok_or(Spent { what, most })?;
    Ok(())
}

impl Spent {
    /// Returns the cause in words.
    pub fn words(self) -> String {
        format!("it asks for more than {} {}, which no recording of its size needs", self.most, self.what)
    }

    /// Returns the error that names the file.
    pub fn of(self, input: &Input) -> Error {
        input.fail(
            self.words(),
            "it is damaged, or made to exhaust a reader: write the readings again, in parts of at most a million rows",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_beyond_the_budget_is_refused_and_not_charged() {
        let mut budget = Budget::of(100);
        assert!(budget.rows(MOST_VALUES + 1, 1).is_err() && budget.rows(u64::MAX, 2).is_err());
        assert!(budget.rows(MOST_VALUES, 3).is_err() && budget.rows(MOST_VALUES, 2).is_ok());
        assert!(budget.rows(100 * VALUES_PER_BYTE, 1).is_ok(), "its bytes stand for more");
        assert!(budget.rows(1, 1).is_err());
        assert!(budget.unpacked(u64::MAX).is_err() && budget.unpacked(HARMLESS_BYTES + 100 * MOST_EXPANSION).is_ok());
        assert!(budget.unpacked(1).is_err());
        assert!(budget.visit(VISITS as usize).is_ok() && budget.visit(1).is_err());
    }

    #[test]
    fn bytes_in_memory_have_one_bound_for_all_parts() {
        let budget = Budget::of(u64::MAX);
        assert!(budget.held(MOST_HELD_BYTES).is_ok() && budget.held(MOST_HELD_BYTES + 1).is_err());
    }
}
