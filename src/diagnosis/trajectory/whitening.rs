//! Rows whose noise is coloured, made white by the autoregression that follows it (Cochrane &
//! Orcutt, JASA 1949).

use nalgebra::Vector3;

use super::colour::Lags;
use super::parameters::PARAMETERS;
use super::rows::Row;

/// An autoregression, the same along each axis, and the standard deviations of what it does not
/// predict.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Whitening {
    coefficients: Vec<f64>,
    /// Of each axis, in the unit of the rows.
    pub deviation: Vector3<f64>,
}

impl Whitening {
    /// From residuals at the rows, with an order of at most `most`.
    pub(super) fn of(rows: &[Row], residual: &[Vector3<f64>], most: usize) -> Self {
        let holds: Vec<bool> = rows.iter().map(|r| r.holds).collect();
        let (coefficients, variance) = Lags::of(residual, &holds, most).fitted();
        Self { coefficients, deviation: variance.map(|v| v.sqrt().max(f64::MIN_POSITIVE)) }
    }

    fn filtered(&self, k: usize, of: impl Fn(usize) -> Vector3<f64>) -> Vector3<f64> {
        let predicted = self.coefficients.iter().enumerate().map(|(i, a)| of(k - 1 - i) * *a);
        of(k) - predicted.sum::<Vector3<f64>>()
    }

    /// A row made white and in units of its deviation; none where something that it needs is
    /// missing.
    pub(super) fn white(&self, rows: &[Row], k: usize) -> Option<(Vector3<f64>, [Vector3<f64>; PARAMETERS])> {
        let order = self.coefficients.len();
        (k >= order && rows[k - order..=k].iter().all(|r| r.holds)).then(|| {
            let weigh = |v: Vector3<f64>| v.component_div(&self.deviation);
            let slope = std::array::from_fn(|p| weigh(self.filtered(k, |n| rows[n].slope[p])));
            (weigh(self.filtered(k, |n| rows[n].residual)), slope)
        })
    }
}
