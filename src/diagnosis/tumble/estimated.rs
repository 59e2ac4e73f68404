//! The calibration as it is handed out: biases and matrices with their intervals, whatever the
//! verdict.
//!
//! It frees what nearly every unit has (offset, scale per axis, misalignment) next to whatever was
//! chosen, so that a number is not forced to zero because it was too small to be named, and comes
//! out also where something else is left out. There, leaving out poses in turn tells how the
//! numbers scatter and not how the law that is missing moves them; what each candidate of that
//! sensor would move them by is added to their intervals.

use nalgebra::{Matrix3, Vector3};

use super::calibration::{Calibration, Point, Triad};
use super::candidate::{Role, Term, terms};
use super::fit::Fit;
use super::group::Group;
use super::imu::Observed;
use super::jackknife::half_width;
use super::residual::Residual;
use crate::sensor::Sense;
use crate::verdict::{SensorCalibration, Triads};

/// Calibrations of both sensors; `None` where the poses do not determine them.
pub(crate) fn calibration(observed: &Observed<'_>, chosen: &Fit) -> Option<Triads> {
    let with_gyro = observed.imu.gyro.is_some();
    let usual = terms(with_gyro, false).into_iter().filter(|t| t.role == Role::EveryUnit).flat_map(|t| t.active());
    let mut active = chosen.active.clone();
    usual.for_each(|p| {
        if !active.contains(&p) {
            active.push(p);
        }
    });
    let full = Fit::balanced(observed, &chosen.point, &active);
    let fit = if full.determined { &full } else { chosen };
    if !fit.determined {
        return None;
    }
    let replicates = fit.replicates(observed.poses.len());
    let sensor = |sense: Sense, unit: &str| {
        let others = alternatives(observed, fit, sense);
        let number = |of: &dyn Fn(&Triad) -> f64| {
            let of = |p: &Point| of(triad(&Calibration::from_point(p), sense));
            let value = of(&fit.point);
            let moved = others.iter().map(|other| (of(other) - value).abs()).fold(0.0, f64::max);
            let half = half_width(&of, fit, &replicates).hypot(AS_MUCH_AGAIN * moved);
            (value, [value - half, value + half])
        };
        let entry = |i: usize, j: usize| number(&|t| matrix(t)[(i, j)]);
        let bias = std::array::from_fn::<_, 3, _>(|i| number(&|t| t.offset[i]));
        let entries = std::array::from_fn::<_, 3, _>(|i| std::array::from_fn::<_, 3, _>(|j| entry(i, j)));
        SensorCalibration {
            matrix: entries.map(|row| row.map(|e| e.0)),
            matrix_ci95: entries.map(|row| row.map(|e| e.1)),
            bias: bias.map(|b| b.0),
            bias_ci95: bias.map(|b| b.1),
            unit: unit.into(),
        }
    };
    Some(Triads {
        gyro: with_gyro.then(|| sensor(Sense::Gyro, "rad/s")),
        accelerometer: sensor(Sense::Accelerometer, "m/s^2"),
        leaves: left(fit, with_gyro),
    })
}

/// Ids of the candidates that a fit frees and that are neither bias nor matrix.
fn left(fit: &Fit, with_gyro: bool) -> Vec<&'static str> {
    let freed = |term: &&Term| term.role != Role::EveryUnit && term.active().all(|p| fit.active.contains(&p));
    let mut ids: Vec<&str> = terms(with_gyro, true).into_iter().filter(freed).map(Term::id).collect();
    ids.dedup();
    ids
}

/// States what a law outside the library moves a number by, over what the candidate nearest to it
/// does: the part of its course that the candidate does not follow moves it about as much again.
const AS_MUCH_AGAIN: f64 = 2.0;

/// The parameters with each candidate that acts on this sensor freed in turn; none where its
/// residual is noise.
fn alternatives(observed: &Observed<'_>, fit: &Fit, sense: Sense) -> Vec<Point> {
    let own = |group: Group| (group == Group::Gravity) == (sense == Sense::Accelerometer);
    if !Residual::of(fit).above.iter().any(|(group, _)| own(*group)) {
        return Vec::new();
    }
    let library = terms(observed.imu.gyro.is_some(), false).into_iter();
    let free = library.filter(|t| t.sensor == sense && t.active().any(|p| !fit.active.contains(&p)));
    let with = |term: &Term| {
        let mut active = fit.active.clone();
        active.extend(term.active().filter(|p| !fit.active.contains(p)));
        Fit::balanced(observed, &fit.point, &active)
    };
    free.map(with).filter(|f| f.determined).map(|f| f.point).collect()
}

fn triad(calibration: &Calibration, sense: Sense) -> &Triad {
    match sense {
        Sense::Accelerometer => &calibration.accelerometer,
        Sense::Gyro => &calibration.gyro,
    }
}

/// calibrated = matrix · (reading − bias), for what is linear in the reading.
fn matrix(triad: &Triad) -> Matrix3<f64> {
    triad.unalign() * Matrix3::from_diagonal(&Vector3::repeat(1.0).component_div(&triad.scale))
}
