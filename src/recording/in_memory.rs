//! A recording in memory: columns of one length on a uniform clock, and what is known of the file
//! they came from.

use std::ops::Range;
use std::path::PathBuf;

use super::dropped::Dropped;
use super::finding::{self, Finding};
use super::roles;

/// A named column in the recording's own unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Heading in the file.
    pub name: String,
    /// One value per row.
    pub values: Vec<f64>,
}

/// A recording in memory, on a uniform clock.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// States where it came from.
    pub path: PathBuf,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// Data rows in the file.
    pub rows: usize,
    /// Rows that were not used, and why.
    pub dropped: Vec<Dropped>,
    /// Data row of the first sample, counted from zero after the header.
    pub first_row: usize,
    /// The first sample that is held here, where `Request::samples` asked for a part.
    pub first_sample: usize,
    /// Sampling rate of the file, whether neighbours were averaged or not.
    pub rate_hz: f64,
    /// The columns asked for, all of the same length, without NaN.
    pub columns: Vec<Column>,
    /// Unit of each column where its file states it outside its heading, in brackets, or by its
    /// format; empty for columns that were never in a file.
    pub units: Vec<Option<String>>,
    /// Set where neighbouring samples were averaged as they were read.
    pub averaged: Option<Averaged>,
    /// Holds what was found and survived: gaps filled, rows dropped, rails touched.
    pub findings: Vec<Finding>,
    /// Samples that were not recorded but filled in some column, ascending; they may overlap.
    pub filled: Vec<Range<usize>>,
    /// The same by column; empty for columns that were never in a file.
    pub filled_by_column: Vec<Vec<Range<usize>>>,
}

/// Neighbouring samples that were averaged as they were read.
#[derive(Debug, Clone, PartialEq)]
pub struct Averaged {
    /// States how many became one.
    pub together: usize,
    /// Samples before averaging.
    pub samples: usize,
    /// Per column, the step that its numbers were rounded to before.
    pub steps: Vec<Option<f64>>,
}

impl Recording {
    /// Values of the column with this heading.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }

    /// Samples of the column with this heading that were not recorded but filled.
    pub fn filled_of(&self, name: &str) -> &[Range<usize>] {
        let place = self.columns.iter().position(|c| c.name == name);
        place.and_then(|place| self.filled_by_column.get(place)).map_or(&[], Vec::as_slice)
    }

    /// The unit that the file states for this column, beyond the last words of its heading.
    pub fn stated(&self, name: &str) -> Option<&str> {
        let place = self.columns.iter().position(|c| c.name == name)?;
        self.units.get(place)?.as_deref()
    }

    /// Words for the unit of this column, where file or heading states one.
    pub fn unit_words(&self, name: &str) -> Option<String> {
        roles::unit_words(name, self.stated(name))
    }

    /// Number of samples, before neighbours were averaged.
    pub fn samples(&self) -> usize {
        self.averaged.as_ref().map_or_else(|| self.columns.first().map_or(0, |c| c.values.len()), |a| a.samples)
    }

    /// Returns whether it is only a stretch of its file.
    pub fn is_part(&self) -> bool {
        use super::dropped::Reason::{BeyondGap, OutsideRows, OutsideSeconds};
        self.dropped.iter().any(|d| matches!(d.reason, BeyondGap | OutsideRows | OutsideSeconds))
    }

    /// Returns what was found, in sentences.
    pub fn sentences(&self) -> Vec<String> {
        finding::sentences(&self.findings)
    }
}
