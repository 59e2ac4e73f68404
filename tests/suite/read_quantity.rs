//! A mass whose velocity or acceleration is read, free or under an input: laws that were planted are
//! named with their numbers in units of displacement, and what is not there gets no name.
//!
//! Recordings come from a plain Runge–Kutta integrator of the test's own in units of 1/ω₀ = 1 s, so that
//! every planted number is its own expectation.

use std::f64::consts::TAU;

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::diagnosis::driven;
use proofmass::diagnosis::model::{Driven, DrivenColumns, Output, Split, Start};
use proofmass::diagnosis::verdict::{Outcome, Verdict};
use proofmass::recording::{Column, Recording, Request, read};
use proofmass::report::diagnosis::worded;
use proofmass::rng::{Philox, Stream};

use super::world::{check, data_test, near, test};

/// Listed by the suite.
pub fn tests() -> Vec<Trial> {
    vec![
        test("read quantity: a decay read as velocity or acceleration gives the same laws", decays),
        test("read quantity: a driven mass read as velocity or acceleration gives the same laws", driven_masses),
        test("read quantity: an accelerometer that clips keeps its rails, beside a spring of its mass", clipped),
        data_test("read quantity: the rate of a ship's roll gives the spring that its angle gives", roll_rate),
        test("read quantity: noise and foreign physics are given no name", silent),
        test("read quantity: a narrow resonance that rings beside one line is no second mode", ringing),
        test("read quantity: a reading that is late is named, and an input that is held is not", late),
        test("read quantity: mains pickup is named at its frequency, beside a spring too", pickup),
        test("read quantity: noise with a memory is no missing physics", remembering_noise),
        test("read quantity: several recordings are refused in a sentence", refused),
    ]
}

/// Rows of a cycle.
const PER_CYCLE: usize = 30;
/// Integration steps from one row to the next.
const STEPS: usize = 12;
/// Lines of an input, from a third of the resonance to three times it.
const LINES: usize = 60;

/// A mass with ω₀ = 1, from rest at `begin`; `force` of (x, v, time) acts beside oscillator and input.
struct Made<'a> {
    zeta: f64,
    begin: f64,
    /// Of the input's standard deviation; zero for a decay.
    gain: f64,
    cycles: usize,
    noise: f64,
    force: &'a dyn Fn(f64, f64, f64) -> f64,
}

impl Made<'_> {
    /// Input and reading of each row.
    fn rows(&self, output: Output) -> [Vec<f64>; 2] {
        let mut rng = Philox::new(7, 0, Stream::Host);
        let phases: Vec<f64> = (0..LINES).map(|_| TAU * rng.normal()).collect();
        let input = |t: f64| {
            let line = |(i, phase): (usize, &f64)| ((0.35 + 0.045 * i as f64) * t + phase).cos();
            phases.iter().enumerate().map(line).sum::<f64>() / (0.5 * LINES as f64).sqrt()
        };
        let rate = |t: f64, u: f64, x: f64, v: f64| self.gain * u - x - 2.0 * self.zeta * v + (self.force)(x, v, t);
        let h = TAU / (PER_CYCLE * STEPS) as f64;
        let (mut x, mut v, mut u) = (self.begin, 0.0, input(0.0));
        let (mut inputs, mut readings) = (Vec::new(), Vec::new());
        for row in 0..self.cycles * PER_CYCLE {
            inputs.push(u);
            readings.push(match output {
                Output::Displacement => x,
                Output::Velocity => v,
                Output::Acceleration => rate((row * STEPS) as f64 * h, u, x, v),
            });
            for step in 0..STEPS {
                let t = (row * STEPS + step) as f64 * h;
                let [middle, end] = if self.gain == 0.0 { [0.0; 2] } else { [input(t + 0.5 * h), input(t + h)] };
                let a1 = rate(t, u, x, v);
                let a2 = rate(t + 0.5 * h, middle, x + 0.5 * h * v, v + 0.5 * h * a1);
                let a3 = rate(t + 0.5 * h, middle, x + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2);
                let a4 = rate(t + h, end, x + h * v + 0.5 * h * h * a2, v + h * a3);
                x += h * v + h * h / 6.0 * (a1 + a2 + a3);
                v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
                u = end;
            }
        }
        let size = (readings.iter().map(|y| y * y).sum::<f64>() / readings.len() as f64).sqrt();
        readings.iter_mut().for_each(|y| *y += self.noise * size * rng.normal());
        [inputs, readings]
    }

    /// The same, diagnosed as what it is said to be.
    fn diagnosed(&self, output: Output, output_is: Output) -> Result<Verdict, Failed> {
        self.judged(self.rows(output), output_is)
    }

    fn judged(&self, rows: [Vec<f64>; 2], output_is: Output) -> Result<Verdict, Failed> {
        judged(rows, self.gain != 0.0, PER_CYCLE, output_is)
    }
}

/// Velocity of a linear mass with ω₀ = 1 that one line of the input, at this frequency, drives from rest, in closed
/// form: the line's answer, and a ringing that begins as its opposite.
fn rung(zeta: f64, line: f64, cycles: usize, noise: f64, seed: u64) -> [Vec<f64>; 2] {
    let mut rng = Philox::new(seed, 0, Stream::Host);
    let (re, im) = (1.0 - line * line, 2.0 * zeta * line);
    let size = re * re + im * im;
    // The line's answer is c cos + s sin of its phase.
    let (c, s) = (re / size, im / size);
    let damped = (1.0 - zeta * zeta).sqrt();
    let (a, b) = (-c, -(zeta * c + line * s) / damped);
    let rows = (0..cycles * PER_CYCLE).map(|row| {
        let t = TAU * row as f64 / PER_CYCLE as f64;
        let (sin, cos) = (line * t).sin_cos();
        let (rings, rung) = (damped * t).sin_cos();
        let fades = (-zeta * t).exp();
        let ringing = fades * ((damped * b - zeta * a) * rung - (damped * a + zeta * b) * rings);
        (cos, line * (s * cos - c * sin) + ringing)
    });
    let (input, mut reading): (Vec<f64>, Vec<f64>) = rows.unzip();
    let power = (reading.iter().map(|y| y * y).sum::<f64>() / reading.len() as f64).sqrt();
    reading.iter_mut().for_each(|y| *y += noise * power * rng.normal());
    [input, reading]
}

// Under one line the response shows nothing of the resonance: a base model that begins at what answers that line
// alone leaves the ringing, which a second mode would explain.
fn ringing() -> Result<(), Failed> {
    for (zeta, line) in [(0.001, 0.7), (0.003, 0.6), (0.0005, 1.4)] {
        let verdict = judged(rung(zeta, line, 150, 0.01, 3), true, PER_CYCLE, Output::Velocity)?;
        let resonance = verdict.base.iter().find(|p| p.name == "omega0").map_or(0.0, |p| p.value);
        let is_right = verdict.effects.is_empty() && verdict.verdict == Outcome::Adequate;
        check(is_right, format!("ζ = {zeta}: {:?} {}", verdict.verdict, verdict.sentence))?;
        // The input's line is 0.3 off or more. By Cramér and Rao the ringing, in noise of a hundredth over 4500 rows
        // and 150 cycles, is known to √24 · 0.01/(√4500 · 300π) = 8e-7, and less well by as much as it fades.
        near("ω₀", resonance, 1.0, 1e-3)?;
        let interval = verdict.base.iter().find(|p| p.name == "omega0").map_or([0.0; 2], |p| p.ci95);
        check(interval[0] <= 1.0 && 1.0 <= interval[1], format!("ζ = {zeta}: ω₀ within {interval:?}"))?;
    }
    Ok(())
}

// A line whose rms is a twentieth of the reading's. It lies 0.0037 from a line of the input, closer than the 0.005 that
// 200 cycles resolve: the input must not take it for its own.
fn pickup() -> Result<(), Failed> {
    const LINE: f64 = 1.2537;
    let spring = |x: f64, _: f64, _: f64| -0.1 * x.powi(3);
    let none = |_: f64, _: f64, _: f64| 0.0;
    for output in [Output::Velocity, Output::Acceleration] {
        for (force, names) in [
            (&none as &dyn Fn(f64, f64, f64) -> f64, vec!["periodic-disturbance"]),
            (&spring, vec!["cubic-stiffness", "periodic-disturbance"]),
        ] {
            let made = Made { zeta: 0.03, begin: 0.0, gain: 0.1, cycles: 200, noise: 0.01, force };
            let [input, mut reading] = made.rows(output);
            let power = (reading.iter().map(|y| y * y).sum::<f64>() / reading.len() as f64).sqrt();
            let time = |row: usize| TAU * row as f64 / PER_CYCLE as f64;
            reading.iter_mut().enumerate().for_each(|(row, y)| *y += 0.07 * power * (LINE * time(row)).cos());
            let verdict = made.judged([input, reading], output)?;
            let mut found = ids(&verdict);
            found.sort_unstable();
            check(found == names, format!("{output:?}: {found:?}, {}", verdict.sentence))?;
            let line = verdict.effects.iter().find(|e| e.id == "periodic-disturbance");
            let frequency = line.and_then(|e| e.parameters.iter().find(|p| p.name == "frequency"));
            let frequency = frequency.ok_or_else(|| Failed::from("no frequency"))?;
            check(
                frequency.ci95[0] < LINE / TAU && LINE / TAU < frequency.ci95[1],
                format!("{:?}, planted {}", frequency.ci95, LINE / TAU),
            )?;
        }
    }
    Ok(())
}

/// Input and reading of a mass with ω₀ = 1, with this many rows in a cycle, diagnosed as what it is said to be.
pub(super) fn judged(
    [input, reading]: [Vec<f64>; 2],
    is_driven: bool,
    per_cycle: usize,
    output_is: Output,
) -> Result<Verdict, Failed> {
    let rate_hz = per_cycle as f64 / TAU;
    let recording = Recording {
        path: "mass.csv".into(),
        rows: reading.len(),
        rate_hz,
        columns: vec![Column { name: "u".into(), values: input }, Column { name: "y".into(), values: reading }],
        ..Recording::default()
    };
    let model = model(is_driven.then(|| "u".to_owned()), rate_hz, output_is);
    let answer = driven::diagnose(&recording, &model, &Control::silent()).map_err(|e| e.to_string())?;
    Ok(worded(answer).verdict)
}

fn model(input: Option<String>, rate_hz: f64, output_is: Output) -> Driven {
    Driven {
        topic: None,
        unit: None,
        output_is,
        rate_hz: Some(rate_hz),
        force_rate: false,
        rows: Vec::new(),
        columns: DrivenColumns { time: None, input, output: "y".into(), environment: Vec::new() },
        start: Start::default(),
        split: Split::default(),
        without: Vec::new(),
    }
}

pub(super) fn ids(verdict: &Verdict) -> Vec<&str> {
    verdict.effects.iter().map(|e| e.id.as_str()).collect()
}

/// Ids, numbers and forces of a mass that moves by about 1.
type Planted = (&'static [&'static str], &'static [f64], fn(f64, f64, f64) -> f64);

fn planted() -> [Planted; 4] {
    [
        (&["cubic-stiffness"], &[0.1], |x, _, _| -0.1 * x * x * x),
        (&["quadratic-damping"], &[0.03], |_, v, _| -0.03 * v * v.abs()),
        (&["coulomb-friction"], &[0.01], |_, v, _| -0.01 * (v / 1e-4).clamp(-1.0, 1.0)),
        (&["cubic-stiffness", "quadratic-damping"], &[0.1, 0.03], |x, v, _| -0.1 * x * x * x - 0.03 * v * v.abs()),
    ]
}

/// Each planted law in a mass that is read both ways.
fn held(made: impl Fn(&'static [f64], fn(f64, f64, f64) -> f64) -> Made<'static>) -> Result<(), Failed> {
    for (expected, numbers, force) in planted() {
        for output in [Output::Velocity, Output::Acceleration] {
            let verdict = made(numbers, force).diagnosed(output, output)?;
            let known = ids(&verdict);
            let all = expected.iter().all(|id| known.contains(id)) && known.len() == expected.len();
            check(all, format!("{expected:?} read as {output:?}: {known:?} {}", verdict.sentence))?;
            for (id, number) in expected.iter().zip(numbers) {
                let effect = verdict.effects.iter().find(|e| e.id == *id).ok_or("it is named")?;
                near(id, effect.parameters[0].value, *number, 0.01 * number)?;
            }
        }
    }
    Ok(())
}

fn decays() -> Result<(), Failed> {
    held(|_, force| {
        let force: &'static dyn Fn(f64, f64, f64) -> f64 = Box::leak(Box::new(force));
        Made { zeta: 0.004, begin: 1.0, gain: 0.0, cycles: 60, noise: 1e-3, force }
    })?;
    // Negative control: −x″ = x + 0.1 x³, so an acceleration that is taken for a displacement shows a
    // nonlinear readout that is not there.
    let cubic = |x: f64, _: f64, _: f64| -0.1 * x * x * x;
    let made = Made { zeta: 0.004, begin: 1.0, gain: 0.0, cycles: 60, noise: 1e-3, force: &cubic };
    let taken_wrongly = made.diagnosed(Output::Acceleration, Output::Displacement)?;
    check(ids(&taken_wrongly) == ["cubic-stiffness", "readout-nonlinearity"], taken_wrongly.sentence)
}

fn driven_masses() -> Result<(), Failed> {
    held(|_, force| {
        let force: &'static dyn Fn(f64, f64, f64) -> f64 = Box::leak(Box::new(force));
        Made { zeta: 0.02, begin: 0.0, gain: 0.25, cycles: 130, noise: 1e-3, force }
    })
}

// Rails in the reading's own sign and unit, which is not that of displacement.
fn clipped() -> Result<(), Failed> {
    let cubic = |x: f64, _: f64, _: f64| -0.1 * x * x * x;
    let made = Made { zeta: 0.02, begin: 0.0, gain: 0.25, cycles: 130, noise: 1e-3, force: &cubic };
    let [input, reading] = made.rows(Output::Acceleration);
    let reading = reading.iter().map(|y| y.clamp(-0.8, 1.1)).collect();
    let verdict = made.judged([input, reading], Output::Acceleration)?;
    let mut known = ids(&verdict);
    known.sort_unstable();
    check(known == ["cubic-stiffness", "readout-saturation"], format!("{known:?} {}", verdict.sentence))?;
    let rails = verdict.effects.iter().find(|e| e.id == "readout-saturation").ok_or("it is named")?;
    near("low", rails.parameters[0].value, -0.8, 0.01)?;
    near("high", rails.parameters[1].value, 1.1, 0.01)
}

// Two rows late: τ = 2 · 2π/30, to half a per cent, a tenth of a degree of phase at ω₀. Its control is an input
// that goes in steps: taken for a smooth one, it looks late by half a row.
fn late() -> Result<(), Failed> {
    let made = Made { zeta: 0.02, begin: 0.0, gain: 0.25, cycles: 130, noise: 1e-3, force: &|_, _, _| 0.0 };
    for output in [Output::Velocity, Output::Acceleration] {
        let [input, reading] = made.rows(output);
        let rows = reading.len() - 2;
        let verdict = made.judged([input[2..].to_vec(), reading[..rows].to_vec()], output)?;
        check(ids(&verdict) == ["readout-delay"], format!("{output:?}: {:?} {}", ids(&verdict), verdict.sentence))?;
        near("tau", verdict.effects[0].parameters[0].value, 2.0 * TAU / PER_CYCLE as f64, 0.002)?;
    }
    let held = held_velocity(0.25, 130);
    let verdict = made.judged(held, Output::Velocity)?;
    check(ids(&verdict).is_empty() && verdict.verdict == Outcome::Adequate, verdict.sentence)?;
    check(verdict.findings.iter().any(|f| f.contains("steps (held)")), format!("{:?}", verdict.findings))
}

/// Input and velocity of a mass whose input is held from row to row, by the exact solution.
fn held_velocity(gain: f64, cycles: usize) -> [Vec<f64>; 2] {
    let (zeta, h) = (0.02_f64, TAU / PER_CYCLE as f64);
    let damped = (1.0 - zeta * zeta).sqrt();
    let (decay, (sin, cos)) = ((-zeta * h).exp(), (damped * h).sin_cos());
    let mut rng = Philox::new(8, 0, Stream::Host);
    let (mut x, mut v, mut u) = (0.0, 0.0, 0.0);
    let (mut inputs, mut readings) = (Vec::new(), Vec::new());
    for _ in 0..cycles * PER_CYCLE {
        u = 0.8 * u + rng.normal();
        inputs.push(u);
        readings.push(v + 1e-3 * rng.normal());
        // About the place of rest under this input.
        let y = x - gain * u;
        x = gain * u + decay * (y * cos + (v + zeta * y) / damped * sin);
        v = decay * (v * cos - (y + zeta * v) / damped * sin);
    }
    [inputs, readings]
}

// An autoregression with 0.5 from row to row: differences of neighbours show half of its variance (1 − ρ).
fn remembering_noise() -> Result<(), Failed> {
    for output in [Output::Velocity, Output::Acceleration] {
        let made = Made { zeta: 0.02, begin: 0.0, gain: 0.25, cycles: 130, noise: 0.0, force: &|_, _, _| 0.0 };
        let [input, mut reading] = made.rows(output);
        let mut rng = Philox::new(9, 0, Stream::Host);
        let mut noise = 0.0;
        for y in &mut reading {
            noise = 0.5 * noise + 0.01 * rng.normal();
            *y += noise;
        }
        let verdict = made.judged([input, reading], output)?;
        let case = format!("{output:?}: {:?} {}", ids(&verdict), verdict.sentence);
        check(ids(&verdict).is_empty() && verdict.verdict == Outcome::Adequate, case)?;
    }
    Ok(())
}

/// Rows on each side of the straight line whose slope is the rate: at 2.46 rad/s it is 0.6 % too small (a sine over
/// ±0.1 s, (ωT)²/10).
const REACH: usize = 10;

// k₃ of the angle by an independent fit: 5.38 1/(s² rad²). A rate that is 0.6 % too small makes it 1.2 % too large.
fn roll_rate(folder: &std::path::Path) -> Result<(), Failed> {
    let request = Request { columns: vec!["roll_rad".into()], rate_hz: Some(100.0), ..Request::default() };
    let recording = read(&folder.join("roll_decay/run_21337.csv"), &request).map_err(|e| e.to_string())?;
    let angle = recording.column("roll_rad").ok_or("no roll")?;
    let offsets = || (0..=2 * REACH).map(|i| i as f64 - REACH as f64);
    let squares: f64 = offsets().map(|j| j * j).sum();
    let slope = |part: &[f64]| 100.0 * offsets().zip(part).map(|(j, y)| j * y).sum::<f64>() / squares;
    let rate: Vec<f64> = angle.windows(2 * REACH + 1).map(slope).collect();
    let columns = vec![Column { name: "y".into(), values: rate }];
    let rate =
        Recording { path: "rate.csv".into(), rows: columns[0].values.len(), rate_hz: 100.0, columns, ..recording };
    let asked = model(None, 100.0, Output::Velocity);
    let answer = driven::diagnose(&rate, &asked, &Control::silent()).map_err(|e| e.to_string())?;
    let verdict = worded(answer).verdict;
    let spring = verdict.effects.iter().find(|e| e.id == "cubic-stiffness").ok_or("the spring is named")?;
    let p = &spring.parameters[0];
    near("k3", p.value, 5.38, 0.5 * (p.ci95[1] - p.ci95[0]) + 0.02 * 5.38)
}

// A null of each; a spring that is pumped at half its resonance; a drag that gives way with displacement.
fn silent() -> Result<(), Failed> {
    type Force = fn(f64, f64, f64) -> f64;
    let foreign: [(&str, Force); 3] = [
        ("nothing", |_, _, _| 0.0),
        ("parametric excitation", |x, _, t| 0.1 * x * (0.5 * t).cos()),
        ("fractional drag", |x, v, _| -0.05 * v / (1.0 + 9.0 * x * x)),
    ];
    for (what, force) in foreign {
        for output in [Output::Velocity, Output::Acceleration] {
            for gain in [0.0, 0.25] {
                let (zeta, begin) = if gain == 0.0 { (0.004, 1.0) } else { (0.02, 0.0) };
                let made = Made { zeta, begin, gain, cycles: 100, noise: 1e-3, force: &force };
                let verdict = made.diagnosed(output, output)?;
                let case = format!("{what}, {output:?}, gain {gain}: {:?} {}", ids(&verdict), verdict.sentence);
                check(verdict.effects.is_empty(), case.clone())?;
                check((verdict.verdict == Outcome::Adequate) == (what == "nothing"), case)?;
            }
        }
    }
    Ok(())
}

fn refused() -> Result<(), Failed> {
    let made = Made { zeta: 0.02, begin: 0.0, gain: 0.25, cycles: 40, noise: 1e-3, force: &|_, _, _| 0.0 };
    let [input, reading] = made.rows(Output::Velocity);
    let rows = reading.len();
    let columns = vec![Column { name: "u".into(), values: input }, Column { name: "y".into(), values: reading }];
    let rate_hz = PER_CYCLE as f64 / TAU;
    let recording = Recording { path: "mass.csv".into(), rows, rate_hz, columns, ..Recording::default() };
    let asked = Driven {
        split: Split { train: vec![[0, 900]], test: vec![[900, rows]] },
        ..model(Some("u".into()), rate_hz, Output::Velocity)
    };
    let said = driven::diagnose(&recording, &asked, &Control::silent()).err().map(|e| e.to_string());
    check(said.as_ref().is_some_and(|s| s.contains("output_is")), format!("{said:?}"))
}
