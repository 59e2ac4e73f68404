//! The spline that follows poses closest, in least squares.
//!
//! A rotation of all control attitudes turns the whole curve alike, so the same weights that fit
//! positions fit the rotation vectors that are still missing; a few rounds leave nothing.

use nalgebra::{UnitQuaternion, Vector3};

use super::basis::{ORDER, Weights};
use super::curve::Spline;
use crate::motion::pose::Pose;
use crate::numerics::banded::{Banded, Factor};
use crate::numerics::order;

/// Evenly spaced knots of a spline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knots {
    /// Time of the first, s.
    pub start_s: f64,
    /// Time between knots, s.
    pub knot_s: f64,
    /// Number of intervals between knots.
    pub segments: usize,
}

impl Knots {
    /// Over a stretch of time, `knot_s` apart or a little less.
    pub fn over(from_s: f64, to_s: f64, knot_s: f64) -> Self {
        let segments = ((to_s - from_s) / knot_s - 1e-9).ceil().max(1.0);
        Self { start_s: from_s, knot_s: (to_s - from_s).max(knot_s * 1e-3) / segments, segments: segments as usize }
    }

    fn points(&self) -> usize {
        self.segments + ORDER - 1
    }

    fn place(&self, time_s: f64) -> (usize, [f64; ORDER]) {
        let (segment, u) = Spline::place(self.start_s, self.knot_s, self.segments, time_s);
        (segment, Weights::at(u).value)
    }
}

/// Distance of a spline from the poses it was fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Departure {
    /// Root mean square of the distance, m.
    pub rms_m: f64,
    /// Largest distance between spline and poses, m.
    pub largest_m: f64,
    /// Root mean square of the angle, rad.
    pub rms_rad: f64,
    /// Largest angle between spline and poses, rad.
    pub largest_rad: f64,
    /// Median distance, m: jumps of a reference do not count in it.
    #[serde(skip)]
    pub median_m: f64,
    /// Number of poses from one knot of the spline to the next.
    #[serde(skip)]
    pub poses_per_knot: f64,
    /// From one knot of the spline to the next, s.
    #[serde(skip)]
    pub knot_s: f64,
}

/// Median length of a vector of three normal numbers of unit variance: that of χ of three degrees of freedom.
const MEDIAN: f64 = 1.5382;

impl Departure {
    /// Distance of a spline from poses.
    pub fn of(spline: &Spline, poses: &[Pose]) -> Self {
        let mut departure = Self::default();
        let mut all_m = Vec::with_capacity(poses.len());
        for pose in poses {
            let [metres, angle] = spline.at(pose.time_s).pose.distance(pose);
            all_m.push(metres);
            departure.rms_m += metres * metres;
            departure.rms_rad += angle * angle;
            departure.largest_m = departure.largest_m.max(metres);
            departure.largest_rad = departure.largest_rad.max(angle);
        }
        let count = poses.len().max(1) as f64;
        departure.rms_m = (departure.rms_m / count).sqrt();
        departure.rms_rad = (departure.rms_rad / count).sqrt();
        let span_s = poses.last().zip(poses.first()).map_or(0.0, |(last, first)| last.time_s - first.time_s);
        departure.median_m = order::median(all_m).unwrap_or_default();
        departure.knot_s = spline.knot_s();
        departure.poses_per_knot = count * spline.knot_s() / span_s.max(spline.knot_s());
        departure
    }

    /// Standard deviations of the spline's position, m, and velocity, m/s, along each axis, where poses err each by
    /// itself: with m poses to a knot it passes 1/m of the poses' variance σ², up to the frequency π/h of its knots,
    /// σ²/m and σ²/m·π²/(3h²); of σ² the departure shows all but that part.
    pub fn of_spline(&self) -> [f64; 2] {
        let passes = 1.0 / self.poses_per_knot;
        if !(passes > 0.0 && passes < 1.0) {
            return [0.0; 2];
        }
        let position_m = self.median_m / MEDIAN * (passes / (1.0 - passes)).sqrt();
        [position_m, position_m * std::f64::consts::PI / (3f64.sqrt() * self.knot_s)]
    }
}

/// Weight of the control points' third differences: too small to be seen, it alone decides where no
/// pose lies.
const STIFFNESS: f64 = 1e-9;
/// Rounds of the attitude, and the rotation below which another one is of no use, rad.
const ROUNDS: (usize, f64) = (30, 1e-14);

/// Fits a spline to poses in order of time; none where they cannot be fitted (numbers that are not
/// finite).
pub fn fit(poses: &[Pose], knots: Knots) -> Option<Spline> {
    let places: Vec<_> = poses.iter().map(|pose| knots.place(pose.time_s)).collect();
    let factor = normal_matrix(&places, knots.points()).factor()?;
    let origin = poses.first()?.position_m;
    let residuals = poses.iter().map(|pose| pose.position_m - origin);
    let positions = solved(&factor, &places, residuals, knots.points());
    let positions = positions.into_iter().map(|p| p + origin).collect::<Vec<_>>();
    let attitudes = attitudes(poses, &places, &factor, knots);
    let spline = Spline::new(knots.start_s, knots.knot_s, positions, attitudes);
    let middle = spline.at(0.5 * (knots.start_s + spline.end_s())).pose;
    (middle.position_m.iter().chain(middle.attitude.coords.iter()).all(|x| x.is_finite())).then_some(spline)
}

fn attitudes(
    poses: &[Pose],
    places: &[(usize, [f64; ORDER])],
    factor: &Factor,
    knots: Knots,
) -> Vec<UnitQuaternion<f64>> {
    let mut attitudes: Vec<_> = (0..knots.points())
        // A control point weighs most two segments before the last that it matters in.
        .map(|k| nearest(poses, knots.start_s + (k as f64 - 2.0) * knots.knot_s))
        .collect();
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS.0 {
        let positions = vec![Vector3::zeros(); attitudes.len()];
        let spline = Spline::new(knots.start_s, knots.knot_s, positions, attitudes.clone());
        let missing = poses.iter().map(|pose| {
            let reached = spline.at(pose.time_s).pose.attitude;
            (pose.attitude * reached.inverse()).scaled_axis()
        });
        let turns = solved(factor, places, missing, attitudes.len());
        let largest = turns.iter().map(|t| t.norm()).fold(0.0, f64::max);
        for (attitude, turn) in attitudes.iter_mut().zip(&turns) {
            *attitude = UnitQuaternion::from_scaled_axis(*turn) * *attitude;
            attitude.renormalize();
        }
        // Below, rounding alone goes on.
        if largest < ROUNDS.1 || (largest < 1e-12 && largest >= 0.5 * best) {
            break;
        }
        best = best.min(largest);
    }
    attitudes
}

/// The attitude of the pose nearest in time.
fn nearest(poses: &[Pose], time_s: f64) -> UnitQuaternion<f64> {
    let after = poses.partition_point(|pose| pose.time_s < time_s).min(poses.len() - 1);
    let before = after.saturating_sub(1);
    let closer = |k: usize| (poses[k].time_s - time_s).abs();
    poses[if closer(before) < closer(after) { before } else { after }].attitude
}

fn normal_matrix(places: &[(usize, [f64; ORDER])], points: usize) -> Banded {
    let mut matrix = Banded::zeros(points, ORDER);
    for (segment, weights) in places {
        for row in 0..ORDER {
            for column in 0..=row {
                matrix.add(segment + row, segment + column, weights[row] * weights[column]);
            }
        }
    }
    let stiffness = STIFFNESS * places.len() as f64 / points as f64;
    let difference: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
    for first in 0..points.saturating_sub(3) {
        for row in 0..4 {
            for column in 0..=row {
                matrix.add(first + row, first + column, stiffness * difference[row] * difference[column]);
            }
        }
    }
    matrix
}

/// Control vectors that meet the values at the places closest.
fn solved(
    factor: &Factor,
    places: &[(usize, [f64; ORDER])],
    values: impl Iterator<Item = Vector3<f64>>,
    points: usize,
) -> Vec<Vector3<f64>> {
    let mut sides: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; points]);
    for ((segment, weights), value) in places.iter().zip(values) {
        for (k, weight) in weights.iter().enumerate() {
            (0..3).for_each(|axis| sides[axis][segment + k] += weight * value[axis]);
        }
    }
    sides.iter_mut().for_each(|side| factor.solve(side));
    (0..points).map(|k| Vector3::new(sides[0][k], sides[1][k], sides[2][k])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// A body that swings about all axes while it moves on a curve: pose, velocity, acceleration,
    /// rate in body axes.
    fn swing(t: f64) -> (Pose, Vector3<f64>, Vector3<f64>, Vector3<f64>) {
        let position_m = Vector3::new((0.7 * t).sin() * 3.0, (1.1 * t).cos() * 2.0, 0.5 * (1.3 * t).sin());
        let velocity = Vector3::new((0.7 * t).cos() * 2.1, (1.1 * t).sin() * -2.2, 0.65 * (1.3 * t).cos());
        let acceleration = Vector3::new((0.7 * t).sin() * -1.47, (1.1 * t).cos() * -2.42, -0.845 * (1.3 * t).sin());
        let (yaw, pitch, roll) = (0.8 * t, 0.4 * (1.7 * t).sin(), 0.3 * (0.9 * t).cos());
        let (yaw_s, pitch_s, roll_s) = (0.8, 0.68 * (1.7 * t).cos(), -0.27 * (0.9 * t).sin());
        // Kinematics of Euler angles (Titterton & Weston, §3.6.3).
        let rate = Vector3::new(
            roll_s - yaw_s * pitch.sin(),
            pitch_s * roll.cos() + yaw_s * roll.sin() * pitch.cos(),
            yaw_s * roll.cos() * pitch.cos() - pitch_s * roll.sin(),
        );
        let attitude = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        (Pose { time_s: t, position_m, attitude }, velocity, acceleration, rate)
    }

    #[test]
    fn a_spline_through_noisy_poses_errs_as_its_departure_says() {
        const NOISE_M: f64 = 1e-3;
        let mut draw = Philox::new(3, 0, Stream::Host);
        let poses: Vec<Pose> = (0..8000)
            .map(|k| {
                let pose = swing(f64::from(k) * 0.01).0;
                Pose { position_m: pose.position_m + Vector3::from_fn(|_, _| NOISE_M * draw.normal()), ..pose }
            })
            .collect();
        let errs = |intervals: f64| {
            let spline = fit(&poses, Knots::over(0.0, 79.99, 0.01 * intervals)).expect("fitted");
            let mut squares = [0.0; 2];
            let times: Vec<f64> = (200..7800).map(|k| 0.01003 * f64::from(k)).collect();
            for t in &times {
                let (found, (pose, velocity, ..)) = (spline.at(*t), swing(*t));
                squares[0] += (found.pose.position_m - pose.position_m).norm_squared();
                squares[1] += (found.velocity_m_s - velocity).norm_squared();
            }
            let rms = squares.map(|sum| (sum / (3 * times.len()) as f64).sqrt());
            (rms, Departure::of(&spline, &poses).of_spline())
        };
        let all = [4.0, 8.0, 16.0].map(errs);
        let near = |rms: f64, sd: f64| (rms / sd - 1.0).abs() < 0.1;
        for (place, (rms, sd)) in all.iter().enumerate() {
            // 3·8000/16 control points at least: 2 % each, and the median of the departure 1 %.
            assert!(near(rms[0], sd[0]) && near(rms[1], sd[1]), "{place}: {rms:?}, {sd:?}");
            // Control: knots twice as far apart let less of the noise pass.
            let other = all[(place + 1) % all.len()].1;
            assert!(!near(rms[0], other[0]) && !near(rms[1], other[1]), "{place}: {rms:?}, {other:?}");
        }
    }

    fn fitted(knot_s: f64) -> Spline {
        let poses: Vec<Pose> = (0..=1000).map(|k| swing(f64::from(k) * 0.02).0).collect();
        fit(&poses, Knots::over(0.0, 20.0, knot_s)).expect("fitted")
    }

    /// Largest errors of acceleration, rate and angular acceleration in the inner part.
    fn errors(spline: &Spline) -> [f64; 3] {
        let mut worst = [0.0f64; 3];
        for k in 0..1700 {
            let t = 1.5 + f64::from(k) * 0.01;
            let (motion, (_, velocity, acceleration, rate)) = (spline.at(t), swing(t));
            assert!((motion.velocity_m_s - velocity).norm() < 1e-3, "at {t} {:?} {:?}", motion.velocity_m_s, velocity);
            let slope = (swing(t + 1e-4).3 - swing(t - 1e-4).3) / 2e-4;
            worst[0] = worst[0].max((motion.acceleration_m_s2 - acceleration).norm());
            worst[1] = worst[1].max((motion.rate_rad_s - rate).norm());
            worst[2] = worst[2].max((motion.angular_acceleration_rad_s2 - slope).norm());
        }
        worst
    }

    #[test]
    fn derivatives_are_the_analytic_ones_to_the_order_of_the_spline() {
        let (coarse, fine) = (errors(&fitted(0.16)), errors(&fitted(0.08)));
        // Order six: position errs by h⁶, acceleration by h⁴. Rotations about axes that turn do not
        // commute: each step's part of the next is h³ [ω, ω′], of which no control point takes what
        // varies within a segment, so attitude errs by h³, rate by h², angular acceleration by h.
        for (k, order) in [(0, 4), (1, 2), (2, 1)] {
            let ratio = coarse[k] / fine[k];
            let expected = 2f64.powi(order);
            assert!((0.6 * expected..2.5 * expected).contains(&ratio), "{k}: {coarse:?} {fine:?}");
        }
        assert!(fine[0] < 1e-6 && fine[1] < 1e-5 && fine[2] < 1e-3, "{fine:?}");
    }

    #[test]
    fn rates_are_the_derivatives_of_the_curve_itself() {
        let spline = fitted(0.4);
        let step = 1e-5;
        for t in [0.013, 3.21, 10.0, 17.77] {
            let (before, here, after) = (spline.at(t - step), spline.at(t), spline.at(t + step));
            let turn = (before.pose.attitude.inverse() * after.pose.attitude).scaled_axis() / (2.0 * step);
            assert!((here.rate_rad_s - turn).norm() < 1e-8, "{t}: {} {turn}", here.rate_rad_s);
            let change = (after.rate_rad_s - before.rate_rad_s) / (2.0 * step);
            assert!((here.angular_acceleration_rad_s2 - change).norm() < 1e-7);
            // The check sees the other sense of the cross product.
            let wrong = here.rate_rad_s.cross(&change).norm() * 1e-3;
            assert!(wrong > 1e-7);
        }
    }

    #[test]
    fn a_body_at_rest_stays_where_it_is_and_a_hole_is_bridged() {
        let attitude = UnitQuaternion::from_euler_angles(0.1, -0.2, 2.0);
        let pose = |k: i32| Pose { time_s: f64::from(k) * 0.1, position_m: Vector3::new(5.0, 6.0, 7.0), attitude };
        let poses: Vec<Pose> = (0..100).filter(|k| !(40..50).contains(k)).map(pose).collect();
        let spline = fit(&poses, Knots::over(0.0, 9.9, 0.2)).expect("fitted");
        let motion = spline.at(4.4);
        assert!(motion.velocity_m_s.norm() < 1e-12 && motion.rate_rad_s.norm() < 1e-12);
        assert!(Departure::of(&spline, &poses).largest_m < 1e-12);
        let mut broken = poses;
        broken[3].position_m.x = f64::NAN;
        assert!(fit(&broken, Knots::over(0.0, 9.9, 0.2)).is_none());
    }
}
