//! Decides whether a random walk that a model names is one, or a smooth trend that its laws left. A
//! walk has power at all frequencies, falling as their square; the residual of a drift that goes as
//! another power of time, or settles in two speeds, has its power at the lowest few.
//!
//! The errors of the model without the walk are regressed on polynomials of time, and of its
//! logarithm (cosines would ask for a trend that is level at both ends), next to the derivatives of
//! the model's own parameters. The better description is that of the larger likelihood less the
//! penalty of its parameters (Schwarz, Annals of Statistics 6, 1978).

use nalgebra::{DMatrix, DVector};

use crate::driven::identification::fit::Fit;
use crate::driven::intake::data::Data;
use crate::numerics::legendre::legendre;
use crate::numerics::log_time::log_time;

/// Highest degree of a trend: beyond, a walk has more power than a trend that is smooth.
const MOST: usize = 8;
/// Log-likelihood by which a smooth trend must be better: odds of twenty to one.
const LEAST_LEAD: f64 = 3.0;
/// Added to the diagonal of the normal equations, relative to it: a parameter's derivative may be
/// a sum of the polynomials.
const RIDGE: f64 = 1e-9;

/// Returns whether a smooth trend describes what a model leaves better than a walk does; `with` is
/// the model that has the walk next to the same terms.
pub(crate) fn is_smooth(data: &Data, without: &Fit, with: &Fit) -> bool {
    let rows = without.linear.residual.len();
    if rows != data.train_len() || rows != with.linear.residual.len() || rows < 100 * MOST {
        return false;
    }
    let (first, length) = (data.hull.start, data.hull.len() as f64);
    let at: Vec<f64> = data.train.iter().flat_map(Clone::clone).map(|k| ((k - first) as f64 + 0.5) / length).collect();
    let free = (with.free.len() as f64 - without.free.len() as f64).max(1.0);
    let walk = log_likelihood(rows, with.variance * rows as f64) - free * penalty(rows);
    smooth(&without.linear.residual, &without.linear.columns, &at) > walk + LEAST_LEAD
}

/// Returns the log-likelihood that one number costs.
fn penalty(rows: usize) -> f64 {
    0.5 * (rows as f64).ln()
}

/// Returns the log-likelihood, less the penalty, of the best polynomial of time or of its
/// logarithm, next to other columns; `at` is time, from 0 to 1.
fn smooth(errors: &[f64], columns: &[Vec<f64>], at: &[f64]) -> f64 {
    let rows = errors.len();
    let courses: [&dyn Fn(f64) -> f64; 2] = [&|t| t, &log_time];
    let best = courses.iter().flat_map(|course| {
        let at: Vec<f64> = at.iter().map(|t| course(*t)).collect();
        let left = left_by(errors, columns, &at);
        left.into_iter().enumerate().map(move |(i, sum)| log_likelihood(rows, sum) - (i + 1) as f64 * penalty(rows))
    });
    best.fold(f64::NEG_INFINITY, f64::max)
}

/// Gaussian log-likelihood at the best variance, but for a constant.
fn log_likelihood(rows: usize, sum: f64) -> f64 {
    -0.5 * rows as f64 * (sum / rows as f64).max(1e-300).ln()
}

/// Returns the sum of squares that polynomials of degree one, two … leave next to other columns.
fn left_by(errors: &[f64], columns: &[Vec<f64>], at: &[f64]) -> Vec<f64> {
    let (own, rows) = (columns.len(), errors.len());
    let width = own + MOST;
    let (mut matrix, mut vector) = (DMatrix::zeros(width, width), DVector::zeros(width));
    let sizes: Vec<f64> = columns.iter().map(|c| c.iter().map(|v| v * v).sum::<f64>().sqrt().max(1e-300)).collect();
    // Of length one: the mean square of a polynomial of degree d is 1/(2d + 1).
    let degree = |d: usize, t: f64| legendre(d, 2.0 * t - 1.0) * ((2 * d + 1) as f64 / rows as f64).sqrt();
    for (i, error) in errors.iter().enumerate() {
        let of_model = columns.iter().zip(&sizes).map(|(c, size)| c[i] / size);
        let row = DVector::from_iterator(width, of_model.chain((1..=MOST).map(|d| degree(d, at[i]))));
        matrix.ger(1.0, &row, &row, 1.0);
        vector.axpy(*error, &row, 1.0);
    }
    for j in 0..width {
        matrix[(j, j)] *= 1.0 + RIDGE;
        matrix[(j, j)] += RIDGE;
    }
    let total: f64 = errors.iter().map(|e| e * e).sum();
    let removed = |width: usize| {
        let (part, right) = (matrix.view((0, 0), (width, width)).into_owned(), vector.rows(0, width).into_owned());
        part.cholesky().map_or(0.0, |c| c.solve(&right).dot(&right))
    };
    (1..=MOST).map(|q| (total - removed(own + q)).max(1e-300)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    const ROWS: usize = 6000;

    /// Log-likelihood, less the penalty, of a walk of this step in white noise: that of its Kalman
    /// filter.
    fn walk_of(course: &[f64], step: f64) -> f64 {
        let (mut level, mut variance, mut sum, mut log) = (0.0, 1e3, 0.0, 0.0);
        for y in course {
            let innovation = variance + 1.0;
            sum += (y - level).powi(2) / innovation;
            log += innovation.ln();
            let gain = variance / innovation;
            level += gain * (y - level);
            variance = variance * (1.0 - gain) + step * step;
        }
        -0.5 * ROWS as f64 * (sum / ROWS as f64).ln() - 0.5 * log - penalty(ROWS)
    }

    /// Returns by how much the best polynomial is better than the best walk.
    fn lead(course: &[f64]) -> f64 {
        let at: Vec<f64> = (0..ROWS).map(|i| (i as f64 + 0.5) / ROWS as f64).collect();
        let steps = (0..40).map(|i| 10f64.powf(-4.0 + 0.1 * f64::from(i)));
        let best = steps.map(|step| walk_of(course, step)).fold(f64::NEG_INFINITY, f64::max);
        smooth(course, &[vec![1.0; ROWS]], &at) - best
    }

    #[test]
    fn walks_are_walks_and_what_settles_in_two_speeds_or_grows_as_a_power_of_time_is_smooth() {
        let smooth = |seed: u64| {
            let mut rng = Philox::new(seed, 0, Stream::Host);
            let course = |t: f64| 6.0 * (-t / 0.1).exp() + 5.0 * (-t / 0.6).exp();
            lead(&(0..ROWS).map(|i| course(i as f64 / ROWS as f64) + rng.normal()).collect::<Vec<f64>>())
        };
        let walk = |seed: u64| {
            let (mut rng, mut level) = (Philox::new(seed, 1, Stream::Host), 0.0);
            let mut next = || {
                level += 0.03 * rng.normal();
                level + rng.normal()
            };
            lead(&(0..ROWS).map(|_| next()).collect::<Vec<f64>>())
        };
        let power = |seed: u64| {
            let mut rng = Philox::new(seed, 2, Stream::Host);
            lead(&(0..ROWS).map(|i| 13.0 * (i as f64 / ROWS as f64).powf(2.3) + rng.normal()).collect::<Vec<f64>>())
        };
        assert!((0..20).all(|s| power(s) > LEAST_LEAD), "{:?}", (0..20).map(power).collect::<Vec<f64>>());
        assert!((0..20).all(|s| smooth(s) > LEAST_LEAD), "{:?}", (0..20).map(smooth).collect::<Vec<f64>>());
        assert!((0..20).all(|s| walk(s) < LEAST_LEAD), "{:?}", (0..20).map(walk).collect::<Vec<f64>>());
    }
}
