//! The full linear model of a calibration in still poses: what it fits, what a user calls it, and
//! how large each parameter may be before anything is recorded.

use nalgebra::{DMatrix, Vector3};

use super::calibration::{GYRO_OFF_DIAGONAL, Point, accelerometer, gyro};
use super::fit::{Beforehand, CONING_PRIOR};
use super::rows::Rows;
use crate::repeatability::information::{Information, Known};
use crate::repeatability::parameter::{Element, Parameter, Role};
use crate::sensor::Sense;
use crate::units::{DEGREE, STANDARD_GRAVITY_M_S2};

/// Plausible sizes before a recording: the largest that the data sheet of a common consumer part
/// allows (MPU-6050 Product Specification 3.4: zero-g output ±50 mg, zero-rate output ±20 °/s,
/// scale ±3 %, cross-axis ±2 %, linear acceleration sensitivity 0.1 °/s/g).
const BIAS: [f64; 2] = [0.05 * STANDARD_GRAVITY_M_S2, 20.0 * DEGREE];
const SCALE: f64 = 0.03;
const CROSS_AXIS: f64 = 0.02;
const G_SENSITIVITY: f64 = 0.1 * DEGREE / STANDARD_GRAVITY_M_S2;
/// Factor by which what is known beforehand is wider in the fit: a part that is out of its data
/// sheet is not drawn back to it.
const WIDER: f64 = 3.0;
/// The same of what the recording does not determine: it stays where it was guessed, and bends
/// nothing else.
const HELD: f64 = 1e-3;

const ACCELEROMETER_OFF_DIAGONAL: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// Places of one sensor's parameters among those fitted.
struct Places {
    sensor: Sense,
    offset: usize,
    scale: usize,
    axis_scale: usize,
}

const PLACES: [Places; 2] = [
    Places {
        sensor: Sense::Accelerometer,
        offset: accelerometer::OFFSET.start,
        scale: accelerometer::SCALE.start,
        axis_scale: accelerometer::AXIS_SCALE.start,
    },
    Places {
        sensor: Sense::Gyro,
        offset: gyro::OFFSET.start,
        scale: gyro::SCALE.start,
        axis_scale: gyro::AXIS_SCALE.start,
    },
];

/// The model of an accelerometer, or of one next to a gyro.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Linear {
    /// Indices of what is fitted: the accelerometer's, then the gyro's, its coning last.
    pub active: Vec<usize>,
    /// Factor from each sensor's readings to SI units; `None` where the file states no unit.
    pub told: [Option<f64>; 2],
}

impl Linear {
    pub(super) fn new(with_gyro: bool, told: [Option<f64>; 2]) -> Self {
        let force = accelerometer::OFFSET.chain(accelerometer::SCALE).chain(accelerometer::AXIS_SCALE);
        let rate = gyro::OFFSET.chain(gyro::SCALE).chain(gyro::AXIS_SCALE).chain(gyro::MISALIGNMENT);
        let rate = rate.chain(gyro::G_SENSITIVITY).chain(gyro::CONING).filter(|_| with_gyro);
        Self { active: force.chain(accelerometer::MISALIGNMENT).chain(rate).collect(), told }
    }

    /// Number of parameters that are told: how a gyro's filter shapes a turn is none of them.
    pub(super) fn told_of(&self) -> usize {
        self.active.iter().filter(|p| !gyro::CONING.contains(p)).count()
    }

    /// Returns what each is, in the order of those fitted.
    pub(super) fn parameters(&self) -> Vec<Parameter> {
        self.active[..self.told_of()].iter().map(|p| parameter(*p, self.told)).collect()
    }

    /// Knowledge beforehand of those fitted, of the size that a first guess gives and about a point; what is
    /// not determined is held there.
    pub(super) fn beforehand(&self, guess: &Point, about: &Point, known: &[Known]) -> Vec<Beforehand> {
        let of = |(n, p): (usize, &usize)| {
            let wide = if known.get(n) == Some(&Known::Not) { HELD } else { WIDER };
            let deviation = if gyro::CONING.contains(p) { CONING_PRIOR } else { wide * as_fitted(*p, guess) };
            Beforehand { parameter: *p, centre: about[*p], deviation }
        };
        self.active.iter().enumerate().map(of).collect()
    }

    /// Plausible sizes of the public parameters, the coning coefficient last.
    pub(super) fn tolerance(&self, guess: &Point) -> Vec<f64> {
        let of = |p: &usize| {
            let sense = usize::from(*p >= gyro::OFFSET.start);
            let told = self.told[sense].unwrap_or(1.0);
            match *p {
                p if gyro::CONING.contains(&p) => CONING_PRIOR,
                p if PLACES.iter().any(|at| (at.axis_scale..at.axis_scale + 2).contains(&p)) => {
                    SCALE * guess[PLACES[sense].scale].abs() * told
                }
                p if is_reading(p) => as_fitted(p, guess) * told,
                p => as_fitted(p, guess),
            }
        };
        self.active.iter().map(of).collect()
    }

    /// Values that are told, from a fitted point.
    pub(super) fn values(&self, point: &Point) -> Vec<f64> {
        let value = |p: &usize| {
            let sense = usize::from(*p >= gyro::OFFSET.start);
            let told = self.told[sense].unwrap_or(1.0);
            let at = &PLACES[sense];
            match *p {
                p if (at.axis_scale..at.axis_scale + 2).contains(&p) => point[at.scale] * (1.0 + point[p]) * told,
                p if is_reading(p) => point[p] * told,
                p => point[p],
            }
        };
        self.active[..self.told_of()].iter().map(value).collect()
    }

    /// Computes the information on the public parameters at a point, the coning coefficient last; `variance`:
    /// factor on each row's variance.
    pub(super) fn information_matrix(&self, rows: &Rows, at: &Point, variance: &[f64]) -> DMatrix<f64> {
        let count = self.active.len();
        let back = self.slopes(at).try_inverse().unwrap_or_else(|| DMatrix::from_element(count, count, f64::NAN));
        back.transpose() * rows.information(variance) * &back
    }

    /// Judges that information.
    pub(super) fn information(&self, rows: &Rows, at: &Point, guess: &Point, variance: &[f64]) -> Information {
        let mut information = Information::of(&self.information_matrix(rows, at, variance), &self.tolerance(guess));
        information.without_from(self.told_of());
        information
    }

    /// Computes the derivatives of the public parameters (rows, coning last) by the fitted ones
    /// (columns).
    pub(super) fn slopes(&self, point: &Point) -> DMatrix<f64> {
        let count = self.active.len();
        let place = |p: usize| self.active.iter().position(|a| *a == p);
        let mut out = DMatrix::identity(count, count);
        for (sense, at) in PLACES.iter().enumerate() {
            let told = self.told[sense].unwrap_or(1.0);
            let (Some(offset), Some(common)) = (place(at.offset), place(at.scale)) else { continue };
            (0..3).for_each(|i| out[(offset + i, offset + i)] = told);
            out[(common, common)] = told;
            for ratio in [at.axis_scale, at.axis_scale + 1] {
                let Some(row) = place(ratio) else { continue };
                out[(row, common)] = told * (1.0 + point[ratio]);
                out[(row, row)] = told * point[at.scale];
            }
        }
        out
    }
}

/// Returns whether it is stated in units of the reading.
fn is_reading(p: usize) -> bool {
    PLACES.iter().any(|at| (at.offset..at.offset + 3).contains(&p) || p == at.scale)
}

/// Plausible size of a parameter as it is fitted.
fn as_fitted(p: usize, guess: &Point) -> f64 {
    let sense = usize::from(p >= gyro::OFFSET.start);
    let scale = guess[PLACES[sense].scale].abs();
    match p {
        p if p == PLACES[sense].scale => SCALE * scale,
        p if is_reading(p) => BIAS[sense] * scale,
        p if (PLACES[sense].axis_scale..PLACES[sense].axis_scale + 2).contains(&p) => SCALE,
        p if gyro::G_SENSITIVITY.contains(&p) => G_SENSITIVITY,
        _ => CROSS_AXIS,
    }
}

fn parameter(p: usize, told: [Option<f64>; 2]) -> Parameter {
    let sense = usize::from(p >= gyro::OFFSET.start);
    let at = &PLACES[sense];
    let of = |role, axis, of| {
        Parameter::Element(Element { sensor: at.sensor, role, axis, of, is_si: told[sense].is_some() })
    };
    match p {
        p if (at.offset..at.offset + 3).contains(&p) => of(Role::Bias, p - at.offset, None),
        p if p == at.scale => of(Role::Scale, 0, None),
        p if (at.axis_scale..at.axis_scale + 2).contains(&p) => of(Role::Scale, 1 + p - at.axis_scale, None),
        p if accelerometer::MISALIGNMENT.contains(&p) => {
            let (i, j) = ACCELEROMETER_OFF_DIAGONAL[p - accelerometer::MISALIGNMENT.start];
            of(Role::Misalignment, i, Some(j))
        }
        p if gyro::MISALIGNMENT.contains(&p) => {
            let (i, j) = GYRO_OFF_DIAGONAL[p - gyro::MISALIGNMENT.start];
            of(Role::Misalignment, i, Some(j))
        }
        p => {
            let n = p.saturating_sub(gyro::G_SENSITIVITY.start).min(8);
            of(Role::GSensitivity, n / 3, Some(n % 3))
        }
    }
}

/// Unit vector of gravity's components, as shares.
pub(super) fn shares(force: &Vector3<f64>) -> Vector3<f64> {
    force / force.norm().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tumble::calibration::PARAMETERS;

    #[test]
    fn slopes_of_what_is_told_are_those_of_its_values() {
        let linear = Linear::new(true, [None, Some(0.5)]);
        let mut point: Point = [0.0; PARAMETERS];
        (0..PARAMETERS).for_each(|p| point[p] = 0.3 + 0.01 * p as f64);
        let slopes = linear.slopes(&point);
        for (column, p) in linear.active.iter().enumerate() {
            let at = |by: f64| {
                let mut moved = point;
                moved[*p] += by;
                linear.values(&moved)
            };
            for (row, (up, down)) in at(1e-6).iter().zip(at(-1e-6)).enumerate() {
                assert!(((up - down) / 2e-6 - slopes[(row, column)]).abs() < 1e-8, "{row} {column}");
            }
        }
        assert_eq!(linear.parameters().len(), 30);
        assert_eq!(linear.tolerance(&point).len(), 31);
    }
}
