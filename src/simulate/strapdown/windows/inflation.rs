//! The inflation that a motion justifies: how large the attitude error of the reference, white
//! noise and random walks would have to be for the recorded windows to be consistent, each by
//! itself.
//!
//! The covariance of a window's end error is a sum over causes, each with its own variance. The
//! variances of maximum likelihood are found by the multiplicative steps of Zhou, Hu, Zhou & Lange
//! (*MM algorithms for variance components models*, J. Comput. Graph. Stat. 28, 2019), which climb
//! and never leave zero or more. Intervals are of the profile likelihood.

use super::bias::Base;
use super::linear::{Kind, Linear, Part};
use super::predict::{Expected, Place, noise};
use super::window::Nine;
use crate::sensor::Sense;
use crate::strapdown::linear::Square;

/// A cause that is inflated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Attitude of the reference, rad, about each axis.
    Attitude,
    /// White noise N of an instrument, unit·√s.
    White(Sense),
    /// Random walk K of an instrument, unit/√s.
    Walk(Sense),
}

/// All causes, in the order of the table.
pub const CAUSES: [Cause; 5] = [
    Cause::Attitude,
    Cause::White(Sense::Gyro),
    Cause::Walk(Sense::Gyro),
    Cause::White(Sense::Accelerometer),
    Cause::Walk(Sense::Accelerometer),
];

/// The causes in one window, each with the coefficient one.
pub type Units = [Part; CAUSES.len()];

/// A window's end by cause.
#[derive(Debug, Clone, Copy)]
pub struct Split {
    /// Covariance per squared coefficient.
    pub units: [Square; CAUSES.len()],
    /// Sum of all other causes.
    pub rest: Expected,
}

/// Which flight the coefficients are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whose {
    /// The one that is compared.
    Own,
    /// Other flights, but for the attitude error of the reference: that is of windows of the one
    /// that is compared.
    OwnReference {
        /// Number of these windows.
        windows: usize,
    },
    /// Other flights, as the one that is compared has too few windows.
    Others,
}

/// Inflation that fits the windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inflation {
    /// Coefficients of the [`CAUSES`], SI.
    pub coefficients: [f64; CAUSES.len()],
    /// 95 % intervals of them; the upper end is infinite where nothing bounds it.
    pub interval: [[f64; 2]; CAUSES.len()],
    /// Windows that it was fitted on.
    pub windows: usize,
    /// Which flight the coefficients are of.
    pub whose: Whose,
}

/// The causes in a window.
pub fn units(linear: &Linear) -> Units {
    CAUSES.map(|cause| match cause {
        Cause::Attitude => linear.attitude_part([1.0; 3]),
        Cause::White(sense) => linear.unit(Kind::White, sense),
        Cause::Walk(sense) => linear.unit(Kind::Walk, sense),
    })
}

/// The same with what the biases taken off bring; `in_bases` has the causes in each base.
pub fn split(place: &Place<'_>, in_bases: &[Units], rest: Expected) -> Split {
    let own = units(place.linear);
    let unit = |cause: usize| {
        noise(place, &own[cause], |base| match &in_bases[base][cause] {
            Part::Noise { end, .. } => **end,
            Part::Constant { .. } => Square::zeros(),
        })
    };
    Split { units: std::array::from_fn(unit), rest }
}

/// The causes in every base.
pub fn in_bases(bases: &[Base]) -> Vec<Units> {
    bases.iter().map(|base| units(&base.linear)).collect()
}

impl Split {
    /// The end with these squared coefficients.
    pub fn expected(&self, squares: &[f64; CAUSES.len()]) -> Expected {
        let mut all = self.rest;
        self.units.iter().zip(squares).for_each(|(unit, square)| all.covariance += unit * *square);
        all
    }
}

/// Windows and their recorded ends.
pub type Recorded = [(Nine, Split)];

/// Least spread of ends, m, m/s and rad: below, numbers are rounding.
const FLOOR: [f64; 3] = [1e-4, 1e-4, 1e-5];
/// Steps of a search, and of one within a profile.
const STEPS: [usize; 2] = [1000, 150];
/// Half of χ²'s 95 % with one degree of freedom.
pub(super) const DROP: f64 = 1.920_729;
/// Coefficients below this share of what alone would explain everything are zero.
const NOTHING: f64 = 1e-3;
/// Fewest windows from which an inflation is estimated.
pub const FEWEST: usize = 4;

/// Finds the coefficients; `None` for too few windows.
pub fn fit(windows: &Recorded) -> Option<Inflation> {
    if windows.len() < FEWEST {
        return None;
    }
    let alone = alone(windows);
    let free = [true; CAUSES.len()];
    let best = climb(windows, alone.map(|s| s / CAUSES.len() as f64), free, STEPS[0]);
    let most = likelihood(windows, &best);
    let interval = std::array::from_fn(|cause| profile(windows, (cause, best, most), alone[cause]));
    let coefficient = |cause: usize| match best[cause] > (NOTHING * NOTHING) * alone[cause] {
        true => best[cause].sqrt(),
        false => 0.0,
    };
    Some(Inflation {
        coefficients: std::array::from_fn(coefficient),
        interval,
        windows: windows.len(),
        whose: Whose::Own,
    })
}

/// The squared coefficient with which each cause alone would make that error as large as recorded
/// which it makes best.
fn alone(windows: &Recorded) -> [f64; CAUSES.len()] {
    std::array::from_fn(|cause| {
        let ratio = |i: usize| -> f64 {
            let recorded: f64 = windows.iter().map(|(error, split)| (error[i] - split.rest.mean[i]).powi(2)).sum();
            let unit: f64 = windows.iter().map(|(_, split)| split.units[cause][(i, i)]).sum();
            if unit > 0.0 { recorded / unit } else { f64::INFINITY }
        };
        // Far more than is needed would leave matrices that cannot be inverted.
        (0..9).map(ratio).fold(f64::INFINITY, f64::min)
    })
}

/// Covariance of a window's end and its root.
fn root(split: &Split, squares: &[f64; CAUSES.len()]) -> Option<nalgebra::Cholesky<f64, nalgebra::Const<9>>> {
    let floor = Square::from_diagonal(&Nine::from_fn(|i, _| FLOOR[i / 3].powi(2)));
    (split.expected(squares).covariance + floor).cholesky()
}

/// Logarithm of the likelihood, but for a constant.
pub(super) fn likelihood(windows: &Recorded, squares: &[f64; CAUSES.len()]) -> f64 {
    let one = |(error, split): &(Nine, Split)| {
        let Some(root) = root(split, squares) else { return f64::NEG_INFINITY };
        let off = error - split.rest.mean;
        -0.5 * (root.ln_determinant() + off.dot(&root.solve(&off)))
    };
    windows.iter().map(one).sum()
}

/// The most likely squared coefficients of those that are free.
fn climb(
    windows: &Recorded,
    mut squares: [f64; CAUSES.len()],
    free: [bool; CAUSES.len()],
    steps: usize,
) -> [f64; CAUSES.len()] {
    for _ in 0..steps {
        let mut sums = [[0.0; 2]; CAUSES.len()];
        for (error, split) in windows {
            let Some(root) = root(split, &squares) else { continue };
            let weighted = root.solve(&(error - split.rest.mean));
            let inverse = root.inverse();
            for (sum, unit) in sums.iter_mut().zip(&split.units) {
                sum[0] += weighted.dot(&(unit * weighted));
                sum[1] += inverse.component_mul(unit).sum();
            }
        }
        for cause in (0..CAUSES.len()).filter(|cause| free[*cause]) {
            let [found, expected] = sums[cause];
            if expected > 0.0 {
                squares[cause] *= (found / expected).max(0.0).sqrt();
            }
        }
    }
    squares
}

/// The ends of a coefficient's interval, the others at their best for each value.
fn profile(windows: &Recorded, (cause, best, most): (usize, [f64; CAUSES.len()], f64), alone: f64) -> [f64; 2] {
    let mut free = [true; CAUSES.len()];
    free[cause] = false;
    let drop = |square: f64| {
        let mut start = best;
        // A cause that the best has none of comes back slowly by factors.
        start.iter_mut().for_each(|s| *s = s.max(1e-12));
        start[cause] = square;
        most - likelihood(windows, &climb(windows, start, free, STEPS[1])) - DROP
    };
    let least = alone * NOTHING * NOTHING;
    let middle = best[cause].max(least);
    let between = |mut inside: f64, mut outside: f64| {
        for _ in 0..12 {
            let half = (inside * outside).sqrt();
            if drop(half) > 0.0 { outside = half } else { inside = half }
        }
        (inside * outside).sqrt().sqrt()
    };
    let low = if drop(least) > 0.0 && middle > least { between(middle, least) } else { 0.0 };
    let beyond = 1e4 * alone.max(middle);
    let high = if drop(beyond) > 0.0 { between(middle, beyond) } else { f64::INFINITY };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// Windows of a diagonal model with two causes that the others do not hide.
    fn windows(count: u64, coefficients: [f64; 5]) -> Vec<(Nine, Split)> {
        let unit = |cause: usize| Square::from_diagonal(&Nine::from_fn(|i, _| if i % 5 == cause { 1.0 } else { 0.01 }));
        let split = Split {
            units: std::array::from_fn(unit),
            rest: Expected { mean: Nine::zeros(), covariance: Square::zeros() },
        };
        let covariance = split.expected(&coefficients.map(|c| c * c)).covariance;
        let one = |k| {
            let mut draw = Philox::new(3, k, Stream::Start);
            Nine::from_fn(|i, _| covariance[(i, i)].sqrt() * draw.normal())
        };
        (0..count).map(|k| (one(k), split)).collect()
    }

    #[test]
    fn what_was_drawn_is_found_within_its_interval() {
        let truth = [2.0, 0.5, 3.0, 1.0, 0.2];
        let found = fit(&windows(200, truth)).expect("windows enough");
        for (cause, truth) in truth.into_iter().enumerate() {
            let [low, high] = found.interval[cause];
            // Five intervals of 95 %, widened by a fifth.
            assert!(low / 1.2 < truth && truth < high * 1.2, "{cause}: {truth} not in {low}..{high}");
            assert!(low <= found.coefficients[cause] && found.coefficients[cause] <= high);
        }
        // 400 squares of the first cause: its standard error is 1/√800 = 3.5 %.
        assert!((found.coefficients[0] / 2.0 - 1.0).abs() < 0.18, "{found:?}");
        assert!(found.interval[0][1] < 2.0 * 1.3 && found.interval[0][0] > 2.0 / 1.3);
        // Three times the drawn size is outside.
        assert!(found.interval[0][1] < 6.0);
        assert!(fit(&windows(2, truth)).is_none());
    }
}
