//! A driven mass whose reading, or whose record of the input, is AC-coupled: each is named with its
//! time constant, whatever is read of the mass, and what only resembles it is not.
//!
//! In units of 1/ω₀ = 1 s, by a Runge–Kutta integrator of the test's own: every planted number is its own
//! expectation.

use std::f64::consts::TAU;

use libtest_mimic::{Failed, Trial};
use nalgebra::Complex;
use proofmass::diagnosis::model::Output;
use proofmass::diagnosis::verdict::{Estimate, Outcome, Verdict};
use proofmass::rng::{Philox, Stream};

use super::read_quantity::{ids, judged};
use super::sweeps;
use super::world::{check, near, test};

/// Listed by the suite.
pub fn tests() -> Vec<Trial> {
    vec![
        test("ac coupled: a reading through a high-pass is named with its time constant", reading),
        test("ac coupled: an input recorded through a high-pass is named with its time constant", input),
        test("ac coupled: next to a cubic spring both are named", beside),
        test("ac coupled: in sweeps over a wide band, beside a low-pass too, and a delay is not taken for it", swept),
        test("ac coupled: a low-pass, a warm-up and a drift of the offset are not taken for it", others),
    ]
}

/// Rows of a cycle.
const PER_CYCLE: usize = 24;
/// Integration steps from one row to the next.
const STEPS: usize = 10;
/// Cycles of a recording.
const CYCLES: usize = 150;
/// Cycles before it, in which transients fade.
const BEFORE: usize = 60;
/// Damping ratio of the mass.
const ZETA: f64 = 0.03;
/// Part of the reading's root mean square that is noise.
const NOISE: f64 = 3e-3;
/// Quantities that are read.
const OUTPUTS: [Output; 3] = [Output::Displacement, Output::Velocity, Output::Acceleration];

/// A mass and how it is recorded; what is 0 is not there.
#[derive(Clone, Copy, Default)]
struct Made {
    /// Cubic spring.
    beta: f64,
    /// Time constant of the high-pass behind the reading.
    read_s: f64,
    /// Time constant of the high-pass before the record of the input.
    recorded_s: f64,
    /// What that record shows of no force.
    rest: f64,
    /// Time constant of a low-pass behind the reading.
    smooth_s: f64,
    /// Size of a warm-up that fades with a fifth of the recording, by the reading's root mean square.
    warm_up: f64,
    /// By how much the offset has drifted at the end, by the same.
    drift: f64,
}

impl Made {
    /// Recorded input and reading of each row.
    fn rows(&self, output: Output, seed: u64) -> [Vec<f64>; 2] {
        let mut rng = Philox::new(seed, 0, Stream::Host);
        let phases: Vec<f64> = (0..60).map(|_| TAU * rng.normal()).collect();
        let force = |t: f64| -> f64 {
            phases.iter().enumerate().map(|(i, phase)| ((0.06 + 0.033 * i as f64) * t + phase).cos()).sum::<f64>() / 8.0
        };
        let seen = |[x, v, ..]: [f64; 5], force: f64| {
            let acceleration = force - x - 2.0 * ZETA * v - self.beta * x * x * x;
            let y = match output {
                Output::Displacement => x,
                Output::Velocity => v,
                Output::Acceleration => acceleration,
            };
            (y, acceleration)
        };
        // Displacement, velocity, and the low-passes in the readout's filters and in the input's.
        let rates = |force: f64, state: [f64; 5]| -> [f64; 5] {
            let (y, acceleration) = seen(state, force);
            let lag = |time_s: f64, from: f64, held: f64| if time_s > 0.0 { (from - held) / time_s } else { 0.0 };
            let smooth = if self.smooth_s > 0.0 { state[2] } else { y };
            let slow = lag(self.read_s, smooth, state[3]);
            [state[1], acceleration, lag(self.smooth_s, y, state[2]), slow, lag(self.recorded_s, force, state[4])]
        };
        let h = TAU / (PER_CYCLE * STEPS) as f64;
        let mut state = [0.0; 5];
        let (mut inputs, mut readings) = (Vec::new(), Vec::new());
        for step in 0..(BEFORE + CYCLES) * PER_CYCLE * STEPS {
            let t = step as f64 * h;
            if step % STEPS == 0 && step >= BEFORE * PER_CYCLE * STEPS {
                let read = if self.smooth_s > 0.0 { state[2] } else { seen(state, force(t)).0 };
                readings.push(read - state[3]);
                inputs.push(force(t) - state[4] + self.rest);
            }
            let to = |k: [f64; 5], by: f64| -> [f64; 5] { std::array::from_fn(|i| state[i] + by * k[i]) };
            let middle = force(t + 0.5 * h);
            let a = rates(force(t), state);
            let b = rates(middle, to(a, 0.5 * h));
            let c = rates(middle, to(b, 0.5 * h));
            let d = rates(force(t + h), to(c, h));
            state = std::array::from_fn(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        let size = (readings.iter().map(|y| y * y).sum::<f64>() / readings.len() as f64).sqrt();
        let rows = readings.len() as f64;
        for (i, y) in readings.iter_mut().enumerate() {
            let along = i as f64 / rows;
            let slow = self.warm_up * (-5.0 * along).exp() + self.drift * along;
            *y += size * (slow + NOISE * rng.normal());
        }
        [inputs, readings]
    }

    fn judged(&self, output: Output, seed: u64) -> Result<Verdict, Failed> {
        judged(self.rows(output, seed), true, PER_CYCLE, output)
    }
}

/// Checks that these and no others are named.
fn named(verdict: &Verdict, expected: &[&str], case: &str) -> Result<(), Failed> {
    let outcome = if expected.is_empty() { Outcome::Adequate } else { Outcome::Explained };
    let mut names = ids(verdict);
    names.sort_unstable();
    check(verdict.verdict == outcome && names == expected, format!("{case}: {names:?} {}", verdict.sentence))
}

/// Checks that a number is as planted to within the width of its 95 % interval, four standard deviations, and that
/// the interval is narrow: less than a tenth of the number.
fn holds(verdict: &Verdict, id: &str, planted: f64) -> Result<(), Failed> {
    let effect = verdict.effects.iter().find(|effect| effect.id == id).ok_or("not named")?;
    let first: &Estimate = effect.parameters.first().ok_or("no number")?;
    let [low, high] = first.ci95;
    check(high - low < 0.1 * planted, format!("{id}: {low} to {high}"))?;
    near(id, first.value, planted, high - low)
}

fn reading() -> Result<(), Failed> {
    for (i, output) in OUTPUTS.into_iter().enumerate() {
        for tau_s in [3.0, 30.0] {
            let verdict = Made { read_s: tau_s, ..Made::default() }.judged(output, i as u64)?;
            named(&verdict, &["readout-highpass"], &format!("{output:?} {tau_s}"))?;
            holds(&verdict, "readout-highpass", tau_s)?;
        }
        named(&Made::default().judged(output, i as u64)?, &[], &format!("{output:?}, nothing"))?;
    }
    Ok(())
}

fn input() -> Result<(), Failed> {
    for (i, output) in OUTPUTS.into_iter().enumerate() {
        for (tau_s, rest) in [(4.0, 0.0), (30.0, 0.5)] {
            let verdict = Made { recorded_s: tau_s, rest, ..Made::default() }.judged(output, 10 + i as u64)?;
            named(&verdict, &["input-highpass"], &format!("{output:?} {tau_s}"))?;
            holds(&verdict, "input-highpass", tau_s)?;
        }
    }
    // Both at once are a shelf, (1 + sτ₁)/(1 + sτ₂), as a loss that goes with a power of frequency is one over a band:
    // they are not told from it, and no explanation.
    let both = Made { recorded_s: 6.0, read_s: 20.0, ..Made::default() }.judged(Output::Displacement, 15)?;
    let names = ids(&both);
    let one = names.len() <= 1 && names.iter().all(|name| ["input-highpass", "readout-highpass"].contains(name));
    check(one && both.verdict == Outcome::Unexplained, format!("both: {names:?} {}", both.sentence))
}

fn beside() -> Result<(), Failed> {
    for (i, output) in OUTPUTS.into_iter().enumerate() {
        let made = Made { beta: 0.01, ..Made::default() };
        let read = Made { read_s: 20.0, ..made }.judged(output, 20 + i as u64)?;
        named(&read, &["cubic-stiffness", "readout-highpass"], &format!("{output:?}, read"))?;
        holds(&read, "cubic-stiffness", 0.01)?;
        holds(&read, "readout-highpass", 20.0)?;
    }
    let recorded = Made { beta: 0.01, recorded_s: 20.0, rest: 0.3, ..Made::default() };
    let verdict = recorded.judged(Output::Displacement, 25)?;
    named(&verdict, &["cubic-stiffness", "input-highpass"], "recorded")?;
    holds(&verdict, "cubic-stiffness", 0.01)?;
    holds(&verdict, "input-highpass", 20.0)
}

fn others() -> Result<(), Failed> {
    for (i, output) in OUTPUTS.into_iter().enumerate() {
        let verdict = Made { smooth_s: 0.15, ..Made::default() }.judged(output, 30 + i as u64)?;
        named(&verdict, &["readout-lowpass"], &format!("{output:?}, low-pass"))?;
        holds(&verdict, "readout-lowpass", 0.15)?;
    }
    let warm = Made { warm_up: 0.3, ..Made::default() }.judged(Output::Displacement, 35)?;
    named(&warm, &["warm-up"], "warm-up")?;
    let drift = Made { drift: 0.3, ..Made::default() }.judged(Output::Displacement, 36)?;
    named(&drift, &["bias-drift"], "drift")
}

/// Steps of a sweep.
const SWEPT: usize = 600;

/// Frequency, X, Y and drive of a resonator of 1 kHz and Q = 20 from half a hertz to 2 kHz, in closed form, behind a
/// high-pass, a low-pass and a delay of these times in s.
fn sweep([high_s, low_s, late_s]: [f64; 3], seed: u64) -> Vec<[f64; 4]> {
    let mut rng = Philox::new(seed, 0, Stream::Host);
    let one = |k: usize| {
        let f: f64 = 0.5 * 4000f64.powf(k as f64 / (SWEPT - 1) as f64);
        let (w, j) = (f / 1000.0, Complex::new(0.0, TAU * f));
        let mut z = Complex::new(1.0 - w * w, w / 20.0).inv() / (1.0 + j * low_s) * (-j * late_s).exp();
        if high_s > 0.0 {
            z *= j * high_s / (1.0 + j * high_s);
        }
        [f, z.re + 2e-3 * rng.normal(), z.im + 2e-3 * rng.normal(), 1.0]
    };
    (0..SWEPT).map(one).collect()
}

fn swept() -> Result<(), Failed> {
    let said = |filters: [f64; 3], seed: u64| -> Result<Verdict, Failed> {
        Ok(sweeps::diagnosed(&sweeps::recording(&sweep(filters, seed)), &sweeps::asked()?)?.0)
    };
    for (seed, tau_s) in [(1, 0.1), (2, 1e-3)] {
        let verdict = said([tau_s, 0.0, 0.0], seed)?;
        named(&verdict, &["readout-highpass"], &format!("swept, {tau_s}"))?;
        holds(&verdict, "readout-highpass", tau_s)?;
    }
    named(&said([0.0; 3], 3)?, &[], "swept, nothing")?;
    let both = said([0.05, 2e-5, 0.0], 4)?;
    named(&both, &["readout-highpass", "readout-lowpass"], "swept, both")?;
    holds(&both, "readout-highpass", 0.05)?;
    holds(&both, "readout-lowpass", 2e-5)?;
    // A fiftieth of a cycle at the resonance is a delay or a low-pass, or is left without a name: past it, where they
    // differ, little is read.
    let late = said([0.0, 0.0, 2e-5], 5)?;
    let alike = ["readout-delay", "readout-lowpass"];
    check(ids(&late).iter().all(|name| alike.contains(name)), format!("{:?}", ids(&late)))?;
    check(late.verdict != Outcome::Adequate && late.verdict != Outcome::Explained, late.sentence)
}
