//! States what the paper's Kalman filter believes of its sensors, and the three ways in which it
//! trusts the accelerometer.

use super::inertial::{PRINTED_ACCELEROMETER_DENSITY, PRINTED_GYRO_DENSITY};
use proofmass_base::units::{DEGREE, DENSITY_TO_RANDOM_WALK, STANDARD_GRAVITY_M_S2};
use proofmass_scenario::navigation::kalman::{Model, Weighting};

/// Three ways to trust the accelerometer, in the order of all arrays here.
pub(super) const WEIGHTINGS: [Weighting; 3] = [Weighting::Plain, Weighting::Magnitude, Weighting::Adaptive];

/// Sampling interval of the simulated sensors, s.
pub(crate) const STEP_S: f64 = 0.01;

/// The filter's beliefs from the printed noise of the paper's sensor family.
pub fn model() -> Model {
    let force_noise_m_s2 = PRINTED_ACCELEROMETER_DENSITY * (0.5 / STEP_S).sqrt();
    Model {
        step_s: STEP_S,
        angle_walk_rad_rts: PRINTED_GYRO_DENSITY * DENSITY_TO_RANDOM_WALK,
        // A bias that wanders by 0.003 °/s in a second: ten times what the family's stability of 20
        // °/h asks, so that the filter also follows a warming sensor.
        bias_walk_rad_s_rts: 0.003 * DEGREE,
        tilt_noise_rad: force_noise_m_s2 / STANDARD_GRAVITY_M_S2,
        force_noise_m_s2,
        gravity_m_s2: STANDARD_GRAVITY_M_S2,
        start_deviation: [1.0 * DEGREE, 0.2 * DEGREE],
    }
}
