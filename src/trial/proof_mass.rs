//! The generator's own integrator: classical Runge–Kutta with many sub-steps, friction switched at its events.
//!
//! Independent of the fitting code on purpose. Not fast: 20,000 samples take some 30 ms.

use rand_distr::{Distribution, StandardNormal};

use super::physics::{Physics, Scales, Term};
use crate::rng::{Philox, Stream};

/// x, v, then hysteresis, second mode (2), gain control, mount, and ten elements of a fractional damper.
type State = [f64; STATES];
const STATES: usize = 17;
const HYSTERESIS: usize = 2;
const MODE: usize = 3;
const GAIN: usize = 5;
const MOUNT: usize = 6;
const FRACTIONAL: usize = 7;

/// A linear proof mass: x'' + 2ζω₀x' + ω₀²x = gain·u.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    /// ω₀.
    pub omega_rad_s: f64,
    /// ζ.
    pub zeta: f64,
    /// Output unit per input unit and s².
    pub gain: f64,
    /// Displacement and velocity at the first step.
    pub start: [f64; 2],
}

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

/// What the readout sees at every step.
#[derive(Debug, Clone)]
pub struct Motion {
    /// The mechanical signal after second mode, low-pass, gain control and mount.
    pub signal: Vec<f64>,
    /// Root mean square velocity.
    pub velocity_rms: f64,
}

/// Which way the friction pushes: the discrete part of the state.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Contact {
    Slipping(f64),
    Sticking,
}

struct Machine<'a> {
    oscillator: Oscillator,
    terms: &'a [Term],
    scales: Scales,
    /// Physical first parameters, in the order of `terms`.
    values: Vec<f64>,
    friction: f64,
    /// Relaxation rate and weight of each fractional element.
    fractional: Vec<[f64; 2]>,
    states: usize,
}

/// One instant's known quantities.
#[derive(Clone, Copy)]
struct Instant {
    t_s: f64,
    input: f64,
    environment: f64,
    largest: f64,
}

impl Machine<'_> {
    /// Acceleration without friction.
    fn acceleration(&self, s: &State, now: &Instant) -> f64 {
        let (x, v) = (s[0], s[1]);
        let k = self.oscillator.omega_rad_s.powi(2);
        let c = 2.0 * self.oscillator.zeta * self.oscillator.omega_rad_s;
        let mut input = now.input;
        let mut total = -c * v - k * x;
        for (term, &value) in self.terms.iter().zip(&self.values) {
            let [p, q] = term.shape;
            let a = term.amplitude;
            match term.physics {
                Physics::CubicStiffness => total -= value * x * x * x,
                Physics::QuadraticStiffness => total -= value * x * x,
                Physics::QuadraticDamping => total -= value * v.abs() * v,
                Physics::SqueezeFilmDamping => total -= value * x * x * v,
                Physics::Hysteresis => total -= value * s[HYSTERESIS],
                Physics::StiffnessDrift if q == 0.0 => {
                    total -= k * value * (now.t_s - self.scales.duration_s / 2.0) * x
                }
                Physics::StiffnessDrift => total -= k * p * a * now.environment * x,
                Physics::DriveNonlinearity => input += value * now.input * now.input,
                Physics::EndStop => {
                    let above = if q >= 0.0 { (x - value).max(0.0) } else { 0.0 };
                    let below = if q <= 0.0 { (-x - value).max(0.0) } else { 0.0 };
                    total -= p * k * (above - below);
                }
                Physics::FractionalDamper => {
                    let order = p;
                    let scale = a * k / self.oscillator.omega_rad_s.powf(order);
                    let elements = self.fractional.iter().enumerate();
                    total -= scale * elements.map(|(j, [_, w])| w * (x - s[FRACTIONAL + j])).sum::<f64>();
                }
                Physics::SofteningWithHistory => {
                    total += k * a.min(0.9) * (now.largest / self.scales.peak).min(1.5) * x;
                }
                Physics::SlippingMount => {
                    let threshold = p * self.scales.u;
                    input -= a.min(1.0) * (now.input - now.input.clamp(-threshold, threshold));
                }
                Physics::NegativeDamping => total += a * c * (-(x / (p * self.scales.x)).powi(2)).exp() * v,
                Physics::BacklashSpring => total += a.min(1.0) * k * x.clamp(-p * self.scales.x, p * self.scales.x),
                Physics::ParametricPumping => {
                    total -= k * a * (p * self.oscillator.omega_rad_s * now.t_s + q).cos() * x;
                }
                Physics::StiffnessJump if now.t_s > p * self.scales.duration_s => total -= q * a * k * x,
                Physics::DampingDrift => total -= p * a * c * now.t_s / self.scales.duration_s * v,
                _ => {}
            }
        }
        total + self.oscillator.gain * input
    }

    fn derivative(&self, s: &State, now: &Instant, contact: Contact) -> State {
        let mut d = [0.0; STATES];
        match contact {
            Contact::Slipping(side) => {
                d[0] = s[1];
                d[1] = self.acceleration(s, now) - side * self.friction;
            }
            Contact::Sticking => {}
        }
        if self.states > 2 {
            self.internal(s, now, &mut d);
        }
        d
    }

    fn internal(&self, s: &State, now: &Instant, d: &mut State) {
        let (x, v) = (s[0], d[0]);
        let omega = self.oscillator.omega_rad_s;
        for term in self.terms {
            let [p, q] = term.shape;
            match term.physics {
                Physics::Hysteresis => {
                    let z = s[HYSTERESIS];
                    d[HYSTERESIS] = v - (q * v.abs() * z + (1.0 - q) * v * z.abs()) / (p * self.scales.x);
                }
                Physics::ParasiticMode => {
                    let w = p.abs() * omega;
                    d[MODE] = s[MODE + 1];
                    let drive = (w / omega).powi(2) * self.oscillator.gain * now.input;
                    d[MODE + 1] = drive - 2.0 * q * w * s[MODE + 1] - w * w * s[MODE];
                }
                Physics::GainControl => {
                    d[GAIN] = (x.abs() - s[GAIN]) / (p * self.scales.duration_s);
                }
                Physics::SlippingMount => {
                    let threshold = p * self.scales.u;
                    let excess = now.input - now.input.clamp(-threshold, threshold);
                    d[MOUNT] = 0.02 * term.amplitude * omega * self.scales.x / self.scales.u * excess;
                }
                Physics::FractionalDamper => {
                    for (j, [rate, _]) in self.fractional.iter().enumerate() {
                        d[FRACTIONAL + j] = rate * (x - s[FRACTIONAL + j]);
                    }
                }
                _ => {}
            }
        }
    }

    /// Displacement with what a second mode adds.
    fn sensed(&self, s: &State) -> f64 {
        let modes = self.terms.iter().filter(|t| t.physics == Physics::ParasiticMode);
        s[0] + modes.map(|t| t.amplitude * t.shape[0].signum() * s[MODE]).sum::<f64>()
    }

    fn signal(&self, s: &State) -> f64 {
        if self.states == 2 {
            return s[0];
        }
        let mut y = self.sensed(s);
        for term in self.terms {
            match term.physics {
                Physics::GainControl => y /= 1.0 + term.amplitude * s[GAIN] / self.scales.x,
                Physics::SlippingMount => y += s[MOUNT],
                _ => {}
            }
        }
        y
    }

    /// One step of length `h` from the fraction `from` of a step on.
    fn advance(&self, s: &State, window: &Window<'_>, from: f64, h: f64, contact: Contact) -> State {
        let share = h / window.step_s;
        let instants = [from, from + share / 2.0, from + share].map(|f| window.instant(f));
        let along = |d: &State, by: f64| {
            let mut moved = *s;
            moved.iter_mut().zip(d).take(self.states).for_each(|(m, d)| *m += by * d);
            moved
        };
        let k1 = self.derivative(s, &instants[0], contact);
        let k2 = self.derivative(&along(&k1, h / 2.0), &instants[1], contact);
        let k3 = self.derivative(&along(&k2, h / 2.0), &instants[1], contact);
        let k4 = self.derivative(&along(&k3, h), &instants[2], contact);
        let mut next = *s;
        for i in 0..self.states {
            next[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        next
    }

    /// One whole step; where the velocity passes through zero, the friction turns or holds at that instant.
    fn step(&self, s: &State, window: &Window<'_>, contact: &mut Contact) -> State {
        if self.friction == 0.0 {
            return self.advance(s, window, 0.0, window.step_s, Contact::Slipping(0.0));
        }
        let (mut state, mut from) = (*s, 0.0);
        // A step rarely holds more than one event; the bound keeps chatter finite.
        for _ in 0..4 {
            if *contact == Contact::Sticking {
                let push = self.acceleration(&state, &window.instant(from));
                if push.abs() > self.friction {
                    *contact = Contact::Slipping(push.signum());
                }
            }
            let rest = (1.0 - from) * window.step_s;
            let next = self.advance(&state, window, from, rest, *contact);
            let Contact::Slipping(side) = *contact else { return next };
            if next[1] * side >= 0.0 {
                return next;
            }
            let (mut low, mut high) = (0.0, rest);
            for _ in 0..30 {
                let middle = 0.5 * (low + high);
                let there = self.advance(&state, window, from, middle, *contact);
                if there[1] * side >= 0.0 { low = middle } else { high = middle }
            }
            state = self.advance(&state, window, from, low, *contact);
            state[1] = 0.0;
            from += low / window.step_s;
            *contact = Contact::Sticking;
        }
        self.advance(&state, window, from, (1.0 - from) * window.step_s, *contact)
    }
}

/// The input over one step, as the parabola through its ends and its middle.
struct Window<'a> {
    t_s: f64,
    step_s: f64,
    input: &'a [f64],
    environment: &'a [f64],
    largest: f64,
}

impl Window<'_> {
    fn instant(&self, fraction: f64) -> Instant {
        let blend = |v: &[f64]| {
            let f = fraction;
            v[0] * (1.0 - f) * (1.0 - 2.0 * f) + v[1] * 4.0 * f * (1.0 - f) + v[2] * f * (2.0 * f - 1.0)
        };
        Instant {
            t_s: self.t_s + fraction * self.step_s,
            input: blend(self.input),
            environment: if self.environment.is_empty() { 0.0 } else { blend(self.environment) },
            largest: self.largest,
        }
    }
}

fn fractional_elements(order: f64, omega_rad_s: f64) -> Vec<[f64; 2]> {
    // s^α = sin(πα)/π ∫ μ^(α−1) s/(s+μ) dμ, on ten logarithmically spaced μ.
    let count = STATES - FRACTIONAL;
    let (low, high) = (omega_rad_s / 300.0, omega_rad_s * 20.0);
    let spacing = (high / low).ln() / (count - 1) as f64;
    let weight = (std::f64::consts::PI * order).sin() / std::f64::consts::PI * spacing;
    (0..count).map(|j| low * (spacing * j as f64).exp()).map(|rate| [rate, weight * rate.powf(order)]).collect()
}

/// Integrates from the clock's start; one signal value per step and one for the start. Not finite values mean that the
/// motion diverged. `noise_seed` is that of the force noise.
pub fn integrate(oscillator: Oscillator, terms: &[Term], scales: Scales, clock: &Clock<'_>, noise_seed: u64) -> Motion {
    let of = |physics| terms.iter().find(|t| t.physics == physics);
    let states = if of(Physics::FractionalDamper).is_some() {
        STATES
    } else if [Physics::Hysteresis, Physics::ParasiticMode, Physics::GainControl, Physics::SlippingMount]
        .into_iter()
        .any(|p| of(p).is_some())
    {
        FRACTIONAL
    } else {
        2
    };
    let machine = Machine {
        oscillator,
        terms,
        scales,
        values: terms.iter().map(|t| t.value(&scales)).collect(),
        friction: of(Physics::CoulombFriction).map_or(0.0, |t| t.value(&scales)),
        fractional: of(Physics::FractionalDamper)
            .map_or_else(Vec::new, |t| fractional_elements(t.shape[0], oscillator.omega_rad_s)),
        states,
    };
    // White acceleration of two-sided density S kicks the velocity by √(S h) per step, and makes a displacement of
    // variance S/(4ζω₀³).
    let kick = of(Physics::ForceNoise).map(|t| {
        let density = t.value(&scales).powi(2) * 2.0 * scales.damping_rad_s * scales.omega_rad_s.powi(2);
        (density * clock.step_s).sqrt()
    });
    let mut rng = Philox::new(noise_seed, 0, Stream::Force);
    let steps = (clock.input.len() - 1) / 2;
    let mut state = [0.0; STATES];
    state[..2].copy_from_slice(&oscillator.start);
    let mut contact = if state[1] == 0.0 { Contact::Sticking } else { Contact::Slipping(state[1].signum()) };
    let mut motion = Motion { signal: Vec::with_capacity(steps + 1), velocity_rms: 0.0 };
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
            let gaussian: f64 = StandardNormal.sample(&mut rng);
            state[1] += kick * gaussian;
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

/// First-order low-pass of a signal that is straight between steps, exact whatever the time constant; `ratio` = step/τ.
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
            (Physics::FractionalDamper, [0.5, 0.0]),
            (Physics::ParametricPumping, [1.1, 0.3]),
        ] {
            let term = Term { physics, amplitude: 0.3, shape };
            let ratio = error(term, 1000) / error(term, 2000);
            assert!((12.0..40.0).contains(&ratio), "{physics:?}: {ratio}");
        }
    }

    // Twenty steps per sample at 20 samples per period of the resonance: 400 per period, here 4000 in 10 s.
    #[test]
    fn abrupt_physics_is_exact_to_a_ten_thousandth_at_the_steps_used() {
        for (physics, shape) in [
            (Physics::CoulombFriction, [0.0, 0.0]),
            (Physics::Hysteresis, [0.5, 0.7]),
            (Physics::EndStop, [30.0, 0.0]),
            (Physics::BacklashSpring, [0.3, 0.0]),
        ] {
            let worst = error(Term { physics, amplitude: 0.3, shape }, 4000);
            assert!(worst < 1e-4, "{physics:?}: {worst}");
        }
    }

    // Between turning points Coulomb friction only shifts the equilibrium by f_c/ω₀²: each half swing loses 2 f_c/ω₀².
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

    // Stationary variance of a resonator driven by white acceleration of two-sided density S: S/(4ζω₀³).
    #[test]
    fn force_noise_has_the_variance_of_its_law() {
        let steps = 400_000;
        let input = vec![0.0; 2 * steps + 1];
        let clock = Clock { input: &input, step_s: 0.02, start_s: 0.0, environment: &[] };
        let oscillator = Oscillator { omega_rad_s: 6.0, zeta: 0.1, gain: 0.0, start: [0.0; 2] };
        let term = Term { physics: Physics::ForceNoise, amplitude: 0.2, shape: [0.0; 2] };
        let signal = integrate(oscillator, &[term], scales(), &clock, 5).signal;
        let variance = signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64;
        // 8000 s of correlation time 1/(ζω₀) ≈ 1.7 s: 4800 independent values, relative deviation √(2/4800) = 2 %.
        assert!((variance / 0.04 - 1.0).abs() < 0.08, "{variance}");
    }

    // A fractional damper's force on x = sin ωt is a ω^α sin(ωt + απ/2) scaled by k/ω₀^α, within its band.
    #[test]
    fn the_fractional_elements_make_a_half_derivative() {
        let elements = fractional_elements(0.5, 6.0);
        for omega in [3.0f64, 6.0, 12.0] {
            let (mut re, mut im) = (0.0, 0.0);
            for [rate, weight] in &elements {
                let d = rate * rate + omega * omega;
                re += weight * omega * omega / d;
                im += weight * omega * rate / d;
            }
            let (size, phase) = (re.hypot(im), im.atan2(re));
            assert!((size / omega.sqrt() - 1.0).abs() < 0.15, "{omega}: {size}");
            assert!((phase - std::f64::consts::FRAC_PI_4).abs() < 0.2, "{omega}: {phase}");
        }
    }
}
