//! Whether noise that a model names is independent of what is known: the disturbance that its
//! filter estimates is regressed on flexible functions of the input, the motion, time and the
//! environment, and its power on functions of the input and the motion. Noise follows none of
//! them; a law that is missing does, if only by acting where the mass turns or the input reverses.
//!
//! The estimate at a sample uses later innovations alone (the disturbance smoother of de Jong,
//! Biometrika 76, 1989), the regressors use earlier ones: with the right model the two are
//! independent. The regression is cross-fitted: each block is predicted from all others, so that
//! chance makes it worse, not better.

use nalgebra::{DMatrix, DVector, Matrix4, Vector4};

use crate::diagnosis::driven::identification::fit::Fit;
use crate::diagnosis::driven::intake::data::Data;
use crate::diagnosis::driven::simulation::gain;
use crate::diagnosis::driven::simulation::run::trace;
use crate::diagnosis::remainder::REAL;
use crate::numerics::moments::mean_sd;
use crate::numerics::{order, special};
use crate::physics::law::Noise;

use super::residual_structure::EVEN;

/// Blocks that are predicted in turn.
const BLOCKS: usize = 24;
/// Rows that each regressor needs.
const ROWS_PER_REGRESSOR: usize = 10;
/// Quantiles at which a regressor may bend.
const KNOTS: [f64; 7] = [0.02, 0.1, 0.25, 0.5, 0.75, 0.9, 0.98];
/// Cosines of time over the recording.
const COSINES: usize = 8;
/// Those along which a law may drift.
const COURSES: usize = 4;
/// Part of its own size by which each normal equation is held back: regressors may repeat each
/// other.
const RIDGE: f64 = 1e-6;

/// Share of a disturbance's variance that may be predicted as a detail of the other laws: as much as
/// of the innovations before they are no longer called white.
const DETAIL: f64 = 0.02;
/// Power is clipped at this many times its median, so that single readings do not speak for the
/// rest: three standard deviations of normal noise, whose median square is 0.455 σ².
const CLIP: f64 = 9.0 / 0.455;

/// Known quantity that an estimated disturbance may follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// The measured input.
    Input,
    /// Displacement and velocity of the mass.
    Motion,
    /// Time since the recording began.
    Time,
    /// A column of the environment.
    Environment,
}

/// How much of a disturbance is predicted by what predicts it best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Explained {
    /// Share of its variance, or of that of its power, cross-fitted; below zero where chance is
    /// all there is.
    pub r_squared: f64,
    /// Whether it is the power that is predicted.
    pub is_power: bool,
    /// Probability of as much by chance: Student's t of the gain per block, times the number of
    /// questions.
    pub p_value: f64,
    /// Known quantity that explains it best.
    pub by: Known,
}

impl Explained {
    /// Whether chance does not account for it, and it is more than a detail.
    pub fn is_real(&self) -> bool {
        self.p_value < REAL && self.r_squared > if self.is_power { EVEN } else { DETAIL }
    }
}

/// How much is predicted of the disturbance that this noise stands for; `None` where the recording
/// is too short to say.
pub(crate) fn explained_by_known(data: &Data, fit: &Fit, noise: Noise) -> Option<Explained> {
    let (innovations, states) = trace(data, &fit.structure, &fit.point, &fit.run(data, true));
    let breaks: Vec<usize> = data.breaks.iter().map(|b| b.saturating_sub(data.hull.start)).collect();
    let disturbance = smoothed(&innovations, fit, data.interval_s(), noise, &breaks)?;
    let known = Regressors::of(data, &states.x, &states.v);
    let (means, powers) = (known.of_means(), known.of_powers());
    let tests = (means.len() + powers.len()) as f64;
    let asked = |values: &[f64], groups: &[Group], is_power: bool| {
        let found = groups.iter().filter_map(|(by, columns)| {
            let (r_squared, p_value) = cross_fitted(values, columns)?;
            Some(Explained { r_squared, is_power, p_value: (tests * p_value).min(1.0), by: *by })
        });
        found.collect::<Vec<Explained>>()
    };
    let mut all = asked(&disturbance, &means, false);
    if let Some(power) = power(&disturbance) {
        all.extend(asked(&power, &powers, true));
    }
    // What chance does not account for comes first, and of that the least probable.
    all.into_iter().min_by(|a, b| (!a.is_real()).cmp(&!b.is_real()).then(a.p_value.total_cmp(&b.p_value)))
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

/// Without mean, of unit size; `None` for a constant.
fn standard(values: &[f64]) -> Option<Vec<f64>> {
    let (mean, sd) = mean_sd(values);
    (sd > 1e-12 * mean.abs() && sd.is_finite() && sd > 0.0).then(|| values.iter().map(|v| (v - mean) / sd).collect())
}

/// A variable and what bends at its quantiles.
fn bent(values: &[f64]) -> Vec<Vec<f64>> {
    let mut sorted = values.to_vec();
    order::sort(&mut sorted);
    let at = |q: f64| sorted[((sorted.len() - 1) as f64 * q) as usize];
    let bends = KNOTS.iter().map(|q| at(*q)).map(|knot| values.iter().map(|v| (v - knot).max(0.0)).collect());
    std::iter::once(values.to_vec()).chain(bends).collect()
}

/// A known quantity and its functions, row by row of the hull.
type Group = (Known, Vec<Vec<f64>>);

/// Known quantities without mean and of unit size, row by row of the hull.
struct Regressors {
    x: Vec<f64>,
    v: Vec<f64>,
    /// The input and its change from sample to sample.
    input: Option<(Vec<f64>, Vec<f64>)>,
    environment: Vec<Vec<f64>>,
}

impl Regressors {
    fn of(data: &Data, x: &[f64], v: &[f64]) -> Self {
        let or_none = |values: &[f64]| standard(values).unwrap_or_else(|| vec![0.0; values.len()]);
        let input = data.input.as_ref().and_then(|i| standard(&i.samples()[data.hull.clone()]));
        let columns = (0..data.environments).filter_map(|j| {
            let column: Vec<f64> = data.hull.clone().map(|k| data.environment[k * data.environments + j]).collect();
            standard(&column)
        });
        Self {
            x: or_none(x),
            v: or_none(v),
            input: input.map(|u| {
                let change = or_none(&changes(&u));
                (u, change)
            }),
            environment: columns.collect(),
        }
    }

    /// What the disturbance itself may follow. Of the input only the present value and which way
    /// it goes: what follows linearly from the samples beside it says how the input goes between
    /// samples, not that a law is missing.
    fn of_means(&self) -> Vec<Group> {
        let (x, v, rows) = (&self.x, &self.v, self.x.len());
        let mut motion: Vec<Vec<f64>> = [bent(x), bent(v)].concat();
        let tensors: [&dyn Fn(f64, f64) -> f64; 8] = [
            &|_, v| v.signum(),
            &|x, v| x * v,
            &|x, v| x * x * v,
            &|x, v| x * v * v,
            &|x, v| x.abs() * v,
            &|x, v| x * v.abs(),
            &|x, v| x.abs() * v.signum(),
            &|x, _| x.powi(3),
        ];
        motion.extend(tensors.iter().map(|f| product(x, v, f)));
        let middle = |i: usize| (i as f64 + 0.5) / rows as f64;
        let mut time: Vec<Vec<f64>> = (1..=COSINES)
            .map(|j| (0..rows).map(|i| (std::f64::consts::PI * j as f64 * middle(i)).cos()).collect())
            .collect();
        // A stiffness or a damping that drifts, along whatever course.
        let drifts = time[..COURSES].iter().flat_map(|t| [x, v].map(|s| product(t, s, &|t, s| t * s)));
        let drifts: Vec<Vec<f64>> = drifts.collect();
        time.extend(drifts);
        let mut groups = vec![(Known::Motion, motion), (Known::Time, time)];
        if let Some((u, change)) = &self.input {
            let mut all = bent(u);
            all.extend([x, v].map(|s| product(u, s, &|u, s| u * s)));
            all.push(product(u, change, &|_, c| c.signum()));
            all.push(product(u, change, &|u, c| u.abs() * c.signum()));
            groups.push((Known::Input, all));
        }
        let environment: Vec<Vec<f64>> = self.environment.iter().flat_map(|c| bent(c)).collect();
        if !environment.is_empty() {
            groups.push((Known::Environment, environment));
        }
        groups
    }

    /// What its power may follow: how large and how fast the motion and the input are, and where
    /// they turn. Not time: noise may grow.
    fn of_powers(&self) -> Vec<Group> {
        let sizes = |values: &[f64]| bent(&values.iter().map(|v| v.abs()).collect::<Vec<f64>>());
        let both = |values: &[f64], change: &[f64]| {
            let mut all = [bent(values), sizes(values), sizes(change)].concat();
            all.extend([turns(change), product(values, change, &|x, v| (x * v).abs())]);
            all
        };
        let mut groups = vec![(Known::Motion, both(&self.x, &self.v))];
        groups.extend(self.input.as_ref().map(|(u, change)| (Known::Input, both(u, change))));
        groups
    }
}

fn product(a: &[f64], b: &[f64], f: &dyn Fn(f64, f64) -> f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| f(*a, *b)).collect()
}

/// Half of the change from the sample before to the one after.
fn changes(values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    (0..values.len()).map(|i| 0.5 * (values[(i + 1).min(last)] - values[i.saturating_sub(1)])).collect()
}

/// One where a velocity changes its sign between a sample and the next.
fn turns(velocity: &[f64]) -> Vec<f64> {
    let last = velocity.len() - 1;
    (0..velocity.len()).map(|i| f64::from(velocity[i] * velocity[(i + 1).min(last)] <= 0.0)).collect()
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
    use super::*;
    use crate::rng::{Philox, Stream};

    const ROWS: usize = 4800;

    /// A disturbance with a memory of twenty samples beside a broad input, and how much of it is a
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
