//! What Parquet stores in the pages of a column.

use crate::element::Element;

/// What to do about a file that is not whole.
pub(crate) const DAMAGED: &str = "the file is cut short or damaged: copy it again, or write it again";

/// How a value is stored in a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Physical {
    Number(Element),
    Bit,
    /// As a day and nanoseconds of it, in twelve bytes.
    Int96,
}
