//! The force of a body without a spring as a sum of parts of its motion, by linear least squares.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::driven::identification::interval;
use crate::driven::selection::held_out::{Block, HeldOut};
use crate::driven::selection::residual_structure::{MEMORY, correlation};
use crate::numerics::least_squares::Linear;

use super::motion::{MotionAndForce, Part};

/// Blocks whose scores are summed apart, for the covariance.
const BLOCKS: usize = 32;
/// Blocks that judging samples are cut into.
const JUDGING: usize = 24;

/// The input that a motion takes: Σ coefficient × part.
#[derive(Debug, Clone)]
pub struct Regression {
    /// The parts; the first is the acceleration.
    pub parts: Vec<Part>,
    /// Their coefficients, in units of the input per unit of the part.
    pub coefficients: Vec<f64>,
    /// Covariance of the coefficients, from the scatter between blocks (Liang & Zeger 1986).
    covariance: DMatrix<f64>,
    /// Mean squared difference of both sides where it was fitted.
    pub variance: f64,
}

impl Regression {
    /// Fitted on the samples of these ranges that count; `None` where they do not determine it.
    pub fn fit(motion: &MotionAndForce, parts: &[Part], ranges: &[Range<usize>]) -> Option<Self> {
        let rows: Vec<usize> = motion.counted(ranges).into_iter().flatten().collect();
        let pick = |values: &[f64]| rows.iter().map(|k| values[*k]).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = parts.iter().map(|p| pick(motion.part(*p))).collect();
        if rows.len() < 10 * (parts.len() + BLOCKS) {
            return None;
        }
        let residual: Vec<f64> = pick(&motion.force).iter().map(|f| -f).collect();
        let linear = Linear { residual, columns };
        let normal = linear.normal();
        let inverse = normal.inverse(0.0)?;
        let coefficients: Vec<f64> = normal.step(1e-12).iter().copied().collect();
        let residual: Vec<f64> = (0..rows.len())
            .map(|k| linear.residual[k] + linear.columns.iter().zip(&coefficients).map(|(c, w)| c[k] * w).sum::<f64>())
            .collect();
        let mut scores = DMatrix::zeros(parts.len(), parts.len());
        for b in 0..BLOCKS {
            let block = residual.len() * b / BLOCKS..residual.len() * (b + 1) / BLOCKS;
            let of = |c: &Vec<f64>| block.clone().map(|k| c[k] * residual[k]).sum::<f64>();
            let score = DVector::from_iterator(parts.len(), linear.columns.iter().map(of));
            scores += &score * score.transpose();
        }
        let covariance = &inverse * scores * &inverse * (BLOCKS as f64 / (BLOCKS as f64 - 1.0));
        let variance = residual.iter().map(|e| e * e).sum::<f64>() / residual.len() as f64;
        let sound = coefficients.iter().all(|c| c.is_finite()) && coefficients[0] != 0.0 && variance.is_finite();
        sound.then_some(Self { parts: parts.to_vec(), coefficients, covariance, variance })
    }

    fn place(&self, part: Part) -> Option<usize> {
        self.parts.iter().position(|p| *p == part)
    }

    /// Coefficient of a part; 0 where it has none.
    pub fn of(&self, part: Part) -> f64 {
        self.place(part).map_or(0.0, |i| self.coefficients[i])
    }

    /// A part's coefficient in units of the input, with its 95 % interval.
    pub fn in_input(&self, part: Part) -> (f64, [f64; 2]) {
        let (value, half) =
            self.place(part).map_or((0.0, 0.0), |i| (self.coefficients[i], self.covariance[(i, i)].max(0.0).sqrt()));
        let half = interval::reach() * half;
        (value, [value - half, value + half])
    }

    /// The same over the coefficient of the acceleration: an acceleration per unit of the part, by
    /// the delta method.
    pub fn as_acceleration(&self, part: Part) -> (f64, [f64; 2]) {
        let Some(i) = self.place(part) else { return (0.0, [0.0; 2]) };
        let (b, a, c) = (self.coefficients[i], self.coefficients[0], &self.covariance);
        let variance = (c[(i, i)] - 2.0 * b / a * c[(i, 0)] + (b / a).powi(2) * c[(0, 0)]) / (a * a);
        let (value, half) = (b / a, interval::reach() * variance.max(0.0).sqrt());
        (value, [value - half, value + half])
    }

    /// Both sides' difference at one sample.
    pub fn residual(&self, motion: &MotionAndForce, k: usize) -> f64 {
        motion.force[k] - self.parts.iter().zip(&self.coefficients).map(|(p, w)| w * motion.part(*p)[k]).sum::<f64>()
    }

    /// Its errors on ranges that it was not fitted on.
    pub fn held_out(&self, motion: &MotionAndForce, ranges: &[Range<usize>]) -> HeldOut {
        let ranges = motion.counted(ranges);
        let length = (ranges.iter().map(Range::len).sum::<usize>() / JUDGING).max(20);
        let (mut blocks, mut errors) = (Vec::new(), Vec::new());
        for r in ranges {
            let count = (r.len() / length).max(1);
            for b in 0..count {
                let range = r.start + r.len() * b / count..r.start + r.len() * (b + 1) / count;
                let here: Vec<f64> = range.clone().map(|k| self.residual(motion, k)).collect();
                let sum = here.iter().map(|e| e * e).sum();
                errors.extend(here);
                blocks.push(Block { range, one_step: sum, free: sum });
            }
        }
        HeldOut { blocks, autocorrelation_factor: correlation(&errors, MEMORY) }
    }

    /// Root mean square of both sides' difference over that of the force, on a range.
    pub fn force_error(&self, motion: &MotionAndForce, range: &Range<usize>) -> f64 {
        let rows = || motion.counted(std::slice::from_ref(range)).into_iter().flatten();
        let residual: f64 = rows().map(|k| self.residual(motion, k).powi(2)).sum();
        (residual / rows().map(|k| motion.force[k].powi(2)).sum::<f64>().max(1e-300)).sqrt()
    }
}
