//! Three kinds of residual, each over its own noise, and their slopes by every parameter.
//!
//! - gravity: |f| − g, one per pose;
//! - still: the gyro's reading at rest, three per pose;
//! - turn: gravity's direction as the integrated gyro carries it from one pose to the next, two per
//!   move: see `turn`.
//!
//! An accelerometer alone has the first kind only.
//!
//! A row belongs to a pose (a move to the pose it starts from), so that whole poses can be held
//! out.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

use super::calibration::{Calibration, Point, gyro};
use super::group::Group;
use super::imu::Observed;
use super::slopes::{Active, reading_slopes};
use super::turn::Turn;
use crate::sensor::Sense;

/// Residuals over their noise, with slopes by the active parameters where asked for.
#[derive(Debug, Clone)]
pub struct Rows {
    /// Each over its standard deviation.
    pub residual: DVector<f64>,
    /// Rows × active parameters; no columns where slopes were not asked for.
    pub slope: DMatrix<f64>,
    /// In SI: divide by it what is in SI to get `residual`.
    pub deviation: Vec<f64>,
    /// Kind of each row.
    pub group: Vec<Group>,
    /// Pose of each row.
    pub pose: Vec<usize>,
}

/// A pose's specific force and its slopes: (column, ∂f).
type Force<'a> = (&'a Vector3<f64>, &'a [(usize, Vector3<f64>)]);

impl Observed<'_> {
    /// Specific force of each pose, m/s².
    pub fn forces_m_s2(&self, calibration: &Calibration) -> Vec<Vector3<f64>> {
        self.poses.iter().map(|p| calibration.specific_force_m_s2(p.accelerometer.into(), &p.slow)).collect()
    }

    /// All residuals at a point of the parameter space; slopes by `active` (empty: none).
    pub fn rows(&self, point: &Point, active: &[usize]) -> Rows {
        let calibration = Calibration::from_point(point);
        let active = Active::new(active);
        let forces = self.forces_m_s2(&calibration);
        let force_slopes: Vec<Vec<(usize, Vector3<f64>)>> = self
            .poses
            .iter()
            .zip(&forces)
            .map(|(pose, force)| active.force_slopes(point, &calibration, pose, force))
            .collect();
        let with_gyro = self.imu.gyro.is_some();
        let moves = if with_gyro { self.poses.len().saturating_sub(1) } else { 0 };
        let turns: Vec<Turn> = (0..moves)
            .map(|k| self.turn(point, &calibration, (!active.list.is_empty()).then_some(&active), k))
            .collect();
        let attitudes = attitudes(&forces, &turns);

        let counts = |k: usize| self.poses[k].counts;
        let turned = |k: usize| k < moves && counts(k) && counts(k + 1);
        let per_pose = |k: usize| usize::from(counts(k)) * if with_gyro { 4 } else { 1 } + usize::from(turned(k)) * 2;
        let count = (0..self.poses.len()).map(per_pose).sum();
        let mut rows = Rows {
            residual: DVector::zeros(count),
            slope: DMatrix::zeros(count, active.list.len()),
            deviation: Vec::with_capacity(count),
            group: Vec::with_capacity(count),
            pose: Vec::with_capacity(count),
        };
        for k in (0..self.poses.len()).filter(|k| counts(*k)) {
            self.gravity_row(&mut rows, k, &forces[k], &force_slopes[k]);
            if with_gyro {
                self.still_rows(
                    &mut rows,
                    (point, &calibration, &active),
                    k,
                    (&forces[k], &force_slopes[k]),
                    &attitudes[k],
                );
            }
            if turned(k) {
                let ends = [k, k + 1].map(|p| (&forces[p], force_slopes[p].as_slice()));
                self.turn_rows(&mut rows, k, &turns[k], ends);
            }
        }
        rows
    }

    fn gravity_row(&self, rows: &mut Rows, k: usize, force: &Vector3<f64>, slopes: &[(usize, Vector3<f64>)]) {
        let length = force.norm().max(f64::MIN_POSITIVE);
        let up = force / length;
        let variance: f64 =
            (0..3).map(|i| self.poses[k].accelerometer_variance[i] * (up[i] / self.accelerometer_scale).powi(2)).sum();
        let deviation = variance.sqrt();
        let row = rows.push(Group::Gravity, k, length - self.imu.gravity_m_s2, deviation);
        for (column, change) in slopes {
            rows.slope[(row, *column)] += up.dot(change) / rows.deviation[row];
        }
    }

    fn still_rows(
        &self,
        rows: &mut Rows,
        (point, calibration, active): (&Point, &Calibration, &Active<'_>),
        k: usize,
        (force, force_slopes): Force<'_>,
        attitude: &Matrix3<f64>,
    ) {
        let pose = &self.poses[k];
        let triad = &calibration.gyro;
        let into_axes = triad.alignment * attitude.transpose();
        let residual = triad.along_axes(pose.gyro, &pose.slow)
            - calibration.g_sensitivity * force
            - into_axes * calibration.frame_rate_rad_s;
        let first = rows.deviation.len();
        for i in 0..3 {
            rows.push(Group::Still, k, residual[i], pose.gyro_variance[i].sqrt() / self.gyro_scale);
        }
        let mut give = |parameter: usize, axis: usize, phi: f64| {
            if let Some(column) = active.column[parameter] {
                rows.slope[(first + axis, column)] -= phi / rows.deviation[first + axis];
            }
        };
        reading_slopes(Sense::Gyro, triad, point[gyro::SCALE.start], &pose.gyro, &pose.slow, &mut give);
        for i in 0..3 {
            for j in 0..3 {
                give(gyro::G_SENSITIVITY.start + 3 * i + j, i, force[j]);
                give(gyro::FRAME_RATE.start + j, i, into_axes[(i, j)]);
            }
        }
        for (column, change) in force_slopes {
            let through = calibration.g_sensitivity * change;
            for i in 0..3 {
                rows.slope[(first + i, *column)] -= through[i] / rows.deviation[first + i];
            }
        }
    }

    fn turn_rows(
        &self,
        rows: &mut Rows,
        k: usize,
        turn: &Turn,
        [(start, start_slopes), (end, end_slopes)]: [Force<'_>; 2],
    ) {
        let back = turn.rotation.transpose();
        let (up_start, up_end) = (start.normalize(), end.normalize());
        let carried = back * up_start;
        let length_s = (self.poses[k + 1].samples.start - self.poses[k].samples.end) as f64 / self.imu.rate_hz;
        let angle_variance: f64 =
            (0..3).map(|i| self.gyro_noise[i].integral_variance(length_s) / self.gyro_scale.powi(2)).sum::<f64>() / 3.0;
        let direction_variance: f64 = [k, k + 1]
            .iter()
            .map(|p| {
                let v = self.poses[*p].accelerometer_variance;
                (0..3).map(|i| v[i] / self.accelerometer_scale.powi(2)).sum::<f64>() / 3.0
            })
            .sum::<f64>()
            / self.imu.gravity_m_s2.powi(2);
        let deviation = (angle_variance + direction_variance).sqrt();
        let (first, second) = tangents(&up_end);
        for tangent in [first, second] {
            let row = rows.push(Group::Turn, k, tangent.dot(&carried), deviation);
            let over = 1.0 / rows.deviation[row];
            for (column, slope) in turn.slopes.iter().enumerate() {
                rows.slope[(row, column)] += tangent.dot(&carried.cross(slope)) * over;
            }
            for (column, change) in start_slopes {
                let turned = back * (change - up_start * up_start.dot(change)) / start.norm();
                rows.slope[(row, *column)] += tangent.dot(&turned) * over;
            }
            for (column, change) in end_slopes {
                rows.slope[(row, *column)] -= tangent.dot(change) / end.norm() * over;
            }
        }
    }
}

impl Rows {
    fn push(&mut self, group: Group, pose: usize, value_si: f64, deviation_si: f64) -> usize {
        let row = self.deviation.len();
        // A column without any noise (a perfect simulation, a dead channel) must not divide by
        // zero.
        let deviation = deviation_si.max(1e-12);
        self.residual[row] = value_si / deviation;
        self.deviation.push(deviation);
        self.group.push(group);
        self.pose.push(pose);
        row
    }

    /// Returns what the rows tell of the active parameters where the variance of each is `variance`
    /// times what was measured: the Fisher information.
    pub(super) fn information(&self, variance: &[f64]) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.slope.ncols(), self.slope.ncols());
        for (r, variance) in variance.iter().enumerate() {
            let row = self.slope.row(r).transpose();
            out.ger(variance.recip(), &row, &row, 1.0);
        }
        out
    }

    /// Sum of squares of one group, and its number of rows.
    pub fn chi_square(&self, group: Group) -> (f64, usize) {
        let squares = self.group.iter().zip(self.residual.iter()).filter(|(g, _)| **g == group);
        squares.fold((0.0, 0), |(sum, n), (_, r)| (sum + r * r, n + 1))
    }
}

/// Two directions across `up`.
fn tangents(up: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let least = up.iamin();
    let first = up.cross(&Vector3::ith(least, 1.0)).normalize();
    (first, up.cross(&first))
}

/// Rotation from each pose's frame to the first one's: gyro for the heading, gravity for the rest.
fn attitudes(forces: &[Vector3<f64>], turns: &[Turn]) -> Vec<Matrix3<f64>> {
    let mut out = vec![Matrix3::identity()];
    for (k, turn) in turns.iter().enumerate().take(forces.len().saturating_sub(1)) {
        let next = out[k] * turn.rotation;
        let level = Rotation3::rotation_between(&(next * forces[k + 1]), &forces[0]);
        out.push(level.map_or(next, |r| r.matrix() * next));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tumble::calibration::{PARAMETERS, accelerometer};
    use crate::tumble::imu::Imu;

    const COUNTS_PER_UNIT: f64 = 1000.0;

    /// Three poses and two turns of an ideal IMU, sampled without noise but for a ripple that gives
    /// poses a variance.
    fn columns() -> ([Vec<f64>; 3], [Vec<f64>; 3]) {
        let (mut gyro, mut accelerometer): ([Vec<f64>; 3], [Vec<f64>; 3]) = Default::default();
        let mut attitude = Rotation3::identity();
        for (turning, axis) in [
            (false, Vector3::zeros()),
            (true, Vector3::new(1.0, 0.5, 0.0)),
            (false, Vector3::zeros()),
            (true, Vector3::new(0.2, -1.0, 0.7)),
            (false, Vector3::zeros()),
        ] {
            for k in 0..if turning { 25 } else { 100 } {
                let rate: Vector3<f64> = if turning { axis * 4.0 } else { Vector3::zeros() };
                let force = attitude.inverse() * Vector3::new(1.0, 2.0, 9.55);
                for i in 0..3 {
                    let ripple = 1e-3 * f64::from((k * (7 + i as i32)) % 11 - 5);
                    gyro[i].push(COUNTS_PER_UNIT * (rate[i] + ripple));
                    accelerometer[i].push(COUNTS_PER_UNIT * (force[i] + ripple));
                }
                attitude *= Rotation3::new(rate / 100.0);
            }
        }
        (gyro, accelerometer)
    }

    #[test]
    fn every_slope_agrees_with_a_finite_difference() {
        let (gyro, accelerometer) = columns();
        let imu = Imu {
            rate_hz: 100.0,
            gyro: Some([&gyro[0], &gyro[1], &gyro[2]]),
            accelerometer: [&accelerometer[0], &accelerometer[1], &accelerometer[2]],
            covariate: Some((0..gyro[0].len()).map(|k| k as f64 * 0.01).collect()),
            gravity_m_s2: 9.81,
        };
        let mut observed = imu.observe(&[0..100, 125..225, 250..350]);
        (observed.accelerometer_scale, observed.gyro_scale) = (COUNTS_PER_UNIT, COUNTS_PER_UNIT);
        let mut point: Point = [0.0; PARAMETERS];
        point[accelerometer::SCALE.start] = COUNTS_PER_UNIT;
        point[gyro::SCALE.start] = COUNTS_PER_UNIT;
        let active: Vec<usize> = (0..PARAMETERS).collect();
        let rows = observed.rows(&point, &active);
        for p in 0..PARAMETERS {
            let step = 1e-6 * point[p].abs().max(1.0);
            let at = |by: f64| {
                let mut moved = point;
                moved[p] += by;
                observed.rows(&moved, &[]).residual
            };
            let difference = (at(step) - at(-step)) / (2.0 * step);
            let slope = rows.slope.column(p);
            // The slopes of turns are first order in one sample's angle (0.05 rad) and in the
            // residual itself.
            let error = (&difference - slope).norm() / slope.norm();
            assert!(slope.norm() > 0.0 && error < 0.01, "parameter {p}: {error}");
        }
    }
}
