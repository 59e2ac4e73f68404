//! The calibration as it is handed out: biases and matrices with their intervals, whatever the
//! verdict.
//!
//! It frees what nearly every unit has (offset, scale per axis, misalignment) beside whatever was
//! chosen, so that a number is not forced to zero because it was too small to be named, and comes
//! out also where something else is left out.

use nalgebra::{Matrix3, Vector3};

use super::calibration::{Calibration, Point, Triad};
use super::candidate::{Role, terms};
use super::fit::Fit;
use super::imu::Observed;
use super::jackknife::half_width;
use crate::diagnosis::verdict::{SensorCalibration, Triads};
use crate::sensor::Sense;

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
        let number = |of: &dyn Fn(&Triad) -> f64| {
            let of = |p: &Point| of(triad(&Calibration::from_point(p), sense));
            let (value, half) = (of(&fit.point), half_width(&of, fit, &replicates));
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
    })
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
