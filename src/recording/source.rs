//! States what is known of a file once it has been read to its end.

use super::dropped::Dropped;
use super::finding::Finding;

/// Holds what is known of a file once it has been read to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct FileSummary {
    /// SHA-256 of all its bytes, hexadecimal.
    pub sha256: String,
    /// Size of the file, bytes.
    pub length_bytes: u64,
    /// Rows in the file, those cut short included.
    pub rows: usize,
    /// Rows that were not given.
    pub dropped: Vec<Dropped>,
    /// Holds what was found and survived.
    pub findings: Vec<Finding>,
}
