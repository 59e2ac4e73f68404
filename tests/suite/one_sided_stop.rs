//! A stop on one side of the proof mass, in a study: on which side it acts, along one axis, along a
//! trajectory and on the GPU.
//!
//! Pushed steadily against it, the mass rests where both springs balance: x = (f + k_c x_c)/(ω₀² +
//! k_c) (Shaw & Holmes, J. Sound Vib. 90 (1983), of a contact without loss); pushed away from it, at
//! f/ω₀², and reads right.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::Backend;
use proofmass::backend::cpu::{Cpu, Precision};
use proofmass::backend::flight::Quantity;
use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::ensemble::{Options, run_on};
use proofmass::statistics::Statistics;
use proofmass::statistics::quantity::ACCELERATION;
use proofmass::study;
use proofmass::validation::parity;

use super::strapdown::{answered, series};
use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("one-sided stop: a steady push is stopped on its side alone", steady),
        test("one-sided stop: along a trajectory it stops the axis that has it", in_motion),
        test("one-sided stop: one number without the other is refused by name", refused),
        gpu_test("one-sided stop: the GPU gives what the CPU does", on_the_gpu),
    ]
}

const OMEGA2: f64 = (TAU * 12.0) * (TAU * 12.0);
/// Four times the spring.
const CONTACT: f64 = 22_739.0;

fn text(stop: &str, excitation: &str, times_s: &[f64]) -> String {
    format!(
        "members = 256\nduration_s = 3.0\n[sensor]\nsample_rate_hz = 1000.0\nresonance_hz = 12.0\n\
         damping_ratio = 0.4\n{stop}[excitation]\n{excitation}\n[report]\ntimes_s = {times_s:?}\n"
    )
}

fn stop(at_m: &str) -> String {
    format!("one_sided_stop_per_s2 = {CONTACT:?}\none_sided_stop_at_m = {at_m}\n")
}

fn run(text: &str, backend: &mut dyn Backend) -> Result<Statistics, Failed> {
    let study = study::parse("one-sided stop", text, Path::new(""))?;
    let job = study.job(study.integrator()?.integrator, study.clock.report_samples.clone());
    Ok(run_on(&job, backend, &Options::default())?)
}

/// What the reading lacks where the mass is stopped at this place.
fn lacking(force: f64, at_m: f64) -> f64 {
    OMEGA2 * (force + CONTACT * at_m) / (OMEGA2 + CONTACT) - force
}

fn steady() -> Result<(), Failed> {
    let read = |sensor: &str, force: f64| -> Result<f64, Failed> {
        let push = format!("kind = \"rectangle\"\namplitude_m_s2 = {force:?}\nstart_s = 0.0\nlength_s = 100.0");
        let mut cpu = Cpu { precision: Precision::F64, ..Cpu::default() };
        Ok(run(&text(sensor, &push, &[3.0]), &mut cpu)?.at[0][ACCELERATION].mean)
    };
    for (at, force, expected) in
        [(2e-4, 3.0, lacking(3.0, 2e-4)), (2e-4, -3.0, 0.0), (-2e-4, -3.0, lacking(-3.0, -2e-4)), (-2e-4, 3.0, 0.0)]
    {
        let what = format!("a stop at {at} m under {force} m/s²");
        let got = read(&stop(&format!("{at:?}")), force)?;
        near(&what, got, expected, 1e-6)?;
        // Control: a place that is a hundredth further is another reading where the stop is met.
        let other = read(&stop(&format!("{:?}", 1.01 * at)), force)?;
        check((other - got).abs() > 1e-3 || expected == 0.0, format!("{what}: a hundredth more reads the same"))?;
        // Beside stops on both sides, that far away that the mass meets none, it is the same.
        let both = format!("{}end_stop_per_s2 = 1000.0\nend_stop_gap_m = 0.1\n", stop(&format!("{at:?}")));
        near(&format!("{what}, beside stops far away"), read(&both, force)?, expected, 1e-6)?;
    }
    Ok(())
}

/// At rest the third axis feels −g, the others nothing: what a stop below keeps from its reading is
/// a velocity along it.
fn in_motion() -> Result<(), Failed> {
    let g = 9.806_65;
    let velocity = |at: &str| -> Result<[f64; 3], Failed> {
        let answer = answered(&format!(
            "members = 64\nduration_s = 10.0\n[sensor]\nsample_rate_hz = 500.0\nresonance_hz = 12.0\n\
             damping_ratio = 0.7\n{}[trajectory]\nkind = \"rest\"\n[report]\ntimes_s = [10.0]\n",
            stop(at)
        ))?;
        Ok([0, 1, 2].map(|axis| series(&answer, Quantity::Velocity(axis), |s| s.mean)[0]))
    };
    let expected = lacking(-g, -1e-3) * 10.0;
    let met = velocity("-1e-3")?;
    // The mass begins at rest where its spring alone would hold it: settling takes 0.05 s of 10.
    near("velocity of the stopped axis", met[2], expected, 5e-3 * expected.abs())?;
    near("velocity of another axis", met[0], 0.0, 1e-6)?;
    // Controls: a stop above, and one below on the other axes alone.
    near("velocity with a stop above", velocity("1e-3")?[2], 0.0, 1e-6)?;
    near("velocity with stops elsewhere", velocity("[-1e-3, -1e-3, 1e-3]")?[2], 0.0, 1e-6)
}

fn refused() -> Result<(), Failed> {
    let said = |keys: &str| {
        let parsed = study::parse("one-sided stop", &text(keys, "kind = \"rest\"", &[1.0]), Path::new(""));
        parsed.err().map(|error| error.to_string()).unwrap_or_default()
    };
    let (stiffness, place) = ("one_sided_stop_per_s2 = 1000.0\n", "one_sided_stop_at_m = -1e-4\n");
    for alone in [stiffness, place] {
        let cause = said(alone);
        check(cause.contains("one_sided_stop_per_s2") && cause.contains("one_sided_stop_at_m"), cause.clone())?;
    }
    let softer = said(&format!("one_sided_stop_per_s2 = -1.0\n{place}"));
    check(softer.contains("sensor.one_sided_stop_per_s2"), softer.clone())?;
    // Control: both together are a study.
    let both = said(&format!("{stiffness}{place}"));
    check(both.is_empty(), both.clone())
}

fn on_the_gpu() -> Result<(), Failed> {
    let mut gpu = Ensembles::on(Arc::new(Gpu::open()?));
    let sine = "kind = \"sine\"\namplitude_m_s2 = 3.0\nfrequency_hz = 5.0";
    let drawn = |from: f64| text(&stop(&format!("{{ min = {from:?}, max = 4e-4 }}")), sine, &[0.5, 1.0, 3.0]);
    let here = run(&drawn(-4e-4), &mut Cpu::default())?;
    let there = run(&drawn(-4e-4), &mut gpu)?;
    let apart = parity::difference(&here, &there);
    check(apart < 5e-3, format!("percentiles {apart} sd apart"))?;
    // Control: stops that stand elsewhere.
    let other = parity::difference(&here, &run(&drawn(-3e-4), &mut gpu)?);
    check(other > 5e-3, format!("other stops are {other} sd apart"))
}
