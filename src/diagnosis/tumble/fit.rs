//! Least squares over poses and moves together (Levenberg–Marquardt), with whole poses left out at
//! no extra cost.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::calibration::{Point, gyro};
use super::group::{GROUPS, Group};
use super::imu::Observed;
use super::rows::Rows;

/// A fitted set of parameters.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    /// All parameters; those not active are as they were at the start.
    pub point: Point,
    /// Indices of those fitted.
    pub active: Vec<usize>,
    /// Residuals and slopes at the optimum.
    pub rows: Rows,
    /// States whether the recording determines every active parameter.
    pub determined: bool,
    /// Factor on the noise variance of each group by which the fit weighed it.
    pub inflation: Inflation,
    /// Rows over the inflated noise, what is known beforehand last.
    design: DMatrix<f64>,
    target: DVector<f64>,
}

/// A factor on the noise variance of each group, in the order of [`GROUPS`]: what a group misfits
/// beyond its noise is noise to the parameters that it shares with the others, so that a gyro which
/// does something unknown does not bend the accelerometer's calibration. (Variance components;
/// Searle, Casella & McCulloch 1992.)
pub(crate) type Inflation = [f64; GROUPS.len()];

/// Every group by its measured noise.
pub(super) const AS_MEASURED: Inflation = [1.0; GROUPS.len()];
/// Misfit that the noise's own uncertainty allows before a group counts for less.
const TOLERATED: f64 = 1.3;
/// Standard deviation of what is known of the coning coefficient beforehand: wide, and enough where
/// no turn shows it.
pub(super) const CONING_PRIOR: f64 = 1.0;

/// Holds what is known of a parameter before the recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Beforehand {
    /// Its index.
    pub parameter: usize,
    /// States where it is expected.
    pub centre: f64,
    /// States how far from there.
    pub deviation: f64,
}

/// States what every fit takes for known.
const ALWAYS: &[Beforehand] = &[Beforehand { parameter: gyro::CONING.start, centre: 0.0, deviation: CONING_PRIOR }];

/// Slopes are scaled to columns of length one, so that counts and rad/s weigh alike.
struct Normal {
    matrix: DMatrix<f64>,
    unit: DVector<f64>,
}

fn normal(design: &DMatrix<f64>) -> Normal {
    let unit = DVector::from_iterator(
        design.ncols(),
        design.column_iter().map(|c| c.norm()).map(|n| if n > 0.0 { 1.0 / n } else { 1.0 }),
    );
    let mut matrix = design.tr_mul(design);
    for i in 0..unit.len() {
        for j in 0..unit.len() {
            matrix[(i, j)] *= unit[i] * unit[j];
        }
    }
    Normal { matrix, unit }
}

/// Holds what a fit is asked: which parameters, how the groups are weighed, and what is known
/// beforehand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Question<'a> {
    /// Indices of the parameters that are fitted.
    pub active: &'a [usize],
    /// Factor on the noise variance of each group.
    pub inflation: &'a Inflation,
    /// Holds what is known before the recording.
    pub known: &'a [Beforehand],
}

/// Rows over the inflated noise, what is known beforehand last.
fn weighed(rows: &Rows, point: &Point, question: Question<'_>) -> (DMatrix<f64>, DVector<f64>) {
    let Question { active, inflation, known } = question;
    let count = rows.group.len();
    let weight = |r: usize| 1.0 / inflation[rows.group[r].place()].sqrt();
    let mut design = rows.slope.clone().insert_rows(count, known.len(), 0.0);
    let mut target = rows.residual.clone().insert_rows(count, known.len(), 0.0);
    for r in 0..count {
        design.row_mut(r).scale_mut(weight(r));
        target[r] *= weight(r);
    }
    for (n, Beforehand { parameter, centre, deviation }) in known.iter().enumerate() {
        if let Some(column) = active.iter().position(|p| p == parameter) {
            design[(count + n, column)] = 1.0 / deviation;
            target[count + n] = (point[*parameter] - centre) / deviation;
        }
    }
    (design, target)
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
    /// Fits `active` from `start`, each group weighed by its noise times its inflation.
    pub(super) fn new(observed: &Observed<'_>, start: &Point, active: &[usize], inflation: &Inflation) -> Self {
        Self::of(observed, start, Question { active, inflation, known: ALWAYS })
    }

    /// The same with what is known beforehand, which holds what the recording does not determine.
    pub(super) fn of(observed: &Observed<'_>, start: &Point, question: Question<'_>) -> Self {
        let Question { active, inflation, .. } = question;
        let mut point = *start;
        let mut rows = observed.rows(&point, active);
        let (mut design, mut target) = weighed(&rows, &point, question);
        let mut damping = 1e-6;
        for _ in 0..60 {
            let Normal { matrix, unit } = normal(&design);
            let gradient = design.tr_mul(&target).component_mul(&unit);
            let before = target.norm_squared();
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
            let (next_design, next_target) = weighed(&next, &trial, question);
            let after = next_target.norm_squared();
            if after.is_finite() && after <= before {
                (point, rows, design, target) = (trial, next, next_design, next_target);
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
        let smallest = normal(&design).matrix.symmetric_eigenvalues().min();
        let determined = smallest > DETERMINED;
        Self { point, active: active.to_vec(), rows, determined, inflation: *inflation, design, target }
    }

    /// The same with each group weighed by its own misfit, where that is more than its noise.
    pub(super) fn balanced(observed: &Observed<'_>, start: &Point, active: &[usize]) -> Self {
        Self::balanced_of(observed, start, active, ALWAYS)
    }

    /// The same with what is known beforehand.
    pub(super) fn balanced_of(observed: &Observed<'_>, start: &Point, active: &[usize], known: &[Beforehand]) -> Self {
        let mut fit = Self::of(observed, start, Question { active, inflation: &AS_MEASURED, known });
        for _ in 0..3 {
            let misfit = GROUPS.map(|g| Some(fit.reduced(g)).filter(|m| *m > TOLERATED).unwrap_or(1.0));
            if misfit.iter().zip(&fit.inflation).all(|(new, old)| (new / old - 1.0).abs() < 0.05) {
                break;
            }
            fit = Self::of(observed, &fit.point, Question { active, inflation: &misfit, known });
        }
        fit
    }

    /// The parameters as they would be without the rows for which `left_out` holds (to first
    /// order), and the residuals of all rows at that point, over their noise. A new fit differs
    /// only by the square of the small change.
    pub(super) fn without(&self, left_out: impl Fn(usize) -> bool) -> (Point, DVector<f64>) {
        let Normal { mut matrix, unit } = normal(&self.design);
        let columns = self.active.len();
        let mut gradient = DVector::zeros(columns);
        for r in (0..self.rows.pose.len()).filter(|r| left_out(*r)) {
            let row = self.design.row(r).transpose().component_mul(&unit);
            matrix -= &row * row.transpose();
            gradient += &row * self.target[r];
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
    pub(super) fn replicates(&self, poses: usize) -> Vec<Point> {
        (0..poses).map(|k| self.without(|r| self.rows.pose[r] == k).0).collect()
    }

    /// Standard deviation of each active parameter if the noise is as it was weighed, and nothing
    /// else errs.
    pub(super) fn deviations(&self) -> Vec<f64> {
        let Normal { matrix, unit } = normal(&self.design);
        match factor(matrix, RIDGE) {
            Some(factored) => {
                let inverse = factored.inverse();
                (0..unit.len()).map(|i| inverse[(i, i)].max(0.0).sqrt() * unit[i]).collect()
            }
            None => vec![f64::INFINITY; unit.len()],
        }
    }

    /// Covariance of the active parameters where the variance of a row is `variance` times what
    /// it was weighed by (the sandwich of White, Econometrica 48 (1980) 817, with known factors).
    pub(super) fn covariance(&self, variance: impl Fn(usize) -> f64) -> Option<DMatrix<f64>> {
        let Normal { matrix, unit } = normal(&self.design);
        let inverse = factor(matrix, RIDGE)?.inverse();
        let mut errors = DMatrix::zeros(unit.len(), unit.len());
        for r in 0..self.design.nrows() {
            let row = self.design.row(r).transpose().component_mul(&unit);
            let times = if r < self.rows.pose.len() { variance(r) } else { 1.0 };
            errors.ger(times, &row, &row, 1.0);
        }
        let scaled = &inverse * errors * &inverse;
        Some(DMatrix::from_fn(unit.len(), unit.len(), |i, j| scaled[(i, j)] * unit[i] * unit[j]))
    }

    /// Residuals of every row when its pose's fold is held out; rows of poses without a fold stay
    /// as fitted.
    pub(super) fn held_out(&self, folds: &[Option<usize>]) -> DVector<f64> {
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
    pub(super) fn reduced(&self, group: Group) -> f64 {
        let (sum, n) = self.rows.chi_square(group);
        let spent = self.leverage(group);
        sum / (n as f64 - spent).max(1.0)
    }

    /// Degrees of freedom that the parameters take from a group: the trace of its part of the hat
    /// matrix.
    pub(super) fn leverage(&self, group: Group) -> f64 {
        let Normal { matrix, unit } = normal(&self.design);
        let Some(factored) = factor(matrix, RIDGE) else { return 0.0 };
        let mut part = DMatrix::zeros(unit.len(), unit.len());
        for r in (0..self.rows.group.len()).filter(|r| self.rows.group[*r] == group) {
            let row = self.design.row(r).transpose().component_mul(&unit);
            part += &row * row.transpose();
        }
        factored.solve(&part).trace()
    }
}
