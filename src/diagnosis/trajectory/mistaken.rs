//! Why readings do not agree with a reference of positions alone: what is usually mistaken is
//! tried, and where one of it makes them agree, the error names it.

use nalgebra::Vector3;

use super::course::Case;
use super::log::{Log, Motion};
use super::start_by_position::start;
use crate::control::{Control, Stopped};
use crate::units::DEGREE;

/// Holds what is wrong with readings or positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mistake {
    /// Specific force with the sign of an acceleration, or positions of a left-handed frame: an IMU
    /// that is turned over makes one of the other.
    Hand,
    /// Rates in degrees per second.
    Degrees,
    /// Positions whose third axis points the other way.
    Up,
}

/// Explained fraction from which a mistake is taken for the reason.
const EXPLAINS: f64 = 0.5;

/// The mistake that makes readings and positions go together, if one does.
///
/// # Errors
/// When stopped.
pub(super) fn mistake(case: &Case<'_>, control: &Control) -> Result<Option<Mistake>, Stopped> {
    let force = case.log.force.iter().map(|f| -f).collect();
    let rate = case.log.rate.iter().map(|w| w * DEGREE).collect();
    let over = |p: &Vector3<f64>| Vector3::new(p.x, -p.y, -p.z);
    let position = case.motion.position.iter().map(over).collect();
    let tried = [
        (Mistake::Hand, Log { force, ..case.log.clone() }, case.motion.clone()),
        (Mistake::Degrees, Log { rate, ..case.log.clone() }, case.motion.clone()),
        (Mistake::Up, case.log.clone(), Motion { position, ..case.motion.clone() }),
    ];
    let mut best = None;
    for (mistake, log, motion) in &tried {
        let explained = start(&Case { log, motion, ..*case }, control)?.start.explained;
        if explained > best.map_or(EXPLAINS, |(_, most)| most) {
            best = Some((*mistake, explained));
        }
    }
    Ok(best.map(|(mistake, _)| mistake))
}

impl Mistake {
    /// Returns what is wrong, and what to do.
    pub(super) fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Hand => (
                "the accelerometer agrees with the reference's positions only with its sign reversed, or with one axis of \
                 the positions mirrored",
                "negate its columns if they read -9.8 m/s² upwards at rest; else the positions are left-handed: negate \
                 one horizontal axis, or name them north, east, down or east, north, up",
            ),
            Self::Degrees => (
                "the gyro agrees with the reference's positions only if its readings are degrees per second",
                "head its columns with their unit, e.g. gx_deg_s",
            ),
            Self::Up => (
                "the positions agree with the accelerometer only if their up points down",
                "set up = \"-z\" (or \"z\") under [reference]",
            ),
        }
    }
}
