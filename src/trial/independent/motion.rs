//! The motion of an oscillator: rates of its states, dry friction with sticking, laws that remember
//! the path.

use super::integrate::{MOST_STEPS, STATES, State, System, Tolerance, advance, step};
use super::law::Law;
use super::oscillator::{Oscillator, environment, filters};
use super::wave::{Shape, Wave};

/// Holds what moves: laws in use, where their states stand, and what remembers.
pub struct EquationOfMotion<'a> {
    /// Oscillator whose motion it is.
    pub o: &'a Oscillator,
    /// Input as a function of time.
    pub wave: Wave,
    /// Laws in use, each with the index of its first state.
    pub laws: Vec<(&'a Law, usize)>,
    foreign: Option<Wave>,
    states: usize,
    length_s: f64,
    /// Input where it is held.
    pub held_value: f64,
    /// Unmeasured force, held over the step.
    pub force: f64,
    /// Sign of sliding; zero when stuck or without friction.
    slide: f64,
    stuck: bool,
    history: Vec<[f64; 3]>,
    play: f64,
}

impl EquationOfMotion<'_> {
    fn input(&self, t: f64) -> f64 {
        if self.o.held { self.held_value } else { self.wave.at(t) + self.o.constant }
    }

    fn delayed(&self, t: f64) -> f64 {
        let after = self.history.partition_point(|h| h[0] < t);
        if after == 0 || after >= self.history.len() {
            return self.history.last().map_or(0.0, |h| if after == 0 { self.history[0][1] } else { h[1] });
        }
        let ([t0, x0, v0], [t1, x1, v1]) = (self.history[after - 1], self.history[after]);
        // Cubic Hermite between accepted steps.
        let (h, s) = (t1 - t0, (t - t0) / (t1 - t0));
        let (a, b) = (s * s * (3.0 - 2.0 * s), s * (1.0 - s));
        x0 * (1.0 - a) + x1 * a + h * b * (v0 * (1.0 - s) - v1 * s)
    }

    /// Acceleration of the mass without dry friction.
    fn acceleration(&self, t: f64, s: &State) -> f64 {
        let (o, x, v) = (self.o, s[0], s[1]);
        let part = t / self.length_s;
        let u = self.input(t);
        let mut drive = u;
        let mut force = self.force + o.hidden - 2.0 * o.zeta * o.omega * v - o.omega * o.omega * x;
        let mut mass = 1.0;
        for (law, at) in &self.laws {
            let own = &s[*at..*at + law.states()];
            force -= law.plain(x, v, o.omega) + law.from_states(x, v, own, o.omega);
            match **law {
                Law::SpringDrift { size, course } => force -= size * course.at(part) * o.omega * o.omega * x,
                Law::SpringEnvironment { size } => {
                    force -= size * environment(o, part) * o.omega * o.omega * x;
                }
                Law::MassDrift { size, course } => mass = 1.0 + size * course.at(part),
                Law::DriveSquare { size } => drive += size * u * u,
                Law::DriveDead { size } => drive = u - u.clamp(-size, size),
                Law::DrivePlay { size } => drive = self.play.clamp(u - size, u + size),
                Law::Parametric { size, hz } => {
                    force -= size * o.omega * o.omega * x * (std::f64::consts::TAU * hz * t).cos();
                }
                Law::Feedback { size, delay } => force -= size * o.omega * o.omega * self.delayed(t - delay),
                Law::Foreign { size, .. } => {
                    force += size * o.omega * o.omega * self.foreign.as_ref().map_or(0.0, |w| w.at(t));
                }
                _ => {}
            }
        }
        (force + o.gain * drive) / mass
    }

    /// Force of dry friction forwards and backwards; none without it.
    fn friction(&self) -> Option<[f64; 2]> {
        self.laws.iter().find_map(|(law, _)| match **law {
            Law::Friction { size, lean } => Some([size * (1.0 + lean), size * (1.0 - lean)]),
            _ => None,
        })
    }

    /// With the mass at rest: stick, or slide the way the force goes.
    pub fn release(&mut self, t: f64, s: &State) {
        let Some([forward, backward]) = self.friction() else { return };
        let a = self.acceleration(t, s);
        self.slide = if a > forward {
            1.0
        } else if a < -backward {
            -1.0
        } else {
            0.0
        };
        self.stuck = self.slide == 0.0;
    }
}

impl System for EquationOfMotion<'_> {
    fn states(&self) -> usize {
        self.states
    }

    fn rates(&self, t: f64, s: &State) -> State {
        let mut rates = [0.0; STATES];
        if !self.stuck {
            let friction = self.friction().map_or(0.0, |[f, b]| if self.slide > 0.0 { f } else { -b });
            (rates[0], rates[1]) = (s[1], self.acceleration(t, s) - friction);
        }
        for (law, at) in &self.laws {
            let n = law.states();
            law.inner(s[0], s[1], &s[*at..*at + n], self.o.omega, &mut rates[*at..*at + n]);
            if let Law::Beside { size, omega, zeta } = **law {
                rates[*at] = s[*at + 1];
                rates[*at + 1] = size * self.input(t) - 2.0 * zeta * omega * s[*at + 1] - omega * omega * s[*at];
            }
        }
        // The analogue filters of the readout follow what is read.
        let mut at = self.states - filters(self.o);
        let mut signal = self.read(s);
        for readout in &self.o.readout {
            for tau in readout.poles() {
                rates[at] = (signal - s[at]) / tau;
                signal = s[at];
                at += 1;
            }
        }
        rates
    }
}

impl EquationOfMotion<'_> {
    /// Returns what the first readout stage sees: the mass and what moves next to it.
    fn read(&self, s: &State) -> f64 {
        let beside: f64 =
            self.laws.iter().map(|(law, at)| if matches!(law, Law::Beside { .. }) { s[*at] } else { 0.0 }).sum();
        s[0] + beside
    }

    /// Returns what the analogue part of the readout gives.
    pub fn read_filtered(&self, s: &State) -> f64 {
        if filters(self.o) > 0 { s[self.states - 1] } else { self.read(s) }
    }
}

/// Ready to move between two times.
pub fn motion(o: &Oscillator, span: [f64; 2]) -> EquationOfMotion<'_> {
    let mut states = 2;
    let laws: Vec<(&Law, usize)> = o
        .laws
        .iter()
        .map(|law| {
            let at = states;
            states += law.states();
            (law, at)
        })
        .collect();
    let foreign = laws.iter().find_map(|(law, _)| match law {
        Law::Foreign { from_hz, to_hz, .. } => Some(
            Shape::Lines {
                count: 40,
                from_hz: *from_hz,
                to_hz: *to_hz,
                of_hz: 0.0,
                odd_only: false,
                seed: o.seed ^ 77,
            }
            .wave(span[0], span[1]),
        ),
        _ => None,
    });
    EquationOfMotion {
        o,
        wave: o.input.wave(span[0], span[1]),
        laws,
        foreign,
        states: states + filters(o),
        length_s: o.rows as f64 / o.rate_hz,
        held_value: 0.0,
        force: 0.0,
        slide: 1.0,
        stuck: false,
        history: Vec::new(),
        play: 0.0,
    }
}

/// Advances with the events of dry friction; laws with a memory of the path keep it.
pub(super) fn glide(
    m: &mut EquationOfMotion<'_>,
    span: [f64; 2],
    state: &mut State,
    h: &mut f64,
    tolerance: &Tolerance,
) -> bool {
    let remembers = m.laws.iter().any(|(l, _)| matches!(l, Law::Feedback { .. }));
    let plays = m.laws.iter().find_map(|(l, _)| if let Law::DrivePlay { size } = l { Some(*size) } else { None });
    if m.friction().is_some() {
        return slide(m, span, state, h, tolerance);
    }
    let mut passed: Vec<[f64; 3]> = Vec::new();
    // Memory must not lag: what is delayed or plays is stepped finely.
    let most = if remembers || plays.is_some() { 0.1 / m.o.omega } else { f64::INFINITY };
    let mut t = span[0];
    while t < span[1] {
        let end = (t + most).min(span[1]);
        if !advance(m, [t, end], state, h, tolerance, |t, s| passed.push([t, s[0], s[1]])) {
            return false;
        }
        if remembers {
            m.history.append(&mut passed);
            if m.history.len() > 40_000 {
                m.history.drain(..20_000);
            }
        }
        if let Some(size) = plays {
            let u = m.input(end);
            m.play = m.play.clamp(u - size, u + size);
        }
        t = end;
    }
    true
}

fn slide(m: &mut EquationOfMotion<'_>, span: [f64; 2], state: &mut State, h: &mut f64, tolerance: &Tolerance) -> bool {
    let [mut t, end] = span;
    let least = 1e-12 * (end - t).max(1e-300);
    let longest = 0.05 / m.o.omega;
    let mut steps = 0;
    while end - t > least {
        steps += 1;
        if steps > MOST_STEPS {
            return false;
        }
        let length = h.min(end - t).min(longest);
        if m.stuck {
            let (next, _) = step(m, t, state, length, tolerance);
            m.release(t + length, &next);
            if m.stuck {
                (t, *state) = (t + length, next);
                continue;
            }
            // It breaks loose within the step: the instant by bisection.
            let (mut low, mut high) = (0.0, length);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                m.stuck = true;
                let (there, _) = step(m, t, state, middle, tolerance);
                m.release(t + middle, &there);
                if m.stuck { low = middle } else { high = middle }
            }
            m.stuck = true;
            (*state, _) = step(m, t, state, high, tolerance);
            t += high;
            m.release(t, state);
            if m.stuck {
                // Rounding at the threshold: try again a little later.
                t += least;
            }
            continue;
        }
        let (next, error) = step(m, t, state, length, tolerance);
        if !error.is_finite() || next[0].abs() > 1e9 {
            return false;
        }
        let factor = (0.9 * error.max(1e-10).powf(-0.2)).clamp(0.2, 4.0);
        if error > 1.0 && length > 1e3 * least {
            *h = length * factor;
            continue;
        }
        if next[1] * m.slide >= 0.0 {
            (t, *state) = (t + length, next);
            if length >= *h || factor < 1.0 {
                *h = length * factor;
            }
            continue;
        }
        // It comes to rest within the step.
        let (mut low, mut high) = (0.0, length);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            let (there, _) = step(m, t, state, middle, tolerance);
            if there[1] * m.slide >= 0.0 { low = middle } else { high = middle }
        }
        (*state, _) = step(m, t, state, high, tolerance);
        t += high.max(least);
        state[1] = 0.0;
        m.release(t, state);
    }
    true
}
