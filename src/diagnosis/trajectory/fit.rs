//! All parameters at once, by Gauss and Newton, each residual weighted by its own colour.

use nalgebra::Vector3;

use super::along_gyro::{AS_A_WHOLE, BY_BLOCK, along_gyro_rows};
use super::attitude::{ATTITUDE, attitude_rows, error};
use super::blocks::{BLOCKS, Blocks, Linear, part};
use super::colour::Held;
use super::course::{Anchor, Case, Course, Turns};
use super::log::Motion;
use super::parameters::{LOWPASS, PARAMETERS, Point, widths};
use super::position::{POSITION, Steady, position_rows};
use super::rows::{Bins, Orders, Row};
use super::shown;
use super::whitening::Whitening;
use crate::control::{Control, Stopped};
use crate::model::Half;
use crate::numerics::order;

/// Rounds at most, and the fraction of a standard error below which none is needed any more.
const ROUNDS: usize = 5;
const SETTLED: f64 = 0.1;
/// Fewest poses in a bin.
const POSES: f64 = 3.0;

/// States how rows of one half of a pose are made.
#[derive(Debug, Clone, Copy)]
struct Recipe {
    /// Width of a bin, s.
    width_s: f64,
    /// States how often rows are differenced, by axis.
    orders: Orders,
    /// Rows that its noise looks back at most.
    most: usize,
}

impl Recipe {
    fn of(half: Half, anchor: Anchor) -> Self {
        match (half, anchor) {
            // More would trust the slow part of the residual, in which references that were
            // smoothed err most.
            (Half::Attitude, _) => Self { width_s: 0.05, orders: ATTITUDE, most: 3 },
            // Second differences of position take more to be made white.
            (Half::Position, Anchor::Reference) => Self { width_s: 0.1, orders: POSITION, most: 10 },
            (Half::Position, Anchor::Found { turns: Turns::AsAWhole, .. }) => {
                Self { width_s: 0.1, orders: AS_A_WHOLE, most: 10 }
            }
            // Third differences take more still.
            (Half::Position, Anchor::Found { turns: Turns::ByBlock, .. }) => {
                Self { width_s: 0.1, orders: BY_BLOCK, most: 20 }
            }
        }
    }

    fn whitening(self, rows: &[Row], residual: &[Vector3<f64>], cut: &Cut) -> Whitening {
        let part = rows.iter().map(|row| cut.part(row.time_s)).collect();
        let held = Held { holds: rows.iter().map(|row| row.holds).collect(), part };
        // Lags must lie in one block: at most half of its rows, so that the other half is left to
        // fit.
        let most = if cut.by_block { self.most.min(rows.len() / (2 * BLOCKS)) } else { self.most };
        Whitening::of(residual, &held, most, &self.orders.groups())
    }

    fn bins(self, motion: &Motion) -> Bins {
        Bins::over(&motion.time_s, self.width_s.max(POSES * motion.interval_s))
    }
}

/// Rows at the last point, with what makes them white.
#[derive(Debug, Clone)]
pub(super) struct Residuals {
    /// The half of a pose that they are of.
    pub half: Half,
    recipe: Recipe,
    /// In order of time.
    pub rows: Vec<Row>,
    /// From one to the next, s.
    pub width_s: f64,
    /// Holds what makes them white.
    pub whitening: Whitening,
}

/// A fit of everything.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    /// The linearised model about the last point.
    pub linear: Linear,
    /// Rows of attitude and of position, where the reference has them.
    pub residuals: Vec<Residuals>,
    /// E at the poses, rad; empty where the reference has no attitudes.
    pub error: Vec<Vector3<f64>>,
}

impl Fit {
    /// From a start; `active` are the parameters that are freed.
    ///
    /// # Errors
    /// When stopped.
    pub(super) fn new(case: &Case<'_>, start: &Point, active: &[usize], control: &Control) -> Result<Self, Stopped> {
        Self::within(ROUNDS, case, start, active, control)
    }

    /// Makes the rows, and what is linear, at a start, and takes no step from there.
    ///
    /// # Errors
    /// When stopped.
    pub(super) fn at(case: &Case<'_>, start: &Point, active: &[usize], control: &Control) -> Result<Self, Stopped> {
        Self::within(0, case, start, active, control)
    }

    /// Fits in so many rounds at most.
    fn within(
        rounds: usize,
        case: &Case<'_>,
        start: &Point,
        active: &[usize],
        control: &Control,
    ) -> Result<Self, Stopped> {
        let mut point = *start;
        let motion = case.motion;
        let ends_s = [motion.time_s[0], motion.time_s[motion.time_s.len() - 1]];
        let cut = Cut {
            ends_s,
            by_block: case.anchor.is_by_block(),
            widths: widths(motion.halves),
            random_walks: case.random_walks,
        };
        let mut round = 0;
        loop {
            control.go_on()?;
            let course = Course::of(case, &point);
            let error = if motion.halves.attitude { error(case, &course, &point) } else { Vec::new() };
            let plain = |half: Half| {
                let recipe = Recipe::of(half, case.anchor);
                let bins = recipe.bins(motion);
                let rows = match (half, motion.halves.attitude) {
                    (Half::Attitude, _) => attitude_rows(case, &course, &point, &bins),
                    (Half::Position, true) => {
                        let stamps: Vec<f64> =
                            (0..motion.time_s.len()).map(|pose| case.stamp_s(&point, pose)).collect();
                        position_rows(case, &course, &point, &bins, &Steady::of(&stamps, &error))
                    }
                    (Half::Position, false) => along_gyro_rows(case, &course, &point, (&bins, recipe.orders)),
                };
                Residuals::new(half, rows, bins.width_s, recipe, &cut)
            };
            let there = [Half::Attitude, Half::Position].into_iter().filter(|half| motion.halves.has(*half));
            let all = there.map(plain).collect();
            let (linear, mut residuals) = coloured(&point, all, active, &cut);
            round += 1;
            if round > rounds {
                // A reference that jumps says nothing of the sensor.
                let solved = linear.solve(active, |_| true).point;
                residuals.iter_mut().zip(&linear.sensors).for_each(|(r, sums)| leave_out(r, sums, &point, &solved));
                let (linear, residuals) = coloured(&point, residuals, active, &cut);
                return Ok(Self { linear, residuals, error });
            }
            let mut solved = linear.solve(active, |_| true);
            // Negative squares belong to no filter: the readings are corrected by none, and steps
            // to below zero must not add up.
            solved.point[LOWPASS] = solved.point[LOWPASS].max(0.0);
            let moved = |(i, p): (usize, &usize)| {
                (solved.point[*p] - point[*p]).abs() > SETTLED * solved.covariance[(i, i)].max(0.0).sqrt()
            };
            if !active.iter().enumerate().any(moved) {
                round = round.max(rounds);
            }
            point = solved.point;
        }
    }

    /// Root mean square of the whitened residual of the attitude's rows, rad/s, of position's,
    /// m/s², where the reference has no attitudes.
    pub(super) fn innovation(&self) -> f64 {
        self.residuals.first().map_or(f64::INFINITY, |r| r.whitening.deviation.norm())
    }

    /// Rows of one half of a pose, with their sums.
    pub(super) fn of(&self, half: Half) -> Option<(&Residuals, &Blocks)> {
        self.residuals.iter().zip(&self.linear.sensors).find(|(r, _)| r.half == half)
    }

    /// Residuals of the rows of one half of a pose at a point, and whether they hold.
    pub(super) fn residuals_at(&self, half: Half, point: &Point) -> Option<Vec<(Vector3<f64>, bool)>> {
        let (residuals, sums) = self.of(half)?;
        let at = residuals.at(sums, &self.linear.point, point);
        Some(at.into_iter().zip(&residuals.rows).map(|(value, row)| (value, row.holds)).collect())
    }

    /// By how much the reference's attitude and the gyro's differ, root mean square of an axis
    /// about the mean, rad; zero where the reference has no attitudes.
    pub(super) fn tilt_rad(&self) -> f64 {
        let count = self.error.len().max(1) as f64;
        let mean = self.error.iter().sum::<Vector3<f64>>() / count;
        (self.error.iter().map(|e| (e - mean).norm_squared()).sum::<f64>() / (3.0 * count)).sqrt()
    }
}

/// Rows whose residual is larger than this, in medians of all, are outliers and not fitted.
const APART: f64 = 8.0;

fn leave_out(residuals: &mut Residuals, sums: &Blocks, from: &Point, to: &Point) {
    let sizes: Vec<f64> = residuals.at(sums, from, to).iter().map(Vector3::norm).collect();
    // Where an attitude turns by block, so does what is usual: a body that vibrates in flight and
    // stands still before it has no one size.
    let count = residuals.rows.len();
    let part = if sums.turn() { count.div_ceil(BLOCKS) } else { count };
    for (rows, sizes) in residuals.rows.chunks_mut(part.max(1)).zip(sizes.chunks(part.max(1))) {
        let held = rows.iter().zip(sizes).filter(|(r, _)| r.holds).map(|(_, s)| *s).collect();
        let usual = order::median(held).unwrap_or_default();
        rows.iter_mut().zip(sizes).for_each(|(row, size)| row.holds &= *size <= APART * usual);
    }
}

/// Iterations of whitening and solving: where the attitude is one, and where it turns by block.
/// There each turn depends on the whitening before it, and the two take longer to settle.
const COLOURED: (usize, usize) = (2, 8);

/// States how rows are cut into blocks, and what is known before them.
struct Cut {
    ends_s: [f64; 2],
    /// States whether an attitude turns by block.
    by_block: bool,
    /// Standard deviations of the prior.
    widths: Point,
    /// N² of gyro and accelerometer, SI.
    random_walks: [f64; 2],
}

impl Cut {
    /// The part of the recording whose residuals go on into each other.
    fn part(&self, time_s: f64) -> usize {
        if self.by_block { part(time_s, self.ends_s, BLOCKS) } else { 0 }
    }
}

impl Residuals {
    /// At another point than the one that they were taken at.
    pub(super) fn at(&self, sums: &Blocks, from: &Point, to: &Point) -> Vec<Vector3<f64>> {
        self.rows.iter().map(|row| row.at(from, &sums.at(row.time_s, from, to))).collect()
    }

    /// With the colour of the rows as they are.
    fn new(half: Half, rows: Vec<Row>, width_s: f64, recipe: Recipe, cut: &Cut) -> Self {
        let residual: Vec<_> = rows.iter().map(|r| r.residual).collect();
        Self { half, recipe, whitening: recipe.whitening(&rows, &residual, cut), rows, width_s }
    }
}

/// The sums of what the colour of the residual makes white that the active parameters leave: from
/// a colour that is nearly right, a few times with that of the residual.
fn coloured(point: &Point, mut residuals: Vec<Residuals>, active: &[usize], cut: &Cut) -> (Linear, Vec<Residuals>) {
    let linear = |residuals: &[Residuals]| Linear {
        point: *point,
        widths: cut.widths,
        noise: shown::noise(residuals.iter().map(|r| (&r.rows[..], r.half, r.width_s)), cut.random_walks),
        sensors: residuals.iter().map(|r| Blocks::of(&r.rows, &r.whitening, cut.ends_s, cut.by_block)).collect(),
    };
    for _ in 0..if cut.by_block { COLOURED.1 } else { COLOURED.0 } {
        let linear = linear(&residuals);
        let solved = linear.solve(active, |_| true).point;
        for (r, sums) in residuals.iter_mut().zip(&linear.sensors) {
            let residual = r.at(sums, point, &solved);
            r.whitening = r.recipe.whitening(&r.rows, &residual, cut);
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
