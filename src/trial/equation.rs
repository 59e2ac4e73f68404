//! The generator's equation of motion and one step of it: classical Runge–Kutta, friction switched
//! at its events.
//!
//! Independent of the fitting code on purpose.

use super::physics::{Physics, Scales, Term};

/// x, v, then hysteresis, second mode (2), gain control, mount, second mass (2), and ten elements
/// of a fractional damper.
pub(super) type State = [f64; STATES];
/// Length of the state.
pub(super) const STATES: usize = 19;
const HYSTERESIS: usize = 2;
const MODE: usize = 3;
const GAIN: usize = 5;
const MOUNT: usize = 6;
const SECOND_MASS: usize = 7;
const FRACTIONAL: usize = 9;

/// A linear proof mass: x'' + 2ζω₀x' + ω₀²x = gain·u.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    /// Natural frequency ω₀, rad/s.
    pub omega_rad_s: f64,
    /// Damping ratio ζ.
    pub zeta: f64,
    /// Output unit per input unit and s².
    pub gain: f64,
    /// Displacement and velocity at the first step.
    pub start: [f64; 2],
}

/// Which way the friction pushes: the discrete part of the state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Contact {
    Slipping(f64),
    Sticking,
}

/// A proof mass with its planted terms.
pub(super) struct Machine<'a> {
    oscillator: Oscillator,
    terms: &'a [Term],
    scales: Scales,
    /// Physical first parameters, in the order of `terms`.
    values: Vec<f64>,
    /// Friction against motion forwards and backwards.
    friction: [f64; 2],
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

impl<'a> Machine<'a> {
    /// With as many states as its terms need.
    pub(super) fn new(oscillator: Oscillator, terms: &'a [Term], scales: Scales) -> Self {
        let of = |physics| terms.iter().find(|t| t.physics == physics);
        let inner = [
            Physics::Hysteresis,
            Physics::ParasiticMode,
            Physics::GainControl,
            Physics::SlippingMount,
            Physics::CoupledMode,
        ];
        let states = if of(Physics::FractionalDamper).is_some() {
            STATES
        } else if inner.into_iter().any(|p| of(p).is_some()) {
            FRACTIONAL
        } else {
            2
        };
        Self {
            oscillator,
            terms,
            scales,
            values: terms.iter().map(|t| t.value(&scales)).collect(),
            friction: of(Physics::CoulombFriction).map_or([0.0; 2], |t| {
                let [lean, _] = t.shape;
                [1.0 + lean, 1.0 - lean].map(|share| share * t.value(&scales))
            }),
            fractional: of(Physics::FractionalDamper)
                .map_or_else(Vec::new, |t| fractional_elements(t.shape[0], oscillator.omega_rad_s)),
            states,
        }
    }

    /// The state from which the mass is let go; a second mass hangs where the first is and moves
    /// with it.
    pub(super) fn beginning(&self) -> State {
        let mut state = [0.0; STATES];
        state[..2].copy_from_slice(&self.oscillator.start);
        state[SECOND_MASS..FRACTIONAL].copy_from_slice(&self.oscillator.start);
        state
    }

    /// Friction against a motion towards this side.
    fn friction(&self, side: f64) -> f64 {
        let [forwards, backwards] = self.friction;
        if side < 0.0 { backwards } else { forwards }
    }

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
                Physics::StiffnessDrift if q == 0.0 => total -= k * value * now.t_s * x,
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
                Physics::CoupledMode => total += value * self.pull(term, s, v),
                _ => {}
            }
        }
        total + self.oscillator.gain * input
    }

    /// Returns what a second mass pulls the first with, over the second's own mass: by a spring and
    /// a damper between them.
    fn pull(&self, term: &Term, s: &State, velocity: f64) -> f64 {
        let [ratio, damping] = term.shape;
        let omega = ratio * self.oscillator.omega_rad_s;
        let [stretch, slip] = [s[SECOND_MASS] - s[0], s[SECOND_MASS + 1] - velocity];
        omega * omega * stretch + 2.0 * damping * omega * slip
    }

    fn derivative(&self, s: &State, now: &Instant, contact: Contact) -> State {
        let mut d = [0.0; STATES];
        match contact {
            Contact::Slipping(side) => {
                d[0] = s[1];
                d[1] = self.acceleration(s, now) - side * self.friction(side);
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
                Physics::CoupledMode => {
                    d[SECOND_MASS] = s[SECOND_MASS + 1];
                    d[SECOND_MASS + 1] = -self.pull(term, s, v);
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

    pub(super) fn signal(&self, s: &State) -> f64 {
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
        let fraction = h / window.step_s;
        let instants = [from, from + fraction / 2.0, from + fraction].map(|f| window.instant(f));
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

    /// One whole step; where the velocity passes through zero, the friction turns or holds at that
    /// instant.
    pub(super) fn step(&self, s: &State, window: &Window<'_>, contact: &mut Contact) -> State {
        if self.friction == [0.0; 2] {
            return self.advance(s, window, 0.0, window.step_s, Contact::Slipping(0.0));
        }
        let (mut state, mut from) = (*s, 0.0);
        // A step rarely holds more than one event; the bound keeps chatter finite.
        for _ in 0..4 {
            if *contact == Contact::Sticking {
                let push = self.acceleration(&state, &window.instant(from));
                if push.abs() > self.friction(push) {
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
pub(super) struct Window<'a> {
    pub(super) t_s: f64,
    pub(super) step_s: f64,
    pub(super) input: &'a [f64],
    pub(super) environment: &'a [f64],
    pub(super) largest: f64,
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

#[cfg(test)]
mod tests {
    use super::*;

    // A fractional damper's force on x = sin ωt is a ω^α sin(ωt + απ/2) scaled by k/ω₀^α, within
    // its band.
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
