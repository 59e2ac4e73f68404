//! Selects the part of a pose that is wanted: a reference may know attitude alone, or position
//! alone.

/// One half of a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Position of the body.
    Position,
    /// Attitude of the body.
    Attitude,
}

/// Part of each pose that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// Both, and neither may be missing.
    Both,
    /// Whatever the file has.
    Any,
    /// One of them, whatever else the file has.
    Only(Part),
}

impl Wanted {
    /// Returns whether a part is read where it is there.
    pub(super) fn takes(self, part: Part) -> bool {
        !matches!(self, Self::Only(other) if other != part)
    }

    /// Returns whether a file without it is refused.
    pub(super) fn needs(self, part: Part) -> bool {
        self == Self::Both || self == Self::Only(part)
    }
}
