//! A move between two poses: the gyro integrated to a rotation.
//!
//! The rates of one interval do not commute: with w linear over the interval h the rotation vector
//! is φ = h w + (h³/12) w × w′ (the second term of the Magnus series), which integration by
//! rectangles leaves out; a turn by hand comes out wrong by 1e-4 rad. That coefficient, 1/12, is
//! for a reading that is the mean over its interval. A reading sampled at one instant, or passed
//! through a low-pass filter, differs from the mean by m w″; over a turn that begins and ends at
//! rest its integral is −m w × w′, so that the filter of the sensor only changes the coefficient:
//! 1/24 for an instant, less for a filter longer than the interval. It is fitted with the turns
//! (`gyro::CONING`). Source: Miller, A new strapdown attitude algorithm, J. Guidance 6 (1983) 287;
//! Savage, J. Guidance 21 (1998) 19.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::calibration::{Calibration, GYRO_OFF_DIAGONAL, Point, gyro};
use super::imu::Observed;
use super::slopes::{Active, reading_slopes};
use crate::sensor::Sense;

/// Coefficient of h² w × (h w′) for a reading that is the mean over its interval.
const CONING_OF_A_MEAN: f64 = 1.0 / 12.0;

/// A move integrated: the rotation from its end to its start, and what each gyro parameter turns it
/// by.
pub struct Turn {
    /// Rotation from axes at the end of the move to axes at its start.
    pub rotation: Matrix3<f64>,
    /// δφ at the end, by active parameter.
    pub slopes: Vec<Vector3<f64>>,
}

impl Observed<'_> {
    /// The move after pose `from`, with slopes where active parameters are given.
    pub fn turn(&self, point: &Point, calibration: &Calibration, active: Option<&Active<'_>>, from: usize) -> Turn {
        let step_s = 1.0 / self.imu.rate_hz;
        let samples = self.poses[from].samples.end..self.poses[from + 1].samples.start;
        let columns = active.map_or(0, |a| a.list.len());
        let mut slopes = vec![Vector3::zeros(); columns];
        let mut rotation = Matrix3::identity();
        let unalign = *calibration.gyro.unalign();
        let read = |k: usize| {
            let slow = self.imu.slow_at(k);
            let force = calibration.specific_force_m_s2(self.imu.accelerometer_at(k).into(), &slow);
            let rate = calibration.rate_rad_s(self.imu.gyro_at(k).into(), &force, &slow);
            (slow, force, rate)
        };
        // Poses are longer than a sample, so that both neighbours exist; the ends of a move are at
        // rest.
        let mut before = read(samples.start.saturating_sub(1));
        let mut here = read(samples.start.min(self.imu.accelerometer[0].len() - 1));
        for k in samples {
            let after = read(k + 1);
            let (slow, force, rate) = here;
            // h² w × (h w′), with w′ from the neighbours.
            let coning = rate.cross(&((after.2 - before.2) * 0.5)) * (step_s * step_s);
            let angle = rate * step_s + coning * (CONING_OF_A_MEAN + calibration.coning);
            if let Some(active) = active {
                // The left Jacobian of this sample's rotation (it turns what came before), to first
                // order in its angle.
                let frame: Matrix3<f64> = rotation * (Matrix3::identity() + angle.cross_matrix() * 0.5);
                let lever = frame * unalign * step_s;
                let mut give = |parameter: usize, axis: usize, phi: f64| {
                    if let Some(column) = active.column[parameter] {
                        slopes[column] -= lever.column(axis) * phi;
                    }
                };
                let counts = self.imu.gyro_at(k);
                reading_slopes(Sense::Gyro, &calibration.gyro, point[gyro::SCALE.start], &counts, &slow, &mut give);
                for (n, (i, j)) in GYRO_OFF_DIAGONAL.iter().enumerate() {
                    give(gyro::MISALIGNMENT.start + n, *i, rate[*j]);
                }
                for n in 0..9 {
                    give(gyro::G_SENSITIVITY.start + n, n / 3, force[n % 3]);
                }
                if let Some(column) = active.column[gyro::CONING.start] {
                    slopes[column] += frame * coning;
                }
            }
            rotation *= Rotation3::new(angle).matrix();
            (before, here) = (here, after);
        }
        let back = rotation.transpose();
        slopes.iter_mut().for_each(|s| *s = back * *s);
        Turn { rotation, slopes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tumble::calibration::{PARAMETERS, accelerometer};
    use crate::tumble::imu::Imu;

    /// A turn of 1.5 s about two axes at once, read as the mean over each interval or at its
    /// middle, against the product of rotations over intervals a hundred times finer.
    fn error_rad(of_mean: bool, coning: f64) -> f64 {
        const FINE: usize = 100;
        let rate = |u: f64| {
            let rise = 30.0 * u * u * (1.0 - u) * (1.0 - u);
            Vector3::new(0.9, -0.3, 0.2) * rise + Vector3::new(-0.6, 1.2, 0.8) * rise * (6.0 * u).sin()
        };
        let mut truth = Matrix3::identity();
        let mut gyro: [Vec<f64>; 3] = Default::default();
        for k in 0..250 {
            let at =
                |n: f64| if (50..200).contains(&k) { rate((k as f64 - 50.0 + n) / 150.0) } else { Vector3::zeros() };
            let fine: Vec<Vector3<f64>> = (0..FINE).map(|n| at((n as f64 + 0.5) / FINE as f64)).collect();
            let reading = if of_mean { fine.iter().sum::<Vector3<f64>>() / FINE as f64 } else { at(0.5) };
            fine.iter().for_each(|w| truth *= Rotation3::new(w * (0.01 / FINE as f64)).matrix());
            (0..3).for_each(|i| gyro[i].push(reading[i]));
        }
        let still: Vec<f64> = vec![1.0; 250];
        let imu = Imu {
            rate_hz: 100.0,
            gyro: Some([&gyro[0], &gyro[1], &gyro[2]]),
            accelerometer: [&still; 3],
            covariate: None,
            gravity_m_s2: 9.81,
        };
        let observed = imu.observe(&[0..50, 200..250]);
        let mut point = [0.0; PARAMETERS];
        (point[accelerometer::SCALE.start], point[gyro::SCALE.start]) = (1.0, 1.0);
        point[gyro::CONING.start] = coning;
        let turn = observed.turn(&point, &Calibration::from_point(&point), None, 0);
        // The sine of the angle: its cosine is one to rounding.
        let off = turn.rotation.transpose() * truth;
        let axis = Vector3::new(off[(2, 1)] - off[(1, 2)], off[(0, 2)] - off[(2, 0)], off[(1, 0)] - off[(0, 1)]);
        (0.5 * axis.norm()).asin()
    }

    #[test]
    fn a_turn_is_integrated_to_a_microradian_by_the_coefficient_of_how_it_was_read() {
        assert!(error_rad(true, 0.0) < 1e-6, "{}", error_rad(true, 0.0));
        assert!(error_rad(false, -1.0 / 24.0) < 1e-6, "{}", error_rad(false, -1.0 / 24.0));
        // Rectangles, and the other reading's coefficient: neither is good enough next to a noise
        // of 8e-5 rad.
        assert!(error_rad(true, -CONING_OF_A_MEAN) > 2e-5, "{}", error_rad(true, -CONING_OF_A_MEAN));
        assert!(error_rad(false, 0.0) > 1e-5, "{}", error_rad(false, 0.0));
    }
}
