//! Normal equations of a linearised model, gathered in blocks of time: every question about a
//! subset of the parameters, a held-out part or a jackknife is then a question about small
//! matrices. Where an attitude turns by block, its turn is eliminated from the sums of each block
//! (Schur's complement), and no sum knows it any more.

use nalgebra::{DMatrix, DVector, Matrix3, Matrix3xX, Vector3};

use super::parameters::{ANCHOR, ANCHOR_RAD, PARAMETERS, Point};
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
    /// States how many whitened residuals were summed.
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

/// Index of the part that a time falls in when the interval is cut into `parts` equal ones; times
/// outside it count to the first or the last.
pub(super) fn part(time_s: f64, [from_s, to_s]: [f64; 2], parts: usize) -> usize {
    let fraction = (time_s - from_s) / (to_s - from_s);
    ((fraction * parts as f64).max(0.0) as usize).min(parts - 1)
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
    /// Holds what was eliminated from each block; nothing where nothing turns by block.
    turns: Vec<Turn>,
    ends_s: [f64; 2],
}

/// The turn of one block, eliminated: by how much it turns follows from the other parameters.
#[derive(Debug, Clone, PartialEq)]
struct Turn {
    /// Turn by the residual alone, rad.
    alone: Vector3<f64>,
    /// Holds what a step in each parameter adds to it.
    by_step: Matrix3xX<f64>,
}

impl Turn {
    /// Eliminates it from the sums of a block and from those of its pieces.
    fn eliminate(pieces: &mut [Sums]) -> Self {
        let mut block = Sums::empty();
        pieces.iter().for_each(|piece| block.add(piece, 1.0));
        let (start, width) = (ANCHOR.start, ANCHOR_RAD);
        let own = block.matrix.fixed_view::<3, 3>(start, start) + Matrix3::identity() / (width * width);
        let inverse = own.try_inverse().unwrap_or_else(Matrix3::zeros);
        let by_step = -(inverse * block.matrix.rows(start, 3));
        let alone = -(inverse * block.vector.fixed_rows::<3>(start));
        for piece in pieces.iter_mut() {
            let rows = piece.matrix.rows(start, 3).into_owned();
            let sums = piece.vector.fixed_rows::<3>(start).into_owned();
            // The square with the turn in it, at no step of the others.
            let own = piece.matrix.fixed_view::<3, 3>(start, start).into_owned();
            piece.square += 2.0 * alone.dot(&sums) + (own * alone).dot(&alone);
            piece.vector += by_step.transpose() * sums + (rows.transpose() + by_step.transpose() * own) * alone;
            piece.matrix += by_step.transpose() * &rows + (rows.transpose() + by_step.transpose() * own) * &by_step;
            for p in ANCHOR {
                piece.vector[p] = 0.0;
                piece.matrix.row_mut(p).fill(0.0);
                piece.matrix.column_mut(p).fill(0.0);
            }
        }
        Self { alone, by_step }
    }
}

impl Blocks {
    /// Of rows, made white, between two times.
    pub(super) fn of(rows: &[Row], whitening: &Whitening, ends_s: [f64; 2], by_block: bool) -> Self {
        let mut pieces = vec![Sums::empty(); BLOCKS * PIECES];
        for k in 0..rows.len() {
            let Some((residual, slope)) = whitening.white(rows, k) else { continue };
            let sums = &mut pieces[part(rows[k].time_s, ends_s, BLOCKS * PIECES)];
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
        let turns = pieces.chunks_mut(PIECES).filter(|_| by_block).map(Turn::eliminate).collect();
        let mut all = vec![Sums::empty(); BLOCKS];
        pieces.iter().enumerate().for_each(|(k, piece)| all[k / PIECES].add(piece, 1.0));
        Self { all, pieces, turns, ends_s }
    }

    /// Returns whether an attitude turns by block.
    pub(super) fn turn(&self) -> bool {
        !self.turns.is_empty()
    }

    /// The point with the turn of the block that a time lies in, where blocks turn: `from` is where
    /// the rows were linearised.
    pub(super) fn at(&self, time_s: f64, from: &Point, to: &Point) -> Point {
        let block = part(time_s, self.ends_s, BLOCKS);
        let mut point = *to;
        if let Some(turn) = self.turns.get(block) {
            let step = DVector::from_fn(PARAMETERS, |p, _| if ANCHOR.contains(&p) { 0.0 } else { to[p] - from[p] });
            let turned = turn.alone + &turn.by_step * step;
            ANCHOR.zip(turned.iter()).for_each(|(p, turn)| point[p] = from[p] + turn);
        }
        point
    }
}

/// A linearised model: the point about which it is one, and the sums of each sensor.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    /// States where it was linearised.
    pub point: Point,
    /// Standard deviations of the prior.
    pub widths: Point,
    /// Part of the square of each slope that is the sensor's noise.
    pub noise: Point,
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
    /// The same of some of the blocks alone.
    pub(super) fn part(&self, wanted: impl Fn(usize) -> bool) -> Self {
        let mut part = self.clone();
        for sensor in &mut part.sensors {
            for block in (0..BLOCKS).filter(|b| !wanted(*b)) {
                sensor.all[block] = Sums::empty();
                sensor.pieces[block * PIECES..(block + 1) * PIECES].fill(Sums::empty());
            }
        }
        part
    }

    /// Information on parameters: the normal matrix of all blocks.
    pub(super) fn information(&self, active: &[usize]) -> DMatrix<f64> {
        let total = self.total(|_| true);
        DMatrix::from_fn(active.len(), active.len(), |i, j| total.matrix[(active[i], active[j])])
    }

    /// Part of what is known of a parameter, with this variance next to all others, that is the sensor's noise.
    pub(super) fn noise_part(&self, p: usize, variance: f64) -> f64 {
        (self.noise[p] * self.information(&[p])[(0, 0)] * variance).min(1.0)
    }

    /// Returns whether a block has rows.
    fn has(&self, block: usize) -> bool {
        self.sensors.iter().any(|s| s.all[block].count > 0)
    }

    /// Returns whether an attitude turns by block.
    pub(super) fn turns_by_block(&self) -> bool {
        self.sensors.iter().any(Blocks::turn)
    }

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
        let widths = &self.widths;
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
    /// piece of the recording; blocks without a row are passed over.
    pub(super) fn scores(&self, active: &[usize], point: &Point) -> Vec<DVector<f64>> {
        let step = DVector::from_fn(PARAMETERS, |p, _| point[p] - self.point[p]);
        let mut all = vec![DVector::zeros(active.len()); BLOCKS * PIECES];
        for sensor in &self.sensors {
            for (score, piece) in all.iter_mut().zip(&sensor.pieces) {
                let gradient = &piece.vector + &piece.matrix * &step;
                active.iter().enumerate().for_each(|(i, p)| score[i] -= gradient[*p]);
            }
        }
        let there = all.into_iter().enumerate().filter(|(piece, _)| self.has(piece / PIECES));
        there.map(|(_, score)| score).collect()
    }

    /// The same with each block left out in turn.
    pub(super) fn replicates(&self, active: &[usize]) -> Vec<Point> {
        let total = self.total(|_| true);
        let without = |block: usize| {
            let mut sums = total.clone();
            self.sensors.iter().for_each(|s| sums.add(&s.all[block], -1.0));
            self.solve_sums(&sums, active).point
        };
        (0..BLOCKS).filter(|b| self.has(*b)).map(without).collect()
    }

    /// Sum of squares and how many numbers, of a sensor's block at a point.
    pub(super) fn squares(&self, sensor: usize, block: usize, point: &Point) -> (f64, usize) {
        let step = DVector::from_fn(PARAMETERS, |p, _| point[p] - self.point[p]);
        let sums = &self.sensors[sensor].all[block];
        (sums.squares(&step), sums.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};
    use crate::trajectory::colour::Held;

    #[test]
    fn a_turn_that_is_eliminated_is_the_one_that_leaves_least() {
        let mut random = Philox::new(5, 0, Stream::Host);
        let mut vector = || Vector3::from_fn(|_, _| random.normal());
        let count = 4 * BLOCKS * PIECES;
        let rows: Vec<Row> = (0..count)
            .map(|k| Row {
                time_s: k as f64 + 0.5,
                residual: vector(),
                slope: Box::new(std::array::from_fn(|p| {
                    if p < 3 || ANCHOR.contains(&p) { vector() } else { Vector3::zeros() }
                })),
                holds: true,
            })
            .collect();
        let residual: Vec<_> = rows.iter().map(|row| row.residual).collect();
        // No row looks back.
        let held = Held { holds: vec![true; count], part: vec![0; count] };
        let whitening = Whitening::of(&residual, &held, 0, &[vec![0, 1, 2]]);
        let ends_s = [0.0, count as f64];
        let blocks = Blocks::of(&rows, &whitening, ends_s, true);
        let step = DVector::from_fn(PARAMETERS, |p, _| if p < 3 { 0.3 * (p as f64 + 1.0) } else { 0.0 });
        let block = 7;
        let own = block * 4 * PIECES..(block + 1) * 4 * PIECES;
        let white: Vec<_> = own.filter_map(|k| whitening.white(&rows, k)).collect();
        let (mut normal, mut side) = (Matrix3::identity() / ANCHOR_RAD.powi(2), Vector3::zeros());
        let turns = |slope: &[Vector3<f64>; PARAMETERS]| {
            Matrix3::from_columns(&[slope[ANCHOR.start], slope[ANCHOR.start + 1], slope[ANCHOR.start + 2]])
        };
        let stepped = |residual: &Vector3<f64>, slope: &[Vector3<f64>; PARAMETERS]| {
            (0..3).fold(*residual, |sum, p| sum + slope[p] * step[p])
        };
        for (residual, slope) in &white {
            normal += turns(slope).transpose() * turns(slope);
            side -= turns(slope).transpose() * stepped(residual, slope);
        }
        let turn = normal.try_inverse().expect("three directions are told") * side;
        let left = |turn: Vector3<f64>| -> f64 {
            white.iter().map(|(r, slope)| (stepped(r, slope) + turns(slope) * turn).norm_squared()).sum()
        };
        let squares = blocks.all[block].squares(&step);
        assert!((squares / left(turn) - 1.0).abs() < 1e-9, "{squares}, {}", left(turn));
        assert!((squares / left(Vector3::zeros()) - 1.0).abs() > 1e-3, "no turn would leave as much");
        let to: Point = std::array::from_fn(|p| step[p]);
        let point = blocks.at(rows[block * 4 * PIECES + 3].time_s, &[0.0; PARAMETERS], &to);
        assert!(ANCHOR.zip(turn.iter()).all(|(p, turn)| (point[p] - turn).abs() < 1e-9));
    }
}
