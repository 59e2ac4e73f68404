//! A first-order low-pass behind the proof mass, τy′ + y = a, over one substep.
//!
//! The state is its own error p = y − f, so that a constant force cancels as it does in the mass's.
//! With the substep as unit of time, r = τ and a force that grows by g in a straight line,
//! r p′ + p = e − r g: over a substep p is a weighted sum of what is known at its two ends.
//!
//! - A linear mass: its motion inside the substep is known, and the exponential of the three
//!   equations together gives the weights; exact at any step, as the map of the mass itself.
//! - Other masses: the motion is Hermite's cubic through both ends, whose answer is exact. Their
//!   substeps resolve the resonance (`Integrator::choose_resolving`).
//!
//! Host only; how members take the step is `cpu::low_pass` and `shaders/simulate.wgsl`.

use nalgebra::Matrix3;

use super::integrator::{Capability, Integrator};
use crate::sensor::ProofMass;

/// Weights of one substep.
pub const WEIGHTS: usize = 7;

/// Names what each is the weight of, by the names that the shader uses: the low-pass's own error,
/// then the error of the mass at the beginning of the substep, the rate of that error there, both
/// at its end, the growth of the force, and the noise of the force.
pub(super) const NAMED: [&str; WEIGHTS] = ["KEPT", "E_BEGIN", "V_BEGIN", "E_END", "V_END", "GROWTH", "PUSH"];

/// Those of a member whose mass is read as it stands at the end of the substep: it has no low-pass,
/// and others that are simulated with it have one.
pub(super) const NONE: [f64; WEIGHTS] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];

/// The weights of a member whose low-pass has this time constant.
pub(super) fn weights(mass: Option<&ProofMass>, integrator: Integrator, substep_s: f64, time_s: f64) -> [f64; WEIGHTS] {
    if time_s <= 0.0 {
        return NONE;
    }
    let ratio = time_s / substep_s;
    let renewed = -(-1.0 / ratio).exp_m1();
    let kept = 1.0 - renewed;
    match (integrator.method().reach, mass) {
        (Capability::Nothing, _) | (_, None) => [kept, 0.0, 0.0, 0.0, 0.0, -ratio * renewed, 0.0],
        (Capability::Linear, Some(mass)) => {
            let [e, v] = of_linear(mass, substep_s, ratio);
            let stiffness = (mass.natural_frequency_rad_s * substep_s).powi(2);
            let damping = 2.0 * mass.damping_ratio * mass.natural_frequency_rad_s * substep_s;
            // The mass rests at w − (C/W) g.
            let rest = renewed - e;
            [kept, e, v, 0.0, 0.0, -ratio * renewed - rest * damping / stiffness, rest]
        }
        (Capability::Hardening | Capability::Cubic | Capability::General, Some(_)) => {
            let [first, second, third] = moments(ratio, renewed);
            // Hermite's basis, power by power.
            let e_end = 3.0 * second - 2.0 * third;
            let [v_begin, v_end] = [first - 2.0 * second + third, third - second];
            [kept, renewed - e_end, v_begin, e_end, v_end, -ratio * renewed, 0.0]
        }
    }
}

/// Returns what the low-pass takes over a substep from the linear mass's distance to rest and its
/// rate.
fn of_linear(mass: &ProofMass, substep_s: f64, ratio: f64) -> [f64; 2] {
    let w0 = mass.natural_frequency_rad_s * substep_s;
    let all =
        Matrix3::new(0.0, 1.0, 0.0, -w0 * w0, -2.0 * mass.damping_ratio * w0, 0.0, 1.0 / ratio, 0.0, -1.0 / ratio)
            .exp();
    [all[(2, 0)], all[(2, 1)]]
}

/// ∫ sᵏ e^{−(1−s)/r}/r ds over the substep, k = 1, 2, 3: from k − 1 by parts where that loses no
/// digits, by the series in 1/r where it would.
fn moments(ratio: f64, renewed: f64) -> [f64; 3] {
    /// Beyond it the parts cancel; below, the series is too long.
    const SLOW: f64 = 4.0;
    let mut all = [0.0; 3];
    let mut before = renewed;
    for (k, moment) in all.iter_mut().enumerate() {
        let power = (k + 1) as f64;
        *moment = if ratio < SLOW {
            1.0 - power * ratio * before
        } else {
            // Σ (−1/r)ⁿ / ((k+1)(k+2)…(k+1+n)) / r.
            let (mut term, mut sum) = (1.0 / (ratio * (power + 1.0)), 0.0);
            for n in 1..30 {
                sum += term;
                term *= -1.0 / (ratio * (power + 1.0 + f64::from(n)));
            }
            sum
        };
        before = *moment;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::member::coefficients;
    use crate::sensor::mechanics::CUBIC_STIFFNESS;

    const STEP_S: f64 = 1e-3;

    fn mass(hz: f64, damping_ratio: f64) -> ProofMass {
        let natural_frequency_rad_s = hz * std::f64::consts::TAU;
        ProofMass { natural_frequency_rad_s, damping_ratio, ..ProofMass::default() }
    }

    /// Error of mass and low-pass after a second under a held noise and a force that grows by g a
    /// step, by steps of this many milliseconds.
    fn after_a_second(mass: &ProofMass, time_s: f64, milliseconds: u32) -> [f64; 2] {
        let step_s = f64::from(milliseconds) * STEP_S;
        let [a, b, d, q, lag, ..] = coefficients(mass, Integrator::ExactHold, step_s);
        let weights = weights(Some(mass), Integrator::ExactHold, step_s, time_s);
        let (g, w) = (0.3 * f64::from(milliseconds), 0.7);
        let (mut e, mut rate, mut p) = (0.0, 0.0, 0.0);
        for _ in 0..1000 / milliseconds {
            let rest = w - lag * g;
            let (u, v) = (e - rest, rate - g);
            p = weights[0] * p + weights[1] * e + weights[2] * v + weights[5] * g + weights[6] * w;
            (e, rate) = (a * u + b * v + rest, d * u + q * v + g);
        }
        [e, p]
    }

    // Not a formula against itself: the same second in one step and in a thousand.
    #[test]
    fn the_linear_step_is_exact_whatever_its_length() {
        for (hz, zeta) in [(3.0, 0.02), (40.0, 0.7), (300.0, 2.0)] {
            for time_s in [2e-4, 0.05, 4.0] {
                let [long, short] = [50, 1].map(|ms| after_a_second(&mass(hz, zeta), time_s, ms)[1]);
                assert!((long - short).abs() < 1e-9 * (1.0 + short.abs()), "{hz} {zeta} {time_s}: {long} {short}");
                // Controls: the low-pass is not the mass, nor another low-pass.
                let other = after_a_second(&mass(hz, zeta), 1.1 * time_s, 1)[1];
                assert!((other - short).abs() > 1e-3, "{other} {short}");
            }
        }
    }

    /// Weights of Hermite's cubic by Simpson's rule over ten thousand parts.
    #[test]
    fn weights_of_the_cubic_are_its_integrals() {
        let cubic = mass(30.0, 0.7).with(&CUBIC_STIFFNESS, 1e9);
        for ratio in [0.01, 0.5, 3.9, 4.1, 50.0, 1e5] {
            let got = weights(Some(&cubic), Integrator::RungeKutta4 { substeps: 1 }, STEP_S, ratio * STEP_S);
            let basis: [fn(f64) -> f64; 4] = [
                |s| 1.0 - s * s * (3.0 - 2.0 * s),
                |s| s * (1.0 - s) * (1.0 - s),
                |s| s * s * (3.0 - 2.0 * s),
                |s| s * s * (s - 1.0),
            ];
            for (weight, shape) in got[1..5].iter().zip(basis) {
                let parts = 20_000;
                let at = |i: i32| {
                    let s = f64::from(i) / f64::from(parts);
                    shape(s) * (-(1.0 - s) / ratio).exp() / ratio
                };
                let inner = (1..parts).map(|i| at(i) * if i % 2 == 1 { 4.0 } else { 2.0 });
                let expected = (inner.sum::<f64>() + at(0) + at(parts)) / (3.0 * f64::from(parts));
                assert!((weight - expected).abs() < 1e-9, "{ratio}: {weight} {expected}");
            }
            // What is steady passes unchanged.
            assert!((got[0] + got[1] + got[3] - 1.0).abs() < 1e-12);
        }
    }

    // A short step makes the cubic and the exact map one.
    #[test]
    fn both_ways_agree_where_the_step_resolves_the_mass() {
        let mass = mass(3.0, 0.3);
        let [exact, cubic] = [Integrator::ExactHold, Integrator::RungeKutta4 { substeps: 1 }]
            .map(|integrator| weights(Some(&mass), integrator, STEP_S, 0.02));
        let [a, b, d, q, ..] = coefficients(&mass, Integrator::ExactHold, STEP_S);
        // From e = 1 at rest, and from a rate of 1: without noise and growth.
        let through = [cubic[1] + cubic[3] * a + cubic[4] * d, cubic[2] + cubic[3] * b + cubic[4] * q];
        for (got, expected) in through.into_iter().zip(&exact[1..3]) {
            // The cubic misses the motion by some (ω₀h)⁴, here 1e-7.
            assert!((got - expected).abs() < 1e-7 * expected.abs(), "{got} {expected}");
        }
    }
}
