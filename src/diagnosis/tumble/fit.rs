//! Least squares over poses and moves together (Levenberg–Marquardt), with whole poses left out at no extra cost.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::calibration::Point;
use super::group::Group;
use super::imu::Observed;
use super::rows::Rows;

/// A fitted set of parameters.
#[derive(Debug, Clone)]
pub struct Fit {
    /// All parameters; those not active are as they were at the start.
    pub point: Point,
    /// Indices of those fitted.
    pub active: Vec<usize>,
    /// Residuals and slopes at the optimum.
    pub rows: Rows,
    /// Whether the recording determines every active parameter.
    pub determined: bool,
}

/// Slopes are scaled to columns of length one, so that counts and rad/s weigh alike.
struct Normal {
    matrix: DMatrix<f64>,
    unit: DVector<f64>,
}

fn normal(rows: &Rows) -> Normal {
    let unit = DVector::from_iterator(
        rows.slope.ncols(),
        rows.slope.column_iter().map(|c| c.norm()).map(|n| if n > 0.0 { 1.0 / n } else { 1.0 }),
    );
    let mut matrix = rows.slope.tr_mul(&rows.slope);
    for i in 0..unit.len() {
        for j in 0..unit.len() {
            matrix[(i, j)] *= unit[i] * unit[j];
        }
    }
    Normal { matrix, unit }
}

/// Smallest eigenvalue of the scaled normal matrix below which a parameter is not determined.
const DETERMINED: f64 = 1e-9;
/// Keeps undetermined directions where they are instead of dividing by zero.
const RIDGE: f64 = 1e-12;

fn factor(mut matrix: DMatrix<f64>, damping: f64) -> Option<Cholesky<f64, Dyn>> {
    for i in 0..matrix.nrows() {
        matrix[(i, i)] += damping.max(RIDGE);
    }
    matrix.cholesky()
}

impl Fit {
    /// Fits `active` from `start`.
    pub fn new(observed: &Observed<'_>, start: &Point, active: &[usize]) -> Self {
        let mut point = *start;
        let mut rows = observed.rows(&point, active);
        let mut damping = 1e-6;
        for _ in 0..60 {
            let Normal { matrix, unit } = normal(&rows);
            let gradient = rows.slope.tr_mul(&rows.residual).component_mul(&unit);
            let before = rows.residual.norm_squared();
            let Some(factored) = factor(matrix, damping) else {
                damping = (damping * 10.0_f64).max(1e-9);
                continue;
            };
            let step = -factored.solve(&gradient);
            let mut trial = point;
            for (c, p) in active.iter().enumerate() {
                trial[*p] += step[c] * unit[c];
            }
            let next = observed.rows(&trial, active);
            let after = next.residual.norm_squared();
            if after.is_finite() && after <= before {
                (point, rows) = (trial, next);
                damping *= 0.1;
                if before - after <= 1e-7 * after.max(1e-9) {
                    break;
                }
            } else {
                if step.norm() < 1e-9 || damping > 1e6 {
                    break;
                }
                damping *= 10.0;
            }
        }
        let smallest = normal(&rows).matrix.symmetric_eigenvalues().min();
        Self { point, active: active.to_vec(), rows, determined: smallest > DETERMINED }
    }

    /// The parameters as they would be without the rows for which `left_out` holds (to first order), and the residuals
    /// of all rows at that point. A new fit differs only by the square of the small change.
    pub fn without(&self, left_out: impl Fn(usize) -> bool) -> (Point, DVector<f64>) {
        let Normal { mut matrix, unit } = normal(&self.rows);
        let columns = self.active.len();
        let mut gradient = DVector::zeros(columns);
        for r in (0..self.rows.pose.len()).filter(|r| left_out(*r)) {
            let row = self.rows.slope.row(r).transpose().component_mul(&unit);
            matrix -= &row * row.transpose();
            gradient += &row * self.rows.residual[r];
        }
        let step = match factor(matrix, RIDGE) {
            Some(factored) => factored.solve(&gradient).component_mul(&unit),
            None => DVector::zeros(columns),
        };
        let mut point = self.point;
        for (c, p) in self.active.iter().enumerate() {
            point[*p] += step[c];
        }
        (point, &self.rows.residual + &self.rows.slope * step)
    }

    /// Delete-one-pose replicates of the parameters, for the jackknife.
    pub fn replicates(&self, poses: usize) -> Vec<Point> {
        (0..poses).map(|k| self.without(|r| self.rows.pose[r] == k).0).collect()
    }

    /// Standard deviation of each active parameter if the noise is as measured, and nothing else errs.
    pub fn deviations(&self) -> Vec<f64> {
        let Normal { matrix, unit } = normal(&self.rows);
        match factor(matrix, RIDGE) {
            Some(factored) => {
                let inverse = factored.inverse();
                (0..unit.len()).map(|i| inverse[(i, i)].max(0.0).sqrt() * unit[i]).collect()
            }
            None => vec![f64::INFINITY; unit.len()],
        }
    }

    /// Residuals of every row when its pose's fold is held out; rows of poses without a fold stay as fitted.
    pub fn held_out(&self, folds: &[Option<usize>]) -> DVector<f64> {
        let mut out = self.rows.residual.clone();
        let count = folds.iter().flatten().max().map_or(0, |m| m + 1);
        for fold in 0..count {
            let inside = |r: usize| folds[self.rows.pose[r]] == Some(fold);
            let (_, residual) = self.without(inside);
            for r in (0..out.len()).filter(|r| inside(*r)) {
                out[r] = residual[r];
            }
        }
        out
    }

    /// Mean square residual of a group over its noise, corrected for the parameters spent on it.
    pub fn reduced(&self, group: Group) -> f64 {
        let (sum, n) = self.rows.chi_square(group);
        let spent = self.leverage(group);
        sum / (n as f64 - spent).max(1.0)
    }

    /// Degrees of freedom that the parameters take from a group: the trace of its part of the hat matrix.
    pub fn leverage(&self, group: Group) -> f64 {
        let Normal { matrix, unit } = normal(&self.rows);
        let Some(factored) = factor(matrix, RIDGE) else { return 0.0 };
        let mut part = DMatrix::zeros(unit.len(), unit.len());
        for r in (0..self.rows.group.len()).filter(|r| self.rows.group[*r] == group) {
            let row = self.rows.slope.row(r).transpose().component_mul(&unit);
            part += &row * row.transpose();
        }
        factored.solve(&part).trace()
    }
}
