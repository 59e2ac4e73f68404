//! Figures of a diagnosis: input and output of one proof mass, or its free ring-down.

use crate::diagnosis::driven::Detail;

use super::diagnosis::Exhibit;

/// Its figures; one of them is the opening.
pub fn exhibits(_detail: &Detail) -> Vec<Exhibit> {
    Vec::new()
}
