//! CPU and GPU agree, and both follow the closed forms.

use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu::Cpu;
use proofmass::backend::gpu::Gpu;
use proofmass::control::Control;
use proofmass::ensemble::{Options, run_on};
use proofmass::kernel::cpu::lanes::Level;
use proofmass::kernel::integrator::Integrator;
use proofmass::kernel::job::Job;
use proofmass::motion::temperature::Temperature;
use proofmass::sensor::{Sensor, SensorTerm};
use proofmass::validation::jobs::{Place, Sine, job, masses};
use proofmass::validation::{closed_form, parity};

use super::law::all_hold;
use super::world::{check, gpu_test, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("sensor terms: each alone makes an error on the CPU, and none makes none", || {
            acts(&mut Place::cpu(&Control::silent()))
        }),
        gpu_test("sensor terms: each alone makes an error on a GPU, and none makes none", || {
            acts(&mut Place::gpu(&Control::silent())?)
        }),
        gpu_test("parity: percentiles of every integrator, CPU and GPU", || {
            all_hold(&parity::rows(&mut Place::gpu(&Control::silent())?, &Control::silent())?)
        }),
        gpu_test("parity: every error source grows by its closed form on the GPU", || {
            all_hold(&closed_form::rows(&mut Place::gpu(&Control::silent())?)?)
        }),
        test("parity: every instruction set gives the same percentiles, the baseline included", levels),
        gpu_test("parity: compensated sums are alive on this adapter", || {
            let got = Gpu::open()?.compensation()?;
            check(got[0] == 0.0, format!("a plain sum kept what f32 must lose: {got:?}"))?;
            check(got[1] == 1.0, format!("the compensated sum lost it: {got:?}"))
        }),
        gpu_test("parity: threads that ask for a GPU at a time all get it", || {
            let ask = || -> Result<[f32; 2], Failed> { Ok(Gpu::open()?.compensation()?) };
            std::thread::scope(|scope| {
                let asked: Vec<_> = (0..16).map(|_| scope.spawn(ask)).collect();
                let mut answers = asked.into_iter().map(|one| one.join().unwrap_or_else(|_| Err("a panic".into())));
                answers.try_for_each(|got| check(got? == [0.0, 1.0], "another sum"))
            })
        }),
    ]
}

/// A row of the table that no kernel takes up would be read, drawn and silently left out.
fn acts(place: &mut Place) -> Result<(), Failed> {
    let force = Sine { amplitude_m_s2: 20.0, frequency_hz: 3.0, offset_m_s2: 1.0 };
    let mut largest = |sensor: Sensor| -> Result<f64, Failed> {
        let temperature = Arc::new(Temperature::new(vec![[0.0, 21.0]], 20.0));
        let job = Job { temperature, ..job(sensor, 256, &[0.5], force, Integrator::Ideal) };
        let statistics = place.run(&job)?;
        Ok(statistics.at.iter().flatten().map(|s| s.mean.abs().max(s.sd)).fold(0.0, f64::max))
    };
    // Shapes are no errors by themselves.
    let shapes = SensorTerm::ALL.into_iter().filter(|term| term.is_shape());
    let shaped = shapes.fold(Sensor::default(), |sensor, shape| sensor.with_error(shape, 0.3));
    for term in SensorTerm::ALL.into_iter().filter(|term| !term.is_shape()) {
        let error = largest(shaped.with_error(term, 0.3))?;
        check(error > 1e-4, format!("{term:?} of 0.3 makes an error of {error}"))?;
    }
    let error = largest(shaped)?;
    check(error == 0.0, format!("no term at all makes an error of {error}"))
}

/// Without fused multiply-add the last bits differ, percentiles do not: every integrator, every
/// error on.
fn levels() -> Result<(), Failed> {
    let force = Sine { amplitude_m_s2: 5.0, frequency_hz: 3.0, offset_m_s2: 0.0 };
    let options = Options::default();
    let run = |level: Level, job: &Job| run_on(job, &mut Cpu { level, ..Cpu::default() }, &options);
    for (mass, integrator) in masses() {
        let job = job(Sensor { proof_mass: Some(mass), ..parity::everything() }, 1024, &[0.5, 5.0], force, integrator);
        let best = run(Level::best(), &job)?;
        for level in Level::available() {
            let apart = parity::difference(&best, &run(level, &job)?);
            check(apart < 2e-3, format!("{integrator} on {}: percentiles {apart} sd apart", level.name()))?;
        }
        // Control: another seed is another ensemble.
        let other = run(Level::Baseline, &Job { seed: job.seed + 1, ..job.clone() })?;
        check(
            parity::difference(&best, &other) > 2e-3,
            "another seed gave the same percentiles: the comparison is blind",
        )?;
    }
    Ok(())
}
