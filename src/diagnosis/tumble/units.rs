//! Parameters as they are told: name, unit, and the factor from SI.

use super::calibration::{GYRO_OFF_DIAGONAL, accelerometer, gyro};
use crate::units::{DEGREE, DEGREE_PER_HOUR, STANDARD_GRAVITY_M_S2};

const AXES: [char; 3] = ['x', 'y', 'z'];

/// Returns what a parameter is multiplied by to stand in its public unit.
pub(crate) fn factor(parameter: usize) -> f64 {
    match parameter {
        p if gyro::G_SENSITIVITY.contains(&p) => STANDARD_GRAVITY_M_S2 / DEGREE,
        p if gyro::FRAME_RATE.contains(&p) => 1.0 / DEGREE_PER_HOUR,
        p if gyro::TEMPERATURE.contains(&p) => 1.0 / DEGREE,
        _ => 1.0,
    }
}

/// Name and unit of a parameter; `covariate` is the unit of τ.
pub(super) fn name_and_unit(parameter: usize, covariate: &str) -> (String, String) {
    let axis = |range: &std::ops::Range<usize>| AXES[(parameter - range.start) % 3];
    let off_diagonal = |(i, j): (usize, usize)| format!("m_{}{}", AXES[i], AXES[j]);
    match parameter {
        p if accelerometer::MISALIGNMENT.contains(&p) => {
            (off_diagonal([(0, 1), (0, 2), (1, 2)][p - accelerometer::MISALIGNMENT.start]), "rad".into())
        }
        p if gyro::MISALIGNMENT.contains(&p) => {
            (off_diagonal(GYRO_OFF_DIAGONAL[p - gyro::MISALIGNMENT.start]), "rad".into())
        }
        p if gyro::G_SENSITIVITY.contains(&p) => {
            let n = p - gyro::G_SENSITIVITY.start;
            (format!("k_{}{}", AXES[n / 3], AXES[n % 3]), "°/s/g".into())
        }
        p if accelerometer::QUADRATIC.contains(&p) => {
            (format!("k2_{}", axis(&accelerometer::QUADRATIC)), "1/(m/s^2)".into())
        }
        p if accelerometer::CUBIC.contains(&p) => (format!("k3_{}", axis(&accelerometer::CUBIC)), "1/(m/s^2)^2".into()),
        p if gyro::QUADRATIC.contains(&p) => (format!("k2_{}", axis(&gyro::QUADRATIC)), "1/(rad/s)".into()),
        p if gyro::CUBIC.contains(&p) => (format!("k3_{}", axis(&gyro::CUBIC)), "1/(rad/s)^2".into()),
        p if accelerometer::TEMPERATURE.contains(&p) => {
            (format!("c_{}", axis(&accelerometer::TEMPERATURE)), format!("m/s^2 per {covariate}"))
        }
        p if gyro::TEMPERATURE.contains(&p) => {
            (format!("c_{}", axis(&gyro::TEMPERATURE)), format!("°/s per {covariate}"))
        }
        p if gyro::FRAME_RATE.contains(&p) => (format!("omega_{}", axis(&gyro::FRAME_RATE)), "°/h".into()),
        p if accelerometer::OFFSET.contains(&p) => (format!("offset_{}", axis(&accelerometer::OFFSET)), "count".into()),
        p if gyro::OFFSET.contains(&p) => (format!("offset_{}", axis(&gyro::OFFSET)), "count".into()),
        _ => ("scale".into(), "count per unit".into()),
    }
}
