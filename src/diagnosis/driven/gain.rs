//! The stationary Kalman gain of an oscillator with force noise and a walking bias: how far one surprise at the readout
//! moves the expected state.
//!
//! Readout noise has unit variance here; strengths are relative to it. Not for nonlinear terms: the gain of the linear
//! part is used, which is exact where they vanish and close to optimal while they are small.

use nalgebra::{Matrix3, Vector3};

pub use crate::kernel::misfit::transition;

/// What the filter needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Correction of displacement, velocity and bias per unit innovation.
    pub k: [f64; 3],
    /// Variance of the innovation over that of the readout noise.
    pub innovation_variance: f64,
}

/// Only white readout noise: nothing is corrected.
pub const NONE: Gain = Gain { k: [0.0; 3], innovation_variance: 1.0 };

/// An oscillator and its noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noisy {
    /// ω₀.
    pub omega_rad_s: f64,
    /// ζ.
    pub zeta: f64,
    /// Sampling interval.
    pub interval_s: f64,
    /// Stationary displacement that force noise causes, over the standard deviation of readout noise.
    pub force: f64,
    /// Standard deviation of one sample's step of the bias, over that of readout noise.
    pub walk: f64,
}

/// Solves the filter's Riccati equation by doubling.
pub fn stationary(noisy: &Noisy) -> Gain {
    if noisy.force <= 0.0 && noisy.walk <= 0.0 {
        return NONE;
    }
    let Noisy { omega_rad_s: omega, zeta, interval_s: h, .. } = *noisy;
    let e = transition(omega, zeta, h);
    let keeps = if noisy.walk > 0.0 { 1.0 } else { 0.0 };
    let f = Matrix3::new(e[0], e[1], 0.0, e[2], e[3], 0.0, 0.0, 0.0, keeps);
    // White force of intensity q gives a stationary displacement variance q/(4ζω³).
    let intensity = noisy.force.powi(2) * 4.0 * zeta * omega.powi(3);
    let mut q = Matrix3::zeros();
    let pieces = 2 * ((omega * h / 0.5).ceil() as usize).clamp(2, 64);
    for j in 0..=pieces {
        let simpson = if j == 0 || j == pieces {
            1.0
        } else if j % 2 == 1 {
            4.0
        } else {
            2.0
        };
        let g = transition(omega, zeta, h * j as f64 / pieces as f64);
        let b = Vector3::new(g[1], g[3], 0.0);
        q += b * b.transpose() * (simpson * h / (3.0 * pieces as f64) * intensity);
    }
    q[(2, 2)] = noisy.walk.powi(2);
    let sees = Vector3::new(1.0, 0.0, keeps);
    let (mut a, mut g, mut p) = (f.transpose(), sees * sees.transpose(), q);
    for _ in 0..60 {
        let Some(w) = (Matrix3::identity() + g * p).try_inverse() else { break };
        let aw = a * w;
        let next = p + a.transpose() * p * w * a;
        g += aw * g * a.transpose();
        a = aw * a;
        let change = (next - p).norm();
        p = next;
        if change <= 1e-13 * p.norm() {
            break;
        }
    }
    let variance = 1.0 + (sees.transpose() * p * sees)[0];
    let k = p * sees / variance;
    if k.iter().all(|v| v.is_finite()) && variance.is_finite() {
        Gain { k: [k[0], k[1], k[2]], innovation_variance: variance }
    } else {
        NONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pure_walk_has_the_textbook_gain() {
        // Local-level model: P² = q(P + 1), K = P/(P + 1) (Durbin & Koopman 2012, §2.11).
        let gain = stationary(&Noisy { omega_rad_s: 10.0, zeta: 0.1, interval_s: 0.01, force: 0.0, walk: 0.3 });
        let q: f64 = 0.09;
        let p = 0.5 * (q + (q * q + 4.0 * q).sqrt());
        assert!((gain.k[2] - p / (1.0 + p)).abs() < 1e-9, "{gain:?}");
        assert!(gain.k[0].abs() < 1e-12);
    }

    #[test]
    fn a_transition_solves_its_equation_on_both_sides_of_critical_damping() {
        for zeta in [0.02, 0.7, 1.0, 1.5] {
            let (omega, t, d) = (3.0, 0.4, 1e-6);
            let (e0, e1) = (transition(omega, zeta, t - d), transition(omega, zeta, t + d));
            let e = transition(omega, zeta, t);
            for j in 0..2 {
                assert!(((e1[j] - e0[j]) / (2.0 * d) - e[2 + j]).abs() < 1e-7);
                let force = -omega * omega * e[j] - 2.0 * zeta * omega * e[2 + j];
                assert!(((e1[2 + j] - e0[2 + j]) / (2.0 * d) - force).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn the_gain_is_stationary() {
        // Iterating the plain Riccati recursion from anywhere ends at the same gain.
        let noisy = Noisy { omega_rad_s: 429.0, zeta: 0.05, interval_s: 1.0 / 610.0, force: 2.0, walk: 0.0 };
        let gain = stationary(&noisy);
        assert!(gain.k[0] > 0.3 && gain.k[0] < 1.0 && gain.innovation_variance > 1.3, "{gain:?}");
    }
}
