//! States what every parameter does to a reading: the common part of all slopes.

use nalgebra::Vector3;

use super::calibration::{Calibration, DRIFT_TERMS, PARAMETERS, Point, Slow, Triad, accelerometer, gyro};
use super::imu::Pose;
use crate::sensor::Sense;

/// Which columns of the slope matrix are wanted.
pub struct Active<'a> {
    /// Column of each parameter, if it has one.
    pub column: [Option<usize>; PARAMETERS],
    /// Parameter of each column of the slope matrix.
    pub list: &'a [usize],
}

/// Calls `give(parameter, axis, φ)` for every parameter that moves axis i of the reading v by −φ.
pub(super) fn reading_slopes(
    sensor: Sense,
    triad: &Triad,
    scale: f64,
    counts: &Vector3<f64>,
    slow: &Slow,
    mut give: impl FnMut(usize, usize, f64),
) {
    let (offset, common, axis, quadratic, cubic, temperature, drift) = match sensor {
        Sense::Accelerometer => (
            accelerometer::OFFSET.start,
            accelerometer::SCALE.start,
            accelerometer::AXIS_SCALE.start,
            accelerometer::QUADRATIC.start,
            accelerometer::CUBIC.start,
            accelerometer::TEMPERATURE.start,
            accelerometer::DRIFT.start,
        ),
        Sense::Gyro => (
            gyro::OFFSET.start,
            gyro::SCALE.start,
            gyro::AXIS_SCALE.start,
            gyro::QUADRATIC.start,
            gyro::CUBIC.start,
            gyro::TEMPERATURE.start,
            gyro::DRIFT.start,
        ),
    };
    for i in 0..3 {
        let raw = (counts[i] - triad.offset[i]) / triad.scale[i];
        let (v, slope) = triad.straightened(i, triad.curved(i, counts[i], slow));
        let steep = 1.0 / slope;
        give(offset + i, i, steep / triad.scale[i]);
        give(common, i, steep * raw / scale);
        if i > 0 {
            give(axis + i - 1, i, steep * raw * scale / triad.scale[i]);
        }
        give(quadratic + i, i, steep * v * v);
        give(cubic + i, i, steep * v * v * v);
        give(temperature + i, i, steep * slow.covariate);
        for (n, cosine) in slow.cosines.iter().enumerate() {
            give(drift + DRIFT_TERMS * i + n, i, steep * cosine);
        }
    }
}

impl Active<'_> {
    /// From the list of parameters.
    pub fn new(list: &[usize]) -> Active<'_> {
        let mut column = [None; PARAMETERS];
        for (c, &p) in list.iter().enumerate() {
            column[p] = Some(c);
        }
        Active { column, list }
    }

    /// ∂f of a pose by every active parameter of the accelerometer: (column, ∂f).
    pub fn force_slopes(
        &self,
        point: &Point,
        calibration: &Calibration,
        pose: &Pose,
        force: &Vector3<f64>,
    ) -> Vec<(usize, Vector3<f64>)> {
        let triad = &calibration.accelerometer;
        let mut out: Vec<(usize, Vector3<f64>)> = Vec::new();
        let mut give = |parameter: usize, axis: usize, phi: f64| {
            if let Some(column) = self.column[parameter] {
                let change = triad.unalign().column(axis) * -phi;
                match out.iter_mut().find(|o| o.0 == column) {
                    Some(o) => o.1 += change,
                    None => out.push((column, change)),
                }
            }
        };
        reading_slopes(
            Sense::Accelerometer,
            triad,
            point[accelerometer::SCALE.start],
            &pose.accelerometer,
            &pose.slow,
            &mut give,
        );
        let m = accelerometer::MISALIGNMENT.start;
        give(m, 0, force[1]);
        give(m + 1, 0, force[2]);
        give(m + 2, 1, force[2]);
        out
    }
}
