//! States what Parquet stores in the pages of a column.

use crate::element::Element;

/// States what to do about a file that is not whole.
pub(crate) const DAMAGED: &str = "the file is cut short or damaged: copy it again, or write it again";

/// States how a value is stored in a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Physical {
    Number(Element),
    Bit,
    /// A day and nanoseconds of it, in twelve bytes.
    Int96,
}

impl Physical {
    /// Returns the bytes that a value takes where it is stored as it is.
    pub(crate) fn stored_bytes(self) -> usize {
        match self {
            Self::Number(element) => element.bytes,
            Self::Bit => 1,
            Self::Int96 => 12,
        }
    }
}
