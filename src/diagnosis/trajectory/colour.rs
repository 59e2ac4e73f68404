//! The colour of a residual: an autoregression whose order is chosen by how likely it makes
//! stretches that it was not fitted on.

use nalgebra::{DMatrix, DVector, Vector3};

/// Stretches of time, and into how many parts they are dealt.
const STRETCHES: usize = 20;
const FOLDS: usize = 5;
/// Added to the diagonal, as a fraction of it: noise without a break in its spectrum has a finite
/// order only nearly.
const RIDGE: f64 = 1e-6;

/// Which rows can be used together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Held {
    /// States whether each row has all that it needs.
    pub holds: Vec<bool>,
    /// The part of the recording that each row is of, in order: residuals of two parts do not go on
    /// into each other.
    pub part: Vec<usize>,
}

impl Held {
    /// Returns whether a row and this many before it can be used together.
    pub(super) fn back(&self, k: usize, order: usize) -> bool {
        k >= order && self.part[k - order] == self.part[k] && self.holds[k - order..=k].iter().all(|h| *h)
    }
}

/// Products of a residual with itself at every two lags, by stretch of time and by axis.
pub(super) struct Lags {
    products: Vec<[DMatrix<f64>; 3]>,
    count: Vec<f64>,
}

impl Lags {
    /// Of a residual, at lags up to `most`; rows that do not hold are not used, nor those whose
    /// lags reach one, or another part.
    pub(super) fn of(residual: &[Vector3<f64>], held: &Held, most: usize) -> Self {
        let most = most.min(residual.len() / 20);
        let empty = || std::array::from_fn(|_| DMatrix::zeros(most + 1, most + 1));
        let (mut products, mut count): (Vec<[DMatrix<f64>; 3]>, _) =
            ((0..STRETCHES).map(|_| empty()).collect(), vec![0.0; STRETCHES]);
        for k in (most..residual.len()).filter(|k| held.back(*k, most)) {
            let stretch = k * STRETCHES / residual.len();
            count[stretch] += 1.0;
            for (axis, products) in products[stretch].iter_mut().enumerate() {
                for i in 0..=most {
                    let at = residual[k - i][axis];
                    (0..=i).for_each(|j| products[(i, j)] += at * residual[k - j][axis]);
                }
            }
        }
        for products in products.iter_mut().flatten() {
            products.fill_upper_triangle_with_lower_triangle();
        }
        Self { products, count }
    }

    /// Products and number of rows of the stretches that are wanted.
    fn sum(&self, wanted: impl Fn(usize) -> bool) -> ([DMatrix<f64>; 3], f64) {
        let size = self.products[0][0].nrows();
        let mut sum = (std::array::from_fn(|_| DMatrix::zeros(size, size)), 0.0);
        for stretch in (0..STRETCHES).filter(|s| wanted(*s)) {
            let (products, count): &mut ([DMatrix<f64>; 3], f64) = &mut sum;
            products.iter_mut().zip(&self.products[stretch]).for_each(|(sum, p)| *sum += p);
            *count += self.count[stretch];
        }
        sum
    }

    /// Coefficients that some axes have in common, nearest row first, and variance of what they do
    /// not predict.
    ///
    /// The order is the one that makes held-out stretches most likely.
    pub(super) fn fitted(&self, axes: &[usize]) -> (Vec<f64>, Vector3<f64>) {
        let most = self.products[0][0].nrows() - 1;
        let scores: Vec<Vec<f64>> = (0..=most).map(|order| self.held_out(order, axes)).collect();
        let total = |order: &usize| scores[*order].iter().sum::<f64>();
        // The lowest of equal ones: where no row has that many before it, all of them are.
        let order = (0..=most).rev().max_by(|a, b| total(a).total_cmp(&total(b))).unwrap_or(0);
        let (products, count) = self.sum(|_| true);
        regression(&products, count, order, axes)
    }

    /// Logarithm of the likelihood of each stretch, by an autoregression fitted on other ones.
    fn held_out(&self, order: usize, axes: &[usize]) -> Vec<f64> {
        let mut scores = Vec::with_capacity(STRETCHES);
        for fold in 0..FOLDS {
            let (products, count) = self.sum(|s| s % FOLDS != fold);
            let (coefficients, variance) = regression(&products, count, order, axes);
            for stretch in (0..STRETCHES).filter(|s| s % FOLDS == fold && self.count[*s] > 0.0) {
                let axis = |axis: usize| {
                    let square = unpredicted(&self.products[stretch][axis], &coefficients);
                    -0.5 * (self.count[stretch] * variance[axis].ln() + square / variance[axis])
                };
                scores.push(axes.iter().copied().map(axis).sum());
            }
        }
        scores
    }
}

/// Least squares out of products, these axes with the same coefficients.
fn regression(products: &[DMatrix<f64>; 3], count: f64, order: usize, axes: &[usize]) -> (Vec<f64>, Vector3<f64>) {
    // Each axis by its own size, so that a loud one does not outweigh the others.
    let scale = Vector3::from_fn(|axis, _| products[axis][(0, 0)].max(f64::MIN_POSITIVE).recip());
    let sum = |i: usize, j: usize| axes.iter().map(|axis| products[*axis][(i, j)] * scale[*axis]).sum::<f64>();
    let ridge = |i: usize, j: usize| if i == j { 1.0 + RIDGE } else { 1.0 };
    let matrix = DMatrix::from_fn(order, order, |i, j| sum(i + 1, j + 1) * ridge(i, j));
    let vector = DVector::from_fn(order, |i, _| sum(i + 1, 0));
    let coefficients = matrix.cholesky().map_or(vec![0.0; order], |c| c.solve(&vector).as_slice().to_vec());
    let variance = Vector3::from_fn(|axis, _| {
        (unpredicted(&products[axis], &coefficients) / f64::max(count, 1.0)).max(f64::MIN_POSITIVE)
    });
    (coefficients, variance)
}

/// Sum of squares of what coefficients do not predict.
fn unpredicted(products: &DMatrix<f64>, coefficients: &[f64]) -> f64 {
    let weight = |i: usize| if i == 0 { 1.0 } else { -coefficients[i - 1] };
    let n = coefficients.len();
    (0..=n).map(|i| (0..=n).map(|j| weight(i) * weight(j) * products[(i, j)]).sum::<f64>()).sum::<f64>().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    #[test]
    fn an_autoregression_is_found_with_its_order_and_white_noise_has_none() {
        let mut random = Philox::new(2, 0, Stream::Host);
        let (mut coloured, mut white): (Vec<Vector3<f64>>, Vec<Vector3<f64>>) = (vec![Vector3::zeros(); 2], Vec::new());
        for k in 2..4000 {
            white.push(Vector3::from_fn(|i, _| [1.0, 5.0, 0.2][i] * random.normal()));
            coloured.push(coloured[k - 1] * 0.9 - coloured[k - 2] * 0.4 + white[k - 2]);
        }
        let held = |count: usize| Held { holds: vec![true; count], part: vec![0; count] };
        let (coefficients, variance) = Lags::of(&coloured, &held(4000), 10).fitted(&[0, 1, 2]);
        assert!((2..=4).contains(&coefficients.len()));
        // A coefficient's standard error is 1/√(3 · 4000) at most: four of them.
        assert!((coefficients[0] - 0.9).abs() < 0.036 && (coefficients[1] + 0.4).abs() < 0.036, "{coefficients:?}");
        assert!((variance[1] / 25.0 - 1.0).abs() < 0.1);
        assert!(Lags::of(&white, &held(3998), 10).fitted(&[0, 1, 2]).0.iter().all(|c| c.abs() < 0.036));
    }
}
