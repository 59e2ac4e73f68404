//! The stationary Kalman gain of an oscillator with force noise and a walking bias, read directly
//! or through a low-pass: how far one surprise at the readout moves the expected state.
//!
//! Readout noise has unit variance here; strengths are relative to it. Not for nonlinear terms: the
//! gain of the linear part is used, which is exact where they vanish and close to optimal while
//! they are small.

use nalgebra::{Matrix4, Vector4};

use crate::physics::free_oscillator::transition;

/// Stationary Kalman gain and innovation variance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Correction of displacement, velocity, bias and the low-pass's state per unit innovation.
    pub k: [f64; 4],
    /// Variance of the innovation over that of the readout noise.
    pub innovation_variance: f64,
}

/// Only white readout noise: nothing is corrected.
pub(crate) const NONE: Gain = Gain { k: [0.0; 4], innovation_variance: 1.0 };

/// An oscillator and its noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noisy {
    /// Natural frequency ω₀, rad/s.
    pub omega_rad_s: f64,
    /// Damping ratio ζ.
    pub zeta: f64,
    /// Sampling interval, s.
    pub interval_s: f64,
    /// Stationary displacement that force noise causes, over the standard deviation of readout
    /// noise.
    pub force: f64,
    /// Standard deviation of one sample's step of the bias, over that of readout noise.
    pub walk: f64,
    /// Time constant of a low-pass through which the displacement is read; 0 without one.
    pub lag_s: f64,
}

/// The linear system behind a gain: displacement, velocity, bias and the low-pass's state, from one
/// sample to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct System {
    /// State at the next sample.
    pub transition: Matrix4<f64>,
    /// Row of the measurement equation.
    pub sees: Vector4<f64>,
    /// State change over one sample under a constant unit force.
    pub push: Vector4<f64>,
    /// Covariance of what noise adds over one sample, in variances of readout noise.
    pub noise: Matrix4<f64>,
}

/// Solves the filter's Riccati equation by doubling.
pub(crate) fn stationary(noisy: &Noisy) -> Gain {
    if noisy.force <= 0.0 && noisy.walk <= 0.0 {
        return NONE;
    }
    let System { transition, sees, noise, .. } = system(noisy);
    let (mut a, mut g, mut p) = (transition.transpose(), sees * sees.transpose(), noise);
    for _ in 0..60 {
        let Some(w) = (Matrix4::identity() + g * p).try_inverse() else { break };
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
        Gain { k: [k[0], k[1], k[2], k[3]], innovation_variance: variance }
    } else {
        NONE
    }
}

/// The linear system of an oscillator and its noise.
pub(crate) fn system(noisy: &Noisy) -> System {
    let Noisy { omega_rad_s: omega, zeta, interval_s: h, lag_s, .. } = *noisy;
    let (keeps, lags) = (f64::from(noisy.walk > 0.0), lag_s > 0.0);
    // White force of intensity q gives a stationary displacement variance q/(4ζω³).
    let intensity = noisy.force.powi(2) * 4.0 * zeta * omega.powi(3);
    let pieces = 2 * ((omega * h / 0.5).ceil() as usize).clamp(2, 64);
    let (mut q, mut push) = (Matrix4::zeros(), Vector4::zeros());
    for j in 0..=pieces {
        let simpson = if j == 0 || j == pieces {
            1.0
        } else if j % 2 == 1 {
            4.0
        } else {
            2.0
        };
        let t = h * j as f64 / pieces as f64;
        let g = transition(omega, zeta, t);
        let b = Vector4::new(g[1], g[3], 0.0, if lags { lagging(omega, zeta, lag_s, t)[1] } else { 0.0 });
        let weight = simpson * h / (3.0 * pieces as f64);
        q += b * b.transpose() * (weight * intensity);
        push += b * weight;
    }
    q[(2, 2)] = noisy.walk.powi(2);
    let e = transition(omega, zeta, h);
    let mut f = Matrix4::zeros();
    (f[(0, 0)], f[(0, 1)], f[(1, 0)], f[(1, 1)], f[(2, 2)]) = (e[0], e[1], e[2], e[3], keeps);
    if lags {
        [f[(3, 0)], f[(3, 1)]] = lagging(omega, zeta, lag_s, h);
        f[(3, 3)] = (-h / lag_s).exp();
    }
    let sees = if lags { Vector4::new(0.0, 0.0, keeps, 1.0) } else { Vector4::new(1.0, 0.0, keeps, 0.0) };
    System { transition: f, sees, push, noise: q }
}

/// Returns what a low-pass at rest holds after a time `t`, per unit of displacement and of velocity
/// that the oscillator began with: z + τz′ = x is solved by z = c₀x + c₁x′ + c₂e^{−t/τ}, as x″ is
/// −ω²x − 2ζωx′.
fn lagging(omega: f64, zeta: f64, lag_s: f64, t: f64) -> [f64; 2] {
    let past = 1.0 - 2.0 * zeta * omega * lag_s;
    let all = past + (omega * lag_s).powi(2);
    let (c0, c1) = (past / all, -lag_s / all);
    let e = transition(omega, zeta, t);
    let fades = (-t / lag_s).exp();
    [c0 * (e[0] - fades) + c1 * e[2], c0 * e[1] + c1 * (e[3] - fades)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pure_walk_has_the_textbook_gain() {
        // Local-level model: P² = q(P + 1), K = P/(P + 1) (Durbin & Koopman 2012, §2.11).
        let gain =
            stationary(&Noisy { omega_rad_s: 10.0, zeta: 0.1, interval_s: 0.01, force: 0.0, walk: 0.3, lag_s: 0.0 });
        let q: f64 = 0.09;
        let p = 0.5 * (q + (q * q + 4.0 * q).sqrt());
        assert!((gain.k[2] - p / (1.0 + p)).abs() < 1e-9, "{gain:?}");
        assert!(gain.k[0].abs() < 1e-12);
    }

    #[test]
    fn a_low_pass_follows_its_equation_from_rest() {
        for (zeta, lag_s) in [(0.02, 0.3), (0.7, 0.01), (1.5, 2.0)] {
            let (omega, t, d) = (3.0, 0.4, 1e-6);
            assert!(lagging(omega, zeta, lag_s, 0.0).iter().all(|z| z.abs() < 1e-12));
            let [z0, z, z1] = [t - d, t, t + d].map(|t| lagging(omega, zeta, lag_s, t));
            let x = transition(omega, zeta, t);
            for j in 0..2 {
                assert!((z[j] + lag_s * (z1[j] - z0[j]) / (2.0 * d) - x[j]).abs() < 1e-8, "{zeta} {lag_s}");
            }
        }
    }

    #[test]
    fn a_low_pass_much_faster_than_all_else_changes_no_gain() {
        let direct =
            Noisy { omega_rad_s: 429.0, zeta: 0.05, interval_s: 1.0 / 610.0, force: 2.0, walk: 0.1, lag_s: 0.0 };
        let (a, b) = (stationary(&direct), stationary(&Noisy { lag_s: 1e-9, ..direct }));
        for j in 0..3 {
            assert!((a.k[j] - b.k[j]).abs() < 1e-4 * a.k[j].abs(), "{a:?} {b:?}");
        }
        assert!((b.k[3] - b.k[0]).abs() < 1e-4 && (a.innovation_variance / b.innovation_variance - 1.0).abs() < 1e-4);
        // And one as slow as the resonance leaves less to be surprised by.
        let slow = stationary(&Noisy { lag_s: 1.0 / 429.0, ..direct });
        assert!(slow.innovation_variance < 0.9 * a.innovation_variance, "{slow:?}");
    }

    #[test]
    fn the_gain_is_stationary() {
        // Iterating the plain Riccati recursion from anywhere ends at the same gain.
        let noisy =
            Noisy { omega_rad_s: 429.0, zeta: 0.05, interval_s: 1.0 / 610.0, force: 2.0, walk: 0.0, lag_s: 0.0 };
        let gain = stationary(&noisy);
        assert!(gain.k[0] > 0.3 && gain.k[0] < 1.0 && gain.innovation_variance > 1.3, "{gain:?}");
    }
}
