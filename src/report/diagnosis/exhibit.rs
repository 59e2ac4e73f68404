//! A figure of a diagnosis and the part of the page that it belongs to.

use crate::figure::Figure;

/// The part of the page a figure belongs to, in the page's order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// The one figure of the first screen: the mismatch, and that it goes away.
    Opening,
    /// Recording, base and repaired model on held-out data; residual before and after.
    Improvement,
    /// Location of the mismatch.
    Isolation,
    /// Says how the parameters were found and how sure they are.
    Identification,
}

/// A figure of a diagnosis.
#[derive(Debug, Clone)]
pub struct Exhibit {
    /// Part of the page that it belongs to.
    pub part: Part,
    /// File name without ending, e.g. "held-out-overlay".
    pub name: String,
    /// The figure with its data.
    pub figure: Figure,
    /// Caption: what the figure shows.
    pub caption: String,
}
