//! Computes what sensors that integrate give of a motion: exact integrals over each sampling
//! interval.

use nalgebra::Vector3;

use crate::motion::truth::{Sample, Truth};
use crate::numerics::lagrange;

/// Integrals over one sampling interval, in turning body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Increment {
    /// Integral of the rate against inertial space, rad.
    pub rotation_rad: Vector3<f64>,
    /// Integral of the specific force, m/s.
    pub velocity_m_s: Vector3<f64>,
}

/// Samples that an interval's polynomial goes through.
const NODES: usize = 8;

/// Increments from each sample to the next.
pub fn increments(truth: &Truth) -> Vec<Increment> {
    let of = |value: fn(&Sample) -> Vector3<f64>| {
        integrals(&truth.samples.iter().map(value).collect::<Vec<_>>(), truth.interval_s)
    };
    let (rotations, velocities) = (of(|s| s.rate_rad_s), of(|s| s.specific_force_m_s2));
    let both = rotations.into_iter().zip(velocities);
    both.map(|(rotation_rad, velocity_m_s)| Increment { rotation_rad, velocity_m_s }).collect()
}

/// Integrals from each of the values, `interval_s` apart, to the next: the polynomial through eight
/// samples about an interval, integrated. For motion at a tenth of the sampling rate it errs by
/// 2·10⁻⁵ of the integral, below by the eighth power of the frequency.
pub fn integrals(values: &[Vector3<f64>], interval_s: f64) -> Vec<Vector3<f64>> {
    let count = values.len();
    let nodes = NODES.min(count);
    let weights: Vec<Vec<f64>> = (0..nodes.saturating_sub(1)).map(|at| weights(nodes, at)).collect();
    let integral = |k: usize| -> Vector3<f64> {
        let first = (k + 1).saturating_sub(nodes / 2).min(count - nodes);
        weights[k - first].iter().zip(&values[first..]).map(|(w, value)| value * (w * interval_s)).sum()
    };
    (0..count.saturating_sub(1)).map(integral).collect()
}

/// Integral, from node `at` to the next, of the polynomial through nodes at 0, 1, 2, …: the weight
/// of each.
fn weights(nodes: usize, at: usize) -> Vec<f64> {
    // Gauss and Legendre's four points integrate the seventh degree exactly (Abramowitz & Stegun,
    // table 25.4).
    const POINTS: [(f64, f64); 2] =
        [(0.339_981_043_584_856_26, 0.652_145_154_862_546_1), (0.861_136_311_594_052_6, 0.347_854_845_137_453_85)];
    let places: Vec<f64> = (0..nodes).map(|k| k as f64).collect();
    let weight = |j: usize| {
        let at_point = |x: f64| lagrange::weight(&places, j, at as f64 + 0.5 + 0.5 * x);
        POINTS.iter().map(|(x, w)| 0.5 * w * (at_point(*x) + at_point(-x))).sum()
    };
    (0..nodes).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    /// Samples of a rate and a force that swing.
    fn swinging(count: usize, interval_s: f64, omega: f64) -> Truth {
        let samples = (0..count).map(|k| {
            let t = k as f64 * interval_s;
            Sample {
                time_s: t,
                attitude: UnitQuaternion::identity(),
                velocity_m_s: Vector3::zeros(),
                position_m: Vector3::zeros(),
                specific_force_m_s2: Vector3::new((omega * t).sin(), 1.0, t),
                rate_rad_s: Vector3::new((omega * t).cos(), 0.0, t * t),
            }
        });
        Truth { interval_s, samples: samples.collect() }
    }

    #[test]
    fn increments_are_the_integrals() {
        let (interval, omega) = (0.005, std::f64::consts::TAU * 20.0);
        let truth = swinging(400, interval, omega);
        for (k, increment) in increments(&truth).iter().enumerate() {
            let (from, to) = (k as f64 * interval, (k + 1) as f64 * interval);
            let rotation = ((omega * to).sin() - (omega * from).sin()) / omega;
            let velocity = ((omega * from).cos() - (omega * to).cos()) / omega;
            // The ends have nodes on one side only.
            let tolerance = if (4..395).contains(&k) { 2e-5 } else { 2e-3 };
            assert!((increment.rotation_rad.x - rotation).abs() < tolerance * interval, "{k}");
            assert!((increment.velocity_m_s.x - velocity).abs() < tolerance * interval, "{k}");
            assert!((increment.velocity_m_s.y - interval).abs() < 1e-15);
            assert!((increment.rotation_rad.z - (to.powi(3) - from.powi(3)) / 3.0).abs() < 1e-14);
        }
        // The mean of both ends is far from it.
        let ends = 0.5 * interval * (1.0 + (omega * interval).cos());
        assert!((ends - (omega * interval).sin() / omega).abs() > 1e-2 * interval);
        assert_eq!((increments(&swinging(1, 0.1, 1.0)).len(), increments(&swinging(3, 0.1, 1.0)).len()), (0, 2));
    }
}
