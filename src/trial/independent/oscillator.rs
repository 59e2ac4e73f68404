//! One proof mass as the second generator has it: its input, laws and readout as a recipe, integrated in continuous time.

use serde::{Deserialize, Serialize};

use super::draw::Draw;
use super::integrate::{STATES, State, System, Tolerance, advance, step};
use super::law::Law;
use super::readout::Readout;
use super::wave::{Shape, Wave};

/// Everything about one driven recording, in internal units (displacement about one).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Oscillator {
    /// Seed of what is random in it.
    pub seed: u64,
    /// Rows per second.
    pub rate_hz: f64,
    /// Rows.
    pub rows: usize,
    /// ω₀, rad/s.
    pub omega: f64,
    /// ζ.
    pub zeta: f64,
    /// Force per input.
    pub gain: f64,
    /// Displacement and velocity at the start of motion.
    pub start: [f64; 2],
    /// Rows of motion before the first recorded one.
    pub before: usize,
    /// Input.
    pub input: Shape,
    /// Whether the input is held between rows, as by a converter, or continuous.
    pub held: bool,
    /// Constant part of the input, measured with it.
    pub constant: f64,
    /// Constant force that is not measured.
    pub hidden: f64,
    /// What is missing in the equation of motion.
    pub laws: Vec<Law>,
    /// What is missing at the readout, in the order in which it acts.
    pub readout: Vec<Readout>,
    /// The environment column: rise and its time constant as a part of the recording; none when absent.
    pub environment: Option<[f64; 2]>,
    /// The input column is late by this, s.
    pub input_lag_s: f64,
    /// Noise on the input column, of its rms.
    pub input_noise: f64,
    /// Standard deviation of sampling instants, rows.
    pub jitter: f64,
    /// Rows lost without a trace: after this part of the recording, so many rows.
    pub slip: Option<[f64; 2]>,
}

/// Fine steps per row over which white force is held.
fn fine(o: &Oscillator) -> usize {
    ((16.0 * o.omega / (std::f64::consts::TAU * o.rate_hz)).ceil() as usize).max(1)
}

/// What moves: laws in use and where their states stand.
struct Motion<'a> {
    o: &'a Oscillator,
    wave: Wave,
    /// Law, first state.
    laws: Vec<(&'a Law, usize)>,
    foreign: Option<Wave>,
    states: usize,
    length_s: f64,
    /// Input where it is held.
    held_value: f64,
    /// Unmeasured held force.
    force: f64,
    /// Sign of sliding; zero when stuck or without friction.
    slide: f64,
    stuck: bool,
    history: Vec<[f64; 3]>,
    play: f64,
}

impl Motion<'_> {
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
    fn release(&mut self, t: f64, s: &State) {
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

impl System for Motion<'_> {
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

impl Motion<'_> {
    /// What the first readout stage sees: the mass and what moves beside it.
    fn read(&self, s: &State) -> f64 {
        let beside: f64 =
            self.laws.iter().map(|(law, at)| if matches!(law, Law::Beside { .. }) { s[*at] } else { 0.0 }).sum();
        s[0] + beside
    }

    fn read_filtered(&self, s: &State) -> f64 {
        if filters(self.o) > 0 { s[self.states - 1] } else { self.read(s) }
    }
}

fn filters(o: &Oscillator) -> usize {
    o.readout.iter().map(|r| r.poles().len()).sum()
}

/// Departure of the environment from its value at the start of the recording.
pub fn environment(o: &Oscillator, part: f64) -> f64 {
    o.environment.map_or(0.0, |[rise, tau]| rise * (1.0 - (-part.max(0.0) / tau).exp()))
}

/// What comes out of the integration.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Continuous input at each row.
    pub input: Vec<f64>,
    /// What the readout's analogue part gives at each row.
    pub signal: Vec<f64>,
}

/// Integrates the first `rows` rows. None when the motion runs away.
pub fn run(o: &Oscillator, rows: usize) -> Option<Run> {
    let dt = 1.0 / o.rate_hz;
    let delay = o.readout.iter().map(Readout::delay_s).sum::<f64>();
    let before = o.before.max((delay * o.rate_hz).ceil() as usize + 1);
    let margin = 4.0 * dt + o.input_lag_s.abs() + o.slip.map_or(0.0, |s| s[1] * dt);
    let span = [-(before as f64) * dt - margin, rows as f64 * dt + margin];
    let mut motion = motion(o, span);
    let mut state = [0.0; STATES];
    (state[0], state[1]) = (o.start[0], o.start[1]);
    let fine = if motion.laws.iter().any(|(l, _)| matches!(l, Law::WhiteForce { .. })) { fine(o) } else { 1 };
    let mut draw = Draw::new(o.seed, 0, 11);
    let mut telegraph = Draw::new(o.seed, 0, 12);
    let mut clock = Draw::new(o.seed, 0, 13);
    let tolerance =
        Tolerance { relative: 1e-9, sizes: std::array::from_fn(|n| if n == 1 { 0.1 * o.omega } else { 0.1 }) };
    let (mut sign, mut until) = (1.0, span[0]);
    let instants: Vec<f64> = (0..rows).map(|n| instant(o, n, &mut clock) - delay).collect();
    let mut next = 0;
    let mut signal = Vec::with_capacity(rows);
    let mut h = 0.05 / o.omega;
    // The motion begins with the recording, or `before` rows earlier from the same start.
    let first = -(before as f64) * dt;
    motion.release(first, &state);
    let last = instants.iter().fold(0.0f64, |a, b| a.max(*b));
    let mut cell = 0usize;
    while next < rows {
        let (from, to) = (first + cell as f64 * dt / fine as f64, first + (cell + 1) as f64 * dt / fine as f64);
        cell += 1;
        if from > last + 2.0 * dt {
            return None;
        }
        let moving = from >= -(o.before as f64 + 0.5) * dt;
        if o.held {
            // The cell's own row: held from its instant on.
            let row = ((from + 1e-9 * dt) / dt).floor();
            motion.held_value = motion.wave.at(row * dt) + o.constant;
        }
        motion.force = 0.0;
        for (law, _) in &motion.laws {
            match **law {
                Law::WhiteForce { size } => motion.force += draw.normal() * (size * o.rate_hz * fine as f64).sqrt(),
                Law::Telegraph { size, dwell } => {
                    if from >= until {
                        sign = -sign;
                        until = from + dwell * telegraph.exponential();
                    }
                    motion.force += sign * size * o.omega * o.omega;
                }
                _ => {}
            }
        }
        let mut t = from;
        loop {
            let stop = instants.get(next).copied().filter(|i| *i < to).unwrap_or(to).max(t);
            if moving && stop > t && !glide(&mut motion, [t, stop], &mut state, &mut h, &tolerance) {
                return None;
            }
            t = stop;
            if t >= to {
                break;
            }
            signal.push(motion.read_filtered(&state));
            next += 1;
        }
    }
    let input = (0..rows).map(|n| motion.wave.at(instant_of_input(o, n)) + o.constant).collect();
    Some(Run { input, signal })
}

/// When the input column is read: late by its lag; rows lost are lost for it as well.
fn instant_of_input(o: &Oscillator, row: usize) -> f64 {
    slipped(o, row) / o.rate_hz - o.input_lag_s
}

fn slipped(o: &Oscillator, row: usize) -> f64 {
    // Only the reading slips: a logger that lost samples of one stream.
    let _ = o;
    row as f64
}

fn instant(o: &Oscillator, row: usize, clock: &mut Draw) -> f64 {
    let jitter = if o.jitter > 0.0 { (o.jitter * clock.normal()).clamp(-0.45, 0.45) } else { 0.0 };
    let lost = o.slip.map_or(0.0, |[part, lost]| if row as f64 >= part * o.rows as f64 { lost } else { 0.0 });
    (row as f64 + jitter + lost) / o.rate_hz
}

fn motion(o: &Oscillator, span: [f64; 2]) -> Motion<'_> {
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
    Motion {
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
fn glide(m: &mut Motion<'_>, span: [f64; 2], state: &mut State, h: &mut f64, tolerance: &Tolerance) -> bool {
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

fn slide(m: &mut Motion<'_>, span: [f64; 2], state: &mut State, h: &mut f64, tolerance: &Tolerance) -> bool {
    let [mut t, end] = span;
    let least = 1e-12 * (end - t).max(1e-300);
    let longest = 0.05 / m.o.omega;
    while end - t > least {
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
