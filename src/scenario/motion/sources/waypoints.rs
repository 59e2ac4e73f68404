//! `waypoints`: from point to point at constant speed on a smooth curve through all of them, and a
//! stop at the last.
//!
//! The curve is the cubic spline through the points, by the length of their chords, with free ends.

use nalgebra::Vector3;

use super::ramp;
use super::section::Section;
use super::source::{Source, fail, positive};
use super::track::{Curve, along};
use crate::error::Result;
use crate::motion::pose::Pose;
use crate::numerics::banded::Banded;

/// Name, keys and poses of kind = "waypoints".
pub const SOURCE: Source =
    Source { name: "waypoints", keys: &["points_m", "speed_m_s", "acceleration_m_s2", "still_s"], poses: Some(poses) };

/// A cubic spline through points.
struct Cubic {
    /// Parameter at each point: the chords up to it, m.
    knots: Vec<f64>,
    points: Vec<Vector3<f64>>,
    /// Second derivatives at the points.
    bends: Vec<Vector3<f64>>,
}

impl Cubic {
    /// Through points that differ from their neighbours; none if there are fewer than two.
    fn through(points: Vec<Vector3<f64>>) -> Option<Self> {
        let chords: Vec<f64> = points.windows(2).map(|p| (p[1] - p[0]).norm()).collect();
        let knots: Vec<f64> = std::iter::once(0.0)
            .chain(chords.iter().scan(0.0, |sum, c| {
                *sum += c;
                Some(*sum)
            }))
            .collect();
        let inner = points.len().checked_sub(2)?;
        let mut bends = vec![Vector3::zeros(); points.len()];
        if inner > 0 {
            let mut matrix = Banded::zeros(inner, 2);
            for k in 0..inner {
                matrix.add(k, k, (chords[k] + chords[k + 1]) / 3.0);
                (k > 0).then(|| matrix.add(k, k - 1, chords[k] / 6.0));
            }
            let factor = matrix.factor()?;
            for axis in 0..3 {
                let slope = |k: usize| (points[k + 1][axis] - points[k][axis]) / chords[k];
                let mut side: Vec<f64> = (0..inner).map(|k| slope(k + 1) - slope(k)).collect();
                factor.solve(&mut side);
                side.iter().zip(&mut bends[1..]).for_each(|(value, bend)| bend[axis] = *value);
            }
        }
        Some(Self { knots, points, bends })
    }

    /// The piece of a parameter, its length, and the distances to its ends; beyond the ends, the
    /// outer pieces go straight on.
    fn piece(&self, q: f64) -> (usize, f64, f64, f64) {
        let piece = self.knots.partition_point(|k| *k <= q).clamp(1, self.knots.len() - 1) - 1;
        let length = self.knots[piece + 1] - self.knots[piece];
        (piece, length, self.knots[piece + 1] - q, q - self.knots[piece])
    }

    /// Length of the curve, m, by Simpson's rule.
    fn length_m(&self) -> f64 {
        const PARTS: usize = 64;
        let piece = |k: usize| {
            let (from, step) = (self.knots[k], (self.knots[k + 1] - self.knots[k]) / (2 * PARTS) as f64);
            let speed = |j: usize| self.slope(from + step * j as f64).norm();
            (0..PARTS).map(|j| (speed(2 * j) + 4.0 * speed(2 * j + 1) + speed(2 * j + 2)) * step / 3.0).sum::<f64>()
        };
        (0..self.knots.len() - 1).map(piece).sum()
    }
}

impl Curve for Cubic {
    fn point(&self, q: f64) -> Vector3<f64> {
        let (k, h, a, b) = self.piece(q);
        let straight = (self.points[k] * a + self.points[k + 1] * b) / h;
        straight + (self.bends[k] * (a * a - h * h) * a + self.bends[k + 1] * (b * b - h * h) * b) / (6.0 * h)
    }

    fn slope(&self, q: f64) -> Vector3<f64> {
        let (k, h, a, b) = self.piece(q.clamp(0.0, self.knots[self.knots.len() - 1]));
        let straight = (self.points[k + 1] - self.points[k]) / h;
        straight + (self.bends[k + 1] * (3.0 * b * b - h * h) - self.bends[k] * (3.0 * a * a - h * h)) / (6.0 * h)
    }
}

fn poses(section: &Section, duration_s: f64) -> Result<Vec<Pose>> {
    let example = "e.g. points_m = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [100.0, 50.0, -10.0]]: north, east, down";
    let points: Vec<Vector3<f64>> = section.points_m.iter().flatten().map(|p| Vector3::from(*p)).collect();
    if points.len() < 2 {
        return Err(fail(format!("trajectory.points_m: need two points or more, got {}", points.len()), example));
    }
    if let Some(at) = points.windows(2).map(|p| (p[1] - p[0]).norm()).position(|apart| apart.is_nan() || apart <= 1e-3)
    {
        let cause = format!("trajectory.points_m: points {} and {} are the same, or not finite", at + 1, at + 2);
        return Err(fail(cause, "leave one of them out"));
    }
    let speed = positive("speed_m_s", section.speed_m_s, 10.0)?;
    let acceleration = positive("acceleration_m_s2", section.acceleration_m_s2, 1.0)?;
    let Some(curve) = Cubic::through(points) else {
        return Err(fail("trajectory.points_m: no curve passes through them", example));
    };
    let length = curve.length_m();
    // A way too short to reach full speed is gone at a lower one.
    let speed = speed.min((length * acceleration).sqrt());
    let (still, rise) = (section.still_s.unwrap_or(10.0), speed / acceleration);
    let arrival = still + rise + (length - speed * rise) / speed;
    let way = move |t: f64| {
        let gone = |since: f64| speed * rise * ramp::integral(since / rise);
        gone(t - still) - gone(t - arrival)
    };
    Ok(along(&curve, duration_s, way))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_leads_through_every_point_and_ends_at_the_last() {
        let section: Section = proofmass_base::document::parse_toml(
            "study.toml",
            "kind = \"waypoints\"\npoints_m = [[0, 0, 0], [100, 0, 0], [100, 80, -20], [0, 80, 0]]\nstill_s = 3.0",
        )
        .expect("read");
        let poses = poses(&section, 60.0).expect("made");
        for point in section.points_m.iter().flatten().map(|p| Vector3::from(*p)) {
            let nearest = poses.iter().map(|p| (p.position_m - point).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 0.11, "{point}: {nearest}");
        }
        let (first, last) = (poses[100].position_m, poses[poses.len() - 1].position_m);
        assert!(first.norm() < 1e-9 && (last - Vector3::new(0.0, 80.0, 0.0)).norm() < 1e-3, "{last}");
        assert!((poses[poses.len() - 100].position_m - last).norm() < 1e-9, "it stops");
    }
}
