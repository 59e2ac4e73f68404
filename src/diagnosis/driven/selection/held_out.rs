//! Prediction on samples that were not fitted: block by block, one step ahead and in free
//! simulation.

use std::ops::Range;

use crate::driven::base::{INITIAL, OFFSET};
use crate::driven::identification::fit::{Fit, Search};
use crate::driven::intake::data::Data;
use crate::driven::simulation::filter::Nothing;
use crate::driven::simulation::run::{Run, innovations};
use crate::driven::simulation::structure::coordinates;
use crate::numerics::special;
use crate::parallel;
use crate::physics::law::Noise;
use crate::physics::scales::Scales;
use crate::physics::state::Lanes;

use super::residual_structure::{MEMORY, correlation};

/// Blocks that they are cut into.
const BLOCKS: usize = 24;
/// Samples at the beginning of a separate test range that only initialise the state.
pub(crate) const LEAD: usize = 50;

/// Errors on one block.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Samples of the block, half-open.
    pub range: Range<usize>,
    /// Sum of squared one-step errors.
    pub one_step: f64,
    /// Sum of squared errors of free simulation.
    pub free: f64,
}

/// A model's record on samples that were not fitted.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HeldOut {
    /// Errors of each block, in the order of the recording.
    pub blocks: Vec<Block>,
    /// Samples per independent one, by the correlation of the one-step errors.
    pub autocorrelation_factor: f64,
}

impl HeldOut {
    /// Number of held-out samples in all blocks.
    pub fn samples(&self) -> usize {
        self.blocks.iter().map(|b| b.range.len()).sum()
    }

    /// Mean squared one-step error.
    pub fn one_step(&self) -> f64 {
        self.blocks.iter().map(|b| b.one_step).sum::<f64>() / self.samples().max(1) as f64
    }

    /// Mean squared error of free simulation.
    pub fn free(&self) -> f64 {
        self.blocks.iter().map(|b| b.free).sum::<f64>() / self.samples().max(1) as f64
    }

    /// Mean Gaussian log-likelihood per sample with the innovation variance of the training rows.
    pub fn log_score(&self, variance: f64) -> f64 {
        -0.5 * ((2.0 * std::f64::consts::PI * variance).ln() + self.one_step() / variance)
    }
}

/// Two models compared on the same blocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Share of the mean squared one-step error that the second removes.
    pub gain: f64,
    /// 95 % interval of the gain, from the scatter between blocks.
    pub ci95: [f64; 2],
    /// Probability of such a gain by chance: the smaller, doubled, of that from the scatter between
    /// blocks and that from the likelihood.
    pub p_value: f64,
}

/// Compares block by block: the mean of the logarithms of the ratios, by Student's t. What happens
/// in a few blocks only is lost in their scatter; but a model fitted elsewhere is e^L times as
/// likely as the truth with a probability of at most e^−L (Markov's inequality), so that the
/// likelihood of all blocks together may speak too.
pub fn compare(before: &HeldOut, after: &HeldOut) -> Comparison {
    let logs: Vec<f64> = before
        .blocks
        .iter()
        .zip(&after.blocks)
        .filter(|(b, a)| b.one_step > 0.0 && a.one_step > 0.0 && a.one_step.is_finite())
        .map(|(b, a)| (b.one_step / a.one_step).ln())
        .collect();
    let n = logs.len() as f64;
    let gain = 1.0 - after.one_step() / before.one_step().max(1e-300);
    if logs.len() < 3 || !gain.is_finite() {
        return Comparison { gain: 0.0, ci95: [-1.0, 1.0], p_value: 1.0 };
    }
    let mean = logs.iter().sum::<f64>() / n;
    let deviation = (logs.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt().max(1e-12);
    let t = mean / deviation;
    let two_sided = special::f_survival(t * t, 1.0, n - 1.0);
    let by_blocks = if t > 0.0 { 0.5 * two_sided } else { 1.0 - 0.5 * two_sided };
    let rows = after.samples() as f64 / after.autocorrelation_factor.max(1.0);
    let by_likelihood = (-0.5 * rows * (before.one_step() / after.one_step().max(1e-300)).ln()).exp();
    let p_value = (2.0 * by_blocks.min(by_likelihood)).min(1.0);
    Comparison { gain, ci95: interval(before, after), p_value }
}

/// 95 % interval of the gain: jackknife over blocks of the logarithm of the ratio of both sums.
fn interval(before: &HeldOut, after: &HeldOut) -> [f64; 2] {
    let sum = |h: &HeldOut| h.blocks.iter().map(|b| b.one_step).sum::<f64>();
    let (all_before, all_after) = (sum(before), sum(after));
    let without: Vec<f64> = before
        .blocks
        .iter()
        .zip(&after.blocks)
        .map(|(b, a)| ((all_after - a.one_step).max(1e-300) / (all_before - b.one_step).max(1e-300)).ln())
        .collect();
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    let deviation = (without.iter().map(|v| (v - mean).powi(2)).sum::<f64>() * (n - 1.0) / n).sqrt();
    let centre = (all_after.max(1e-300) / all_before.max(1e-300)).ln();
    let reach = special::t_quantile(0.975, n - 1.0) * deviation;
    [centre + reach, centre - reach].map(|log| (1.0 - log.exp()).max(-1.0))
}

/// A model's errors on samples that were not fitted.
pub(crate) fn held_out(data: &Data, fit: &Fit, scales: &Scales, ranges: &[Range<usize>]) -> HeldOut {
    let (mut blocks, mut errors) = (Vec::new(), Vec::new());
    let total: usize = ranges.iter().map(Range::len).sum();
    let length = (total / BLOCKS).max(20);
    let hull = Evaluation::new(data, fit, &fit.point, &for_free_simulation(data, fit, scales), data.hull.clone());
    for range in ranges {
        let inside = range.start >= data.hull.start && range.end <= data.hull.end;
        if inside {
            hull.cut(range.clone(), length, &mut blocks);
            hull.one_step(range, &mut errors);
        } else {
            let point = with_state_at(data, fit, scales, range);
            let here = Evaluation::new(data, fit, &point, &point, range.clone());
            let judged = range.start + LEAD.min(range.len() / 4)..range.end;
            here.cut(judged.clone(), length, &mut blocks);
            here.one_step(&judged, &mut errors);
        }
    }
    HeldOut { blocks, autocorrelation_factor: correlation(&errors, MEMORY) }
}

/// The fitted model with its state at the beginning of a separate range found from the first
/// samples there.
pub(crate) fn with_state_at(data: &Data, fit: &Fit, scales: &Scales, range: &Range<usize>) -> Vec<f64> {
    let lead = LEAD.min(range.len() / 4).max(4);
    let mut point = fit.point.clone();
    let mut free = fit.structure.beginnings();
    free.iter().for_each(|i| point[*i] = 0.0);
    let offsets = (0..=fit.structure.further).map(|r| fit.point[fit.structure.offset(r)]);
    point[OFFSET] = offsets.sum::<f64>() / (fit.structure.further + 1) as f64;
    point[INITIAL] = data.reading[range.start] - point[OFFSET];
    let walks = fit.structure.terms.iter().any(|t| t.noise() == Some(Noise::Walk));
    if walks {
        free.insert(0, OFFSET);
    }
    let rows = range.start..(range.start + lead).min(range.end);
    let search = Search {
        data,
        structure: &fit.structure,
        point: point.clone(),
        free,
        coordinates: coordinates(&fit.structure, scales),
        run: Run { range: rows.clone(), steps: fit.steps, corrected: false },
        rows: vec![rows],
    };
    search.minimise(10).map_or(point, |m| search.point(&m.z))
}

/// The fitted model with offset and initial state as free simulation of the training rows wants
/// them: a filter that corrects itself leaves them undetermined.
pub(crate) fn for_free_simulation(data: &Data, fit: &Fit, scales: &Scales) -> Vec<f64> {
    if !fit.structure.is_noisy() {
        return fit.point.clone();
    }
    let mut point = fit.point.clone();
    let free = fit.structure.all_beginnings();
    for (r, recording) in data.recordings().iter().enumerate().take(fit.structure.further + 1) {
        let initial = fit.structure.initial(r);
        point[initial] = data.reading[recording.start] - point[fit.structure.offset(r)];
        point[initial + 1] = 0.0;
    }
    let search = Search {
        data,
        structure: &fit.structure,
        point,
        free,
        coordinates: coordinates(&fit.structure, scales),
        run: Run { range: data.hull.clone(), steps: fit.steps, corrected: false },
        rows: data.train.clone(),
    };
    search.minimise(4).map_or_else(|| fit.point.clone(), |m| search.point(&m.z))
}

/// Both kinds of error over one run.
struct Evaluation {
    start: usize,
    free: Vec<Lanes>,
    one_step: Option<Vec<Lanes>>,
}

impl Evaluation {
    fn new(data: &Data, fit: &Fit, point: &[f64], free: &[f64], range: Range<usize>) -> Self {
        let run = |corrected, point: &[f64]| {
            let run = Run { range: range.clone(), steps: fit.steps, corrected };
            innovations(data, &fit.structure, &[point.to_vec()], &run, &mut Nothing)
        };
        let (free, one_step) =
            parallel::join(|| run(false, free), || fit.structure.is_noisy().then(|| run(true, point)));
        Self { start: range.start, free, one_step }
    }

    fn one_step(&self, range: &Range<usize>, errors: &mut Vec<f64>) {
        let lanes = self.one_step.as_ref().unwrap_or(&self.free);
        errors.extend(lanes[range.start - self.start..range.end - self.start].iter().map(|e| e[0]));
    }

    fn cut(&self, range: Range<usize>, length: usize, blocks: &mut Vec<Block>) {
        let count = (range.len() / length).max(1);
        let sum = |lanes: &[Lanes], r: &Range<usize>| -> f64 {
            let total: f64 = lanes[r.start - self.start..r.end - self.start].iter().map(|e| e[0] * e[0]).sum();
            if total.is_finite() { total } else { f64::MAX / 1e6 }
        };
        for b in 0..count {
            let r = range.start + range.len() * b / count..range.start + range.len() * (b + 1) / count;
            let free = sum(&self.free, &r);
            let one_step = self.one_step.as_ref().map_or(free, |lanes| sum(lanes, &r));
            blocks.push(Block { range: r, one_step, free });
        }
    }
}

/// 95 % interval of the ratio of root-mean-square errors, from blocks: jackknife of its logarithm.
pub(crate) fn ratio_interval(before: &HeldOut, after: &HeldOut) -> [f64; 2] {
    let n = before.blocks.len();
    let whole = |skip: Option<usize>| {
        let sum = |h: &HeldOut| -> f64 {
            h.blocks.iter().enumerate().filter(|(i, _)| Some(*i) != skip).map(|(_, b)| b.free).sum()
        };
        0.5 * (sum(after).max(1e-300) / sum(before).max(1e-300)).ln()
    };
    let centre = whole(None);
    if n < 3 {
        return [0.0, centre.exp().max(1.0)];
    }
    let apart: Vec<f64> = (0..n).map(|i| whole(Some(i))).collect();
    let mean = apart.iter().sum::<f64>() / n as f64;
    let variance = apart.iter().map(|v| (v - mean).powi(2)).sum::<f64>() * (n as f64 - 1.0) / n as f64;
    let reach = special::t_quantile(0.975, n as f64 - 1.0) * variance.sqrt();
    [(centre - reach).exp(), (centre + reach).exp().min(1e6)]
}
