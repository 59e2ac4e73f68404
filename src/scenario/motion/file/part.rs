//! What of a pose is wanted: a reference may know attitude alone, or position alone.

/// One half of a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Where the body is.
    Position,
    /// How it is turned.
    Attitude,
}

/// What of each pose is read.
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
    /// Whether a part is read where it is there.
    pub(super) fn takes(self, part: Part) -> bool {
        !matches!(self, Self::Only(other) if other != part)
    }

    /// Whether a file without it is refused.
    pub(super) fn needs(self, part: Part) -> bool {
        self == Self::Both || self == Self::Only(part)
    }
}
