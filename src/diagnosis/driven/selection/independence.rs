//! Tests whether noise that a model names is independent of what is known. Its innovations are
//! tested for what the input, the motion, time and the environment would make of them
//! (`lagrange_multiplier`), and the power of the disturbance that the filter estimates is regressed
//! on functions of the input and the motion. Noise follows none of them; a law that is missing
//! does, if only by acting where the mass turns or the input reverses.
//!
//! The estimate at a sample uses later innovations alone (the disturbance smoother of de Jong,
//! Biometrika 76, 1989), the regressors use earlier ones: with the right model the two are
//! independent. The regression of power is cross-fitted: each block is predicted from all others,
//! so that chance makes it worse, not better.

use nalgebra::{DMatrix, DVector, Matrix4, Vector4};

use crate::driven::base::OMEGA;
use crate::driven::identification::fit::Fit;
use crate::driven::intake::data::Data;
use crate::driven::simulation::gain;
use crate::driven::simulation::run::trace;
use crate::numerics::moments::mean_sd;
use crate::numerics::{order, special};
use crate::physics::law::Noise;
use crate::remainder::REAL;

use super::known::{Known, Regressors};
use super::lagrange_multiplier::{Entry, Filter, Score, Tested};
use super::pumped::Pumped;
use super::residual_structure::EVEN;

/// Blocks that are predicted in turn.
const BLOCKS: usize = 24;
/// Rows that each regressor needs.
const ROWS_PER_REGRESSOR: usize = 10;
/// Part of its own size by which each normal equation is held back: regressors may repeat each
/// other.
const RIDGE: f64 = 1e-6;

/// Share of what a noise absorbs that known quantities may explain. At a tenth its strength is
/// overstated by 5 %, √(1/0.9).
const DETAIL: f64 = 0.1;
/// Power is clipped at this many times its median, so that single readings do not speak for the
/// rest: three standard deviations of normal noise, whose median square is 0.455 σ².
const CLIP: f64 = 9.0 / 0.455;

/// Share of a disturbance that is predicted by the known quantity that predicts it best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Explained {
    /// Share of the degrees of freedom that the noise absorbs in the innovations; of the variance
    /// of its power, cross-fitted. Below zero where chance is all there is.
    pub r_squared: f64,
    /// States whether it is the power that is predicted.
    pub is_power: bool,
    /// Probability of as much by chance, times the number of questions: of the score test, or
    /// Student's t of the gain per block.
    pub p_value: f64,
    /// Known quantity that explains it best.
    pub by: Known,
}

impl Explained {
    /// Returns whether chance does not account for it, and it is more than a detail.
    pub fn is_real(&self) -> bool {
        self.p_value < REAL && self.r_squared > self.least()
    }

    /// Share above which it is more than a detail.
    pub fn least(&self) -> f64 {
        if self.is_power { EVEN } else { DETAIL }
    }
}

/// Returns how much is predicted of the disturbance that this noise stands for; `None` where the
/// recording is too short.
pub(crate) fn explained_by_known(data: &Data, fit: &Fit, noise: Noise) -> Option<Explained> {
    let (innovations, states) = trace(data, &fit.structure, &fit.point, &fit.run(data, true));
    let breaks: Vec<usize> = data.breaks.iter().map(|b| b.saturating_sub(data.hull.start)).collect();
    let disturbance = smoothed(&innovations, fit, data.interval_s(), noise, &breaks)?;
    let filter = Filter::of(fit, data.interval_s(), breaks);
    let known = Regressors::of(data, fit.point[OMEGA], [&states.x, &states.v]);
    let freedom = filter.freedom(noise) * innovations.len() as f64;
    let granted = known.between_samples().iter().map(|g| filter.answer(g, Entry::Force)).collect::<Vec<_>>();
    let means = known.of_means();
    let asked = means.iter().flat_map(|group| [Entry::Force, Entry::Reading].map(|entry| (group, entry)));
    let tested = Tested::of(&innovations, &granted)?;
    let asked = asked.filter_map(|((by, columns), entry)| {
        let Score { gain, p_value } = tested.score(columns.iter().map(|c| filter.answer(c, entry)))?;
        Some(Explained { r_squared: gain / freedom, is_power: false, p_value, by: *by })
    });
    let mut all: Vec<Explained> = asked.collect();
    let motion = [&states.x, &states.v].map(|motion| Pumped::of(&disturbance, motion));
    all.extend(motion.iter().flatten().flat_map(|pumped| {
        let looked_at = 2.0 * pumped.looked_at as f64;
        pumped.columns.iter().filter_map({
            let (filter, tested) = (&filter, &tested);
            move |columns| {
                let Score { gain, p_value } = tested.score(columns.iter().map(|c| filter.answer(c, Entry::Force)))?;
                let p_value = looked_at * p_value;
                Some(Explained { r_squared: gain / freedom, is_power: false, p_value, by: Known::Time })
            }
        })
    }));
    let powers = known.of_powers();
    all.extend(power(&disturbance).iter().flat_map(|power| {
        powers.iter().filter_map(|(by, columns)| {
            let (r_squared, p_value) = cross_fitted(power, columns)?;
            Some(Explained { r_squared, is_power: true, p_value, by: *by })
        })
    }));
    let tests = (2 * means.len() + powers.len()) as f64;
    let all = all.into_iter().map(|e| Explained { p_value: (tests * e.p_value).min(1.0), ..e });
    // What chance does not account for comes first, and of that the least probable.
    all.min_by(|a, b| (!a.is_real()).cmp(&!b.is_real()).then(a.p_value.total_cmp(&b.p_value)))
}

/// Squares of a disturbance, clipped, about their mean.
fn power(disturbance: &[f64]) -> Option<Vec<f64>> {
    let squares = || disturbance.iter().map(|d| d * d);
    let limit = CLIP * order::median(squares().collect())?;
    let clipped: Vec<f64> = squares().map(|p| p.min(limit)).collect();
    let (mean, sd) = mean_sd(&clipped);
    (sd > 0.0 && sd.is_finite()).then(|| clipped.iter().map(|p| p - mean).collect())
}

/// The disturbance between each sample and the next, up to a factor, from the innovations after it.
fn smoothed(innovations: &[f64], fit: &Fit, interval_s: f64, noise: Noise, breaks: &[usize]) -> Option<Vec<f64>> {
    let noisy = fit.structure.noisy(&fit.point, interval_s);
    let (system, k) = (gain::system(&noisy), gain::stationary(&noisy).k);
    let gain = Vector4::<f64>::from(k);
    let closed = system.transition * (Matrix4::<f64>::identity() - gain * system.sees.transpose());
    let along = match noise {
        Noise::Force => system.push,
        Noise::Walk => Vector4::new(0.0, 0.0, 1.0, 0.0),
    };
    let mut costate = Vector4::<f64>::zeros();
    let mut disturbance: Vec<f64> = vec![0.0; innovations.len()];
    for i in (0..innovations.len()).rev() {
        if breaks.contains(&(i + 1)) {
            costate = Vector4::zeros();
        }
        disturbance[i] = along.dot(&costate);
        costate = system.sees * innovations[i] + closed.transpose() * costate;
    }
    disturbance.iter().all(|d| d.is_finite()).then_some(disturbance)
}

/// Share of the variance that regressors predict of blocks that they were not fitted to, and the
/// probability of that by chance.
fn cross_fitted(values: &[f64], columns: &[Vec<f64>]) -> Option<(f64, f64)> {
    let (rows, width) = (values.len(), columns.len() + 1);
    if rows < ROWS_PER_REGRESSOR * width || rows < 4 * BLOCKS {
        return None;
    }
    let row = |i: usize| DVector::from_iterator(width, std::iter::once(1.0).chain(columns.iter().map(move |c| c[i])));
    let edges: Vec<usize> = (0..=BLOCKS).map(|b| rows * b / BLOCKS).collect();
    let blocks: Vec<(DMatrix<f64>, DVector<f64>)> = edges
        .windows(2)
        .map(|edge| {
            let mut normal = (DMatrix::zeros(width, width), DVector::zeros(width));
            for (i, value) in (edge[0]..edge[1]).zip(&values[edge[0]..edge[1]]) {
                let here = row(i);
                normal.0.ger(1.0, &here, &here, 1.0);
                normal.1.axpy(*value, &here, 1.0);
            }
            normal
        })
        .collect();
    let mut all = (DMatrix::zeros(width, width), DVector::zeros(width));
    for (matrix, vector) in &blocks {
        all.0 += matrix;
        all.1 += vector;
    }
    let gains: Vec<[f64; 2]> = edges
        .windows(2)
        .zip(&blocks)
        .map(|(edge, (matrix, vector))| {
            let mut others = &all.0 - matrix;
            for j in 0..width {
                others[(j, j)] *= 1.0 + RIDGE;
                others[(j, j)] += 1e-12 * rows as f64;
            }
            let weights = others.cholesky()?.solve(&(&all.1 - vector));
            let here = || (edge[0]..edge[1]).map(|i| (values[i], weights.dot(&row(i))));
            let total: f64 = here().map(|(value, _)| value * value).sum();
            let gain: f64 = here().map(|(value, predicted)| value.powi(2) - (value - predicted).powi(2)).sum();
            Some([gain, gain / total.max(1e-300)])
        })
        .collect::<Option<_>>()?;
    let total: f64 = values.iter().map(|v| v * v).sum();
    let of = |which: usize| gains.iter().map(|g| g[which]).collect::<Vec<f64>>();
    // Loud blocks speak for the rest in the first, and not in the second: two questions.
    let p_value = 2.0 * above_zero(&of(0)).min(above_zero(&of(1)));
    (total > 0.0).then(|| (of(0).iter().sum::<f64>() / total, p_value.min(1.0)))
}

/// Probability of a mean as far above zero by chance: Student's t.
fn above_zero(values: &[f64]) -> f64 {
    let (mean, sd) = mean_sd(values);
    let n = values.len() as f64;
    let t = mean / (sd * (n / (n - 1.0)).sqrt() / n.sqrt()).max(1e-300);
    let two_sided = special::f_survival(t * t, 1.0, n - 1.0);
    if t > 0.0 { 0.5 * two_sided } else { 1.0 - 0.5 * two_sided }
}

#[cfg(test)]
mod tests {
    use super::super::known::bent;
    use super::*;
    use crate::rng::{Philox, Stream};

    const ROWS: usize = 4800;

    /// A disturbance with a memory of twenty samples under a broad input, and how much of it is a
    /// dead zone's.
    fn explained_of(seed: u64, part: f64) -> Option<(f64, f64)> {
        let mut rng = Philox::new(seed, 0, Stream::Host);
        let input: Vec<f64> = (0..ROWS).map(|_| rng.normal()).collect();
        let mut slow = 0.0;
        let noise: Vec<f64> = (0..ROWS)
            .map(|_| {
                slow += -0.05 * slow + (0.1f64).sqrt() * rng.normal();
                slow
            })
            .collect();
        let bend = |u: f64| u - u.signum() * (u.abs() - 0.5).max(0.0) - 0.56 * u;
        let disturbance: Vec<f64> = noise.iter().zip(&input).map(|(n, u)| n + part * bend(*u)).collect();
        cross_fitted(&disturbance, &bent(&input))
    }

    // The gain of a block has a mean below zero by chance, so that fewer than the stated fraction
    // of nulls alarm: of 100 at 1 %, more than 5 come once in 3000 at most.
    #[test]
    fn noise_with_a_memory_follows_nothing_and_a_dead_zone_is_predicted() {
        let found = |part: f64| (0..100).filter(|s| explained_of(*s, part).is_some_and(|f| f.1 < 0.01)).count();
        assert!(found(0.0) <= 5, "{} alarms", found(0.0));
        assert!(found(2.0) >= 95, "{} found", found(2.0));
    }
}
