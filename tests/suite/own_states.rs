//! Laws with states of their own in a study: coupled mode, parasitic mode and hysteresis.
//!
//! Expected: linear modes by the exponential of their matrix, the force among its states; the
//! spring with memory in `powers`.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use nalgebra::{SMatrix, SVector};
use proofmass::backend::cpu::{self, Cpu, Precision};
use proofmass::backend::flight::Quantity;
use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::backend::{Backend, Batch, Ran};
use proofmass::control::Control;
use proofmass::ensemble::{Choice, Options, run_on};
use proofmass::kernel::integrator::Integrator;
use proofmass::kernel::job::{Job, Waveform};
use proofmass::physics::coefficients::{Coefficients, laws};
use proofmass::sensor::{ProofMass, Sensor};
use proofmass::statistics::quantity::{ACCELERATION, POSITION};
use proofmass::strapdown::backends::run_on as fly;
use proofmass::study;
use proofmass::validation::jobs::{Sine, job};
use proofmass::validation::parity::{difference, everything};

use super::strapdown::{answered, parsed, percentiles_apart};
use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("own states: linear modes move as the exponential of their matrix, of order 4", modes),
        test(
            "own states: under a steady force a low-pass shows a parasitic mode from the beginning on",
            behind_a_low_pass,
        ),
        test("own states: tiles and a stop between them do not change a bit", interrupted),
        test("own states: keys of a study give them, and refuse one in part", keys),
        test("own states: in motion a stiff parasitic mode is a scale error", in_motion),
        gpu_test("own states: the GPU draws the ensemble of the CPU, in any tiles", on_the_gpu),
        gpu_test("own states: in motion the GPU flies as the CPU does", in_motion_on_the_gpu),
    ]
}

pub(super) const OMEGA: f64 = 12.0;
pub(super) const ZETA: f64 = 0.1;
pub(super) const FORCE: Sine = Sine { amplitude_m_s2: 0.5, frequency_hz: 1.3, offset_m_s2: 0.1 };

/// A proof mass of 2 Hz with these parameters of a law, SI.
pub(super) fn mass<const N: usize>(law: &str, parameters: [f64; N]) -> Result<ProofMass, Failed> {
    let plain = ProofMass { natural_frequency_rad_s: OMEGA, damping_ratio: ZETA, ..ProofMass::default() };
    with(plain, law, &parameters)
}

/// A mass with these parameters of a law as well; further ones are what they are when left out.
pub(super) fn with(mass: ProofMass, law: &str, parameters: &[f64]) -> Result<ProofMass, Failed> {
    let law = laws().iter().find(|l| l.term.id() == law).ok_or("it is not listed")?;
    Ok(law.given().iter().zip(parameters).fold(mass, |mass, (given, value)| mass.with(&given.key, *value)))
}

/// Error of the reading of one noiseless member, m/s², in f64, after `seconds` in steps of `step_s`.
pub(super) fn error(mass: ProofMass, waveform: Arc<dyn Waveform>, step_s: f64, seconds: f64) -> Result<f64, Failed> {
    shown(Sensor { proof_mass: Some(mass), ..Sensor::default() }, waveform, step_s, seconds)
}

/// The same of any sensor.
fn shown(sensor: Sensor, waveform: Arc<dyn Waveform>, step_s: f64, seconds: f64) -> Result<f64, Failed> {
    let mut job: Job = job(sensor, 64, &[1.0], FORCE, Integrator::RungeKutta4General { substeps: 1 });
    let samples = (seconds / step_s).round() as u64;
    (job.clock.step_s, job.clock.steps_per_sample, job.clock.samples) = (step_s, 1, samples);
    (job.clock.report_samples, job.waveform) = (vec![samples], waveform);
    let mut cpu = Cpu { precision: Precision::F64, ..Cpu::default() };
    Ok(run_on(&job, &mut cpu, &Options::default())?.at[0][ACCELERATION].mean)
}

/// Displacement of the mass and of the second mode after `seconds` from rest, from the matrix of
/// their motion, states (x, x′, z, z′).
fn by_exponential(motion: [[f64; 4]; 4], push: [f64; 4], rest: [f64; 4], seconds: f64) -> [f64; 2] {
    let omega = TAU * FORCE.frequency_hz;
    // Behind the motion: the sine, its cosine, and one.
    let mut all = SMatrix::<f64, 7, 7>::zeros();
    for row in 0..4 {
        for column in 0..4 {
            all[(row, column)] = motion[row][column];
        }
        all[(row, 4)] = push[row] * FORCE.amplitude_m_s2;
        all[(row, 6)] = push[row] * FORCE.offset_m_s2;
    }
    (all[(4, 5)], all[(5, 4)]) = (omega, -omega);
    let [x, v, z, w] = rest.map(|r| r * FORCE.offset_m_s2);
    let end = (all * seconds).exp() * SVector::<f64, 7>::from([x, v, z, w, 0.0, 1.0, 1.0]);
    [end[0], end[2]]
}

/// μ, ω₂, ζ₂ of a coupled mode.
fn coupled([mu, omega2, zeta2]: [f64; 3], seconds: f64) -> f64 {
    let (k, c) = (omega2 * omega2, 2.0 * zeta2 * omega2);
    let (own, damping) = (OMEGA * OMEGA, 2.0 * ZETA * OMEGA);
    let motion = [
        [0.0, 1.0, 0.0, 0.0],
        [-own - mu * k, -damping - mu * c, mu * k, mu * c],
        [0.0, 0.0, 0.0, 1.0],
        [k, c, -k, -c],
    ];
    let [x, _] = by_exponential(motion, [0.0, 1.0, 0.0, 0.0], [1.0 / own, 0.0, 1.0 / own, 0.0], seconds);
    own * x
}

/// g₂, ω₂, ζ₂ of a parasitic mode.
fn parasitic([gain, omega2, zeta2]: [f64; 3], seconds: f64) -> f64 {
    let (own, k) = (OMEGA * OMEGA, omega2 * omega2);
    let motion = [
        [0.0, 1.0, 0.0, 0.0],
        [-own, -2.0 * ZETA * OMEGA, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, -k, -2.0 * zeta2 * omega2],
    ];
    let [x, z] = by_exponential(motion, [0.0, 1.0, 0.0, gain], [1.0 / own, 0.0, gain / k, 0.0], seconds);
    own * (x + z)
}

fn modes() -> Result<(), Failed> {
    /// The reading by the exponential, for parameters and a time.
    type Exact = fn([f64; 3], f64) -> f64;
    let cases: [(&str, Exact, [f64; 3]); 2] =
        [("coupled-mode", coupled, [0.3, 20.0, 0.05]), ("parasitic-mode", parasitic, [0.4, 20.0, 0.05])];
    for (law, exact, p) in cases {
        for seconds in [0.4, 2.0] {
            let force = FORCE.specific_force_m_s2(seconds);
            let got = force + error(mass(law, p)?, Arc::new(FORCE), 1e-3, seconds)?;
            near(&format!("{law} after {seconds} s"), got, exact(p, seconds), 1e-6)?;
            // Control: a twentieth more of it is another motion.
            let [strength, omega2, zeta2] = p;
            let other = exact([1.05 * strength, omega2, zeta2], seconds);
            check((got - other).abs() > 1e-4, format!("{law}: a twentieth more moves to {other} too"))?;
        }
        let away = |step_s: f64| -> Result<f64, Failed> {
            let force = FORCE.specific_force_m_s2(0.48);
            Ok((force + error(mass(law, p)?, Arc::new(FORCE), step_s, 0.48)? - exact(p, 0.48)).abs())
        };
        let order = (away(8e-3)? / away(4e-3)?).log2();
        near(&format!("order of {law}"), order, 4.0, 0.2)?;
        check((order - 3.0).abs() > 0.5, "of order 3 too (control)")?;
    }
    Ok(())
}

/// Under a steady force nothing moves: the mode adds its static share g₂ω₀²/ω₂² of it to the reading
/// at every time, also behind a low-pass. Control: one that begins from nothing lacks e^(−t/τ) of it.
fn behind_a_low_pass() -> Result<(), Failed> {
    let [gain, omega2, zeta2] = [0.4, 20.0, 0.9];
    let mass = mass("parasitic-mode", [gain, omega2, zeta2])?;
    let mut sensor = Sensor { proof_mass: Some(mass), ..Sensor::default() };
    sensor.accelerometer.readout_lowpass_s = 0.5;
    let steady = Sine { amplitude_m_s2: 0.0, frequency_hz: 1.0, offset_m_s2: 0.5 };
    let share = gain * (OMEGA / omega2).powi(2) * 0.5;
    for seconds in [0.001, 0.25f64] {
        let got = shown(sensor, Arc::new(steady), 1e-3, seconds)?;
        near("reading error", got, share, 1e-9)?;
        let from_nothing = share * (1.0 - (-seconds / 0.5).exp());
        check((got - from_nothing).abs() > 0.5 * share, "one that begins from nothing shows as much")?;
    }
    Ok(())
}

/// An ensemble with every error, all three laws and two powers, behind a low-pass.
fn all(members: u64) -> Result<Job, Failed> {
    let mut sensor = everything();
    let mut every = mass("coupled-mode", [0.2, 25.0, 0.1])?;
    for (law, parameters) in [
        ("parasitic-mode", &[0.1, 40.0, 0.05][..]),
        ("hysteresis", &[30.0, 5.0, 3.0, 1.4]),
        ("power-law-stiffness", &[20.0, 0.01, 2.3]),
        ("power-law-damping", &[0.5, 0.05, 1.5]),
    ] {
        every = with(every, law, parameters)?;
    }
    (every.force_noise_m_s_rts, sensor.accelerometer.readout_lowpass_s) = (1e-3, 0.01);
    sensor.proof_mass = Some(every);
    let force = Sine { amplitude_m_s2: 2.0, frequency_hz: 1.0, offset_m_s2: 0.5 };
    let integrator = Integrator::choose(Some(&every), 1e-3).integrator;
    Ok(job(sensor, members, &[0.07, 1.0, 2.5], force, integrator))
}

fn interrupted() -> Result<(), Failed> {
    let job = all(300)?;
    let run = |tile_samples: u64, before: Option<&Ran>, stops: bool| {
        let stop = || stops;
        let resume = match before {
            Some(Ran::Part(stopped)) => Some(stopped),
            _ => None,
        };
        let batch = Batch { job: &job, members: 0..300, bins: &[], resume, stop: &stop, progress: &|_| {} };
        Cpu { tile_samples, ..Cpu::default() }.run(&batch)
    };
    let whole = |ran: Ran| match ran {
        Ran::Whole(partials) => Ok(format!("{partials:?}")),
        Ran::Part(_) => Err(Failed::from("it was stopped")),
    };
    let plain = whole(run(512, None, false)?)?;
    for tile_samples in [4, 60] {
        check(whole(run(tile_samples, None, false)?)? == plain, format!("tiles of {tile_samples} change it"))?;
    }
    let mut stopped = run(20, None, true)?;
    check(whole(run(20, Some(&stopped), false)?)? == plain, "a stop changes the result")?;
    // Control: what is kept of the laws counts. In each group of 64 it stands before four totals and
    // whether a member failed, five numbers of each member.
    let lanes = 64 * size_of::<f64>();
    let Ran::Part(kept) = &mut stopped else { return Err("it did not stop".into()) };
    let end = kept.state.len() - 5 * lanes;
    kept.state[end - 5 * lanes..end].fill(0);
    check(whole(run(20, Some(&stopped), false)?)? != plain, "the states of laws are not kept")
}

fn text(sensor: &str) -> String {
    format!(
        "members = 64\nduration_s = 6.0\nstep_s = 0.005\n[sensor]\nresonance_hz = 30.0\ndamping_ratio = 0.7\n{sensor}\n\
         [excitation]\nkind = \"rectangle\"\namplitude_m_s2 = 2.0\nstart_s = 0.0\nlength_s = 50.0\n"
    )
}

const STIFF: &str = "parasitic_mode_gain = 0.01\nparasitic_mode_hz = 60.0\nparasitic_mode_damping_ratio = 0.3\n";

fn keys() -> Result<(), Failed> {
    let run = |sensor: &str| -> Result<Vec<[f64; 4]>, Failed> {
        let study = study::parse("modes", &text(sensor), Path::new(""))?;
        let job = study.job(study.integrator()?.integrator, vec![study.clock.samples]);
        Ok(cpu::outcomes::<f64>(&job, &Control::silent())?)
    };
    // At rest the mode is displaced by g₂ f/ω₂², of f/ω₀² a part g₂(ω₀/ω₂)²: a bias of a quarter of
    // a hundredth of 2 m/s².
    let position = run(STIFF)?[0][POSITION];
    near("position by the mode", position - run("")?[0][POSITION], 0.5 * 0.0025 * 2.0 * 36.0, 1e-6)?;
    let other = run(&STIFF.replace("60.0", "61.0"))?[0][POSITION];
    check((other - position).abs() > 1e-3, "another frequency is the same (control)")?;
    // Drawn, it spreads the members.
    let spread = run(&STIFF.replace("= 0.01", "= { mean = 0.01, sd = 0.003 }"))?;
    check(spread.iter().any(|o| (o[POSITION] - spread[0][POSITION]).abs() > 1e-3), "members are alike")?;
    let said = |sensor: &str| {
        study::parse("modes", &text(sensor), Path::new("")).err().map(|e| e.to_string()).unwrap_or_default()
    };
    for (given, lacking) in [
        ("parasitic_mode_gain = 0.01", "sensor.parasitic_mode_hz"),
        ("coupled_mode_mass_ratio = 0.01\ncoupled_mode_damping_ratio = 0.1", "sensor.coupled_mode_hz"),
        ("hysteresis_per_s2 = 10.0\nhysteresis_gamma_per_m = 1.0", "sensor.hysteresis_beta_per_m"),
        ("hysteresis_gamma_per_m = 1.0", "sensor.hysteresis_per_s2"),
        (&STIFF.replace("60.0", "0.0"), "sensor.parasitic_mode_hz"),
        (&STIFF.replace("0.3", "-0.3"), "sensor.parasitic_mode_damping_ratio"),
    ] {
        let error = said(given);
        check(error.contains(lacking), format!("{given}: {error:?}"))?;
    }
    // A memory of 10 nm is lost within a step: at 2 m/s² and 30 Hz the mass moves by 10 mm/s.
    let forgets = "hysteresis_per_s2 = 100.0\nhysteresis_beta_per_m = 1e8\nhysteresis_gamma_per_m = 0.0\n";
    let integrator = |sensor: &str| study::parse("modes", &text(sensor), Path::new(""))?.integrator();
    let error = integrator(forgets).err().map(|e| e.to_string()).unwrap_or_default();
    check(error.contains("sensor.hysteresis_beta_per_m") && error.contains("memory"), error)?;
    integrator(&forgets.replace("1e8", "1e3"))?;
    // A sine that each member draws is a force as well.
    let drawn = |beta: &str| {
        let sine = "kind = \"sine\"\nfrequency_hz = 1.0\namplitude_m_s2 = { mean = 2.0, sd = 0.1 }\n";
        let all = text(&forgets.replace("1e8", beta));
        let (sensor, _) = all.split_once("kind =").unwrap_or_default();
        study::parse("modes", &(sensor.to_owned() + sine), Path::new(""))?.integrator()
    };
    let error = drawn("1e8").err().map(|e| e.to_string()).unwrap_or_default();
    check(error.contains("sensor.hysteresis_beta_per_m") && error.contains("memory"), error)?;
    drawn("1e3")?;
    // The steps follow the mode: 60 Hz need more of them than 30 Hz, and 6 kHz far more.
    let substeps = |sensor: &str| -> Result<u32, Failed> {
        Ok(study::parse("modes", &text(sensor), Path::new(""))?.integrator()?.integrator.substeps())
    };
    let [near_by, far] = [substeps(STIFF)?, substeps(&STIFF.replace("60.0", "6000.0"))?];
    // √(30² + 60²) Hz · 2π · 5 ms/0.25, and with 6000 Hz.
    check((near_by, far) == (9, 754), format!("{near_by} and {far} substeps"))
}

fn flight(keys: &str) -> String {
    format!(
        "members = 256\nduration_s = 20.0\n[sensor]\nsample_rate_hz = 200.0\nresonance_hz = 30.0\ndamping_ratio = 0.7\n\
         {keys}\n[trajectory]\nkind = \"waypoints\"\npoints_m = [[0.0, 0.0, 0.0], [400.0, 0.0, 0.0]]\n\
         speed_m_s = 10.0\nstill_s = 2.0\n[report]\ntimes_s = [20.0]\n"
    )
}

/// A mode at twice the resonance adds a four-hundredth of its slow input: the errors are those of a
/// scale factor of 2500 ppm.
fn in_motion() -> Result<(), Failed> {
    let north = |keys: &str| -> Result<f64, Failed> {
        let answer = answered(&flight(keys))?;
        Ok(answer.ensemble.summary(*answer.report.last().ok_or("no report")?, Quantity::Position(0)).mean)
    };
    let bare = north("")?;
    let [by_mode, by_scale, other] = [
        north(STIFF)? - bare,
        north("[accelerometer]\nscale_factor_ppm = 2500.0")? - bare,
        north("[accelerometer]\nscale_factor_ppm = 2600.0")? - bare,
    ];
    check(by_scale > 0.1, format!("a scale error moves by {by_scale} m"))?;
    near("north by the mode over that by a scale error", by_mode / by_scale, 1.0, 2e-3)?;
    check((other / by_scale - 1.0).abs() > 0.02, "another scale error is the same (control)")
}

fn on_the_gpu() -> Result<(), Failed> {
    let job = all(2048)?;
    let device = Arc::new(Gpu::open()?);
    let on = |tile_samples: u64| {
        let mut ensembles = Ensembles::on(device.clone());
        ensembles.tile_samples = tile_samples;
        run_on(&job, &mut ensembles, &Options::default())
    };
    let (here, there) = (run_on(&job, &mut Cpu::default(), &Options::default())?, on(4096)?);
    let apart = difference(&here, &there);
    check(apart < 2e-3, format!("CPU and GPU are {apart} sd apart"))?;
    for tile_samples in [20, 3] {
        check(on(tile_samples)?.at == there.at, format!("tiles of {tile_samples} change a bit"))?;
    }
    // Control: without the laws it is another ensemble.
    let mut plain = job.clone();
    plain.draw = Arc::new(move |i| {
        let mut member = (job.draw)(i);
        member.sensor.proof_mass.iter_mut().for_each(|mass| mass.laws = Coefficients::default());
        member
    });
    let without = run_on(&plain, &mut Cpu::default(), &Options::default())?;
    check(difference(&without, &there) > 2e-2, "the laws move nothing")
}

fn in_motion_on_the_gpu() -> Result<(), Failed> {
    let spread = STIFF.replace("= 0.01", "= { mean = 0.01, sd = 0.003 }");
    let text = |sensor: &str| {
        let noise = "[accelerometer]\nvelocity_random_walk_m_s_rth = 0.01\n[gyro]\nangle_random_walk_deg_rth = 0.01\n";
        let coupled = "coupled_mode_mass_ratio = 0.1\ncoupled_mode_hz = 40.0\ncoupled_mode_damping_ratio = 0.1\n";
        flight(&format!("{sensor}{coupled}{noise}")).replace("= 256", "= 1024")
    };
    let on = |choice, text: &str| -> Result<_, Failed> {
        let study = parsed(text)?;
        let flight = study.flight(study.in_motion.as_ref().ok_or("no trajectory")?, vec![20, 1000, 4000])?;
        Ok(fly(choice, &flight, &Control::silent())?)
    };
    let (here, there) = (on(Choice::Cpu, &text(&spread))?, on(Choice::Gpu, &text(&spread))?);
    let other = on(Choice::Cpu, &text(&spread.replace("60.0", "61.0")))?;
    check(there.machine.kind == "gpu", "the GPU's run was not on a GPU")?;
    let apart = percentiles_apart(&here, &there, 3);
    check(apart < 5e-3, format!("percentiles {apart} sd apart"))?;
    check(percentiles_apart(&here, &other, 3) > 5e-3, "another mode gave the same percentiles")
}
