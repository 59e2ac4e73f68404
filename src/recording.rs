//! Recordings: columns of numbers from a CSV file, with what is wrong with them found and said.
//!
//! Not for judging physics: a gap or a clipped rail is reported here, what it means is `diagnosis`' business.

use std::path::PathBuf;

/// A named column in the recording's own unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Heading in the file.
    pub name: String,
    /// One value per row.
    pub values: Vec<f64>,
}

/// A recording in memory, on a uniform clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Where it came from.
    pub path: PathBuf,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// Sampling rate.
    pub rate_hz: f64,
    /// The columns asked for, all of the same length, without NaN.
    pub columns: Vec<Column>,
    /// What was found and survived, in words for the report: gaps filled, samples dropped, rails touched.
    pub findings: Vec<String>,
}

impl Recording {
    /// Values of the column with this heading.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.columns.first().map_or(0, |c| c.values.len())
    }
}
