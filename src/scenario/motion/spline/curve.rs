//! The motion that control points make.

use nalgebra::{UnitQuaternion, Vector3};

use super::basis::{ORDER, Weights};
use crate::motion::pose::Pose;

/// A motion at an instant, over a level that does not turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Position and attitude at the instant.
    pub pose: Pose,
    /// First derivative of position, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Second derivative of position, m/s².
    pub acceleration_m_s2: Vector3<f64>,
    /// Rate against the level, in body axes, rad/s.
    pub rate_rad_s: Vector3<f64>,
    /// Angular acceleration in body axes, rad/s².
    pub angular_acceleration_rad_s2: Vector3<f64>,
}

/// A uniform B-spline of order six.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    /// Time of the first knot, s.
    start_s: f64,
    /// From one knot to the next, s.
    knot_s: f64,
    positions: Vec<Vector3<f64>>,
    attitudes: Vec<UnitQuaternion<f64>>,
    /// Rotation vector from each control attitude to the next, in the axes of the former.
    turns: Vec<Vector3<f64>>,
}

impl Spline {
    /// Of control points, of which there are as many as segments and five more.
    pub fn new(start_s: f64, knot_s: f64, positions: Vec<Vector3<f64>>, attitudes: Vec<UnitQuaternion<f64>>) -> Self {
        let turn = |pair: &[UnitQuaternion<f64>]| (pair[0].inverse() * pair[1]).scaled_axis();
        let turns = attitudes.windows(2).map(turn).collect();
        Self { start_s, knot_s, positions, attitudes, turns }
    }

    /// Time of the last knot, s.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.segments() as f64 * self.knot_s
    }

    /// From one knot to the next, s.
    pub fn knot_s(&self) -> f64 {
        self.knot_s
    }

    fn segments(&self) -> usize {
        self.positions.len().saturating_sub(ORDER - 1)
    }

    /// The segment of an instant and the coordinate in it; beyond the ends, those of the ends.
    pub fn place(start_s: f64, knot_s: f64, segments: usize, time_s: f64) -> (usize, f64) {
        let at = ((time_s - start_s) / knot_s).clamp(0.0, segments as f64);
        let segment = (at as usize).min(segments.saturating_sub(1));
        (segment, at - segment as f64)
    }

    /// The motion at an instant; beyond the ends it is that of the ends.
    pub fn at(&self, time_s: f64) -> Motion {
        let (segment, u) = Self::place(self.start_s, self.knot_s, self.segments(), time_s);
        let weights = Weights::at(u);
        let sum = |weights: &[f64; ORDER]| -> Vector3<f64> {
            // From the segment's own point on, so that far from the origin no digit is lost.
            let origin = self.positions[segment];
            weights.iter().zip(&self.positions[segment..]).map(|(w, p)| (p - origin) * *w).sum()
        };
        let per_s = 1.0 / self.knot_s;
        let steps = weights.cumulative();
        let mut attitude = self.attitudes[segment];
        let (mut rate, mut change) = (Vector3::zeros(), Vector3::zeros());
        for j in 1..ORDER {
            let turn = self.turns[segment + j - 1];
            let part = UnitQuaternion::from_scaled_axis(turn * steps.value[j]);
            let own = turn * (steps.first[j] * per_s);
            attitude *= part;
            rate = part.inverse_transform_vector(&rate) + own;
            change =
                part.inverse_transform_vector(&change) + rate.cross(&own) + turn * (steps.second[j] * per_s * per_s);
        }
        Motion {
            pose: Pose { time_s, position_m: self.positions[segment] + sum(&weights.value), attitude },
            velocity_m_s: sum(&weights.first) * per_s,
            acceleration_m_s2: sum(&weights.second) * (per_s * per_s),
            rate_rad_s: rate,
            angular_acceleration_rad_s2: change,
        }
    }
}
