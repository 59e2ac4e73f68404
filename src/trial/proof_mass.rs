//! The generator's own integration from the first step to the last, with force noise and a filter
//! at the end.
//!
//! Many sub-steps per sample; independent of the fitting code on purpose. Not fast: 20,000 samples
//! take some 30 ms.

use super::equation::{Contact, Machine, Oscillator, Window};
use super::physics::{Physics, Scales, Term};
use proofmass_numerics::rng::{Philox, Stream};

/// The input on the integrator's half-steps.
#[derive(Debug, Clone)]
pub struct Clock<'a> {
    /// Values at every half step, `2·steps + 1` of them.
    pub input: &'a [f64],
    /// Length of a step.
    pub step_s: f64,
    /// Time of the first value.
    pub start_s: f64,
    /// The environment column at the same instants; empty when there is none.
    pub environment: &'a [f64],
}

/// Motion and input that the readout sees at every step.
#[derive(Debug, Clone)]
pub struct MechanicalSignal {
    /// The mechanical signal after second mode, low-pass, gain control and mount.
    pub signal: Vec<f64>,
    /// Root mean square velocity.
    pub velocity_rms: f64,
}

/// Integrates from the clock's start; one signal value per step and one for the start. Not finite
/// values mean that the motion diverged. `noise_seed` is that of the force noise.
pub fn integrate(
    oscillator: Oscillator,
    terms: &[Term],
    scales: Scales,
    clock: &Clock<'_>,
    noise_seed: u64,
) -> MechanicalSignal {
    let of = |physics| terms.iter().find(|t| t.physics == physics);
    let machine = Machine::new(oscillator, terms, scales);
    // White acceleration of two-sided density S kicks the velocity by √(S h) per step, and makes a
    // displacement of variance S/(4ζω₀³).
    let kick = of(Physics::ForceNoise).map(|t| {
        let density = t.value(&scales).powi(2) * 2.0 * scales.damping_rad_s * scales.omega_rad_s.powi(2);
        (density * clock.step_s).sqrt()
    });
    let mut rng = Philox::new(noise_seed, 0, Stream::Force);
    let steps = (clock.input.len() - 1) / 2;
    let mut state = machine.beginning();
    let mut contact = if state[1] == 0.0 { Contact::Sticking } else { Contact::Slipping(state[1].signum()) };
    let mut motion = MechanicalSignal { signal: Vec::with_capacity(steps + 1), velocity_rms: 0.0 };
    let mut largest = 0.0f64;
    motion.signal.push(machine.signal(&state));
    for n in 0..steps {
        largest = largest.max(state[0].abs());
        let window = Window {
            t_s: clock.start_s + n as f64 * clock.step_s,
            step_s: clock.step_s,
            input: &clock.input[2 * n..2 * n + 3],
            environment: clock.environment.get(2 * n..2 * n + 3).unwrap_or_default(),
            largest,
        };
        state = machine.step(&state, &window, &mut contact);
        if let Some(kick) = kick {
            state[1] += kick * rng.normal();
        }
        motion.velocity_rms += state[1] * state[1];
        motion.signal.push(machine.signal(&state));
        if !state[0].is_finite() {
            motion.signal.resize(steps + 1, f64::NAN);
            break;
        }
    }
    if let Some(term) = of(Physics::ReadoutLowpass) {
        low_pass(&mut motion.signal, clock.step_s / term.value(&scales));
    }
    motion.velocity_rms = (motion.velocity_rms / steps.max(1) as f64).sqrt();
    motion
}

/// First-order low-pass of a signal that is straight between steps, exact whatever the time
/// constant; `ratio` = step/τ.
fn low_pass(signal: &mut [f64], ratio: f64) {
    let decay = (-ratio).exp();
    let (mut before, mut filtered) = (signal[0], signal[0]);
    for value in signal.iter_mut() {
        let lag = (*value - before) / ratio;
        filtered = decay * (filtered - (before - lag)) + (*value - lag);
        before = *value;
        *value = filtered;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scales() -> Scales {
        Scales { x: 1.0, peak: 1.5, v: 6.0, u: 1.0, duration_s: 10.0, omega_rad_s: 6.0, damping_rad_s: 1.2, gain: 30.0 }
    }

    fn run(term: Option<Term>, steps: usize, gain: f64, start: [f64; 2]) -> Vec<f64> {
        let step_s = 10.0 / steps as f64;
        let input: Vec<f64> = (0..=2 * steps).map(|k| (4.0 * k as f64 * step_s / 2.0).sin()).collect();
        let clock = Clock { input: &input, step_s, start_s: 0.0, environment: &[] };
        let oscillator = Oscillator { omega_rad_s: 6.0, zeta: 0.1, gain, start };
        let terms: Vec<Term> = term.into_iter().collect();
        integrate(oscillator, &terms, scales(), &clock, 1).signal
    }

    // x = Im(H e^{iωt}) + decaying transient, H = g/(ω₀² − ω² + 2iζω₀ω); at rest at t = 0.
    #[test]
    fn the_linear_case_is_the_closed_form() {
        let (w0, zeta, w, g) = (6.0f64, 0.1f64, 4.0f64, 30.0f64);
        let (re, im) = (w0 * w0 - w * w, 2.0 * zeta * w0 * w);
        let size = g / (re * re + im * im);
        let (cosine, sine) = (-size * im, size * re); // x = sine·sin ωt + cosine·cos ωt
        let wd = w0 * (1.0 - zeta * zeta).sqrt();
        let (a, b) = (-cosine, (-sine * w - zeta * w0 * cosine) / wd);
        let signal = run(None, 4000, g, [0.0, 0.0]);
        for (n, got) in signal.iter().enumerate() {
            let t = n as f64 * 10.0 / 4000.0;
            let free = (-zeta * w0 * t).exp() * (a * (wd * t).cos() + b * (wd * t).sin());
            let expected = sine * (w * t).sin() + cosine * (w * t).cos() + free;
            assert!((got - expected).abs() < 1e-8, "t = {t}: {got} {expected}");
        }
    }

    fn error(term: Term, steps: usize) -> f64 {
        let (coarse, fine) = (run(Some(term), steps, 30.0, [0.5, 0.0]), run(Some(term), 16_000, 30.0, [0.5, 0.0]));
        coarse.iter().zip(fine.iter().step_by(16_000 / steps)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn smooth_physics_converges_at_fourth_order_or_better() {
        for (physics, shape) in [
            (Physics::CubicStiffness, [1.0, 0.0]),
            (Physics::SqueezeFilmDamping, [0.0, 0.0]),
            (Physics::ParasiticMode, [2.5, 0.05]),
            (Physics::CoupledMode, [1.3, 0.05]),
            (Physics::FractionalDamper, [0.5, 0.0]),
            (Physics::ParametricPumping, [1.1, 0.3]),
        ] {
            let term = Term { physics, amplitude: 0.3, shape };
            let ratio = error(term, 1000) / error(term, 2000);
            assert!((12.0..40.0).contains(&ratio), "{physics:?}: {ratio}");
        }
    }

    // Twenty steps per sample at 20 samples per period of the resonance: 400 per period, here 4000
    // in 10 s.
    #[test]
    fn abrupt_physics_is_exact_to_a_ten_thousandth_at_the_steps_used() {
        for (physics, shape) in [
            (Physics::CoulombFriction, [0.0, 0.0]),
            (Physics::CoulombFriction, [0.4, 0.0]),
            (Physics::Hysteresis, [0.5, 0.7]),
            (Physics::EndStop, [30.0, 0.0]),
            (Physics::BacklashSpring, [0.3, 0.0]),
        ] {
            let worst = error(Term { physics, amplitude: 0.3, shape }, 4000);
            assert!(worst < 1e-4, "{physics:?}: {worst}");
        }
    }

    // Between turning points Coulomb friction only shifts the equilibrium by f_c/ω₀²: each half
    // swing loses 2 f_c/ω₀².
    #[test]
    fn friction_takes_the_same_length_from_every_half_swing_and_then_holds() {
        let steps = 20_000;
        let input = vec![0.0; 2 * steps + 1];
        let clock = Clock { input: &input, step_s: 10.0 / steps as f64, start_s: 0.0, environment: &[] };
        let oscillator = Oscillator { omega_rad_s: 6.0, zeta: 0.0, gain: 0.0, start: [1.0, 0.0] };
        let friction = Term { physics: Physics::CoulombFriction, amplitude: 0.6, shape: [0.0; 2] };
        let f_c = friction.value(&scales());
        let signal = integrate(oscillator, &[friction], scales(), &clock, 1).signal;
        let turn = |n: f64| signal[(n * std::f64::consts::PI / 6.0 / clock.step_s).round() as usize];
        let loss = 2.0 * f_c / 36.0;
        assert!((turn(1.0) + (1.0 - loss)).abs() < 1e-6, "{} {}", turn(1.0), 1.0 - loss);
        assert!((turn(2.0) - (1.0 - 2.0 * loss)).abs() < 1e-6);
        let end = signal[signal.len() - 1];
        assert!(end == signal[signal.len() - 500] && end.abs() <= f_c / 36.0, "it holds where it stopped: {end}");
    }

    // Backwards the equilibrium is shifted by (1 − lean) f_c/ω₀², forwards by (1 + lean) f_c/ω₀².
    #[test]
    fn friction_that_leans_takes_more_from_the_half_swings_forwards() {
        let steps = 20_000;
        let input = vec![0.0; 2 * steps + 1];
        let clock = Clock { input: &input, step_s: 10.0 / steps as f64, start_s: 0.0, environment: &[] };
        let oscillator = Oscillator { omega_rad_s: 6.0, zeta: 0.0, gain: 0.0, start: [1.0, 0.0] };
        let turns = |lean: f64| {
            let friction = Term { physics: Physics::CoulombFriction, amplitude: 0.6, shape: [lean, 0.0] };
            let signal = integrate(oscillator, &[friction], scales(), &clock, 1).signal;
            [1.0, 2.0].map(|n| signal[(n * std::f64::consts::PI / 6.0 / clock.step_s).round() as usize])
        };
        let loss = 2.0 * 0.6 * 1.2 * 6.0 / 36.0;
        let [back, forth] = turns(0.5);
        assert!((back + 1.0 - 0.5 * loss).abs() < 1e-6, "{back}");
        assert!((forth - (1.0 - 0.5 * loss - 1.5 * loss)).abs() < 1e-6, "{forth}");
        let [back, _] = turns(0.0);
        assert!((back + 1.0 - 0.5 * loss).abs() > 0.1, "friction that does not lean takes twice as much: {back}");
    }

    // Two masses tuned alike have Ω² = ω₀²(1 + μ/2 ∓ √(μ + μ²/4)) (Den Hartog, Mechanical Vibrations,
    // § 3.2). From both displaced by one: x = Σ c cos Ωt over both, by x(0) = 1 and x″(0) = −ω₀².
    #[test]
    fn a_coupled_mode_splits_the_resonance_as_a_vibration_absorber_does() {
        let (omega, mu, steps) = (6.0f64, 0.3f64, 20_000);
        let input = vec![0.0; 2 * steps + 1];
        let clock = Clock { input: &input, step_s: 10.0 / steps as f64, start_s: 0.0, environment: &[] };
        let oscillator = Oscillator { omega_rad_s: omega, zeta: 0.0, gain: 0.0, start: [1.0, 0.0] };
        let term = Term { physics: Physics::CoupledMode, amplitude: mu, shape: [1.0, 0.0] };
        let signal = integrate(oscillator, &[term], scales(), &clock, 1).signal;
        let worst = |mu: f64| {
            let [slow, fast] = [-1.0, 1.0].map(|side| 1.0 + 0.5 * mu + side * (mu + 0.25 * mu * mu).sqrt());
            let share = (fast - 1.0) / (fast - slow);
            let at = |t: f64| share * (omega * slow.sqrt() * t).cos() + (1.0 - share) * (omega * fast.sqrt() * t).cos();
            let apart = signal.iter().enumerate().map(|(n, x)| (x - at(n as f64 * clock.step_s)).abs());
            apart.fold(0.0, f64::max)
        };
        assert!(worst(mu) < 1e-7, "{}", worst(mu));
        assert!(worst(1.1 * mu) > 0.1, "a heavier second mass splits it further: {}", worst(1.1 * mu));
    }

    // Stationary variance of a resonator driven by white acceleration of two-sided density S:
    // S/(4ζω₀³).
    #[test]
    fn force_noise_has_the_variance_of_its_law() {
        let steps = 400_000;
        let input = vec![0.0; 2 * steps + 1];
        let clock = Clock { input: &input, step_s: 0.02, start_s: 0.0, environment: &[] };
        let oscillator = Oscillator { omega_rad_s: 6.0, zeta: 0.1, gain: 0.0, start: [0.0; 2] };
        let term = Term { physics: Physics::ForceNoise, amplitude: 0.2, shape: [0.0; 2] };
        let signal = integrate(oscillator, &[term], scales(), &clock, 5).signal;
        let variance = signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64;
        // 8000 s of correlation time 1/(ζω₀) ≈ 1.7 s: 4800 independent values, relative deviation
        // √(2/4800) = 2 %.
        assert!((variance / 0.04 - 1.0).abs() < 0.08, "{variance}");
    }
}
