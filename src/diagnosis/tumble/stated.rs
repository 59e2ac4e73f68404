//! Takes the units that a file states for its columns, unless what was read contradicts them: gravity of a length, or
//! turns of a size, that no sensor errs by.

use super::calibration::{Point, accelerometer, gyro};
use super::imu::Observed;
use crate::model;
use crate::number::short;
use crate::recording::Recording;
use crate::recording::roles::{self, Stated};
use crate::recording::unit::Unit;

/// Times by which readings in their stated unit may be too large or too small: sensors err by less, units differ by
/// more.
const MOST: f64 = 2.0;

/// Units of accelerometer and gyro, where the file states them.
pub(super) fn units(recording: &Recording, model: &model::Tumble) -> [Option<Unit>; 2] {
    let unit = |names: &[String; 3]| match roles::stated(&names[0], recording.stated(&names[0])) {
        Some(Stated::Inertial(unit)) => Some(unit),
        _ => None,
    };
    [unit(&model.columns.accelerometer), model.columns.gyro.as_ref().and_then(unit)]
}

/// Takes back each unit by which a first guess of the scales is far from one, and says so.
pub(super) fn contradicted(observed: &mut Observed<'_>, guess: &Point, units: &[Option<Unit>; 2]) -> Vec<String> {
    let read = ["gravity", "the turns between the poses"];
    let scales = [accelerometer::SCALE.start, gyro::SCALE.start];
    let mut findings = Vec::new();
    for (sense, unit) in units.iter().enumerate() {
        let Some(unit) = unit else { continue };
        let times = guess[scales[sense]] * unit.si;
        if (1.0 / MOST..MOST).contains(&times) {
            continue;
        }
        observed.told[sense] = None;
        findings.push(format!(
            "in `{}` {} would have {} times the size that is right: is `{}` the unit? It is taken for unknown",
            unit.name,
            read[sense],
            short(times),
            unit.name
        ));
    }
    findings
}
