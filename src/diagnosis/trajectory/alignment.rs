//! Gyro and reference laid on each other although parts of either are wrong: one rotation, one
//! shift of the clocks, one bias, from whatever mounting.
//!
//! The shift is the one at which directions of rates go together best: vectors longer than is usual
//! count by their direction alone, so that a leap weighs no more than any other window, and the
//! rotation for each shift is that of Wahba's problem by a singular value decomposition (Markley,
//! JAS 36, 1988). From there the better half of the windows that turn is fitted again and again:
//! least trimmed squares by concentration steps (Rousseeuw & Van Driessen, 2006), which half of the
//! windows being wrong cannot move.

use nalgebra::{Matrix3, Vector3};

use super::rates::{Rates, SHIFTS_S};
use super::start::{nearest, refined};
use crate::numerics::order;

/// Fewest windows that tell anything.
const FEWEST: usize = 20;
/// A window turns where the gyro reads more than this part of its root mean square.
const TURNS: f64 = 0.5;
/// Concentration steps for a trial shift, and for the one that is taken.
const STEPS: [usize; 2] = [3, 10];

/// Holds what makes of the reference's rate the gyro's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Alignment {
    /// By how much the IMU stamps late, s.
    pub late_s: f64,
    /// From the reference's body axes to the gyro's.
    pub turned: Matrix3<f64>,
    /// Of the gyro, rad/s.
    pub bias: Vector3<f64>,
}

/// Rates of the reference and of the gyro over one window.
type Pair = (Vector3<f64>, Vector3<f64>);

impl Alignment {
    /// Found from some of the windows; none where hardly any can be compared.
    pub(super) fn of(rates: &Rates<'_>) -> Option<Self> {
        let pairs = |shift_s: f64| -> Vec<Pair> {
            rates.windows.iter().filter_map(|w| Some((w.rate, rates.read(w, shift_s)?))).collect()
        };
        let count = (SHIFTS_S.0 / SHIFTS_S.1) as i32;
        let shifts = (-count..=count).map(|k| f64::from(k) * SHIFTS_S.1);
        let all = shifts.map(|shift_s| (shift_s, directions(&pairs(shift_s))));
        let (shift_s, (_, turned)) = all.max_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
        let start = Self { late_s: shift_s, turned, bias: Vector3::zeros() };
        let left = |late_s: f64| Self { late_s, ..start }.concentrated(&pairs(late_s), STEPS[0]).1;
        let late_s = refined(shift_s, SHIFTS_S.1, |late_s| -left(late_s));
        let pairs = pairs(late_s);
        (turning(&pairs).len() >= FEWEST).then(|| Self { late_s, ..start }.concentrated(&pairs, STEPS[1]).0)
    }

    /// The rate that the gyro should read where the reference turns so, rad/s.
    pub(super) fn expected(&self, rate: &Vector3<f64>) -> Vector3<f64> {
        self.turned * rate + self.bias
    }

    /// Fitted to the half of the turning windows that it fits best, with the mean square that is
    /// left of them, as a part of theirs.
    fn concentrated(mut self, pairs: &[Pair], steps: usize) -> (Self, f64) {
        let turning = turning(pairs);
        let mut left = 1.0;
        for _ in 0..steps {
            let part = |(x, y): &Pair| (y - self.expected(x)).norm_squared() / y.norm_squared();
            let mut sorted: Vec<(f64, &Pair)> = turning.iter().map(|pair| (part(pair), *pair)).collect();
            order::sort_by_key(&mut sorted, |s| s.0);
            sorted.truncate(turning.len().div_ceil(2));
            let count = sorted.len().max(1) as f64;
            left = sorted.iter().map(|s| s.0).sum::<f64>() / count;
            let of = |sum: Matrix3<f64>, (_, (x, y)): &(f64, &Pair)| sum + (y - self.bias) * x.transpose();
            self.turned = nearest(&sorted.iter().fold(Matrix3::zeros(), of));
            let apart = |axis: usize| {
                order::median(sorted.iter().map(|(_, (x, y))| (y - self.turned * x)[axis]).collect())
                    .unwrap_or_default()
            };
            self.bias = Vector3::from_fn(|axis, _| apart(axis));
        }
        (self, left)
    }
}

/// Pairs in which the gyro turns.
pub(super) fn turning(pairs: &[Pair]) -> Vec<&Pair> {
    let square = pairs.iter().map(|(_, y)| y.norm_squared()).sum::<f64>() / pairs.len().max(1) as f64;
    let least = TURNS * square.sqrt();
    pairs.iter().filter(|(_, y)| y.norm() > least).collect()
}

/// Returns how well the directions of both go together in the best rotation, at most 1, and that
/// rotation.
fn directions(pairs: &[Pair]) -> (f64, Matrix3<f64>) {
    let usual = order::median(pairs.iter().map(|(_, y)| y.norm()).collect()).unwrap_or_default();
    let held = |v: &Vector3<f64>| v / v.norm().max(usual).max(f64::MIN_POSITIVE);
    let (mut products, mut squares) = (Matrix3::zeros(), [0.0, 0.0]);
    for (x, y) in pairs {
        let (x, y) = (held(x), held(y));
        products += y * x.transpose();
        squares[0] += x.norm_squared();
        squares[1] += y.norm_squared();
    }
    let turned = nearest(&products);
    let size = (squares[0] * squares[1]).sqrt().max(f64::MIN_POSITIVE);
    ((turned.transpose() * products).trace() / size, turned)
}
