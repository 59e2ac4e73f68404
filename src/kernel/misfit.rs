//! The contract of `misfit`: many models of one driven recording, and how far the free simulation of each stays from the
//! readings.
//!
//! A model is a [`Point`] in the space of all parameters of all candidates; a parameter at zero (rails: infinitely far) is
//! a candidate left out. What each parameter does is defined where the diagnosis fits it, under `diagnosis::driven`; this
//! kernel does the same for thousands of points at once, in single precision, and keeps sums only. Not for noise terms,
//! which no free simulation shows, nor for polishing a fit.

use std::ops::Range;

mod point;

pub use point::{Point, transition};

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
    /// Samples that are simulated; time counts from the recording's first.
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
pub const MOST_DIRECTIONS: usize = 16;

/// What one point leaves unexplained.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// Sum of squared errors of each block, y²; infinite where the simulation left every bound.
    pub squares: Vec<f64>,
    /// Sum of error times each direction, y.
    pub along: Vec<f64>,
}

/// Numbers per point that the kernel reads.
pub const COLUMNS: usize = 42;
/// Numbers per point that it carries from sample to sample: x, v, z, x₂, v₂, low-pass, warm-up, lost.
pub const STATE: usize = 8;
/// Displacements beyond this, in output units, count as lost.
pub const LOST: f32 = 1e6;

/// A rail that nothing reaches.
const FAR: f64 = 1e30;

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
    pub const SHARE: usize = 36;
    pub const SHIFT: usize = 37;
    pub const WEIGHTS: usize = 38;
}

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
            mode: any(|p| p.mode_gain != 0.0 || p.mode_x0 != 0.0 || p.mode_v0 != 0.0),
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
