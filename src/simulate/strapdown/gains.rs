//! A fix as the linear model applies it.

use nalgebra::SMatrix;

use super::linear::{Drive, Square};
use crate::kernel::aiding::{Fix, SEEN};

type Inputs = SMatrix<f64, 6, 6>;

/// Effect of a fix on errors x (attitude, velocity, position) and to what is taken off the inputs,
/// c.
#[derive(Debug, Clone)]
pub struct Gains {
    /// 1 − K H: what is left of x.
    pub kept: Square,
    /// G H: what c grows by.
    pub taken: SMatrix<f64, 6, 9>,
    /// K R Kᵀ.
    pub noise: Square,
    /// −K R Gᵀ.
    pub noise_with_taken: Drive,
    /// G R Gᵀ.
    pub noise_of_taken: Inputs,
}

impl Gains {
    /// Gains and covariances of one fix.
    pub fn of(fix: &Fix) -> Self {
        let of_errors = SMatrix::<f64, 9, SEEN>::from_fn(|row, k| fix.gain[row][k]);
        let of_taken = Inputs::from_fn(|row, k| fix.gain[9 + row][k]);
        let mut seen = SMatrix::<f64, SEEN, 9>::zeros();
        (0..SEEN).for_each(|k| seen[(k, 3 + k)] = 1.0);
        let variance = Inputs::from_diagonal(&fix.sd.map(|sd| sd.unwrap_or(0.0).powi(2)).into());
        Self {
            kept: Square::identity() - of_errors * seen,
            taken: of_taken * seen,
            noise: of_errors * variance * of_errors.transpose(),
            noise_with_taken: -(of_errors * variance * of_taken.transpose()),
            noise_of_taken: of_taken * variance * of_taken.transpose(),
        }
    }
}
