//! States what was named of the axes, by the keys that a study of six axes has for it.

use super::calibration::{Calibration, Triad, accelerometer, gyro};
use super::candidate::Term;
use crate::by_axis::{Drawn, over};
use crate::sensor::{SensorTerm, coupling};
use crate::units::key::Key;

/// Holds what a study does not hold of a term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lacking {
    /// It holds all of it.
    Nothing,
    /// The elements of a row apart: it draws each about the mean of the row with its spread.
    Elements,
    /// The temperature over time: what was recorded is none in °C.
    Temperature,
    /// The term as a whole.
    All,
}

/// Numbers of a key for x, y and z, SI.
pub(super) type Numbers = (&'static Key, [Drawn; 3]);

/// A named term by its key, and what that leaves out; the recorded column may be a temperature.
pub(super) fn of(term: &Term, calibration: &Calibration, is_warmth: bool) -> (Option<Numbers>, Lacking) {
    let [force, rate] = [&calibration.accelerometer, &calibration.gyro];
    let row = |term: SensorTerm| &term.row().keys[0];
    let first = term.parameters.first().cloned().unwrap_or_default();
    let (key, numbers) = match first {
        r if r == accelerometer::AXIS_SCALE => (row(SensorTerm::ScaleFactor), scales(force)),
        r if r == accelerometer::MISALIGNMENT => (&coupling::ACCELEROMETER_MISALIGNMENT, across(force)),
        r if r == accelerometer::QUADRATIC => {
            let fixed = |axis: usize| Drawn { mean: force.quadratic[axis], sd: 0.0 };
            return (Some((row(SensorTerm::Nonlinearity), [0, 1, 2].map(fixed))), Lacking::Nothing);
        }
        r if r == gyro::AXIS_SCALE => (&coupling::GYRO_SCALE_FACTOR, scales(rate)),
        r if r == gyro::MISALIGNMENT => (&coupling::GYRO_MISALIGNMENT, gyro_rows(calibration)),
        r if r == gyro::G_SENSITIVITY => {
            let row = |i: usize| over(&[0, 1, 2].map(|j| calibration.g_sensitivity[(i, j)]));
            (&coupling::G_SENSITIVITY, [0, 1, 2].map(row))
        }
        r if r == accelerometer::TEMPERATURE && is_warmth => (&coupling::ACCELEROMETER_BIAS_PER_K, per_kelvin(force)),
        r if r == gyro::TEMPERATURE && is_warmth => (&coupling::GYRO_BIAS_PER_K, per_kelvin(rate)),
        r if r == accelerometer::TEMPERATURE || r == gyro::TEMPERATURE => return (None, Lacking::Temperature),
        _ => return (None, Lacking::All),
    };
    (Some((key, numbers)), if is_spread(&numbers) { Lacking::Elements } else { Lacking::Nothing })
}

/// Change of the biases per kelvin.
fn per_kelvin(triad: &Triad) -> [Drawn; 3] {
    [0, 1, 2].map(|axis| Drawn { mean: triad.temperature[axis], sd: 0.0 })
}

/// Returns whether a row of it has elements that differ.
fn is_spread(numbers: &[Drawn; 3]) -> bool {
    numbers.iter().any(|row| row.sd != 0.0)
}

/// The gyro's rows where the accelerometer's misalignment alone was named: its axes are turned for
/// a study, and the gyro turns with them.
pub(super) fn turned_gyro(named: &[Numbers], calibration: &Calibration) -> Option<Numbers> {
    let has = |wanted: &Key| named.iter().any(|(key, _)| *key == wanted);
    let alone = has(&coupling::ACCELEROMETER_MISALIGNMENT) && !has(&coupling::GYRO_MISALIGNMENT);
    alone.then(|| (&coupling::GYRO_MISALIGNMENT, gyro_rows(calibration)))
}

/// The cubes next to the squares of a nonlinear accelerometer.
pub(super) fn cubes(named: &[Numbers], calibration: &Calibration) -> Option<Numbers> {
    let squares = &SensorTerm::Nonlinearity.row().keys[0];
    let fixed = |axis: usize| Drawn { mean: calibration.accelerometer.cubic[axis], sd: 0.0 };
    let has = named.iter().any(|(key, _)| *key == squares);
    has.then(|| (&SensorTerm::CubicNonlinearity.row().keys[0], [0, 1, 2].map(fixed)))
}

/// Scales of the axes over their mean, less one: the common scale is calibrated.
fn scales(triad: &Triad) -> [Drawn; 3] {
    let mean = triad.scale.mean();
    [0, 1, 2].map(|axis| Drawn { mean: triad.scale[axis] / mean - 1.0, sd: 0.0 })
}

/// The accelerometer's misalignment in a study's axes, of which x is exact; here it is z. To first
/// order the one goes over into the other by a turn, and what x reads of y, y reads of x.
fn across(triad: &Triad) -> [Drawn; 3] {
    let m = &triad.alignment;
    [Drawn::default(), over(&[m[(0, 1)]]), over(&[m[(0, 2)], m[(1, 2)]])]
}

/// The gyro's misalignment in the same axes.
fn gyro_rows(calibration: &Calibration) -> [Drawn; 3] {
    let (turned, m) = (&calibration.accelerometer.alignment, &calibration.gyro.alignment);
    let element = |i: usize, j: usize| m[(i, j)] + if i < j { -turned[(i, j)] } else { turned[(j, i)] };
    [0, 1, 2].map(|i| over(&[element(i, (i + 1) % 3), element(i, (i + 2) % 3)]))
}

#[cfg(test)]
mod tests {
    use super::super::calibration::PARAMETERS;
    use super::*;
    use nalgebra::{Matrix3, Rotation3, Vector3};

    /// Readings of one force by the fitted calibration and by what a study is given of it differ by
    /// a turn of the axes alone, to second order.
    #[test]
    fn a_study_reads_what_the_calibration_reads_in_turned_axes() {
        let mut p = [0.0; PARAMETERS];
        (p[accelerometer::SCALE.start], p[gyro::SCALE.start]) = (1.0, 1.0);
        p[accelerometer::MISALIGNMENT].copy_from_slice(&[2e-3, -1e-3, 3e-3]);
        p[gyro::MISALIGNMENT].copy_from_slice(&[1e-3, 4e-3, -2e-3, 5e-4, 3e-3, -1e-3]);
        let c = Calibration::from_point(&p);
        let turn = Rotation3::new(Vector3::new(-3e-3, -1e-3, -2e-3)).into_inner();
        let lower = c.accelerometer.alignment * turn.transpose();
        let is_lower = |m: &Matrix3<f64>| [(0, 1), (0, 2), (1, 2)].iter().all(|place| m[*place].abs() < 2e-5);
        // The control: turned the other way, it is not.
        assert!(is_lower(&lower) && !is_lower(&(c.accelerometer.alignment * turn)), "{lower}");
        let [x, y, z] = across(&c.accelerometer);
        assert_eq!((x, y.sd), (Drawn::default(), 0.0));
        assert!((y.mean - lower[(1, 0)]).abs() < 2e-5);
        assert!((z.mean - 0.5 * (lower[(2, 0)] + lower[(2, 1)])).abs() < 2e-5);
        let agrees = |rows: &[Drawn; 3], rates: Matrix3<f64>| {
            rows.iter().enumerate().all(|(i, row)| {
                let elements = over(&[rates[(i, (i + 1) % 3)], rates[(i, (i + 2) % 3)]]);
                (row.mean - elements.mean).abs() < 3e-5 && (row.sd - elements.sd).abs() < 3e-5
            })
        };
        let rows = gyro_rows(&c);
        assert!(agrees(&rows, c.gyro.alignment * turn.transpose()));
        assert!(!agrees(&rows, c.gyro.alignment * turn));
    }

    /// A gyro of which nothing was named turns with the accelerometer's axes: its rows are the turn
    /// itself. Named by itself, or next to an accelerometer of which nothing was, it needs no more.
    #[test]
    fn a_gyro_turns_with_the_axes_of_its_accelerometer() {
        let mut p = [0.0; PARAMETERS];
        (p[accelerometer::SCALE.start], p[gyro::SCALE.start]) = (1.0, 1.0);
        p[accelerometer::MISALIGNMENT].copy_from_slice(&[2e-3, -1e-3, 3e-3]);
        let c = Calibration::from_point(&p);
        let accelerometer = (&coupling::ACCELEROMETER_MISALIGNMENT, across(&c.accelerometer));
        let gyro = (&coupling::GYRO_MISALIGNMENT, gyro_rows(&c));
        let (key, rows) = turned_gyro(&[accelerometer], &c).expect("rows");
        assert!(*key == coupling::GYRO_MISALIGNMENT);
        // −xy and −xz; xy and −yz; xz and yz.
        let expected = [[-2e-3, 1e-3], [2e-3, -3e-3], [-1e-3, 3e-3]].map(|row| over(&row));
        for (row, expected) in rows.iter().zip(expected) {
            assert!((row.mean - expected.mean).abs() < 1e-12 && (row.sd - expected.sd).abs() < 1e-12);
        }
        assert!(turned_gyro(&[accelerometer, gyro], &c).is_none() && turned_gyro(&[gyro], &c).is_none());
        assert!(is_spread(&rows) && !is_spread(&scales(&c.gyro)));
    }
}
