//! The page of a diagnosis: the verdict in plain words first, then where, how sure and at what cost, then the proof.
//!
//! The kinds give their figures as [`Exhibit`]s; this file decides the order of the page, the same for all kinds.

use crate::diagnosis::Detail;

use super::figure::Figure;
use super::{diagnosis_driven, diagnosis_static, diagnosis_tumble};

/// The part of the page a figure belongs to, in the page's order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// The one figure of the first screen: the mismatch, and that it goes away.
    Opening,
    /// Recording, base and repaired model on held-out data; residual before and after.
    Improvement,
    /// Where the mismatch lives.
    Isolation,
    /// How the parameters were found and how sure they are.
    Identification,
}

/// A figure of a diagnosis.
#[derive(Debug, Clone)]
pub struct Exhibit {
    /// Where on the page.
    pub part: Part,
    /// File name without ending, e.g. "held-out-overlay".
    pub name: String,
    /// The figure.
    pub figure: Figure,
    /// What it shows and what to see in it.
    pub caption: String,
}

/// The figures of any kind of diagnosis.
pub fn exhibits(detail: &Detail) -> Vec<Exhibit> {
    match detail {
        Detail::Driven(detail) => diagnosis_driven::exhibits(detail),
        Detail::Static(detail) => diagnosis_static::exhibits(detail),
        Detail::Tumble(detail) => diagnosis_tumble::exhibits(detail),
    }
}
