//! Tells what a recording holds besides what it is compared by.

/// A channel that holds something besides that noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Besides {
    /// Heading of the column.
    pub channel: String,
    /// The thing itself.
    pub what: What,
}

/// Something that is no such noise.
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// Effects of the library, by id.
    Named(Vec<String>),
    /// Jumps of the bias, s from the first sample.
    Jumps(Vec<f64>),
    /// Something that no law of the library describes.
    Unnamed,
}
