//! States what a motion does not determine: candidates that it tells nothing of, and elements of a named one.

use super::account::{Hidden, Manoeuvre};
use super::judgement::Standing;
use super::selection::Named;
use crate::sensor::Sense;

/// Half an interval over the smallest size that matters, beyond which the motion tells nothing of
/// it.
const WIDE: f64 = 10.0;

/// Says which numbers of a named term the motion does not determine, and that none is given for them.
pub(super) fn elements(named: &Named) -> Option<String> {
    let names = named.standing.undetermined();
    let phrase = named.standing.term.phrase();
    (!names.is_empty()).then(|| {
        format!("this motion does not determine {} of {phrase}, and no number is given for it", names.join(", "))
    })
}

/// A term whose interval is so wide that the recording says nothing of it.
pub(super) fn hidden(standing: &Standing) -> Option<Hidden> {
    let term = standing.term;
    let widest = term.size(standing.half_widths.iter().copied().fold(0.0, f64::max));
    (widest > WIDE * term.smallest).then(|| Hidden {
        term,
        half_width: widest * term.unit.per_si,
        manoeuvre: match (term.id(), term.sensor) {
            ("earth-rate", _) => Manoeuvre::Longer,
            ("lever-arm", _) => Manoeuvre::FigureEight,
            ("g-sensitivity", _) | (_, Some(Sense::Accelerometer)) => Manoeuvre::SixPositions,
            (_, Some(Sense::Gyro)) => Manoeuvre::TurnEveryAxis,
            _ => Manoeuvre::FigureEight,
        },
    })
}
