//! Rows whose noise is coloured, made white by the autoregression that follows it (Cochrane & Orcutt, JASA 1949).

use nalgebra::{DMatrix, DVector, Vector3};

use super::parameters::PARAMETERS;
use super::rows::Row;

/// Added to the diagonal, as a share of it: noise without a break in its spectrum has a finite order only nearly.
const RIDGE: f64 = 1e-6;

/// An autoregression, the same along each axis, and the deviations of what it cannot foretell.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitening {
    coefficients: Vec<f64>,
    /// Of each axis, in the unit of the rows.
    pub deviation: Vector3<f64>,
}

/// Whether a row and all before it that it is foretold from hold.
fn whole(rows: &[Row], k: usize, order: usize) -> bool {
    k >= order && rows[k - order..=k].iter().all(|r| r.holds)
}

impl Whitening {
    /// From residuals at the rows, by least squares, looking back so many of them.
    pub fn of(rows: &[Row], residual: &[Vector3<f64>], order: usize) -> Self {
        let order = order.min(rows.len() / 20);
        let mut matrix = DMatrix::zeros(order, order);
        let mut vector = DVector::zeros(order);
        for k in (0..rows.len()).filter(|k| whole(rows, *k, order)) {
            for i in 0..order {
                let at = residual[k - 1 - i];
                vector[i] += at.dot(&residual[k]);
                for j in 0..=i {
                    matrix[(i, j)] += at.dot(&residual[k - 1 - j]);
                }
            }
        }
        for i in 0..order {
            for j in 0..i {
                matrix[(j, i)] = matrix[(i, j)];
            }
            matrix[(i, i)] += RIDGE * matrix[(i, i)] + f64::MIN_POSITIVE;
        }
        let coefficients = matrix.cholesky().map_or(vec![0.0; order], |c| c.solve(&vector).as_slice().to_vec());
        let mut whitening = Self { coefficients, deviation: Vector3::repeat(1.0) };
        let left: Vec<Vector3<f64>> = (0..rows.len())
            .filter(|k| whole(rows, *k, order))
            .map(|k| whitening.filtered(k, |n| residual[n]))
            .collect();
        let squares: Vector3<f64> = left.iter().map(|r| r.component_mul(r)).sum();
        whitening.deviation = (squares / left.len().max(1) as f64).map(|s| s.sqrt().max(f64::MIN_POSITIVE));
        whitening
    }

    fn filtered(&self, k: usize, of: impl Fn(usize) -> Vector3<f64>) -> Vector3<f64> {
        let foretold = self.coefficients.iter().enumerate().map(|(i, a)| of(k - 1 - i) * *a);
        of(k) - foretold.sum::<Vector3<f64>>()
    }

    /// A row made white and in units of its deviation; none where something that it needs is missing.
    pub fn white(&self, rows: &[Row], k: usize) -> Option<(Vector3<f64>, [Vector3<f64>; PARAMETERS])> {
        whole(rows, k, self.coefficients.len()).then(|| {
            let weigh = |v: Vector3<f64>| v.component_div(&self.deviation);
            let slope = std::array::from_fn(|p| weigh(self.filtered(k, |n| rows[n].slope[p])));
            (weigh(self.filtered(k, |n| rows[n].residual)), slope)
        })
    }
}
