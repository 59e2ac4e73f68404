//! Figures of a diagnosis: a sensor at rest: its noise and its drift.

use crate::diagnosis::fixed::Detail;

use super::diagnosis::Exhibit;

/// Its figures; one of them is the opening.
pub fn exhibits(_detail: &Detail) -> Vec<Exhibit> {
    Vec::new()
}
