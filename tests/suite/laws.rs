//! Each law of the physics room is the same law wherever it is computed: in single and double
//! precision, on the GPU, in the diagnosis' simulation, and as the trial wrote its equation down
//! independently.

use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::Backend;
use proofmass::backend::cpu::{Cpu, Precision};
use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::diagnosis::driven::identification::fit::fit;
use proofmass::diagnosis::driven::identification::start::first_scales;
use proofmass::diagnosis::driven::intake::data::Data;
use proofmass::diagnosis::driven::intake::input::{Input, Interpolation};
use proofmass::diagnosis::driven::intake::observed::Observed;
use proofmass::diagnosis::driven::simulation::filter::Nothing;
use proofmass::diagnosis::driven::simulation::run::{Run, innovations};
use proofmass::diagnosis::driven::simulation::structure::ModelStructure;
use proofmass::ensemble::{Options, run_on};
use proofmass::kernel::integrator::Integrator;
use proofmass::kernel::job::Job;
use proofmass::motion::temperature::Temperature;
use proofmass::numerics::elementary::Real;
use proofmass::physics::coefficients::laws;
use proofmass::physics::coulomb_friction::{CoulombFriction, Sides};
use proofmass::physics::dimension::Units;
use proofmass::physics::library::Term;
use proofmass::physics::state::{Base, Instants, MOST_VALUES};
use proofmass::sensor::{ProofMass, Sensor};
use proofmass::statistics::quantity::ACCELERATION;
use proofmass::trial::equation::Oscillator;
use proofmass::trial::physics::{Physics, Scales, Term as Planted};
use proofmass::trial::proof_mass::{Clock, integrate};
use proofmass::validation::jobs::{Sine, job};

use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("laws: each moves the mass as the trial's own equation does, and its neighbour does not", as_the_trial),
        test("laws: single precision is double precision to its rounding", single_is_double),
        test("laws: a coupled mode, which is not searched for, is fitted by name", coupled_mode_by_name),
        test("laws: a study moves a mass as the diagnosis' simulation does, for each law that it can run", as_a_study),
        gpu_test("laws: the GPU moves a mass as the CPU does, for each law that a study can run", as_the_gpu),
    ]
}

const OMEGA: f64 = 6.0;
const ZETA: f64 = 0.1;
const GAIN: f64 = 30.0;
const RATE_HZ: f64 = 50.0;
const SAMPLES: usize = 500;
/// The trial's steps per sample.
const FINE: usize = 40;

/// Sizes of the motion below; those that matter scale the trial's amplitudes.
fn scales() -> Scales {
    let duration_s = SAMPLES as f64 / RATE_HZ;
    Scales {
        x: 1.0,
        peak: 1.5,
        v: 6.0,
        u: 1.0,
        duration_s,
        omega_rad_s: OMEGA,
        damping_rad_s: 2.0 * ZETA * OMEGA,
        gain: GAIN,
    }
}

/// The input, at any time: two tones below and above the resonance.
fn input(t: f64) -> f64 {
    0.7 * (4.0 * t).sin() + 0.5 * (7.3 * t + 1.0).sin()
}

/// Laws of the equation of motion, with shapes that the trial plants them with.
fn planted() -> Vec<Planted> {
    let term = |physics, amplitude, shape| Planted { physics, amplitude, shape };
    vec![
        term(Physics::CubicStiffness, 0.3, [1.0, 0.0]),
        term(Physics::QuadraticStiffness, 0.2, [1.0, 0.0]),
        term(Physics::QuadraticDamping, 0.5, [0.0, 0.0]),
        term(Physics::SqueezeFilmDamping, 0.5, [0.0, 0.0]),
        term(Physics::CoulombFriction, 0.5, [0.0, 0.0]),
        term(Physics::CoulombFriction, 0.5, [-0.5, 0.0]),
        term(Physics::Hysteresis, 0.2, [0.5, 0.7]),
        // β = 0.9 and γ = −1.2 over the rms displacement.
        term(Physics::Hysteresis, 0.2, [-10.0 / 3.0, -3.0]),
        term(Physics::StiffnessDrift, 0.2, [1.0, 0.0]),
        term(Physics::ParasiticMode, 0.2, [2.5, 0.05]),
        term(Physics::CoupledMode, 0.2, [1.3, 0.05]),
        term(Physics::DriveNonlinearity, 0.3, [1.0, 0.0]),
        term(Physics::EndStop, 0.5, [3.0, 0.0]),
    ]
}

/// The law of the library that the trial calls so, in the form planted.
fn counterpart(planted: &Planted) -> Result<Term, Failed> {
    let id = planted.physics.id();
    if planted.physics == Physics::CoulombFriction && planted.shape[0] != 0.0 {
        return Ok(Term::CoulombFriction(CoulombFriction(Sides::Apart)));
    }
    Term::all().into_iter().find(|t| t.id() == id).ok_or_else(|| format!("the library has no {id}").into())
}

/// Values of the library's parameters, by the names that both use; unknown beginnings are at rest.
fn values(term: &Term, planted: &Planted) -> Result<Vec<f64>, Failed> {
    let known = planted.parameters(&scales());
    let mut values = Vec::new();
    for parameter in term.candidate().parameters {
        let value = known.iter().find(|(name, _)| *name == parameter.name);
        values.push(value.ok_or_else(|| format!("the trial has no {} of {}", parameter.name, term.id()))?.1);
    }
    values.resize(term.values(), 0.0);
    Ok(values)
}

/// A recording that is fitted from end to end, but for what the interpolation of its input does not
/// know.
fn data(reading: Vec<f64>, input: Vec<f64>) -> Data {
    let inner = 20..SAMPLES - 20;
    Data {
        reading,
        input: Some(Input::new(input, Interpolation::BandLimited)),
        environment: Vec::new(),
        environments: 0,
        followed: Vec::new(),
        observed: Observed::default(),
        rate_hz: RATE_HZ,
        hull: 0..SAMPLES,
        breaks: Vec::new(),
        train: vec![inner],
        validation: Vec::new(),
        test: Vec::new(),
        own_test: false,
        windows: None,
        clock_s: Vec::new(),
        work: Default::default(),
        trace: Default::default(),
    }
}

/// Readings of the diagnosis' simulation from rest.
fn simulated(term: Option<(Term, &[f64])>, steps: usize) -> Vec<f64> {
    let data = data(vec![0.0; SAMPLES], (0..SAMPLES).map(|k| input(k as f64 / RATE_HZ)).collect());
    let mut point = vec![GAIN, OMEGA, ZETA, 0.0, 0.0, 0.0];
    point.extend(term.iter().flat_map(|(_, p)| p.iter()));
    let terms: Vec<Term> = term.iter().map(|(t, _)| *t).collect();
    let run = Run { range: 0..SAMPLES, steps, corrected: false };
    innovations(&data, &ModelStructure::new(&terms), &[point], &run, &mut Nothing).iter().map(|e| -e[0]).collect()
}

/// Readings of the trial from rest.
fn integrated(planted: Option<Planted>) -> Vec<f64> {
    let step_s = 1.0 / (RATE_HZ * FINE as f64);
    let grid: Vec<f64> = (0..=2 * FINE * (SAMPLES - 1)).map(|k| input(0.5 * k as f64 * step_s)).collect();
    let clock = Clock { input: &grid, step_s, start_s: 0.0, environment: &[] };
    let oscillator = Oscillator { omega_rad_s: OMEGA, zeta: ZETA, gain: GAIN, start: [0.0; 2] };
    let terms: Vec<Planted> = planted.into_iter().collect();
    integrate(oscillator, &terms, scales(), &clock, 1).signal.into_iter().step_by(FINE).collect()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    // The ends are left out: there the interpolation of a sampled input knows one side only.
    let inner = 60..SAMPLES - 60;
    let square = |v: f64| v * v;
    let apart: f64 = inner.clone().map(|k| square(a[k] - b[k])).sum();
    (apart / inner.map(|k| square(b[k])).sum::<f64>()).sqrt()
}

fn as_the_trial() -> Result<(), Failed> {
    let plain = integrated(None);
    near("no law", distance(&simulated(None, 8), &plain), 0.0, TOLERANCE)?;
    let all = planted();
    for (i, here) in all.iter().enumerate() {
        let term = counterpart(here)?;
        let own = values(&term, here)?;
        let got = simulated(Some((term, &own)), 16);
        let expected = integrated(Some(*here));
        near(term.id(), distance(&got, &expected), 0.0, TOLERANCE)?;
        // Controls: the law moves the mass, and its neighbour moves it otherwise.
        let neighbour = integrated(Some(all[(i + 1) % all.len()]));
        for other in [&plain, &neighbour] {
            let apart = distance(&got, other);
            check(apart > 5.0 * TOLERANCE, format!("{}: {apart} from another law", term.id()))?;
        }
    }
    Ok(())
}

/// The input of the simulation is interpolated from its samples, which costs up to a thousandth of
/// the reading.
const TOLERANCE: f64 = 2e-3;

/// Two masses integrated here, with noise of a thousandth, and the law fitted to them from
/// elsewhere.
fn coupled_mode_by_name() -> Result<(), Failed> {
    let (mu, omega2, zeta2) = (0.08, 1.5 * OMEGA, 0.03);
    let push =
        |t: f64| (0..14).map(|i| (f64::from(i).mul_add(0.9, 2.1) * t + f64::from(i * i)).sin()).sum::<f64>() * 0.3;
    let h = 1.0 / (RATE_HZ * FINE as f64);
    let slope = |t: f64, [x, v, z, w]: [f64; 4]| {
        let pull = omega2 * omega2 * (z - x) + 2.0 * zeta2 * omega2 * (w - v);
        [v, GAIN * push(t) - OMEGA * OMEGA * x - 2.0 * ZETA * OMEGA * v + mu * pull, w, -pull]
    };
    let add = |s: [f64; 4], k: [f64; 4], by: f64| std::array::from_fn(|i| s[i] + by * k[i]);
    let (mut s, mut reading) = ([0.0; 4], Vec::new());
    for n in 0..SAMPLES * FINE {
        let t = n as f64 * h;
        if n % FINE == 0 {
            let noise = f64::from((n as u32).wrapping_mul(2_654_435_769) >> 8) / f64::from(1u32 << 24) - 0.5;
            reading.push(s[0] + 2e-3 * noise);
        }
        let k1 = slope(t, s);
        let k2 = slope(t + 0.5 * h, add(s, k1, 0.5 * h));
        let k3 = slope(t + 0.5 * h, add(s, k2, 0.5 * h));
        let k4 = slope(t + h, add(s, k3, h));
        s = std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    let pushed = (0..SAMPLES).map(|k| push(k as f64 / RATE_HZ)).collect();
    let data = data(reading, pushed);
    let scales = first_scales(&data);
    let begin = [GAIN, 1.02 * OMEGA, ZETA, 0.0, 0.0, 0.0];
    let base = fit(&data, &ModelStructure::new(&[]), &begin, &scales, 25).ok_or("no base model")?;
    let start: Vec<f64> = begin.into_iter().chain([0.03, 1.35 * OMEGA, 0.05, 0.0, 0.0]).collect();
    let named = Term::all().into_iter().find(|t| t.id() == "coupled-mode").ok_or("it is not listed")?;
    let found = fit(&data, &ModelStructure::new(&[named]), &start, &scales, 60).ok_or("no fit")?;
    let own = &found.point[6..];
    near("mass ratio", own[0] / mu, 1.0, 0.02)?;
    near("its frequency", own[1] / omega2, 1.0, 0.005)?;
    near("its damping", own[2] / zeta2, 1.0, 0.1)?;
    check(base.variance > 100.0 * found.variance, format!("{} and {}", base.variance, found.variance))
}

/// The acceleration that a law adds to none, and the rate of its first state.
fn pulled<T: Real>(term: &Term, p: &[f64], [x, v, u, z]: [f64; 4]) -> [f64; 2] {
    let of = T::of;
    let base = Base { gain: [of(GAIN)], stiffness: [of(OMEGA * OMEGA)], damping: [of(0.0)] };
    let at = Instants {
        time: of(2.0),
        step: of(0.01),
        input: [of(u)],
        x: [of(x)],
        v: [of(v)],
        base: &base,
        environment: &[],
    };
    let mut values = [[of(0.0)]; MOST_VALUES];
    values.iter_mut().zip(p).for_each(|(value, p)| *value = [of(*p)]);
    let (mut rates, mut sum) = ([[of(0.0)]; 3], [of(0.0)]);
    term.force::<T, 1, false>(&at, &values, &[[of(z)], [of(0.5 * z)], [of(0.0)]], &mut rates, &mut sum);
    [sum[0].f64(), rates[0][0].f64()]
}

fn single_is_double() -> Result<(), Failed> {
    for here in planted() {
        let term = counterpart(&here)?;
        let p = values(&term, &here)?;
        let mut moved = 0.0f64;
        for k in 0..50 {
            let tone = |f: f64| (f * f64::from(k) + 0.3).sin();
            let state = [1.3 * tone(0.7), 5.0 * tone(1.1), tone(1.9), 0.4 * tone(2.3)];
            let [double, single] = [pulled::<f64>(&term, &p, state), pulled::<f32>(&term, &p, state)];
            for (d, s) in double.iter().zip(single) {
                // A few roundings of 6e-8 of terms of order 100.
                near(term.id(), s, *d, 1e-6 * (1.0 + d.abs()) * 10.0)?;
            }
            moved = moved.max(double[0].abs());
        }
        let acts = term.role().acts_on_mass();
        check((moved > 1e-3) == acts, format!("{} adds {moved} to the acceleration", term.id()))?;
    }
    Ok(())
}

/// A proof mass of 2 Hz that follows one law as strongly as a fifth of its own spring or damper at
/// 1 m/s².
fn mass(number: usize) -> ProofMass {
    let omega = 12.0;
    let plain = ProofMass { natural_frequency_rad_s: omega, damping_ratio: 0.1, ..ProofMass::default() };
    let Some(law) = laws().get(number) else { return plain };
    // A fifth in units in which ω₀² m and 1/ω₀ s are one.
    let units = Units { y: 1.0 / (omega * omega), u: 1.0, s: 1.0 / omega };
    law.given()
        .iter()
        .enumerate()
        .fold(plain, |mass, (parameter, given)| mass.with(&given.key, 0.2 * law.factor(parameter, &units)))
}

/// One noiseless member of a study.
fn study(mass: ProofMass) -> Job {
    let force = Sine { amplitude_m_s2: 0.5, frequency_hz: 1.3, offset_m_s2: 0.1 };
    let sensor = Sensor { proof_mass: Some(mass), ..Sensor::default() };
    let integrator = Integrator::choose(Some(&mass), 1e-3).integrator;
    let general = Integrator::RungeKutta4General { substeps: integrator.substeps() };
    let mut job = job(sensor, 64, &[0.5, 2.0], force, general);
    job.waveform = Arc::new(force);
    // One kelvin above the reference: what follows the temperature is as strong as the others.
    job.temperature = Arc::new(Temperature::new(vec![[0.0, 21.0]], 20.0));
    job
}

/// Error of the reading at the report times.
fn read(job: &Job, backend: &mut dyn Backend) -> Result<Vec<f64>, Failed> {
    let options = Options::default();
    Ok(run_on(job, backend, &options)?.at.iter().map(|at| at[ACCELERATION].mean).collect())
}

fn as_a_study() -> Result<(), Failed> {
    let plain = read(&study(mass(usize::MAX)), &mut Cpu { precision: Precision::F64, ..Cpu::default() })?;
    for (number, law) in laws().iter().enumerate() {
        let job = study(mass(number));
        let double = read(&job, &mut Cpu { precision: Precision::F64, ..Cpu::default() })?;
        let single = read(&job, &mut Cpu::default())?;
        for ((d, s), without) in double.iter().zip(&single).zip(&plain) {
            near(law.term.id(), *s, *d, 2e-4 * (1.0 + d.abs()))?;
            check((d - without).abs() > 1e-3, format!("{} moves nothing: {d} and {without}", law.term.id()))?;
        }
        // The same equation, integrated in displacement by the law itself.
        let expected = in_displacement(number);
        near(law.term.id(), double[double.len() - 1], expected, 2e-3 * (1.0 + expected.abs()))?;
    }
    Ok(())
}

/// Error of the reading after 2 s, integrated in metres and seconds.
fn in_displacement(number: usize) -> f64 {
    let (mass, law) = (mass(number), laws()[number]);
    let (omega, h) = (mass.natural_frequency_rad_s, 1e-4);
    let force = |t: f64| 0.5 * (std::f64::consts::TAU * 1.3 * t).sin() + 0.1;
    let p = mass.laws.values(&law, &Units { y: 1.0, u: 1.0, s: 1.0 }).map(|v| [v]);
    let base = Base { gain: [1.0], stiffness: [omega * omega], damping: [2.0 * mass.damping_ratio * omega] };
    let slope = |t: f64, [x, v, z, w]: [f64; 4]| {
        let mut sum = [force(t) - base.stiffness[0] * x - base.damping[0] * v];
        let at = Instants { time: t, step: 1e-3, input: [force(t)], x: [x], v: [v], base: &base, environment: &[1.0] };
        let mut rates = [[0.0]; 3];
        law.term.force::<f64, 1, false>(&at, &p, &[[z], [w], [0.0]], &mut rates, &mut sum);
        [v, sum[0], rates[0][0], rates[1][0]]
    };
    let add = |s: [f64; 4], k: [f64; 4], by: f64| std::array::from_fn(|i| s[i] + by * k[i]);
    // A study begins with the reading right: x = f/ω₀², at rest, and so are a law's own states.
    let static_m = force(0.0) / (omega * omega);
    let own = match law.term.id() {
        "coupled-mode" => static_m,
        "parasitic-mode" => p[0][0] * force(0.0) / p[1][0].powi(2),
        _ => 0.0,
    };
    let end = (0..20_000).fold([static_m, 0.0, own, 0.0], |s, n| {
        let t = f64::from(n) * h;
        let k1 = slope(t, s);
        let k2 = slope(t + 0.5 * h, add(s, k1, 0.5 * h));
        let k3 = slope(t + 0.5 * h, add(s, k2, 0.5 * h));
        let k4 = slope(t + h, add(s, k3, h));
        std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    });
    let read_beside = if law.term.id() == "parasitic-mode" { end[2] } else { 0.0 };
    omega * omega * (end[0] + read_beside) - force(2.0)
}

fn as_the_gpu() -> Result<(), Failed> {
    let mut gpu = Ensembles::on(Arc::new(Gpu::open()?));
    for (number, law) in laws().iter().enumerate() {
        let job = study(mass(number));
        let (here, there) = (read(&job, &mut Cpu::default())?, read(&job, &mut gpu)?);
        let other = read(&study(mass((number + 1) % laws().len())), &mut gpu)?;
        for (a, b) in here.iter().zip(&there) {
            near(law.term.id(), *b, *a, 2e-4 * (1.0 + a.abs()))?;
        }
        // Control: early on, all of them have moved the mass little; at some report time the
        // neighbour's stands elsewhere.
        let apart = here.iter().zip(&other).map(|(a, neighbour)| (neighbour - a).abs()).fold(0.0, f64::max);
        check(apart > 1e-3, format!("{}: the neighbouring law differs by no more than {apart}", law.term.id()))?;
    }
    Ok(())
}
