//! Numbers that no IMU and no reference has: a fit that needs one has failed, whatever it explains.
//!
//! A term of the library has its range there; here stand the numbers that are fitted without being
//! judged. Not for numbers that are poorly known: those are left unstated (`published`).

use std::ops::Range;

use super::account::Absurd;
use super::judgement::{FALSE_NAME, Standing};
use super::parameters::{FORCE_BIAS, GYRO_BIAS, Point};
use super::scatter::Excess;
use super::selection::Selection;
use crate::units::DEGREE;

/// A term that is refused for its size is missed where it removes more of the error than this.
const MOST: f64 = 0.5;
/// An attitude that errs by more over a twentieth of a second is none: what an axis of a sensor may
/// be off at most, 10°.
const ERRS_RAD: f64 = 10.0 * DEGREE;

/// Biases, in SI: the widest of common datasheets.
const BIASES: [(Range<usize>, f64, &str, &str, &str); 2] = [
    (GYRO_BIAS, 30.0 * DEGREE, "rad/s", "a bias of the gyro", "LSM9DS1 datasheet: zero-rate level of ±30 °/s"),
    (FORCE_BIAS, 2.5, "m/s²", "a bias of the accelerometer", "ADXL345 datasheet: 0 g offset of ±250 mg"),
];

/// The largest bias that there is, SI, of parameters that are one.
pub(super) fn bias(p: usize) -> Option<f64> {
    BIASES.iter().find(|row| row.0.contains(&p)).map(|row| row.1)
}

/// Returns what a fitted model needs beyond what there is: biases at its point, an attitude of the
/// reference that errs, and where something is left unexplained, terms that were refused although
/// they would do most.
pub(super) fn absurd(
    point: &Point,
    erring: Option<Excess>,
    selection: &Selection,
    is_unexplained: bool,
) -> Vec<Absurd> {
    let biases = BIASES.into_iter().filter_map(|(range, most, unit, what, source)| {
        let value = range.map(|p| point[p].abs()).fold(0.0, f64::max);
        (value > most).then(|| Absurd { what: what.into(), value, most, unit, source })
    });
    let errs = erring.filter(|e| e.deviation > ERRS_RAD).map(|e| Absurd {
        what: "a reference whose attitudes err".into(),
        value: e.deviation,
        most: ERRS_RAD,
        unit: "rad",
        source: "the widest error of an axis, 10°",
    });
    let refused = |s: &&Standing| {
        !s.plausible && s.matters && s.p_value < FALSE_NAME && s.ci95[0] > MOST && s.largest > s.term.largest()
    };
    let terms = selection.others.iter().filter(|_| is_unexplained).filter(refused).map(|s| Absurd {
        what: s.term.phrase(),
        value: s.largest * s.term.unit.per_si,
        most: s.term.largest() * s.term.unit.per_si,
        unit: s.term.unit.name,
        source: "the library's range",
    });
    biases.chain(errs).chain(terms).collect()
}
