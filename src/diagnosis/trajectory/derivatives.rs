//! States how the readings change: what a low-pass that they went through has taken.

use nalgebra::Vector3;

use super::log::Log;
use crate::parallel;

/// Vectors at the samples of a log, of both sensors.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Both {
    /// Of the gyro's readings.
    pub rate: Vec<Vector3<f64>>,
    /// Of the accelerometer's.
    pub force: Vec<Vector3<f64>>,
}

/// Derivatives of the readings of a log by time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Derivatives {
    /// First ones, from one neighbour to the other; unit/s.
    pub first: Both,
    /// Second ones, smoothed; unit/s².
    pub second: Both,
    /// By how much straight lines from sample to sample lie above the curve in the mean, unit: a
    /// low-pass of the root of a sixth of the interval's square.
    pub above: Both,
}

/// Over which a parabola is fitted to either side, of gyro and of accelerometer, s: noise of the
/// readings that it lets through stands in the residual too, and makes the low-pass look shorter.
const HALF_S: [f64; 2] = [0.2, 0.4];
/// States what the widths may be divided by where the motion is too quick for them.
const NARROWER: [f64; 3] = [1.0, 2.0, 4.0];
/// Regression of the narrowest width's derivative on that of a wider one, within which the wider
/// one serves: beyond that, Gauss–Newton steps along it overshoot.
const FAITHFUL: [f64; 2] = [0.7, 1.4];
/// Fewest samples to either side.
const FEWEST: usize = 2;
/// Longest step between neighbours, in usual intervals, and how much longer than its samples a
/// smoothed stretch may last.
const GAP: f64 = 2.5;
/// Shortest step between neighbours, in usual intervals: stamps closer together were bunched by the
/// logger.
const LEAST: f64 = 0.25;
/// Relative difference of the steps to both sides up to which they count as even.
const EVEN: f64 = 0.1;

impl Derivatives {
    /// Of the readings of a log.
    pub(super) fn of(log: &Log) -> Self {
        let curves = [&log.rate, &log.force].map(|values| Curves { log, values });
        let each = || 0..log.time_s.len();
        let first = |sensor: usize| each().map(|k| curves[sensor].first(k)).collect();
        let second = |sensor: usize| curves[sensor].smoothed(HALF_S[sensor]);
        let above = |sensor: usize| each().map(|k| curves[sensor].above(k)).collect();
        Self {
            above: Both { rate: above(0), force: above(1) },
            first: Both { rate: first(0), force: first(1) },
            second: Both { rate: second(0), force: second(1) },
        }
    }
}

struct Curves<'a> {
    log: &'a Log,
    values: &'a [Vector3<f64>],
}

impl Curves<'_> {
    fn has_neighbours(&self, k: usize) -> bool {
        let time_s = &self.log.time_s;
        let is_next = |step_s: f64| step_s >= LEAST * self.log.interval_s && step_s <= GAP * self.log.interval_s;
        k > 0 && k + 1 < time_s.len() && is_next(time_s[k] - time_s[k - 1]) && is_next(time_s[k + 1] - time_s[k])
    }

    /// Zero at the ends and next to gaps.
    fn first(&self, k: usize) -> Vector3<f64> {
        if !self.has_neighbours(k) {
            return Vector3::zeros();
        }
        let time_s = &self.log.time_s;
        let (before, after) = (time_s[k] - time_s[k - 1], time_s[k + 1] - time_s[k]);
        let slope = |to: usize, step_s: f64| (self.values[to] - self.values[k]) / step_s;
        // The parabola through the three.
        (slope(k + 1, after) * before + slope(k - 1, -before) * after) / (before + after)
    }

    /// A twelfth of the second derivative times the square of the interval; zero where stamps are
    /// uneven.
    fn above(&self, k: usize) -> Vector3<f64> {
        let step = |k: usize| self.log.time_s[k] - self.log.time_s[k - 1];
        if !self.has_neighbours(k) || (step(k + 1) / step(k) - 1.0).abs() > EVEN {
            return Vector3::zeros();
        }
        (self.values[k + 1] + self.values[k - 1] - self.values[k] * 2.0) / 12.0
    }

    /// Second derivatives by the widest parabola that follows the motion.
    fn smoothed(&self, half_s: f64) -> Vec<Vector3<f64>> {
        let second = |half_s: f64| parallel::map_indices(self.values.len(), |k| self.second(k, half_s));
        let narrowest = second(half_s / NARROWER[NARROWER.len() - 1]);
        let product = |a: &[Vector3<f64>]| a.iter().zip(&narrowest).map(|(a, b)| a.dot(b)).sum::<f64>();
        for times in &NARROWER[..NARROWER.len() - 1] {
            let wide = second(half_s / times);
            let square: f64 = wide.iter().map(Vector3::norm_squared).sum();
            if (FAITHFUL[0] * square..=FAITHFUL[1] * square).contains(&product(&wide)) {
                return wide;
            }
        }
        narrowest
    }

    /// Twice the second coefficient of the parabola of least squares.
    fn second(&self, k: usize, half_s: f64) -> Vector3<f64> {
        let (time_s, interval_s) = (&self.log.time_s, self.log.interval_s);
        let side = ((half_s / interval_s).round() as usize).max(FEWEST);
        if k < side || k + side >= time_s.len() || time_s[k + side] - time_s[k - side] > GAP * side as f64 * interval_s
        {
            return Vector3::zeros();
        }
        let around = k - side..=k + side;
        let count = (2 * side + 1) as f64;
        let at = |j: usize| time_s[j] - time_s[k];
        let (mut mean, mut square) = (0.0, 0.0);
        for j in around.clone() {
            mean += at(j) / count;
            square += at(j) * at(j) / count;
        }
        // The square made orthogonal to a constant and to a line.
        let spread = square - mean * mean;
        let cube = around.clone().map(|j| (at(j) - mean) * at(j) * at(j)).sum::<f64>() / count;
        let bend = |j: usize| at(j) * at(j) - square - cube / spread * (at(j) - mean);
        let (mut sum, mut weight) = (Vector3::zeros(), 0.0);
        for j in around {
            sum += self.values[j] * bend(j);
            weight += bend(j) * bend(j);
        }
        if weight > 0.0 { sum * (2.0 / weight) } else { Vector3::zeros() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_parabola_are_exact_on_uneven_stamps() {
        let time_s: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k) + 0.002 * f64::from(k % 3)).collect();
        let values: Vec<Vector3<f64>> = time_s.iter().map(|t| Vector3::new(3.0 * t * t - t, 2.0, -t)).collect();
        let log = Log { time_s: time_s.clone(), rate: values.clone(), force: values, interval_s: 0.01 };
        let got = Derivatives::of(&log);
        for (k, t) in time_s.iter().enumerate().take(155).skip(45) {
            assert!((got.first.rate[k] - Vector3::new(6.0 * t - 1.0, 0.0, -1.0)).norm() < 1e-9);
            assert!((got.second.force[k] - Vector3::new(6.0, 0.0, 0.0)).norm() < 1e-6);
        }
        // Next to a gap there are none.
        let mut gap = log;
        gap.time_s.iter_mut().skip(100).for_each(|t| *t += 1.0);
        assert_eq!(Derivatives::of(&gap).second.rate[100], Vector3::zeros());
    }
}
