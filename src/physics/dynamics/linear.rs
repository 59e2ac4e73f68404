//! The linear proof mass under a rectangular force, exactly: closed form by the characteristic
//! roots, and the exact-hold map by matrix exponential. Equation 5 of the paper as printed stands
//! here too, to be confronted with equation 4.
//!
//! Not for noise or for cubic springs.

use nalgebra::{Complex, Matrix5, Vector5};

use super::duffing::Oscillator;

/// Displacement of the proof mass with its derivative and its first two integrals over time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MassResponse {
    /// Displacement x, m.
    pub x_m: f64,
    /// Velocity x′, m/s.
    pub v_m_s: f64,
    /// ∫x dt, m s.
    pub integral_m_s: f64,
    /// ∬x dt², m s².
    pub double_integral_m_s2: f64,
}

/// A force that is `force_n` from `start_s` for `length_s`, and zero otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// Force, N.
    pub force_n: f64,
    /// Time at which the force begins, s.
    pub start_s: f64,
    /// Duration of the force, s.
    pub length_s: f64,
}

impl Rectangle {
    /// The force at a time; the edges belong to the step that begins there.
    pub fn at_n(&self, time_s: f64) -> f64 {
        let inside = time_s >= self.start_s && time_s < self.start_s + self.length_s;
        if inside { self.force_n } else { 0.0 }
    }

    /// Returns what an ideal sensor of unit mass would report: reading, speed and distance.
    pub fn ideal(&self, time_s: f64) -> (f64, f64, f64) {
        let inside = (time_s - self.start_s).clamp(0.0, self.length_s);
        let after = (time_s - self.start_s - self.length_s).max(0.0);
        let a = self.force_n;
        (self.at_n(time_s), a * inside, a * (0.5 * inside * inside + self.length_s * after))
    }
}

/// The roots (−D₀ ± √(D₀² − 4km)) / 2m of equation 4's characteristic polynomial.
pub fn roots(oscillator: &Oscillator) -> [Complex<f64>; 2] {
    let Oscillator { mass_kg: m, damping_kg_s: d, stiffness_n_m: k, .. } = *oscillator;
    let root = Complex::new(d * d - 4.0 * k * m, 0.0).sqrt();
    [(-root - d) / (2.0 * m), (root - d) / (2.0 * m)]
}

/// The exponents ±½√(D₀² − 4km/m − D₀²/m) that stand in equation 5 as printed, everything under one
/// root.
pub fn printed_roots(oscillator: &Oscillator) -> [Complex<f64>; 2] {
    let Oscillator { mass_kg: m, damping_kg_s: d, stiffness_n_m: k, .. } = *oscillator;
    let half = Complex::new(d * d - 4.0 * k * m / m - d * d / m, 0.0).sqrt() * 0.5;
    [-half, half]
}

/// Equation 5 with given exponents: F₀/k + c₁e^(r₁t) + c₂e^(r₂t), where rest at t = 0 fixes c₁ and
/// c₂.
///
/// The exponents must differ; at critical damping the form itself does not exist.
fn step_response(oscillator: &Oscillator, roots: [Complex<f64>; 2], force_n: f64, time_s: f64) -> MassResponse {
    if time_s <= 0.0 {
        return MassResponse::default();
    }
    let level = force_n / oscillator.stiffness_n_m;
    let [r1, r2] = roots;
    let (c1, c2) = (r2 / (r1 - r2) * level, -r1 / (r1 - r2) * level);
    let t = time_s;
    let sum = |f: &dyn Fn(Complex<f64>) -> Complex<f64>| (c1 * f(r1) + c2 * f(r2)).re;
    MassResponse {
        x_m: level + sum(&|r| (r * t).exp()),
        v_m_s: sum(&|r| r * (r * t).exp()),
        integral_m_s: level * t + sum(&|r| ((r * t).exp() - 1.0) / r),
        double_integral_m_s2: 0.5 * level * t * t + sum(&|r| ((r * t).exp() - 1.0 - r * t) / (r * r)),
    }
}

/// Returns what is left when equation 5 with these exponents is put into equation 4: m x″ + D₀x′ +
/// kx − F₀, N.
pub fn residual_n(oscillator: &Oscillator, roots: [Complex<f64>; 2], force_n: f64, time_s: f64) -> f64 {
    let Oscillator { mass_kg: m, damping_kg_s: d, stiffness_n_m: k, .. } = *oscillator;
    let [r1, r2] = roots;
    let level = force_n / k;
    let (c1, c2) = (r2 / (r1 - r2) * level, -r1 / (r1 - r2) * level);
    let residual = |c: Complex<f64>, r: Complex<f64>| c * (r * r * m + r * d + k) * (r * time_s).exp();
    (residual(c1, r1) + residual(c2, r2)).re
}

/// The exact response from rest to a rectangle: a step up and, later, a step down.
pub fn rectangle_response(oscillator: &Oscillator, rectangle: Rectangle, time_s: f64) -> MassResponse {
    let roots = roots(oscillator);
    let up = step_response(oscillator, roots, rectangle.force_n, time_s - rectangle.start_s);
    let down = step_response(oscillator, roots, -rectangle.force_n, time_s - rectangle.start_s - rectangle.length_s);
    MassResponse {
        x_m: up.x_m + down.x_m,
        v_m_s: up.v_m_s + down.v_m_s,
        // Each step's integrals grow on after it, so the sum is exact at every time.
        integral_m_s: up.integral_m_s + down.integral_m_s,
        double_integral_m_s2: up.double_integral_m_s2 + down.double_integral_m_s2,
    }
}

/// The exact-hold map: over one step of constant force, `[x, v, ∫x, ∬x, F]` is multiplied by this
/// matrix.
pub fn exact_hold(oscillator: &Oscillator, step_s: f64) -> Matrix5<f64> {
    let Oscillator { mass_kg: m, damping_kg_s: d, stiffness_n_m: k, .. } = *oscillator;
    let mut rate = Matrix5::zeros();
    rate[(0, 1)] = 1.0;
    rate[(1, 0)] = -k / m;
    rate[(1, 1)] = -d / m;
    rate[(1, 4)] = 1.0 / m;
    rate[(2, 0)] = 1.0;
    rate[(3, 2)] = 1.0;
    (rate * step_s).exp()
}

/// Applies an exact-hold map to a motion under a force.
pub fn hold_step(map: &Matrix5<f64>, motion: MassResponse, force_n: f64) -> MassResponse {
    let v = map * Vector5::new(motion.x_m, motion.v_m_s, motion.integral_m_s, motion.double_integral_m_s2, force_n);
    MassResponse { x_m: v[0], v_m_s: v[1], integral_m_s: v[2], double_integral_m_s2: v[3] }
}

#[cfg(test)]
mod tests {
    use super::super::duffing::PAPER;
    use super::*;

    #[test]
    fn closed_form_and_exact_hold_agree_under_and_over_damping() {
        for damping in [0.1, 1.0, 5.0] {
            let oscillator = Oscillator { damping_kg_s: damping, ..PAPER.linear() };
            let rectangle = Rectangle { force_n: 1.0, start_s: 1.0, length_s: 3.0 };
            let map = exact_hold(&oscillator, 0.125);
            let mut motion = MassResponse::default();
            for step in 0..160 {
                motion = hold_step(&map, motion, rectangle.at_n(f64::from(step) * 0.125));
            }
            let exact = rectangle_response(&oscillator, rectangle, 20.0);
            assert!((motion.x_m - exact.x_m).abs() < 1e-12, "D0 {damping}");
            assert!((motion.double_integral_m_s2 - exact.double_integral_m_s2).abs() < 1e-9, "D0 {damping}");
        }
    }
}
