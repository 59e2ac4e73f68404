//! Start of a run: ideal, drawn, or with a still start.
//!
//! A drawn tilt is normal about level and stays. Along one axis it lets in its share of gravity, a
//! constant acceleration error; in six axes the attitude begins wrong by it, and by a drawn
//! heading.
//!
//! During a still start the sensor stands still and level for the first seconds of each member's
//! run, and the mean errors over them are what the alignment believes to be zero:
//!
//! - the gyro's mean is taken for its bias and subtracted from then on;
//! - the accelerometer's mean is taken for tilt (levelling). Along one horizontal axis at rest,
//!   bias and tilt cannot be told apart: the attitude starts wrong by −mean/g, and the gravity that
//!   this tilt lets in hides the mean from then on. So the acceleration error starts from error −
//!   mean, and the tilt error from −mean/g.
//!
//! Velocity and position start at zero at its end, and times count from there; the excitation
//! begins there, too.

use super::check::whole;
use super::file::{self, AlignmentKind};
use super::refusal::refuse;
use crate::error::Result;
use crate::units::number::Number;

/// Longest still start, samples: what is left of the 2³² that a run may have is enough for the run.
const MOST_SAMPLES: f64 = 2e9;

/// Initial alignment, checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alignment {
    /// With the biases that the study gives: level, or tilted as drawn.
    Ideal,
    /// Bias and levelling from the mean of the first samples.
    Still {
        /// Number of them, at the study's sampling rate.
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

/// The tilt that a member begins with, °, where it is drawn.
///
/// # Errors
/// `kind = "drawn"` without a standard deviation, or one without it.
pub(super) fn tilt(name: &str, section: Option<&file::Alignment>) -> Result<Option<Number>> {
    let Some(section) = section else { return Ok(None) };
    let drawn = section.kind == Some(AlignmentKind::Drawn);
    let example = "e.g. kind = \"drawn\" and tilt_sd_deg = 0.2";
    match section.tilt_sd_deg {
        Some(_) if !drawn => {
            Err(refuse(name, "`alignment.tilt_sd_deg` belongs to kind = \"drawn\"", format!("use {example}")))
        }
        None if drawn => Err(refuse(
            name,
            "`alignment.tilt_sd_deg` is missing: kind = \"drawn\" needs the standard deviation of the tilt",
            example,
        )),
        sd => Ok(sd.map(|sd| Number::Normal { mean: 0.0, sd })),
    }
}

/// Checks `[alignment]`.
///
/// # Errors
/// A still start without a length, or with one that is not a positive multiple of the sample
/// period; a length without a still start.
pub(super) fn alignment(
    name: &str,
    section: Option<&file::Alignment>,
    sample_s: f64,
    in_motion: bool,
) -> Result<Alignment> {
    let Some(section) = section else { return Ok(Alignment::Ideal) };
    let spreads = [("tilt_sd_deg", section.tilt_sd_deg), ("heading_sd_deg", section.heading_sd_deg)];
    if section.heading_sd_deg.is_some() && !in_motion {
        return Err(refuse(
            name,
            "`alignment.heading_sd_deg` is given without a [trajectory], and a study of one axis has no heading",
            "remove it, or add a [trajectory], e.g. kind = \"rest\"",
        ));
    }
    for (key, given) in spreads {
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
        (Some(kind @ (AlignmentKind::Ideal | AlignmentKind::Drawn)), Some(_)) => Err(refuse(
            name,
            match kind {
                AlignmentKind::Drawn => "`alignment.still_s` does not belong to kind = \"drawn\"",
                _ => "`alignment.still_s` does not belong to kind = \"ideal\"",
            },
            "remove it, or use kind = \"still\"",
        )),
        (Some(AlignmentKind::Ideal | AlignmentKind::Drawn), None) => Ok(Alignment::Ideal),
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
