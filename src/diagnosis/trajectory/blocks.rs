//! Normal equations of a linearised model, gathered in blocks of time: every question about a
//! subset of the parameters, a held-out part or a jackknife is then a question about small
//! matrices.

use nalgebra::{DMatrix, DVector};

use super::parameters::{PARAMETERS, Point, widths};
use super::rows::Row;
use super::whitening::Whitening;

/// Blocks of time that are left out one by one.
pub(super) const BLOCKS: usize = 20;

/// Sums over some rows: XᵀX, Xᵀr, rᵀr.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sums {
    matrix: DMatrix<f64>,
    vector: DVector<f64>,
    square: f64,
    /// How many whitened residuals were summed.
    pub count: usize,
}

impl Sums {
    fn empty() -> Self {
        Self {
            matrix: DMatrix::zeros(PARAMETERS, PARAMETERS),
            vector: DVector::zeros(PARAMETERS),
            square: 0.0,
            count: 0,
        }
    }

    fn add(&mut self, other: &Self, times: f64) {
        self.matrix += &other.matrix * times;
        self.vector += &other.vector * times;
        self.square += other.square * times;
        self.count = if times > 0.0 { self.count + other.count } else { self.count.saturating_sub(other.count) };
    }

    /// Sum of squares at a step from where it was linearised.
    pub(super) fn squares(&self, step: &DVector<f64>) -> f64 {
        (self.square + 2.0 * self.vector.dot(step) + (&self.matrix * step).dot(step)).max(0.0)
    }
}

/// Pieces that each block is cut into where slow waves are laid over the recording.
const PIECES: usize = 10;

/// The sums of one sensor, block by block.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Blocks {
    /// In order of time.
    pub all: Vec<Sums>,
    /// The same by pieces of a block.
    pieces: Vec<Sums>,
}

impl Blocks {
    /// Of rows, made white, between two times.
    pub(super) fn of(rows: &[Row], whitening: &Whitening, [from_s, to_s]: [f64; 2]) -> Self {
        let mut pieces = vec![Sums::empty(); BLOCKS * PIECES];
        for k in 0..rows.len() {
            let Some((residual, slope)) = whitening.white(rows, k) else { continue };
            let fraction = (rows[k].time_s - from_s) / (to_s - from_s);
            let count = pieces.len();
            let sums = &mut pieces[((fraction * count as f64).max(0.0) as usize).min(count - 1)];
            let active: Vec<usize> = (0..PARAMETERS).filter(|p| slope[*p] != nalgebra::Vector3::zeros()).collect();
            for (n, p) in active.iter().enumerate() {
                sums.vector[*p] += slope[*p].dot(&residual);
                for q in &active[..=n] {
                    let product = slope[*p].dot(&slope[*q]);
                    sums.matrix[(*p, *q)] += product;
                    if p != q {
                        sums.matrix[(*q, *p)] += product;
                    }
                }
            }
            sums.square += residual.norm_squared();
            sums.count += 3;
        }
        let mut all = vec![Sums::empty(); BLOCKS];
        pieces.iter().enumerate().for_each(|(k, piece)| all[k / PIECES].add(piece, 1.0));
        Self { all, pieces }
    }
}

/// A linearised model: the point about which it is one, and the sums of each sensor.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    /// Where it was linearised.
    pub point: Point,
    /// By sensor: attitude, and position where there is one.
    pub sensors: Vec<Blocks>,
}

/// Parameters of a subset, the others being zero.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Solved {
    /// All parameters, SI; those that were not fitted as they were.
    pub point: Point,
    /// Covariance of the active ones under white noise, in their order.
    pub covariance: DMatrix<f64>,
}

impl Linear {
    /// The sums over blocks.
    fn total(&self, wanted: impl Fn(usize) -> bool) -> Sums {
        let mut total = Sums::empty();
        for blocks in &self.sensors {
            for (_, sums) in blocks.all.iter().enumerate().filter(|(n, _)| wanted(*n)) {
                total.add(sums, 1.0);
            }
        }
        total
    }

    /// Best parameters of a subset on the blocks wanted.
    pub(super) fn solve(&self, active: &[usize], wanted: impl Fn(usize) -> bool) -> Solved {
        self.solve_sums(&self.total(wanted), active)
    }

    fn solve_sums(&self, sums: &Sums, active: &[usize]) -> Solved {
        let widths = widths();
        // What is not active goes to zero.
        let mut step = DVector::from_iterator(PARAMETERS, self.point.iter().map(|v| -v));
        active.iter().for_each(|p| step[*p] = 0.0);
        let gradient = &sums.vector + &sums.matrix * &step;
        let count = active.len();
        let scale: Vec<f64> = active.iter().map(|p| widths[*p]).collect();
        // In units of the widths of the prior.
        let mut matrix =
            DMatrix::from_fn(count, count, |i, j| sums.matrix[(active[i], active[j])] * scale[i] * scale[j]);
        let mut right = DVector::from_fn(count, |i, _| -gradient[active[i]] * scale[i]);
        for i in 0..count {
            matrix[(i, i)] += 1.0;
            right[i] -= self.point[active[i]] / scale[i];
        }
        let mut point = [0.0; PARAMETERS];
        let mut covariance = DMatrix::zeros(count, count);
        if let Some(factored) = matrix.cholesky() {
            let solution = factored.solve(&right);
            let inverse = factored.inverse();
            for (i, p) in active.iter().enumerate() {
                point[*p] = self.point[*p] + solution[i] * scale[i];
                for j in 0..count {
                    covariance[(i, j)] = inverse[(i, j)] * scale[i] * scale[j];
                }
            }
        }
        Solved { point, covariance }
    }

    /// Minus the gradients of half the sum of squares by the active parameters at a point, piece by
    /// piece of the recording.
    pub(super) fn scores(&self, active: &[usize], point: &Point) -> Vec<DVector<f64>> {
        let step = DVector::from_fn(PARAMETERS, |p, _| point[p] - self.point[p]);
        let mut all = vec![DVector::zeros(active.len()); BLOCKS * PIECES];
        for sensor in &self.sensors {
            for (score, piece) in all.iter_mut().zip(&sensor.pieces) {
                let gradient = &piece.vector + &piece.matrix * &step;
                active.iter().enumerate().for_each(|(i, p)| score[i] -= gradient[*p]);
            }
        }
        all
    }

    /// The same with each block left out in turn.
    pub(super) fn replicates(&self, active: &[usize]) -> Vec<Point> {
        let total = self.total(|_| true);
        let without = |block: usize| {
            let mut sums = total.clone();
            self.sensors.iter().for_each(|s| sums.add(&s.all[block], -1.0));
            self.solve_sums(&sums, active).point
        };
        (0..BLOCKS).filter(|b| self.sensors.iter().any(|s| s.all[*b].count > 0)).map(without).collect()
    }

    /// Sum of squares and how many numbers, of a sensor's block at a point.
    pub(super) fn squares(&self, sensor: usize, block: usize, point: &Point) -> (f64, usize) {
        let step = DVector::from_fn(PARAMETERS, |p, _| point[p] - self.point[p]);
        let sums = &self.sensors[sensor].all[block];
        (sums.squares(&step), sums.count)
    }
}
