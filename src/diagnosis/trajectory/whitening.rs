//! Rows whose noise is coloured, made white by the autoregression that follows it (Cochrane &
//! Orcutt, JASA 1949).

use nalgebra::Vector3;

use super::colour::{Held, Lags};
use super::parameters::PARAMETERS;
use super::rows::Row;

/// An autoregression, the same along axes of one group, and the standard deviations of what it does
/// not predict.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Whitening {
    /// By axis, nearest row first.
    coefficients: [Vec<f64>; 3],
    /// Of each axis, in the unit of the rows.
    pub deviation: Vector3<f64>,
}

impl Whitening {
    /// From residuals at rows that can be used together so, with an order of at most `most`; axes of
    /// one group have one colour.
    pub(super) fn of(residual: &[Vector3<f64>], held: &Held, most: usize, groups: &[Vec<usize>]) -> Self {
        let lags = Lags::of(residual, held, most);
        let mut whitening = Self { coefficients: Default::default(), deviation: Vector3::zeros() };
        for group in groups {
            let (coefficients, variance) = lags.fitted(group);
            for axis in group {
                whitening.coefficients[*axis].clone_from(&coefficients);
                whitening.deviation[*axis] = variance[*axis].sqrt().max(f64::MIN_POSITIVE);
            }
        }
        // The coefficients need rows with all `most` lags in one part; the deviation can use every row
        // that has as many as were chosen.
        let usable = (0..residual.len()).filter(|k| held.back(*k, whitening.order()));
        let (sum, count) = usable.fold((Vector3::zeros(), 0.0), |(sum, count): (Vector3<f64>, f64), k| {
            let left = whitening.filtered(k, |n| residual[n]);
            (sum + left.component_mul(&left), count + 1.0)
        });
        if count > 0.0 {
            whitening.deviation = sum.map(|square| (square / count).sqrt().max(f64::MIN_POSITIVE));
        }
        whitening
    }

    fn order(&self) -> usize {
        self.coefficients.iter().map(Vec::len).max().unwrap_or_default()
    }

    fn filtered(&self, k: usize, of: impl Fn(usize) -> Vector3<f64>) -> Vector3<f64> {
        let at = of(k);
        Vector3::from_fn(|axis, _| {
            let predicted = self.coefficients[axis].iter().enumerate().map(|(i, a)| of(k - 1 - i)[axis] * *a);
            at[axis] - predicted.sum::<f64>()
        })
    }

    /// A row made white and in units of its deviation; none where something that it needs is
    /// missing.
    pub(super) fn white(&self, rows: &[Row], k: usize) -> Option<(Vector3<f64>, [Vector3<f64>; PARAMETERS])> {
        let order = self.order();
        (k >= order && rows[k - order..=k].iter().all(|r| r.holds)).then(|| {
            let weigh = |v: Vector3<f64>| v.component_div(&self.deviation);
            let slope = std::array::from_fn(|p| weigh(self.filtered(k, |n| rows[n].slope[p])));
            (weigh(self.filtered(k, |n| rows[n].residual)), slope)
        })
    }
}
