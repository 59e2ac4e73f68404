//! What Parquet stores in the pages of a column.

use crate::recording::element::Element;

/// What to do about a file that is not whole.
pub const DAMAGED: &str = "the file is cut short or damaged: copy it again, or write it again";

/// How a value is stored in a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Physical {
    /// As a number.
    Number(Element),
    /// As a bit.
    Bit,
    /// As a day and nanoseconds of it, in twelve bytes.
    Int96,
}
