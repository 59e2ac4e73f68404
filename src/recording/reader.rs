//! States what a format provides: the parts of a file (topics, messages, arrays), and the rows of
//! one of them in blocks.
//!
//! A format is one file under `formats` that implements [`Log`] and [`Reader`], and one line in the
//! registry there.

use std::fmt::Debug;

use super::clock::stamp::Stamp;
use super::dropped::Dropped;
use super::finding::Finding;
use crate::error::Result;

/// About how many rows a block holds.
pub const BLOCK_ROWS: usize = 4096;

/// A column as its file describes it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Heading {
    /// Name of the part, as the file states it.
    pub name: String,
    /// Its unit, as it is written there.
    pub unit: Option<String>,
    /// The format says that it holds the time.
    pub clock: bool,
    /// It is given where it is asked for by name alone.
    pub aside: bool,
}

impl Heading {
    /// A column of which only the name is known.
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// A column in a unit.
    pub fn in_unit(name: impl Into<String>, unit: &str) -> Self {
        Self { name: name.into(), unit: Some(unit.into()), ..Self::default() }
    }

    /// The clock, with its unit in brackets behind its name, where all clocks have it.
    pub fn clock(name: &str, unit: &str) -> Self {
        Self { name: format!("{name} [{unit}]"), unit: Some(unit.into()), clock: true, aside: false }
    }
}

/// Part of a file that is a table of its own.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Part {
    /// Topic, message or array; empty where the file is one table.
    pub name: String,
    /// Type of its messages, as the file calls it.
    pub kind: String,
    /// Rows, where the file states them.
    pub rows: Option<u64>,
    /// Columns of numbers; none where it cannot be read as any.
    pub columns: Vec<Heading>,
    /// It holds angular rates and specific forces.
    pub is_imu: bool,
}

/// Rows on their way.
#[derive(Debug, Clone, Default)]
pub struct Block {
    /// Rows held.
    pub rows: usize,
    /// A time stamp per row, where a clock was chosen.
    pub stamps: Vec<Stamp>,
    /// Per column chosen, a number per row; NaN where it is missing.
    pub columns: Vec<Vec<f64>>,
    /// Per column chosen, the first row of the block whose whole number a double had to round.
    pub rounded: Vec<Option<usize>>,
}

impl Block {
    /// Room for this many columns.
    pub fn new(columns: usize) -> Self {
        Self { columns: vec![Vec::new(); columns], rounded: vec![None; columns], ..Self::default() }
    }

    /// Removes all rows and keeps the memory.
    pub fn clear(&mut self) {
        self.rows = 0;
        self.stamps.clear();
        self.columns.iter_mut().for_each(Vec::clear);
        self.rounded.fill(None);
    }
}

/// Which columns are wanted, by their place among the headings.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Choice {
    /// Index of the time column.
    pub time: Option<usize>,
    /// Indices of the columns of readings.
    pub places: Vec<usize>,
}

/// A file whose parts are known.
pub trait Log: Debug + Send {
    /// Topics, messages or arrays of the file.
    fn parts(&self) -> &[Part];

    /// Returns what was found on the way and survived.
    fn findings(&self) -> Vec<Finding> {
        Vec::new()
    }

    /// Begins to read columns of a part.
    ///
    /// # Errors
    /// A part that holds no numbers, or that cannot be read.
    fn open(self: Box<Self>, part: usize, choice: &Choice) -> Result<Box<dyn Reader>>;
}

/// Rows of a part, block by block.
pub trait Reader: Debug + Send {
    /// Fills an empty block with the rows that follow; false at the end. A block of no rows is not
    /// the end.
    ///
    /// # Errors
    /// What is damaged, with what was expected and its place in the file.
    fn next(&mut self, block: &mut Block) -> Result<bool>;

    /// Returns how far the file was read, bytes.
    fn bytes_read(&self) -> u64;

    /// Rows that could not be given, counted among the rows of the file.
    fn dropped(&self) -> Vec<Dropped> {
        Vec::new()
    }

    /// Returns what was found and survived.
    fn findings(&self) -> Vec<Finding> {
        Vec::new()
    }
}
