//! DIR/repaired.toml, whatever the kind of recording: of one axis, or along the reference of a
//! motion. There a navigator subtracts the constants that were calibrated, and DIR/uncorrected.toml
//! is the study of one that does not.

use super::answer::Detail;
use super::repair::{self, Repair};
use super::verdict::Verdict;

/// Returns the repaired sensor as a study; `None` where nothing that a study could run came out.
pub fn document(repair: Option<&Repair>, detail: &Detail, verdict: &Verdict) -> Option<String> {
    match detail {
        Detail::Trajectory(detail) => {
            detail.repaired.as_ref().map(|sensor| sensor.corrected().document(verdict, "repaired"))
        }
        Detail::Driven(_) | Detail::Static(_) | Detail::Tumble(_) | Detail::Response(_) => {
            repair.map(|repair| repair::study_document(repair, verdict))
        }
    }
}

/// Returns the sensor with its constants left in, as a study; `None` where a study corrects
/// nothing.
pub fn uncorrected(detail: &Detail, verdict: &Verdict) -> Option<String> {
    let Detail::Trajectory(detail) = detail else { return None };
    let sensor = detail.repaired.as_ref()?;
    (sensor.corrected() != *sensor).then(|| sensor.document(verdict, "uncorrected"))
}
