//! All parameters at once, by Gauss and Newton, each residual weighted by its own colour.

use nalgebra::Vector3;

use super::attitude::{attitude_rows, error};
use super::blocks::{Blocks, Linear};
use super::course::{Case, Course};
use super::parameters::{PARAMETERS, Point};
use super::position::{Steady, position_rows};
use super::rows::{Bins, Row};
use super::whitening::Whitening;
use crate::control::{Control, Stopped};
use crate::numerics::order;

/// Rounds at most, and the fraction of a standard error below which none is needed any more.
const ROUNDS: usize = 5;
const SETTLED: f64 = 0.1;
/// Width of a bin of attitude and of position, s, and in poses at least.
const WIDTH: [(f64, f64); 2] = [(0.05, 3.0), (0.1, 3.0)];
/// Rows that the noise of attitude and of position looks back at most. More of attitude would trust
/// the slow part of the residual, in which references that were smoothed err most; the second
/// differences of position take more to be made white.
const MOST: [usize; 2] = [3, 10];

/// Rows at the last point, with what makes them white.
#[derive(Debug, Clone)]
pub(super) struct Residuals {
    /// In order of time.
    pub rows: Vec<Row>,
    /// From one to the next, s.
    pub width_s: f64,
    /// What makes them white.
    pub whitening: Whitening,
}

/// A fit of everything.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    /// The linearised model about the last point.
    pub linear: Linear,
    /// Rows of attitude, and of position where the reference has it.
    pub residuals: Vec<Residuals>,
    /// E at the poses, rad.
    pub error: Vec<Vector3<f64>>,
}

impl Fit {
    /// From a start; `active` are the parameters that are freed.
    ///
    /// # Errors
    /// When stopped.
    pub(super) fn new(case: &Case<'_>, start: &Point, active: &[usize], control: &Control) -> Result<Self, Stopped> {
        let mut point = *start;
        let motion = case.motion;
        let bins = WIDTH.map(|(width_s, poses)| Bins::over(&motion.time_s, width_s.max(poses * motion.interval_s)));
        let mut round = 0;
        loop {
            control.go_on()?;
            let course = Course::of(case, &point);
            let error = error(case, &course, &point);
            let mut all = vec![(attitude_rows(case, &course, &point, &bins[0]), bins[0].width_s)];
            if motion.has_position {
                let stamps: Vec<f64> = (0..motion.time_s.len()).map(|pose| case.stamp_s(&point, pose)).collect();
                let steady = Steady::of(&stamps, &error);
                all.push((position_rows(case, &course, &point, &bins[1], &steady), bins[1].width_s));
            }
            let ends = [motion.time_s[0], motion.time_s[motion.time_s.len() - 1]];
            let (linear, mut residuals) = whitened(&point, all, active, ends);
            round += 1;
            if round > ROUNDS {
                // A reference that jumps says nothing of the sensor.
                let solved = linear.solve(active, |_| true).point;
                residuals.iter_mut().for_each(|r| leave_out(&mut r.rows, &point, &solved));
                let (linear, residuals) = coloured(&point, residuals, active, ends);
                return Ok(Self { linear, residuals, error });
            }
            let solved = linear.solve(active, |_| true);
            let moved = |(i, p): (usize, &usize)| {
                (solved.point[*p] - point[*p]).abs() > SETTLED * solved.covariance[(i, i)].max(0.0).sqrt()
            };
            if !active.iter().enumerate().any(moved) {
                round = round.max(ROUNDS);
            }
            point = solved.point;
        }
    }

    /// Root mean square of the whitened residual of the attitude's rows, rad/s.
    pub(super) fn innovation_rad_s(&self) -> f64 {
        self.residuals.first().map_or(f64::INFINITY, |r| r.whitening.deviation.norm())
    }

    /// By how much the reference's attitude and the gyro's differ, root mean square of an axis
    /// about the mean, rad.
    pub(super) fn tilt_rad(&self) -> f64 {
        let count = self.error.len().max(1) as f64;
        let mean = self.error.iter().sum::<Vector3<f64>>() / count;
        (self.error.iter().map(|e| (e - mean).norm_squared()).sum::<f64>() / (3.0 * count)).sqrt()
    }
}

/// Rows whose residual is larger than this, in medians of all, are outliers and not fitted.
const APART: f64 = 8.0;

fn leave_out(rows: &mut [Row], from: &Point, to: &Point) {
    let sizes: Vec<f64> = rows.iter().map(|r| r.at(from, to).norm()).collect();
    let held = rows.iter().zip(&sizes).filter(|(r, _)| r.holds).map(|(_, s)| *s).collect();
    let usual = order::median(held).unwrap_or_default();
    rows.iter_mut().zip(&sizes).for_each(|(row, size)| row.holds &= *size <= APART * usual);
}

/// The colour of the residual that the active parameters leave, and the sums of what it makes
/// white.
fn whitened(point: &Point, all: Vec<(Vec<Row>, f64)>, active: &[usize], ends: [f64; 2]) -> (Linear, Vec<Residuals>) {
    let plain = |(sensor, (rows, width_s)): (usize, (Vec<Row>, f64))| {
        let residual: Vec<_> = rows.iter().map(|r| r.residual).collect();
        Residuals { whitening: Whitening::of(&rows, &residual, MOST[sensor]), rows, width_s }
    };
    let residuals: Vec<Residuals> = all.into_iter().enumerate().map(plain).collect();
    coloured(point, residuals, active, ends)
}

/// The same from a colour that is nearly right, twice with that of the residual.
fn coloured(
    point: &Point,
    mut residuals: Vec<Residuals>,
    active: &[usize],
    ends: [f64; 2],
) -> (Linear, Vec<Residuals>) {
    let linear = |residuals: &[Residuals]| Linear {
        point: *point,
        sensors: residuals.iter().map(|r| Blocks::of(&r.rows, &r.whitening, ends)).collect(),
    };
    for _ in 0..2 {
        let solved = linear(&residuals).solve(active, |_| true).point;
        for (sensor, r) in residuals.iter_mut().enumerate() {
            let residual: Vec<_> = r.rows.iter().map(|row| row.at(point, &solved)).collect();
            r.whitening = Whitening::of(&r.rows, &residual, MOST[sensor]);
        }
    }
    (linear(&residuals), residuals)
}

impl Row {
    /// Its residual at another point than the one it was taken at.
    pub(super) fn at(&self, from: &Point, to: &Point) -> Vector3<f64> {
        (0..PARAMETERS).filter(|p| to[*p] != from[*p]).fold(self.residual, |r, p| r + self.slope[p] * (to[p] - from[p]))
    }
}
