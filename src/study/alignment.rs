//! How a run begins: ideal, drawn (six axes only: the attitude is wrong by draws, readings are as given), or with a still
//! start.
//!
//! During a still start the sensor stands still and level for the first seconds of each member's run, and the mean errors
//! over them are what the alignment believes to be zero:
//!
//! - the gyro's mean is taken for its bias and subtracted from then on;
//! - the accelerometer's mean is taken for tilt (levelling). Along one horizontal axis at rest, bias and tilt cannot be
//!   told apart: the attitude starts wrong by −mean/g, and the gravity that this tilt lets in hides the mean from then on.
//!   So the acceleration error starts from error − mean, and the tilt error from −mean/g.
//!
//! Velocity and position start at zero at its end, and times count from there; the excitation begins there, too.

use super::check::{refuse, whole};
use super::file::{self, AlignmentKind};
use crate::error::Result;

/// Longest still start, samples: what is left of the 2³² that a run may have is enough for the run.
const MOST_SAMPLES: f64 = 2e9;

/// How a run begins, checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alignment {
    /// Level, and with the biases that the study gives.
    Ideal,
    /// Bias and levelling from the mean of the first samples.
    Still {
        /// How many, at the study's sampling rate.
        samples: u64,
    },
}

impl Alignment {
    /// Samples of the still start; 0 without one.
    pub fn still_samples(self) -> u64 {
        match self {
            Self::Ideal => 0,
            Self::Still { samples } => samples,
        }
    }
}

/// Checks `[alignment]`.
///
/// # Errors
/// A still start without a length, or with one that is not a positive multiple of the sample period; a length without a
/// still start.
pub(super) fn alignment(
    name: &str,
    section: Option<&file::Alignment>,
    sample_s: f64,
    in_motion: bool,
) -> Result<Alignment> {
    let Some(section) = section else { return Ok(Alignment::Ideal) };
    let six = [("tilt_sd_deg", section.tilt_sd_deg), ("heading_sd_deg", section.heading_sd_deg)];
    if let Some((key, _)) = six.iter().find(|(_, given)| given.is_some()).filter(|_| !in_motion) {
        let cause = format!("`alignment.{key}` is given without a [trajectory]");
        return Err(refuse(
            name,
            cause,
            "a study of one axis has no heading: add a [trajectory], e.g. kind = \"rest\"",
        ));
    }
    for (key, given) in six {
        if given.is_some_and(|sd| !(sd >= 0.0 && sd.is_finite())) {
            let cause = format!("`alignment.{key}` = {:?}°: need zero or more", given.unwrap_or_default());
            return Err(refuse(name, cause, "give a standard deviation in degrees, e.g. 0.5"));
        }
    }
    let example = "e.g. kind = \"still\" and still_s = 10.0";
    match (section.kind, section.still_s) {
        (None, None) => {
            Err(refuse(name, "[alignment] is empty", format!("give its kind, {example}, or kind = \"ideal\"")))
        }
        (None, Some(_)) => {
            Err(refuse(name, "`alignment.still_s` is given without `kind`", format!("add kind = \"still\": {example}")))
        }
        (Some(AlignmentKind::Ideal | AlignmentKind::Drawn), Some(_)) => Err(refuse(
            name,
            "`alignment.still_s` belongs to kind = \"still\" only",
            "take it out, or use kind = \"still\"",
        )),
        (Some(AlignmentKind::Ideal), None) => Ok(Alignment::Ideal),
        (Some(AlignmentKind::Drawn), None) if in_motion => Ok(Alignment::Ideal),
        (Some(AlignmentKind::Drawn), None) => Err(refuse(
            name,
            "`alignment.kind` = \"drawn\" needs a [trajectory]",
            "a study of one axis begins ideal or with a still start",
        )),
        (Some(AlignmentKind::Still), None) => Err(refuse(
            name,
            "`alignment.still_s` is missing: kind = \"still\" needs the length of the still start",
            example,
        )),
        (Some(AlignmentKind::Still), Some(still_s)) if !(still_s > 0.0 && still_s.is_finite()) => Err(refuse(
            name,
            format!("`alignment.still_s` = {still_s:?} s: need more than zero"),
            "give the length of the still start in seconds, e.g. 10.0",
        )),
        (Some(AlignmentKind::Still), Some(still_s)) if still_s / sample_s > MOST_SAMPLES => Err(refuse(
            name,
            format!("`alignment.still_s` = {still_s:?} s has more than {MOST_SAMPLES:.0e} samples"),
            "shorten the still start: ten seconds to some minutes are usual",
        )),
        (Some(AlignmentKind::Still), Some(still_s)) => {
            let samples = whole(name, "still start", "sample period", still_s, sample_s)? as u64;
            Ok(Alignment::Still { samples })
        }
    }
}
