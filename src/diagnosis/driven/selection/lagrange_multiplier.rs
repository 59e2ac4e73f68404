//! The Lagrange multiplier (score) test: asks whether innovations follow from known quantities,
//! each of which is passed through the model's own filter first, as the force or the change of the
//! reading that a missing law would make of it.
//!
//! Innovations of the right model are unpredictable from what came before, and so from what the
//! filter makes of it, however slowly the mass answers. The statistic holds for noise of uneven
//! strength and of any distribution (White, Econometrica 48, 1980; the efficient score of Rao,
//! 1948).

use nalgebra::{DMatrix, DVector, Matrix4, Vector4};

use crate::driven::identification::fit::Fit;
use crate::driven::simulation::gain;
use crate::numerics::special;
use crate::physics::law::Noise;

use super::known::standard;

/// Rows that each column needs.
const ROWS_PER_COLUMN: usize = 10;
/// Directions with less than this part of the largest one's variance repeat the others.
const DISTINCT: f64 = 1e-9;

/// Place where a missing law would enter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Entry {
    /// On the mass as a force, over one sample.
    Force,
    /// At the reading.
    Reading,
}

/// The stationary filter of a model: how its innovations answer to what the model does not hold.
pub(super) struct Filter {
    /// Error of the predicted state, from one sample to the next.
    closed: Matrix4<f64>,
    /// Correction of its state by a unit error of the reading.
    corrected: Vector4<f64>,
    push: Vector4<f64>,
    sees: Vector4<f64>,
    noise: Matrix4<f64>,
    innovation_variance: f64,
    /// Rows before which the recording is interrupted.
    breaks: Vec<usize>,
}

impl Filter {
    pub(super) fn of(fit: &Fit, interval_s: f64, breaks: Vec<usize>) -> Self {
        let noisy = fit.structure.noisy(&fit.point, interval_s);
        let (system, stationary) = (gain::system(&noisy), gain::stationary(&noisy));
        let corrected = system.transition * Vector4::<f64>::from(stationary.k);
        Self {
            closed: system.transition - corrected * system.sees.transpose(),
            corrected,
            push: system.push,
            sees: system.sees,
            noise: system.noise,
            innovation_variance: stationary.innovation_variance,
            breaks,
        }
    }

    /// Innovations that something known would cause, were it to act there.
    pub(super) fn answer(&self, to: &[f64], entry: Entry) -> Vec<f64> {
        let mut error = Vector4::<f64>::zeros();
        let step = |(k, g): (usize, &f64)| {
            if self.breaks.contains(&k) {
                error = Vector4::zeros();
            }
            match entry {
                Entry::Force => {
                    let seen = self.sees.dot(&error);
                    error = self.closed * error + self.push * *g;
                    seen
                }
                Entry::Reading => {
                    let seen = self.sees.dot(&error) + g;
                    error = self.closed * error - self.corrected * *g;
                    seen
                }
            }
        };
        to.iter().enumerate().map(step).collect()
    }

    /// Returns the degrees of freedom per sample that this noise absorbs: the trace of its
    /// smoother.
    pub(super) fn freedom(&self, noise: Noise) -> f64 {
        let mut own = self.noise;
        for i in 0..4 {
            for j in 0..4 {
                let of_walk = i == 2 && j == 2;
                if of_walk != (noise == Noise::Walk) {
                    own[(i, j)] = 0.0;
                }
            }
        }
        let mut information = self.sees * self.sees.transpose() / self.innovation_variance;
        let mut carried = self.closed;
        for _ in 0..50 {
            information += carried.transpose() * information * carried;
            carried *= carried;
        }
        (own * information).trace()
    }
}

/// Part of innovations that a group of columns explains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Score {
    /// Sum of squares explained over the innovations' variance, less what chance explains.
    pub gain: f64,
    /// Probability of as much by chance.
    pub p_value: f64,
}

/// Innovations without what is granted.
pub(super) struct Tested {
    errors: DVector<f64>,
    variance: f64,
    /// Orthonormal columns of what is granted, a constant among them.
    granted: DMatrix<f64>,
}

impl Tested {
    pub(super) fn of(innovations: &[f64], granted: &[Vec<f64>]) -> Option<Self> {
        let constant = vec![1.0; innovations.len()];
        let granted = whitened(&matrix(granted.iter().filter_map(|c| standard(c)).chain([constant]).collect()))?;
        let mut errors = DVector::from_column_slice(innovations);
        errors -= &granted * (granted.transpose() * &errors);
        let variance = errors.norm_squared() / innovations.len() as f64;
        (variance > 0.0).then_some(Self { errors, variance, granted })
    }

    /// Returns what the columns explain beyond what is granted: `None` where the recording is too
    /// short or nothing is left of the columns.
    pub(super) fn score(&self, columns: impl Iterator<Item = Vec<f64>>) -> Option<Score> {
        let mut columns = matrix(columns.filter_map(|c| standard(&c)).collect());
        if columns.nrows() < ROWS_PER_COLUMN * (columns.ncols() + self.granted.ncols()) {
            return None;
        }
        columns -= &self.granted * (self.granted.transpose() * &columns);
        let mut directions = whitened(&columns)?;
        let score = directions.transpose() * &self.errors;
        for mut direction in directions.column_iter_mut() {
            direction.component_mul_assign(&self.errors);
        }
        let covariance = directions.transpose() * &directions;
        let statistic = score.dot(&covariance.cholesky()?.solve(&score));
        let width = score.len() as f64;
        let gain = score.norm_squared() / self.variance - width;
        (statistic.is_finite() && gain.is_finite())
            .then(|| Score { gain, p_value: special::chi_squared_survival(statistic, width) })
    }
}

/// Side by side; of no rows without a column.
fn matrix(columns: Vec<Vec<f64>>) -> DMatrix<f64> {
    let rows = columns.first().map_or(0, Vec::len);
    DMatrix::from_iterator(rows, columns.len(), columns.into_iter().flatten())
}

/// Orthonormal columns that span the same; none where they are all nothing.
fn whitened(columns: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    if columns.is_empty() {
        return None;
    }
    let found = (columns.transpose() * columns).symmetric_eigen();
    let largest = found.eigenvalues.max();
    let kept: Vec<usize> =
        (0..found.eigenvalues.len()).filter(|j| found.eigenvalues[*j] > (DISTINCT * largest).max(1e-9)).collect();
    let scaled = DMatrix::from_fn(columns.ncols(), kept.len(), |i, j| {
        found.eigenvectors[(i, kept[j])] / found.eigenvalues[kept[j]].sqrt()
    });
    (!kept.is_empty()).then(|| columns * scaled)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    const ROWS: usize = 3000;

    /// A local level (Durbin & Koopman 2012, §2.11): a bias that walks by 0.3 per sample, read with
    /// unit noise; P² = q(P + 1).
    fn local_level() -> Filter {
        let q: f64 = 0.09;
        let p = 0.5 * (q + (q * q + 4.0 * q).sqrt());
        let transition = Matrix4::from_diagonal(&Vector4::new(0.0, 0.0, 1.0, 0.0));
        let sees = Vector4::new(0.0, 0.0, 1.0, 0.0);
        let corrected = sees * (p / (p + 1.0));
        let mut noise = Matrix4::zeros();
        noise[(2, 2)] = q;
        let (closed, push) = (transition - corrected * sees.transpose(), sees);
        Filter { closed, corrected, push, sees, noise, innovation_variance: p + 1.0, breaks: Vec::new() }
    }

    /// Counts how often of 200 a slow known quantity is found (p < 0.01) in innovations that are
    /// noise of uneven strength and this much of its answer.
    fn found(part: f64) -> usize {
        let filter = local_level();
        (0..200)
            .filter(|seed| {
                let mut rng = Philox::new(*seed, 0, Stream::Host);
                let mut slow = 0.0;
                let known: Vec<f64> = (0..ROWS)
                    .map(|_| {
                        slow += -0.01 * slow + 0.14 * rng.normal();
                        slow
                    })
                    .collect();
                let answer = filter.answer(&known, Entry::Reading);
                let innovations: Vec<f64> = answer
                    .iter()
                    .zip(&known)
                    .map(|(a, k)| part * a + rng.normal() * if k.abs() > 1.0 { 2.0 } else { 1.0 })
                    .collect();
                let square: Vec<f64> = known.iter().map(|k| k * k).collect();
                let columns = [known, square].map(|c| filter.answer(&c, Entry::Reading));
                let found = Tested::of(&innovations, &[]).and_then(|t| t.score(columns.into_iter()));
                found.is_some_and(|s| s.p_value < 0.01)
            })
            .count()
    }

    // Of 200 at 1 %, more than 8 come by chance once in 4000 (binomial).
    #[test]
    fn uneven_noise_follows_nothing_and_a_known_quantity_is_found() {
        assert!(found(0.0) <= 8, "{} alarms", found(0.0));
        assert!(found(1.0) >= 195, "{} found", found(1.0));
    }

    #[test]
    fn granted_columns_explain_no_more_and_a_level_is_followed_by_its_filter() {
        let mut rng = Philox::new(5, 0, Stream::Host);
        let known: Vec<f64> = (0..ROWS).map(|_| rng.normal()).collect();
        let innovations: Vec<f64> = known.iter().map(|k| k + rng.normal()).collect();
        let columns = vec![known];
        let score = |granted: &[Vec<f64>]| Tested::of(&innovations, granted)?.score(columns.iter().cloned());
        assert!(score(&[]).is_some_and(|s| s.gain > 1000.0));
        assert_eq!(score(&columns), None);
        // A constant error of the reading is taken for the level: (1 − K)^k of it is left.
        let left = local_level().answer(&[1.0; 20], Entry::Reading);
        let p: f64 = 0.5 * (0.09 + (0.09f64 * 0.09 + 0.36).sqrt());
        let keeps = 1.0 / (p + 1.0);
        assert!((left[10] - keeps.powi(10)).abs() < 1e-9, "{} {}", left[10], keeps.powi(10));
        // The smoother of a local level absorbs K/(2 − K) of each sample's freedom.
        let k = 1.0 - keeps;
        assert!((local_level().freedom(Noise::Walk) - k / (2.0 - k)).abs() < 1e-6);
    }
}
