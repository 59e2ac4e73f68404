//! Numbers to be used whatever the verdict: calibrations of both sensors, clock and lever arm,
//! fitted next to all that is named so that none is forced to zero because it was too small to be
//! named.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::course::{accelerometer_matrix, gyro_matrix, vector};
use super::fitted::Fitted;
use super::log::Halves;
use super::mounted;
use super::parameters::{
    DRIFT, FORCE_BIAS, GYRO_BIAS, GYRO_MISALIGNMENT, GYRO_OFF_DIAGONAL, GYRO_SCALE, LEVER_ARM, MOUNTING, OFFSET, Point,
    TILT, widths,
};
use super::permutation::Permutation;
use super::selection::Selection;
use crate::units::DEGREE;
use crate::verdict::{Estimate, SensorCalibration, Triads};

/// States how well scale and axes are known where nothing shows them, the accelerometer's among them, which are held
/// or nearly so: what a sensor may have at most.
const HELD: f64 = 0.2;

/// Returns what nearly every unit has, next to a model.
pub(super) fn usual(active: &[usize], selection: &Selection) -> Vec<usize> {
    let gyro = [OFFSET..OFFSET + 1, DRIFT..DRIFT + 1, GYRO_SCALE, GYRO_MISALIGNMENT];
    let more = gyro.into_iter().chain([LEVER_ARM].into_iter().filter(|arm| selection.judges(arm.start))).flatten();
    let mut all = active.to_vec();
    more.for_each(|p| {
        if !all.contains(&p) {
            all.push(p);
        }
    });
    all
}

/// A model with clock and mounting free, which biases ought not to depend on; where the gyro's axes
/// are free, so is its mounting.
pub(super) fn seated(active: &[usize], halves: Halves) -> Vec<usize> {
    let misaligned = active.iter().any(|p| GYRO_MISALIGNMENT.contains(p));
    let mounting = MOUNTING.filter(|_| halves.attitude && !misaligned);
    let more = [OFFSET, DRIFT].into_iter().chain(mounting).filter(|p| !active.contains(p));
    active.iter().copied().chain(more).collect()
}

/// Numbers of the base model, and clock, mounting and lever arm of the wide one; those that are
/// known less well than before the recording are left out.
pub(super) fn base(chosen: &Fitted, wide: &Fitted, turned: UnitQuaternion<f64>) -> Vec<Estimate> {
    let widths = widths();
    let is_known = |p: usize, e: &Estimate, per_si: f64| e.ci95[1] - e.ci95[0] <= 2.0 * widths[p] * per_si;
    let mut all: Vec<Estimate> = Vec::new();
    let rows = [
        (chosen, GYRO_BIAS, ["gyro_bias_x", "gyro_bias_y", "gyro_bias_z"], "rad/s", 1.0),
        (chosen, FORCE_BIAS, ["accelerometer_bias_x", "accelerometer_bias_y", "accelerometer_bias_z"], "m/s^2", 1.0),
        (wide, LEVER_ARM, ["lever_arm_x", "lever_arm_y", "lever_arm_z"], "m", 1.0),
    ];
    for (fitted, range, names, unit, per_si) in rows {
        if range == LEVER_ARM && wide.has(MOUNTING.start) {
            let angles = mounted::angles(wide, turned, ["mounting_x", "mounting_y", "mounting_z"]);
            all.extend(MOUNTING.zip(angles).filter(|(p, e)| is_known(*p, e, 1.0 / DEGREE)).map(|(_, e)| e));
        }
        let there = range.zip(names).filter(|(p, _)| fitted.has(*p));
        all.extend(there.filter_map(|(p, name)| {
            let estimate = fitted.estimate(p, name, unit, per_si);
            is_known(p, &estimate, per_si).then_some(estimate)
        }));
    }
    for (p, name) in TILT.zip(["gravity_north", "gravity_east"]).filter(|(p, _)| chosen.has(*p)) {
        all.push(chosen.estimate(p, name, "m/s^2", 1.0));
    }
    for (p, name, unit, per_si) in [(OFFSET, "time_offset", "s", 1.0), (DRIFT, "clock_drift", "ppm", 1e6)] {
        all.extend(Some(wide.estimate(p, name, unit, per_si)).filter(|e| is_known(p, e, per_si)));
    }
    all
}

/// The parameter of an element of the gyro's matrix.
fn element(row: usize, column: usize) -> usize {
    let at = |place: &(usize, usize)| *place == (row, column);
    GYRO_OFF_DIAGONAL.iter().position(at).map_or(GYRO_SCALE.start + row, |n| GYRO_MISALIGNMENT.start + n)
}

/// calibrated = matrix · (reading − bias), in the axes that the columns ought to read.
pub(super) fn calibration(wide: &Fitted, swapped: [Permutation; 2]) -> Option<Triads> {
    let sensor = |entries: [[(f64, [f64; 2]); 3]; 3], bias_at: usize, swap: Permutation, unit: &str| {
        let bias = move |p: &Point| -> Vector3<f64> { swap.matrix() * vector(p, bias_at) };
        let biases: [(f64, [f64; 2]); 3] = std::array::from_fn(|i| wide.number(&|p: &Point| bias(p)[i]));
        SensorCalibration {
            matrix: entries.map(|row| row.map(|e| e.0)),
            matrix_ci95: entries.map(|row| row.map(|e| e.1)),
            bias: biases.map(|b| b.0),
            bias_ci95: biases.map(|b| b.1),
            unit: unit.into(),
        }
    };
    let gyro =
        |p: &Point| gyro_matrix(p).try_inverse().unwrap_or_else(Matrix3::identity) * swapped[0].matrix().transpose();
    let straight = swapped[0].matrix().transpose();
    let fitted = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let (value, ci95) = wide.number(&|p: &Point| gyro(p)[(i, j)]);
            let is_shown = wide.has(element(i, straight.column(j).iamax())) && ci95[1] - ci95[0] < 2.0 * HELD;
            if is_shown {
                (value, ci95)
            } else {
                (straight[(i, j)], [straight[(i, j)] - HELD, straight[(i, j)] + HELD])
            }
        })
    });
    let taken = swapped[1].matrix().transpose();
    let taken = accelerometer_matrix(&wide.point).try_inverse().unwrap_or_else(Matrix3::identity) * taken;
    let held = |i, j| (taken[(i, j)], [taken[(i, j)] - HELD, taken[(i, j)] + HELD]);
    let held = std::array::from_fn(|i| std::array::from_fn(|j| held(i, j)));
    wide.has(FORCE_BIAS.start).then(|| Triads {
        gyro: Some(sensor(fitted, GYRO_BIAS.start, swapped[0], "rad/s")),
        accelerometer: sensor(held, FORCE_BIAS.start, swapped[1], "m/s^2"),
    })
}
