//! Which directions of a parameter space a recording determines, before any estimate.
//!
//! The information matrix is scaled by the size that each parameter may have before anything is
//! recorded, so that its eigenvalues are pure numbers: n² says that the recording narrows that
//! direction to 1/n of its tolerance. (Identifiability by the spectrum of the Fisher information;
//! Hermann & Krener, IEEE Trans. Automatic Control 22 (1977) 728.)

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::numerics::order;

/// Knowledge of one parameter by a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Known {
    /// It is determined.
    Determined,
    /// Its interval is a good part of its tolerance.
    Weakly,
    /// The recording says hardly more than the tolerance does: no estimate is given.
    Not,
}

impl Known {
    /// By a standard error over the tolerance.
    pub(crate) fn by_error(over_tolerance: f64) -> Self {
        match over_tolerance {
            error if error.is_nan() || error > NOT => Self::Not,
            error if error > WEAKLY => Self::Weakly,
            _ => Self::Determined,
        }
    }
}

/// A direction of the parameter space that the recording does not determine.
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    /// Parameters in it with their weight, the heaviest first, each over its tolerance.
    pub parts: Vec<(usize, f64)>,
    /// Standard error along it over the tolerance; infinite where nothing tells of it.
    pub over_tolerance: f64,
}

/// Standard error over the tolerance from which a parameter is not determined. A tolerance is two to
/// three standard deviations of a batch of parts: an estimate as wide as one standard deviation
/// says no more than the data sheet.
const NOT: f64 = 1.0 / 3.0;
/// From which it is determined weakly: below, what the tolerance adds to the knowledge is a
/// hundredth.
pub(crate) const WEAKLY: f64 = 0.1;
/// Share of a direction's length below which a parameter is not said to be in it.
const IN_IT: f64 = 0.3;

/// The information of a recording, judged.
#[derive(Debug, Clone, PartialEq)]
pub struct Information {
    /// Knowledge of each parameter.
    pub known: Vec<Known>,
    /// Directions that it does not determine, worst first.
    pub undetermined: Vec<Direction>,
}

impl Information {
    /// Judges an information matrix (inverse squared units) by the tolerances of its parameters.
    pub fn of(information: &DMatrix<f64>, tolerance: &[f64]) -> Self {
        let count = tolerance.len();
        let scaled = DMatrix::from_fn(count, count, |i, j| information[(i, j)] * tolerance[i] * tolerance[j]);
        if scaled.iter().any(|v| !v.is_finite()) {
            return Self { known: vec![Known::Not; count], undetermined: Vec::new() };
        }
        let eigen = SymmetricEigen::new(scaled);
        // With the tolerance as what is known before: it bounds the variance of what nothing tells
        // of, and adds a hundredth to what is weakly determined.
        let variance = |i: usize| -> f64 {
            (0..count).map(|n| eigen.eigenvectors[(i, n)].powi(2) / (eigen.eigenvalues[n].max(0.0) + 1.0)).sum()
        };
        let bound = |ratio: f64| ratio * ratio / (1.0 + ratio * ratio);
        let known = |i: usize| match variance(i) {
            v if v > bound(NOT) => Known::Not,
            v if v > bound(WEAKLY) => Known::Weakly,
            _ => Known::Determined,
        };
        let mut undetermined: Vec<Direction> = (0..count)
            .filter(|n| eigen.eigenvalues[*n] < 1.0 / (NOT * NOT))
            .map(|n| Direction {
                parts: parts(&eigen.eigenvectors.column(n).into_owned()),
                over_tolerance: eigen.eigenvalues[n].max(0.0).sqrt().recip(),
            })
            .collect();
        order::sort_by_key(&mut undetermined, |d| -d.over_tolerance.min(f64::MAX));
        Self { known: (0..count).map(known).collect(), undetermined }
    }

    /// Notes what was not determined where the fit began: what was held there may seem determined.
    pub(crate) fn beside(&mut self, before: &Self) {
        self.known.iter_mut().zip(&before.known).for_each(|(now, then)| *now = (*now).max(*then));
        if self.undetermined.len() < before.undetermined.len() {
            self.undetermined.clone_from(&before.undetermined);
        }
    }

    /// The same without the parameters from this one on: what a fit needs and nobody asks for.
    pub(crate) fn without_from(&mut self, first: usize) {
        self.known.truncate(first);
        self.undetermined.iter_mut().for_each(|d| d.parts.retain(|(p, _)| *p < first));
        self.undetermined.retain(|d| !d.parts.is_empty());
    }
}

fn parts(direction: &DVector<f64>) -> Vec<(usize, f64)> {
    let mut out: Vec<(usize, f64)> =
        direction.iter().copied().enumerate().filter(|(_, weight)| weight.abs() > IN_IT).collect();
    order::sort_by_key(&mut out, |part| -part.1.abs());
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_that_is_told_and_a_difference_that_is_not_leave_both_terms_undetermined() {
        // Parameters 0 and 1 only as a sum, 2 well, 3 to a fifth of its tolerance.
        let mut information = DMatrix::zeros(4, 4);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            information[(i, j)] = 1e6;
        }
        (information[(2, 2)], information[(3, 3)]) = (1e6, 25.0 / 4.0);
        let found = Information::of(&information, &[1.0, 1.0, 1.0, 2.0]);
        assert_eq!(found.known, [Known::Not, Known::Not, Known::Determined, Known::Weakly]);
        assert_eq!(found.undetermined.len(), 1);
        let mut named: Vec<usize> = found.undetermined[0].parts.iter().map(|p| p.0).collect();
        named.sort_unstable();
        assert_eq!(named, [0, 1]);
        let broken = Information::of(&DMatrix::from_element(2, 2, f64::NAN), &[1.0, 1.0]);
        assert_eq!(broken.known, [Known::Not, Known::Not]);
    }
}
