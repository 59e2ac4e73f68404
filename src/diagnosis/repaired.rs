//! DIR/repaired.toml, whatever the kind of recording: of one axis, or along the reference of a
//! motion.

use super::answer::Detail;
use super::repair::{self, Repair};
use super::verdict::Verdict;

/// The repaired sensor as a study; `None` where nothing that a study could run came out.
pub fn document(repair: Option<&Repair>, detail: &Detail, verdict: &Verdict) -> Option<String> {
    match detail {
        Detail::Trajectory(detail) => detail.repaired.as_ref().map(|sensor| sensor.document(verdict)),
        Detail::Driven(_) | Detail::Static(_) | Detail::Tumble(_) => {
            repair.map(|repair| repair::study_document(repair, verdict))
        }
    }
}
