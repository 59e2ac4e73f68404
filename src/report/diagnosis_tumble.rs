//! Figures of a diagnosis: an IMU in many still poses.

use crate::diagnosis::tumble::Detail;

use super::diagnosis::Exhibit;

/// Its figures; one of them is the opening.
pub fn exhibits(_detail: &Detail) -> Vec<Exhibit> {
    Vec::new()
}
