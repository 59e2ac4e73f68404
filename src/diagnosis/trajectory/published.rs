//! Numbers to be used whatever the verdict: calibrations of both sensors, clock and lever arm,
//! fitted next to all that is named so that none is forced to zero because it was too small to be
//! named.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::candidate;
use super::course::{accelerometer_matrix, gyro_matrix, vector};
use super::fitted::Fitted;
use super::log::Halves;
use super::mounted;
use super::parameters::{
    DELIVERED, DRIFT, FORCE_BIAS, FORCE_MATRIX, FORCE_PLACES, G_SENSITIVITY, GYRO_BIAS, GYRO_MISALIGNMENT,
    GYRO_OFF_DIAGONAL, GYRO_SCALE, LEVER_ARM, MOUNTING, OFFSET, Point, TILT,
};
use super::permutation::Permutation;
use super::selection::Selection;
use crate::units::DEGREE;
use crate::verdict::{Estimate, SensorCalibration, Triads};

/// States how well scale and axes are known where nothing shows them: what a sensor may have at most.
const HELD: f64 = 0.2;

/// Returns what nearly every unit has, next to a model: of the accelerometer's scale and axes what the motion shows
/// better than the sensor is delivered with, for the rest would go into its biases.
pub(super) fn usual(active: &[usize], selection: &Selection) -> Vec<usize> {
    let gyro = [OFFSET..OFFSET + 1, DRIFT..DRIFT + 1, GYRO_SCALE, GYRO_MISALIGNMENT];
    let arm = [LEVER_ARM].into_iter().filter(|arm| selection.judges(arm.start));
    let of_force = FORCE_MATRIX.filter(|p| selection.half_width(*p).is_some_and(|half| half < DELIVERED));
    let more = gyro.into_iter().chain(arm).flatten().chain(of_force);
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
pub(super) fn base(chosen: &Fitted, wide: &Fitted, turned: UnitQuaternion<f64>, widths: &Point) -> Vec<Estimate> {
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
fn of_gyro((row, column): (usize, usize)) -> Option<usize> {
    let at = |place: &(usize, usize)| *place == (row, column);
    Some(GYRO_OFF_DIAGONAL.iter().position(at).map_or(GYRO_SCALE.start + row, |n| GYRO_MISALIGNMENT.start + n))
}

/// That of the accelerometer's, whose axes are the body's: none above the diagonal.
fn of_accelerometer((row, column): (usize, usize)) -> Option<usize> {
    let at = |place: &(usize, usize)| *place == (row, column);
    FORCE_PLACES.iter().position(at).map(|n| FORCE_MATRIX.start + n)
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
    let matrix = |of: fn(&Point) -> Matrix3<f64>, place: fn((usize, usize)) -> Option<usize>, swap: Permutation| {
        let straight = swap.matrix().transpose();
        let calibrated = move |p: &Point| of(p).try_inverse().unwrap_or_else(Matrix3::identity) * straight;
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let (value, ci95) = wide.number(&|p: &Point| calibrated(p)[(i, j)]);
                let fitted = place((i, straight.column(j).iamax())).is_none_or(|p| wide.has(p));
                if fitted && ci95[1] - ci95[0] < 2.0 * HELD {
                    return (value, ci95);
                }
                (straight[(i, j)], [straight[(i, j)] - HELD, straight[(i, j)] + HELD])
            })
        })
    };
    wide.has(FORCE_BIAS.start).then(|| Triads {
        gyro: Some(sensor(matrix(gyro_matrix, of_gyro, swapped[0]), GYRO_BIAS.start, swapped[0], "rad/s")),
        accelerometer: sensor(
            matrix(accelerometer_matrix, of_accelerometer, swapped[1]),
            FORCE_BIAS.start,
            swapped[1],
            "m/s^2",
        ),
        leaves: [candidate::G_SENSITIVITY.id].into_iter().filter(|_| wide.has(G_SENSITIVITY.start)).collect(),
    })
}
