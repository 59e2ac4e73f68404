//! Free decays of many samples to a cycle, of which a search takes some: what only all of them show is named as
//! it is, and numbers are those of every sample.
//!
//! Units are the first amplitude and 1/ω₀, so that every planted number is its own expectation.

use std::f64::consts::TAU;

use libtest_mimic::{Failed, Trial};
use proofmass::diagnosis::verdict::{Outcome, Verdict};
use proofmass::rng::{Philox, Stream};

use super::decays::{diagnosed, ids};
use super::world::{check, test};

/// Listed by the suite.
pub fn tests() -> Vec<Trial> {
    vec![
        test("dense decay: hum is named at its own frequency and size, not at an alias", hum),
        test("dense decay: a stop's stiffness and gap are those planted, to a thousandth", stop),
        test("dense decay: spring, drag and friction are named, and no hysteresis for them", friction),
        test("dense decay: five laws are named together", five),
    ]
}

/// Integration steps from one sample to the next.
const STEPS: usize = 20;

/// A decay from rest at 1 under dry friction and a further force of (x, v), with what the reading adds to the
/// displacement at a time.
struct Made<'a> {
    per_cycle: usize,
    cycles: usize,
    zeta: f64,
    friction: f64,
    force: &'a dyn Fn(f64, f64) -> f64,
    added: &'a dyn Fn(f64) -> f64,
    seed: u64,
}

/// Standard deviation of a reading.
const NOISE: f64 = 1e-3;

impl Made<'_> {
    fn rate_hz(&self) -> f64 {
        self.per_cycle as f64 / TAU
    }

    fn acceleration(&self, x: f64, v: f64, sign: f64) -> f64 {
        -x - 2.0 * self.zeta * v - self.friction * sign + (self.force)(x, v)
    }

    /// One step (Runge and Kutta) in which the mass goes one way.
    fn step(&self, [x, v]: [f64; 2], h: f64, sign: f64) -> [f64; 2] {
        let a1 = self.acceleration(x, v, sign);
        let a2 = self.acceleration(x + 0.5 * h * v, v + 0.5 * h * a1, sign);
        let a3 = self.acceleration(x + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2, sign);
        let a4 = self.acceleration(x + h * v + 0.5 * h * h * a2, v + h * a3, sign);
        [x + h * v + h * h / 6.0 * (a1 + a2 + a3), v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)]
    }

    fn diagnosed(&self) -> Result<Verdict, Failed> {
        let h = TAU / (self.per_cycle * STEPS) as f64;
        let (mut state, mut sign, mut is_held) = ([1.0, 0.0], -1.0f64, false);
        let mut rng = Philox::new(self.seed, 0, Stream::Host);
        let mut reading = Vec::new();
        for row in 0..self.cycles * self.per_cycle {
            let time = row as f64 * TAU / self.per_cycle as f64;
            reading.push(state[0] + (self.added)(time) + NOISE * rng.normal());
            for _ in 0..STEPS {
                if is_held {
                    break;
                }
                let next = self.step(state, h, sign);
                if next[1] * sign >= 0.0 || state[1] == 0.0 {
                    state = next;
                    continue;
                }
                // It turns within the step, and is held where the spring is the weaker.
                let before = h * state[1] / (state[1] - next[1]);
                let turned = [self.step(state, before, sign)[0], 0.0];
                is_held = self.acceleration(turned[0], 0.0, 0.0).abs() <= self.friction;
                sign = -sign;
                state = if is_held { turned } else { self.step(turned, h - before, sign) };
            }
        }
        diagnosed(reading, self.rate_hz())
    }
}

/// The value lies within twice the 95 % interval, which chance leaves once in ten thousand; the interval is
/// within `sharp` of the value, so that a biased number could not lie in it.
fn holds(verdict: &Verdict, id: &str, parameter: &str, planted: f64, sharp: f64) -> Result<(), Failed> {
    let effect = verdict.effects.iter().find(|e| e.id == id).ok_or_else(|| format!("no {id}: {}", verdict.sentence))?;
    let known = effect.parameters.iter().find(|p| p.name == parameter);
    let [low, high] = known.ok_or_else(|| format!("no {parameter}"))?.ci95;
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let said = format!("{parameter} of {id}: {middle} ± {half}, planted {planted}");
    check((middle - planted).abs() < 2.0 * half && half < sharp * planted.abs(), said)
}

/// The size of the hum, a and b together, is the one planted within 4 %: five times the scatter σ√(2/n) that noise
/// of 10⁻³ gives a size of 2·10⁻³ over 7,500 samples or more, and far from the quarter that an alias had.
fn is_large(verdict: &Verdict, planted: f64) -> Result<(), Failed> {
    let hum = verdict.effects.iter().find(|e| e.id == "periodic-disturbance").ok_or("no hum")?;
    let found = hum.parameters[0].value.hypot(hum.parameters[1].value);
    check((found / planted - 1.0).abs() < 0.04, format!("size {found}, planted {planted}"))
}

/// The verdict is explained by these names and no others.
fn explained(verdict: &Verdict, names: &[&str]) -> Result<(), Failed> {
    let mut found = ids(verdict);
    found.sort_unstable();
    let said = format!("{} by {found:?}: {}", verdict.verdict.name(), verdict.sentence);
    check(verdict.verdict == Outcome::Explained && found == names, said)
}

const NONE: &dyn Fn(f64, f64) -> f64 = &|_, _| 0.0;

// 50 periods of hum to a cycle. A search of 40 rows to a cycle takes one sample in 6, 12 or 3: there hum has the
// alias 50 − 250/6, 50 − 500/12, and at 150/3 it does not swing at all. Its size is a and b together.
fn hum() -> Result<(), Failed> {
    for (per_cycle, cycles, size) in [(250, 40, 0.005), (500, 30, 0.005), (150, 60, 0.004)] {
        let added = |t: f64| 0.02 + size * (50.0 * t + 1.0).sin();
        let made = Made { per_cycle, cycles, zeta: 0.004, friction: 0.0, force: NONE, added: &added, seed: 5 };
        let verdict = made.diagnosed()?;
        explained(&verdict, &["periodic-disturbance"])?;
        holds(&verdict, "periodic-disturbance", "frequency", 50.0 / TAU, 1e-4)?;
        is_large(&verdict, size)?;
    }
    Ok(())
}

// The corner lies between two samples: neither a parabola through them nor a step across it may move the number.
fn stop() -> Result<(), Failed> {
    for (per_cycle, seed) in [(100, 1), (300, 2)] {
        let force = |x: f64, _: f64| -3.0 * (x - 0.6).max(0.0);
        let made = Made { per_cycle, cycles: 40, zeta: 0.005, friction: 0.0, force: &force, added: &|_| 0.02, seed };
        let verdict = made.diagnosed()?;
        explained(&verdict, &["end-stop"])?;
        holds(&verdict, "end-stop", "k_c", 3.0, 2e-3)?;
        holds(&verdict, "end-stop", "gap", 0.6, 1e-3)?;
    }
    Ok(())
}

fn friction() -> Result<(), Failed> {
    for seed in 1..5 {
        let force = |x: f64, v: f64| 0.04 * x.powi(3) - 0.015 * v.abs() * v;
        let added = |_: f64| 0.06;
        let made =
            Made { per_cycle: 100, cycles: 80, zeta: 0.0025, friction: 0.002, force: &force, added: &added, seed };
        let verdict = made.diagnosed()?;
        explained(&verdict, &["coulomb-friction", "cubic-stiffness", "quadratic-damping"])?;
        holds(&verdict, "coulomb-friction", "f_c", 0.002, 0.02)?;
        holds(&verdict, "cubic-stiffness", "beta", -0.04, 0.01)?;
        holds(&verdict, "quadratic-damping", "c2", 0.015, 0.02)?;
    }
    Ok(())
}

fn five() -> Result<(), Failed> {
    let force = |x: f64, v: f64| 0.04 * x.powi(3) - 0.015 * v.abs() * v;
    let added = |t: f64| 0.06 + 4e-5 * t + 0.002 * (50.0 * t).cos();
    let made =
        Made { per_cycle: 150, cycles: 80, zeta: 0.0025, friction: 0.002, force: &force, added: &added, seed: 3 };
    let verdict = made.diagnosed()?;
    let names = ["bias-drift", "coulomb-friction", "cubic-stiffness", "periodic-disturbance", "quadratic-damping"];
    explained(&verdict, &names)?;
    holds(&verdict, "coulomb-friction", "f_c", 0.002, 0.02)?;
    holds(&verdict, "bias-drift", "c", 4e-5, 0.1)?;
    is_large(&verdict, 0.002)
}
