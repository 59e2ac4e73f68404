//! Tilt from an accelerometer (the paper's eq. 3) and from a gyro.
//!
//! The gyro's way carries the direction of gravity in the sensor's frame along, so that poses may
//! be arbitrary. Not a full attitude: heading is never known here.

/// A vector in the sensor's frame.
pub type Vector = [f64; 3];

/// Length of a vector.
pub fn norm(v: Vector) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// Eq. 3: pitch from specific force, atan(a_x / √(a_y² + a_z²)), rad. Biases are taken off by
/// whoever calibrated.
pub fn pitch_rad(specific_force: Vector) -> f64 {
    let [x, y, z] = specific_force;
    x.atan2(y.hypot(z))
}

/// The direction of "up" in the sensor's frame after the sensor has turned at a rate for `step_s`
/// (Rodrigues' rotation, exact for a constant rate).
pub fn turn(up: Vector, rate_rad_s: Vector, step_s: f64) -> Vector {
    let speed = norm(rate_rad_s);
    if speed == 0.0 {
        return up;
    }
    let axis = rate_rad_s.map(|r| r / speed);
    // A fixed direction seen from a turning frame turns the other way.
    let (s, c) = (-speed * step_s).sin_cos();
    let cross =
        [axis[1] * up[2] - axis[2] * up[1], axis[2] * up[0] - axis[0] * up[2], axis[0] * up[1] - axis[1] * up[0]];
    let along = axis[0] * up[0] + axis[1] * up[1] + axis[2] * up[2];
    std::array::from_fn(|i| up[i] * c + cross[i] * s + axis[i] * along * (1.0 - c))
}

/// Returns how fast the pitch of eq. 3 changes when the sensor, with this direction of "up", turns
/// at a rate; rad/s.
pub fn pitch_rate_rad_s(up: Vector, rate_rad_s: Vector) -> f64 {
    (rate_rad_s[2] * up[1] - rate_rad_s[1] * up[2]) / up[1].hypot(up[2])
}

/// Mean of some vectors.
pub fn mean(vectors: &[Vector]) -> Vector {
    let n = vectors.len() as f64;
    std::array::from_fn(|i| vectors.iter().map(|v| v[i]).sum::<f64>() / n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pitch_is_read_and_carried_alike() {
        // Nose up by 0.3 rad: gravity's reaction gains a forward part.
        let up = [0.3f64.sin(), 0.0, 0.3f64.cos()];
        assert!((pitch_rad(up) - 0.3).abs() < 1e-12);
        let rate = [0.1, -0.5, 0.2];
        let after = turn(up, rate, 1e-6);
        assert!((norm(after) - 1.0).abs() < 1e-12);
        let numeric = (pitch_rad(after) - 0.3) / 1e-6;
        assert!((numeric - pitch_rate_rad_s(up, rate)).abs() < 1e-5);
        // A full turn comes back.
        let full = turn(up, rate, 2.0 * std::f64::consts::PI / norm(rate));
        assert!((0..3).all(|i| (full[i] - up[i]).abs() < 1e-12));
    }
}
