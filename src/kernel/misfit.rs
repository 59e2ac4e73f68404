//! The contract of `misfit`: many models of one driven recording, and how far the free simulation of each stays from the
//! readings.
//!
//! A model is a [`Point`] in the space of all parameters of all candidates; a parameter at zero (rails: infinitely far) is
//! a candidate left out. What each parameter does is defined where the diagnosis fits it, under `diagnosis::driven`; this
//! kernel does the same for thousands of points at once, in single precision, and keeps sums only. Not for noise terms,
//! which no free simulation shows, nor for polishing a fit.

use std::ops::Range;

/// Parameters of one model; y the reading's unit, u the input's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// g, y/(u s²).
    pub gain: f64,
    /// ω₀.
    pub omega_rad_s: f64,
    /// ζ.
    pub zeta: f64,
    /// Offset of the reading, y.
    pub offset: f64,
    /// Displacement at the beginning of the run, y.
    pub x0: f64,
    /// Velocity there, y/s.
    pub v0: f64,
    /// β of βx³, 1/(y² s²).
    pub cubic: f64,
    /// α of αx², 1/(y s²).
    pub quadratic: f64,
    /// c₂ of c₂|x′|x′, 1/y.
    pub speed_damping: f64,
    /// c of c x²x′, 1/(y² s).
    pub squeeze_film: f64,
    /// f_c of f_c sgn x′, y/s².
    pub friction: f64,
    /// κ of ω₀²(1 + κt), 1/s.
    pub stiffness_drift: f64,
    /// κ of g(u + κu²), 1/u.
    pub drive_square: f64,
    /// Stiffness of the stop above, 1/s².
    pub stop_above: f64,
    /// Its distance, y.
    pub gap_above: f64,
    /// Stiffness of the stop below, 1/s².
    pub stop_below: f64,
    /// Its distance, y.
    pub gap_below: f64,
    /// k_h of the Bouc–Wen spring, 1/s².
    pub hysteresis: f64,
    /// Its yield displacement z_y, y.
    pub yield_displacement: f64,
    /// g₂ of the second mode, y/(u s²).
    pub mode_gain: f64,
    /// ω₂.
    pub mode_omega_rad_s: f64,
    /// ζ₂.
    pub mode_zeta: f64,
    /// τ of the readout's low-pass; zero: none.
    pub lowpass_s: f64,
    /// Delay of the reading.
    pub delay_s: f64,
    /// d of y = x + d·u, y/u.
    pub feedthrough: f64,
    /// k₂ of the readout, 1/y.
    pub bend_2: f64,
    /// k₃ of the readout, 1/y².
    pub bend_3: f64,
    /// c of c·t, y/s.
    pub ramp: f64,
    /// c of c·exp(−t/τ), y.
    pub warm_up: f64,
    /// Its τ.
    pub warm_up_s: f64,
    /// Lower rail, y.
    pub low: f64,
    /// Upper rail, y.
    pub high: f64,
}

/// A rail that nothing reaches.
const FAR: f64 = 1e30;

impl Default for Point {
    fn default() -> Self {
        Self {
            gain: 0.0,
            omega_rad_s: 1.0,
            zeta: 0.0,
            offset: 0.0,
            x0: 0.0,
            v0: 0.0,
            cubic: 0.0,
            quadratic: 0.0,
            speed_damping: 0.0,
            squeeze_film: 0.0,
            friction: 0.0,
            stiffness_drift: 0.0,
            drive_square: 0.0,
            stop_above: 0.0,
            gap_above: 0.0,
            stop_below: 0.0,
            gap_below: 0.0,
            hysteresis: 0.0,
            yield_displacement: 1.0,
            mode_gain: 0.0,
            mode_omega_rad_s: 1.0,
            mode_zeta: 0.0,
            lowpass_s: 0.0,
            delay_s: 0.0,
            feedthrough: 0.0,
            bend_2: 0.0,
            bend_3: 0.0,
            ramp: 0.0,
            warm_up: 0.0,
            warm_up_s: 1.0,
            low: -FAR,
            high: FAR,
        }
    }
}

/// Units in which single precision is at its best: output and input of order one, time in samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Standard deviation of the output.
    pub output: f64,
    /// Standard deviation of the input; 1 without one.
    pub input: f64,
    /// Sampling interval.
    pub interval_s: f64,
}

/// One recording, and how it is simulated and summed.
#[derive(Debug, Clone)]
pub struct Job<'a> {
    /// Readings of the whole recording, y.
    pub reading: &'a [f64],
    /// Input on half steps, 2·`steps` per sample, of the whole recording; empty without one.
    pub grid: &'a [f64],
    /// How far before the end of a step its last input is read, in grid points.
    pub grid_end: usize,
    /// Runge–Kutta steps per sample.
    pub steps: usize,
    /// Samples that are simulated.
    pub run: Range<usize>,
    /// Stretches, ascending and within the run, over which squares are summed apart.
    pub blocks: Vec<Range<usize>>,
    /// Sequences as long as the run with which the errors are multiplied and summed over all blocks: an orthonormal basis
    /// of what other parameters could still take up, say. At most [`MOST_DIRECTIONS`].
    pub directions: &'a [Vec<f64>],
    /// Units to compute in.
    pub units: Units,
}

/// Most sequences that errors are projected on.
pub const MOST_DIRECTIONS: usize = 8;

/// What one point leaves unexplained.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// Sum of squared errors of each block, y²; infinite where the simulation left every bound.
    pub squares: Vec<f64>,
    /// Sum of error times each direction, y.
    pub along: Vec<f64>,
}

/// Numbers per point that the kernel reads.
pub const COLUMNS: usize = 41;
/// Numbers per point that it carries from sample to sample: x, v, z, x₂, v₂, low-pass, warm-up, lost.
pub const STATE: usize = 8;
/// Displacements beyond this, in output units, count as lost.
pub const LOST: f32 = 1e6;

/// Places of the numbers per point; the first eight are exp(At) over a step and over half a step.
#[allow(missing_docs)]
pub mod column {
    pub const FULL: usize = 0;
    pub const HALF: usize = 4;
    pub const GAIN: usize = 8;
    pub const STIFFNESS: usize = 9;
    pub const OFFSET: usize = 10;
    pub const CUBIC: usize = 11;
    pub const QUADRATIC: usize = 12;
    pub const SPEED_DAMPING: usize = 13;
    pub const SQUEEZE_FILM: usize = 14;
    pub const FRICTION: usize = 15;
    pub const STIFFNESS_DRIFT: usize = 16;
    pub const DRIVE_SQUARE: usize = 17;
    pub const STOP_ABOVE: usize = 18;
    pub const GAP_ABOVE: usize = 19;
    pub const STOP_BELOW: usize = 20;
    pub const GAP_BELOW: usize = 21;
    pub const HYSTERESIS: usize = 22;
    pub const YIELD: usize = 23;
    pub const MODE_GAIN: usize = 24;
    pub const MODE_DAMPING: usize = 25;
    pub const MODE_STIFFNESS: usize = 26;
    pub const LAG: usize = 27;
    pub const KEEPS: usize = 28;
    pub const FEEDTHROUGH: usize = 29;
    pub const BEND_2: usize = 30;
    pub const BEND_3: usize = 31;
    pub const RAMP: usize = 32;
    pub const FADE: usize = 33;
    pub const LOW: usize = 34;
    pub const HIGH: usize = 35;
    pub const SHIFT: usize = 36;
    pub const WEIGHTS: usize = 37;
}

/// Names in the shader of the columns.
pub const COLUMN_NAMES: [(&str, usize); 29] = [
    ("GAIN", column::GAIN),
    ("STIFFNESS", column::STIFFNESS),
    ("OFFSET", column::OFFSET),
    ("CUBIC", column::CUBIC),
    ("QUADRATIC", column::QUADRATIC),
    ("SPEED_DAMPING", column::SPEED_DAMPING),
    ("SQUEEZE_FILM", column::SQUEEZE_FILM),
    ("FRICTION", column::FRICTION),
    ("STIFFNESS_DRIFT", column::STIFFNESS_DRIFT),
    ("DRIVE_SQUARE", column::DRIVE_SQUARE),
    ("STOP_ABOVE", column::STOP_ABOVE),
    ("GAP_ABOVE", column::GAP_ABOVE),
    ("STOP_BELOW", column::STOP_BELOW),
    ("GAP_BELOW", column::GAP_BELOW),
    ("HYSTERESIS", column::HYSTERESIS),
    ("YIELD", column::YIELD),
    ("MODE_GAIN", column::MODE_GAIN),
    ("MODE_DAMPING", column::MODE_DAMPING),
    ("MODE_STIFFNESS", column::MODE_STIFFNESS),
    ("LAG", column::LAG),
    ("KEEPS", column::KEEPS),
    ("FEEDTHROUGH", column::FEEDTHROUGH),
    ("BEND_2", column::BEND_2),
    ("BEND_3", column::BEND_3),
    ("RAMP", column::RAMP),
    ("FADE", column::FADE),
    ("LOW", column::LOW),
    ("HIGH", column::HIGH),
    ("SHIFT", column::SHIFT),
];

/// Which parts of the kernel a job needs; the rest is skipped. Decided by all points of a job together, so that how they
/// are grouped changes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[allow(missing_docs)]
pub struct Parts {
    pub spring: bool,
    pub damping: bool,
    pub friction: bool,
    pub drift: bool,
    pub drive: bool,
    pub stop: bool,
    pub hysteresis: bool,
    pub mode: bool,
    pub lag: bool,
    pub feedthrough: bool,
    pub bend: bool,
    pub bias: bool,
    pub rails: bool,
    pub delay: bool,
}

impl Parts {
    /// What any of the points needs.
    pub fn of(points: &[Point]) -> Self {
        let any = |f: fn(&Point) -> bool| points.iter().any(f);
        Self {
            spring: any(|p| p.cubic != 0.0 || p.quadratic != 0.0),
            damping: any(|p| p.speed_damping != 0.0 || p.squeeze_film != 0.0),
            friction: any(|p| p.friction != 0.0),
            drift: any(|p| p.stiffness_drift != 0.0),
            drive: any(|p| p.drive_square != 0.0),
            stop: any(|p| p.stop_above != 0.0 || p.stop_below != 0.0),
            hysteresis: any(|p| p.hysteresis != 0.0),
            mode: any(|p| p.mode_gain != 0.0),
            lag: any(|p| p.lowpass_s != 0.0),
            feedthrough: any(|p| p.feedthrough != 0.0),
            bend: any(|p| p.bend_2 != 0.0 || p.bend_3 != 0.0),
            bias: any(|p| p.ramp != 0.0 || p.warm_up != 0.0),
            rails: any(|p| p.low > -FAR || p.high < FAR),
            delay: any(|p| p.delay_s != 0.0),
        }
    }

    /// Whether the equation of motion is more than the base model's.
    pub fn moves(&self) -> bool {
        let force = self.spring || self.damping || self.friction || self.drift || self.drive || self.stop;
        force || self.hysteresis || self.mode
    }

    /// As the shader's override constants.
    pub fn constants(&self) -> Vec<(&'static str, f64)> {
        let flag = |on: bool| f64::from(u8::from(on));
        vec![
            ("MOVES", flag(self.moves())),
            ("HAS_SPRING", flag(self.spring)),
            ("HAS_DAMPING", flag(self.damping)),
            ("HAS_FRICTION", flag(self.friction)),
            ("HAS_DRIFT", flag(self.drift)),
            ("HAS_DRIVE", flag(self.drive)),
            ("HAS_STOP", flag(self.stop)),
            ("HAS_HYSTERESIS", flag(self.hysteresis)),
            ("HAS_MODE", flag(self.mode)),
            ("HAS_LAG", flag(self.lag)),
            ("HAS_FEEDTHROUGH", flag(self.feedthrough)),
            ("HAS_BEND", flag(self.bend)),
            ("HAS_BIAS", flag(self.bias)),
            ("HAS_RAILS", flag(self.rails)),
            ("HAS_DELAY", flag(self.delay)),
        ]
    }
}

impl Point {
    /// The numbers that the kernel reads, and the state it begins with.
    pub fn columns(&self, units: &Units, steps: usize) -> ([f64; COLUMNS], [f64; STATE]) {
        use column::*;
        let (y, u, s) = (units.output, units.input, units.interval_s);
        let h = 1.0 / steps as f64;
        let (omega, mode_omega) = (self.omega_rad_s * s, self.mode_omega_rad_s * s);
        let mut c = [0.0; COLUMNS];
        c[FULL..FULL + 4].copy_from_slice(&transition(omega, self.zeta, h));
        c[HALF..HALF + 4].copy_from_slice(&transition(omega, self.zeta, 0.5 * h));
        c[GAIN] = self.gain * u * s * s / y;
        c[STIFFNESS] = omega * omega;
        c[OFFSET] = self.offset / y;
        c[CUBIC] = self.cubic * y * y * s * s;
        c[QUADRATIC] = self.quadratic * y * s * s;
        c[SPEED_DAMPING] = self.speed_damping * y;
        c[SQUEEZE_FILM] = self.squeeze_film * y * y * s;
        c[FRICTION] = self.friction * s * s / y;
        c[STIFFNESS_DRIFT] = c[STIFFNESS] * self.stiffness_drift * s;
        c[DRIVE_SQUARE] = c[GAIN] * self.drive_square * u;
        c[STOP_ABOVE] = self.stop_above * s * s;
        c[GAP_ABOVE] = self.gap_above / y;
        c[STOP_BELOW] = self.stop_below * s * s;
        c[GAP_BELOW] = self.gap_below / y;
        c[HYSTERESIS] = self.hysteresis * s * s;
        c[YIELD] = 0.5 * y / self.yield_displacement;
        c[MODE_GAIN] = self.mode_gain * u * s * s / y;
        c[MODE_DAMPING] = 2.0 * self.mode_zeta * mode_omega;
        c[MODE_STIFFNESS] = mode_omega * mode_omega;
        let lag = self.lowpass_s / s;
        c[LAG] = lag / h;
        c[KEEPS] = (-h / lag).exp();
        c[FEEDTHROUGH] = self.feedthrough * u / y;
        c[BEND_2] = self.bend_2 * y;
        c[BEND_3] = self.bend_3 * y * y;
        c[RAMP] = self.ramp * s / y;
        c[FADE] = (-s / self.warm_up_s).exp_m1();
        c[LOW] = (self.low / y).max(-FAR);
        c[HIGH] = (self.high / y).min(FAR);
        let delay = 2.0 * self.delay_s / (s * h);
        c[SHIFT] = delay.ceil();
        c[WEIGHTS..].copy_from_slice(&lagrange(delay.ceil() - delay));
        let (x, v) = (self.x0 / y, self.v0 * s / y);
        (c, [x, v, 0.0, 0.0, 0.0, x - lag * v, self.warm_up / y, 0.0])
    }
}

/// Weights of the points −1, 0, 1, 2 of a cubic through them, at `t`.
fn lagrange(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

/// exp(At) for A = [[0, 1], [−ω², −2ζω]], row by row; any ζ ≥ 0.
pub fn transition(omega: f64, zeta: f64, t: f64) -> [f64; 4] {
    let decay = (-zeta * omega * t).exp();
    let d = 1.0 - zeta * zeta;
    // C = cos(w t) and S = sin(w t)/w, continued analytically through critical damping.
    let (c, s) = if d > 1e-8 {
        let w = omega * d.sqrt();
        ((w * t).cos() * decay, (w * t).sin() / w * decay)
    } else if d < -1e-8 {
        let w = omega * (-d).sqrt();
        let (up, down) = (((w - zeta * omega) * t).exp(), ((-w - zeta * omega) * t).exp());
        (0.5 * (up + down), 0.5 * (up - down) / w)
    } else {
        (decay, t * decay)
    };
    let a = zeta * omega;
    [c + a * s, s, -omega * omega * s, c - a * s]
}

/// Stretches of a run that lie within one block, or within none: what is simulated in one go.
pub fn stretches(job: &Job<'_>) -> Vec<(Range<usize>, Option<usize>)> {
    let mut all = Vec::new();
    let mut from = job.run.start;
    for (number, block) in job.blocks.iter().enumerate() {
        let block = block.start.max(from)..block.end.min(job.run.end);
        if block.is_empty() {
            continue;
        }
        if from < block.start {
            all.push((from..block.start, None));
        }
        from = block.end;
        all.push((block, Some(number)));
    }
    // Samples after the last block change nothing that is asked for.
    all
}
