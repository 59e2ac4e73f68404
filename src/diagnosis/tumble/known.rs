//! Tells what a recording in still poses can know, what it finds, and the same of its halves.
//!
//! One fit of the full linear model, of all poses and of those of each half. The variance of a row
//! is its measured noise times what the whole fit leaves of its kind, times what neighbouring poses
//! remember of one another: an error that lasts over poses is not averaged out by them.

use nalgebra::DMatrix;

use super::calibration::Point;
use super::fit::{Fit, Question};
use super::group::{GROUPS, Group};
use super::imu::Observed;
use super::linear::Linear;
use super::memory;
use super::motion;
use super::residual::Residual;
use super::wander;
use crate::repeatability::besides::{Besides, What};
use crate::repeatability::information::{Information, Known};
use crate::repeatability::parameter::Estimate;
use crate::repeatability::run::{Halves, Run, Split};
use crate::sensor::Sense;

/// Degrees of freedom behind the measured noise: as in `residual`.
const NOISE_FREEDOM: f64 = 60.0;
/// Poses in the shortest block that a half is made of: each block loses the move out of it.
const BLOCKS: [usize; 3] = [5, 3, 2];
/// Fewest poses of a half: fewer leave no residual to any parameter.
const FEWEST: usize = 4;

/// A recording in poses, ready to be checked.
#[derive(Debug)]
pub(super) struct Poses<'a> {
    pub observed: Observed<'a>,
    pub guess: Point,
    pub linear: Linear,
    /// Numbers of poses that were left out, from zero.
    pub left_out: Vec<usize>,
    pub findings: Vec<String>,
}

/// The variance of each kind of row over what was measured inside the poses.
#[derive(Debug, Clone)]
struct Errors {
    /// By group.
    left: [f64; GROUPS.len()],
    /// By group: gravity, then x, y and z of the gyro at rest; moves are taken to be independent.
    memory: [f64; 4],
    /// Degrees of freedom behind it, by group.
    freedom: [f64; GROUPS.len()],
}

impl Errors {
    fn of(fit: &Fit) -> Self {
        let left = GROUPS.map(|g| fit.reduced(g).max(1.0));
        let freedom = GROUPS.map(|g| {
            let own = (fit.rows.chi_square(g).1 as f64 - fit.leverage(g)).max(1.0);
            // Where the measured noise accounts for the residual, its degrees of freedom count as well.
            if fit.inflation[g.place()] > 1.0 { own } else { own + NOISE_FREEDOM }
        });
        let series = |group: Group, axis: usize, of: usize| -> f64 {
            let rows = (0..fit.rows.group.len()).filter(|r| fit.rows.group[*r] == group);
            memory::factor(&rows.skip(axis).step_by(of).map(|r| fit.rows.residual[r]).collect::<Vec<_>>())
        };
        let still = [0, 1, 2].map(|axis| series(Group::Still, axis, 3));
        Self { left, memory: [series(Group::Gravity, 0, 1), still[0], still[1], still[2]], freedom }
    }

    /// The factor on the measured variance of every row.
    fn of_rows(&self, groups: &[Group]) -> Vec<f64> {
        let mut still = 0;
        let of = |group: &Group| {
            let memory = match group {
                Group::Gravity => self.memory[0],
                Group::Still => {
                    still += 1;
                    self.memory[1 + (still - 1) % 3]
                }
                Group::Turn => 1.0,
            };
            self.left[group.place()] * memory
        };
        groups.iter().map(of).collect()
    }
}

/// Checks a recording.
pub(super) fn check(poses: Poses<'_>) -> Run {
    let Poses { observed, guess, linear, left_out, findings } = poses;
    let rows = observed.rows(&guess, &linear.active);
    let before = linear.information(&rows, &guess, &guess, &vec![1.0; rows.group.len()]);
    let fit = Fit::balanced_of(&observed, &guess, &linear.active, &linear.beforehand(&guess, &guess, &before.known));
    let errors = Errors::of(&fit);
    let reading = Reading { linear: &linear, guess: &guess, errors: &errors };
    let (information, estimate) = reading.told(&fit, &before, &linear.tolerance(&guess));
    let half = |counts: &dyn Fn(usize) -> bool| {
        let mut part = observed.clone();
        part.poses.iter_mut().enumerate().for_each(|(k, pose)| pose.counts &= counts(k));
        (part.counting() >= FEWEST).then(|| reading.part(&part, (&fit, &estimate)))
    };
    let splits = std::iter::once(Split::FirstAndSecond).chain(BLOCKS.map(|poses| Split::Blocks { poses }));
    let halves = splits.filter_map(|split| {
        let first = first_half(&observed, split);
        Some(Halves { split, each: [half(&|k| first[k])?, half(&|k| !first[k])?] })
    });
    let halves = Halves::least_lost(&estimate, halves);
    let moved = motion::of(&observed, &fit, &left_out);
    let remedies = motion::remedies(&observed, &fit, &errors.left, &estimate);
    let besides = beyond(&fit);
    Run { information, estimate, halves, motion: Some(moved), remedies, findings, besides }
}

/// Sensors whose residual is more than noise and more than noise may wander. Gravity's direction after a move is both
/// sensors', and the gyro's where the accelerometer reads gravity as it is.
fn beyond(fit: &Fit) -> Vec<Besides> {
    let above = Residual::of(fit).above;
    let times = |group: Group| above.iter().find(|(g, times)| *g == group && *times > wander::MOST).map(|a| a.1.sqrt());
    let turned = if times(Group::Gravity).is_none() { times(Group::Turn) } else { None };
    let of_gyro = [times(Group::Still), turned].into_iter().flatten().max_by(f64::total_cmp);
    let said = |sensor: Sense, times: f64| Besides { channel: sensor.name().to_owned(), what: What::Beyond(times) };
    let accelerometer = times(Group::Gravity).map(|times| said(Sense::Accelerometer, times));
    accelerometer.into_iter().chain(of_gyro.map(|times| said(Sense::Gyro, times))).collect()
}

/// The means by which fits are read.
struct Reading<'a> {
    linear: &'a Linear,
    guess: &'a Point,
    errors: &'a Errors,
}

impl Reading<'_> {
    /// Estimates from some of the poses. What they do not determine is held where the whole has it, what the
    /// whole does not determine where it was held before.
    fn part(&self, part: &Observed<'_>, (whole, estimate): (&Fit, &Estimate)) -> Estimate {
        let Self { linear, guess, errors } = *self;
        let information = Information { known: estimate.known.clone(), undetermined: Vec::new() };
        let rows = part.rows(&whole.point, &linear.active);
        let mut before = linear.information(&rows, &whole.point, guess, &errors.of_rows(&rows.group));
        before.beside(&information);
        let known = linear.beforehand(guess, &whole.point, &before.known);
        let question = Question { active: &linear.active, inflation: &whole.inflation, known: &known };
        let mut held = linear.tolerance(guess);
        (0..estimate.known.len()).filter(|p| estimate.determines(*p)).for_each(|p| held[p] = estimate.deviation(p));
        self.told(&Fit::of(part, &whole.point, question), &before, &held).1
    }

    /// Knowledge and estimates of a fit; `held`: errors of what is held.
    fn told(&self, fit: &Fit, before: &Information, held: &[f64]) -> (Information, Estimate) {
        let Self { linear, guess, errors } = *self;
        let factor = errors.of_rows(&fit.rows.group);
        let mut information = linear.information(&fit.rows, &fit.point, guess, &factor);
        information.beside(before);
        // The design holds the inflation already.
        let weighed = |r: usize| factor[r] / fit.inflation[fit.rows.group[r].place()];
        let slopes = linear.slopes(&fit.point);
        let covariance = match fit.covariance(weighed) {
            Some(covariance) => &slopes * covariance * slopes.transpose(),
            None => DMatrix::from_element(slopes.nrows(), slopes.nrows(), f64::NAN),
        };
        let tolerance = linear.tolerance(guess);
        let matrix = linear.information_matrix(&fit.rows, &fit.point, &factor);
        let covariance = covariance + of_held(&matrix, &before.known, (&tolerance, held));
        let parameters = linear.parameters();
        let count = parameters.len();
        let freedom = parameters.iter().filter_map(|p| p.element()).map(|p| self.freedom(p.sensor)).collect();
        let estimate = Estimate {
            tolerance: tolerance[..count].to_vec(),
            value: linear.values(&fit.point),
            covariance: covariance.view((0, 0), (count, count)).into_owned(),
            freedom,
            known: information.known.clone(),
            parameters,
        };
        (information, estimate)
    }

    fn freedom(&self, sensor: Sense) -> f64 {
        match sensor {
            Sense::Accelerometer => self.errors.freedom[Group::Gravity.place()],
            Sense::Gyro => self.errors.freedom[Group::Still.place()].min(self.errors.freedom[Group::Turn.place()]),
        }
    }
}

/// Covariance that parameters have because others are held, each wrongly by its error: it enters those that
/// the poses do not separate from them.
fn of_held(information: &DMatrix<f64>, known: &[Known], (tolerance, errors): (&[f64], &[f64])) -> DMatrix<f64> {
    let count = tolerance.len();
    let is_held = |p: &usize| known.get(*p) == Some(&Known::Not);
    let (held, free): (Vec<usize>, Vec<usize>) = (0..count).partition(is_held);
    let mut out = DMatrix::zeros(count, count);
    let own = DMatrix::from_fn(free.len(), free.len(), |i, j| {
        information[(free[i], free[j])] * tolerance[free[i]] * tolerance[free[j]] + f64::from(u8::from(i == j))
    });
    let with = DMatrix::from_fn(free.len(), held.len(), |i, j| {
        information[(free[i], held[j])] * tolerance[free[i]] * errors[held[j]]
    });
    let Some(moved) = own.cholesky().map(|c| c.solve(&with)) else { return out };
    let added = &moved * moved.transpose();
    for (i, p) in free.iter().enumerate() {
        for (j, q) in free.iter().enumerate() {
            out[(*p, *q)] = added[(i, j)] * tolerance[*p] * tolerance[*q];
        }
    }
    out
}

/// Which poses make the first half.
fn first_half(observed: &Observed<'_>, split: Split) -> Vec<bool> {
    let total = observed.counting();
    let mut place = 0;
    let of = |counts: bool| {
        let first = match split {
            Split::FirstAndSecond => 2 * place < total,
            Split::Blocks { poses } => (place / poses) % 2 == 0,
            Split::Alternating { .. } => place % 2 == 0,
        };
        place += usize::from(counts);
        first
    };
    observed.poses.iter().map(|p| p.counts).map(of).collect()
}
