//! A spring that follows the temperature, in a study: `sensor.stiffness_per_k`.
//!
//! Expected: under a steady force, the share −κϑ/(1 + κϑ) of it that the reading lacks (the balance of
//! the spring); in motion of the mass, the equation with its temperature, written down here and
//! integrated finely.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu::{self, Cpu};
use proofmass::backend::flight::Quantity;
use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::control::Control;
use proofmass::ensemble::{Choice, Options, run_on};
use proofmass::statistics::quantity::ACCELERATION;
use proofmass::strapdown::backends::run_on as fly;
use proofmass::study::{self, Study};
use proofmass::validation::parity::difference;

use super::strapdown::{answered, parsed as flown, percentiles_apart};
use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("warm spring: a steady force is read short by what the spring is stiffer", steady),
        test("warm spring: the mass moves as its equation says", moving),
        test("warm spring: a temperature is needed, and one that leaves a spring", refused),
        test("warm spring: in motion it is a scale error", in_motion),
        gpu_test("warm spring: the GPU draws the ensemble of the CPU, in any tiles", on_the_gpu),
        gpu_test("warm spring: in motion the GPU flies as the CPU does", in_motion_on_the_gpu),
    ]
}

const RESONANCE_HZ: f64 = 12.0;
const ZETA: f64 = 0.1;
const PER_K: f64 = -0.004;
/// Warms by 30 K in two seconds.
const PROFILE: &str = "[temperature]\nprofile_s_deg_c = [[0.0, 20.0], [2.0, 50.0]]\nreference_deg_c = 20.0\n";
const SINE: &str = "kind = \"sine\"\namplitude_m_s2 = 2.0\nfrequency_hz = 5.0\n";
const STEADY: &str = "kind = \"rectangle\"\namplitude_m_s2 = 2.0\nstart_s = 0.0\nlength_s = 50.0\n";

/// A mass of 12 Hz read a thousand times a second.
fn parsed(sensor: &str, temperature: &str, excitation: &str, duration_s: f64) -> Result<Study, Failed> {
    let text = format!(
        "members = 64\nduration_s = {duration_s:?}\n[sensor]\nsample_rate_hz = 1000.0\nresonance_hz = {RESONANCE_HZ:?}\n\
         {sensor}{temperature}[excitation]\n{excitation}[report]\ntimes_s = [{duration_s:?}]\n"
    );
    Ok(study::parse("warm spring", &text, Path::new(""))?)
}

fn keys(zeta: f64, per_k: f64) -> String {
    format!("damping_ratio = {zeta:?}\nstiffness_per_k = {per_k:?}\n")
}

/// Error of the first member's reading at the end, in f64.
fn error(study: &Study) -> Result<f64, Failed> {
    let job = study.job(study.integrator()?.integrator, vec![study.clock.samples]);
    Ok(cpu::outcomes::<f64>(&job, &Control::silent())?[0][ACCELERATION])
}

fn steady() -> Result<(), Failed> {
    for (per_k, deg_c) in [(PER_K, 45.0), (0.003, 45.0), (PER_K, 5.0)] {
        let profile = format!("[temperature]\nprofile_s_deg_c = [[0.0, {deg_c:?}]]\nreference_deg_c = 20.0\n");
        let got = error(&parsed(&keys(0.7, per_k), &profile, STEADY, 3.0)?)?;
        let share = per_k * (deg_c - 20.0);
        near(&format!("{per_k} per K at {deg_c} °C"), got, -2.0 * share / (1.0 + share), 1e-9)?;
        check((got + 2.0 * share).abs() > 1e-3, "to first order alone it is the same (control)")?;
    }
    Ok(())
}

/// The error of the reading after two seconds, by the equation, with the warming of `PROFILE`.
fn integrated(per_k: f64) -> f64 {
    let omega = TAU * RESONANCE_HZ;
    let (own, h, steps) = (omega * omega, 2e-5, 100_000);
    let force = |t: f64| 2.0 * (TAU * 5.0 * t).sin();
    let slope = |t: f64, [x, v]: [f64; 2]| {
        let stiffness = own * (1.0 + per_k * 15.0 * t);
        [v, force(t) - stiffness * x - 2.0 * ZETA * omega * v]
    };
    let add = |s: [f64; 2], d: [f64; 2], by: f64| [s[0] + by * d[0], s[1] + by * d[1]];
    let end = (0..steps).fold([0.0; 2], |s, n| {
        let t = f64::from(n) * h;
        let d1 = slope(t, s);
        let d2 = slope(t + 0.5 * h, add(s, d1, 0.5 * h));
        let d3 = slope(t + 0.5 * h, add(s, d2, 0.5 * h));
        let d4 = slope(t + h, add(s, d3, h));
        std::array::from_fn(|i| s[i] + h / 6.0 * (d1[i] + 2.0 * d2[i] + 2.0 * d3[i] + d4[i]))
    });
    own * end[0] - force(2.0)
}

fn moving() -> Result<(), Failed> {
    let got = error(&parsed(&keys(ZETA, PER_K), PROFILE, SINE, 2.0)?)?;
    near("reading error", got, integrated(PER_K), 1e-5)?;
    check((got - integrated(1.02 * PER_K)).abs() > 1e-3, "a fiftieth more of it is the same (control)")?;
    let late = PROFILE.replace("reference", "lag_s = 1.0\nreference");
    let other = error(&parsed(&keys(ZETA, PER_K), &late, SINE, 2.0)?)?;
    check((got - other).abs() > 1e-3, "a temperature that lags is the same (control)")
}

fn refused() -> Result<(), Failed> {
    let said = |sensor: &str, temperature: &str| {
        parsed(sensor, temperature, SINE, 2.0)
            .err()
            .map(|e| e.message().unwrap_or_default().to_owned())
            .unwrap_or_default()
    };
    let without = said(&keys(ZETA, PER_K), "");
    check(without.contains("sensor.stiffness_per_k") && without.contains("[temperature]"), without.clone())?;
    // 1 − 0.04 · 30 < 0.
    let gone = said(&keys(ZETA, -0.04), PROFILE);
    check(gone.contains("sensor.stiffness_per_k") && gone.contains("50.0 °C"), gone.clone())?;
    let cold = said(&keys(ZETA, 0.04), &PROFILE.replace("50.0", "-10.0"));
    check(cold.contains("sensor.stiffness_per_k") && cold.contains("10.0 °C"), cold.clone())?;
    let in_motion = flown(&flight("stiffness_per_k = -0.2", 64)).err();
    let in_motion = in_motion.and_then(|e| e.message().map(str::to_owned)).unwrap_or_default();
    check(in_motion.contains("sensor.stiffness_per_k") && in_motion.contains("30.0 °C"), in_motion.clone())?;
    // A drift of −0.4/s and a warming of 15 K/s: 1 − 0.4·2 − 0.015·30 < 0, and either alone leaves a spring.
    let drift = "stiffness_drift_per_s = -0.4\n";
    let both = said(&format!("{}{drift}", keys(ZETA, -0.015)), PROFILE);
    check(both.contains("stiffness_per_k") && both.contains("stiffness_drift_per_s"), both.clone())?;
    for good in [format!("{}{drift}", keys(ZETA, -0.001)), keys(ZETA, -0.015)] {
        check(said(&good, PROFILE).is_empty(), said(&good, PROFILE))?;
    }
    // Before the first point it is as cold: 1 − 0.04·30 < 0 at the beginning, and a drift of 0.3/s makes up
    // for it by the first point, at 1 s.
    let cold = PROFILE.replace("[[0.0, 20.0], [2.0, 50.0]]", "[[1.0, -10.0], [2.0, 20.0]]");
    let drifts = |per_k: f64| said(&format!("{}stiffness_drift_per_s = 0.3\n", keys(ZETA, per_k)), &cold);
    check(drifts(0.04).contains("stiffness_per_k"), format!("{:?}", drifts(0.04)))?;
    check(drifts(0.02).is_empty(), drifts(0.02))?;
    // A still start of a second is a second more of drift.
    let still = |length_s: f64| {
        let text = format!("{PROFILE}[alignment]\nkind = \"still\"\nstill_s = {length_s:?}\n");
        said(&format!("{}{drift}", keys(ZETA, 1e-6)), &text)
    };
    let long = still(1.0);
    check(long.contains("stiffness_drift_per_s"), format!("{long:?}"))?;
    check(still(0.1).is_empty(), still(0.1))?;
    // Controls: in warmth that one stiffens. ω = ω₀√(1 + 160 · 30) needs 70 · 75.4 · 1 ms/0.25 steps.
    for good in [keys(ZETA, PER_K), keys(ZETA, 0.04)] {
        check(said(&good, PROFILE).is_empty(), said(&good, PROFILE))?;
    }
    let substeps = |per_k: f64| -> Result<u32, Failed> {
        Ok(parsed(&keys(ZETA, per_k), PROFILE, SINE, 2.0)?.integrator()?.integrator.substeps())
    };
    let got = [substeps(160.0)?, substeps(PER_K)?];
    check(got == [21, 1], format!("{got:?} substeps"))
}

fn flight(keys: &str, members: u32) -> String {
    format!(
        "members = {members}\nduration_s = 20.0\n[sensor]\nsample_rate_hz = 200.0\nresonance_hz = 30.0\ndamping_ratio = 0.7\n\
         {keys}\n[temperature]\nprofile_s_deg_c = [[0.0, 30.0]]\nreference_deg_c = 20.0\n\
         [trajectory]\nkind = \"waypoints\"\npoints_m = [[0.0, 0.0, 0.0], [400.0, 0.0, 0.0]]\n\
         speed_m_s = 10.0\nstill_s = 2.0\n[report]\ntimes_s = [20.0]\n"
    )
}

/// Ten kelvins of 1/3900 each: 1/391 of the force is missing.
fn in_motion() -> Result<(), Failed> {
    let north = |keys: &str| -> Result<f64, Failed> {
        let answer = answered(&flight(keys, 256))?;
        Ok(answer.ensemble.summary(*answer.report.last().ok_or("no report")?, Quantity::Position(0)).mean)
    };
    // What follows no temperature beside one is refused: a bias over it that does nothing here.
    let idle = "[accelerometer]\nbias_temperature_ug_k = 1e-9\n";
    let bare = north(idle)?;
    let share = 1.0 / 391.0;
    let by_scale = north(&format!("{idle}scale_factor_ppm = {:?}", -1e6 * share))? - bare;
    let by_spring = north(&format!("stiffness_per_k = {:?}", 1.0 / 3900.0))? - bare;
    check(by_scale.abs() > 0.1, format!("a scale error moves by {by_scale} m"))?;
    near("north by the spring over that by a scale error", by_spring / by_scale, 1.0, 2e-3)?;
    let other = north(&format!("stiffness_per_k = {:?}", 1.05 / 3900.0))? - bare;
    check((other / by_scale - 1.0).abs() > 0.02, "another spring is the same (control)")
}

fn on_the_gpu() -> Result<(), Failed> {
    let drawn = |sd: f64| {
        let keys = keys(ZETA, PER_K).replace("= -0.004", &format!("= {{ mean = -0.004, sd = {sd:?} }}"));
        let noise = "[accelerometer]\nvelocity_random_walk_m_s_rth = 0.01\n";
        let mut study = parsed(&format!("{keys}cubic_stiffness_per_m2_s2 = 1e8\n{noise}"), PROFILE, SINE, 2.0)?;
        study.members = 2048;
        Ok::<_, Failed>(study.job(study.integrator()?.integrator, vec![70, 1000, 2000]))
    };
    let job = drawn(0.001)?;
    let device = Arc::new(Gpu::open()?);
    let on = |tile_samples: u64| {
        let mut ensembles = Ensembles::on(device.clone());
        ensembles.tile_samples = tile_samples;
        run_on(&job, &mut ensembles, &Options::default())
    };
    let (here, there) = (run_on(&job, &mut Cpu::default(), &Options::default())?, on(4096)?);
    let apart = difference(&here, &there);
    check(apart < 2e-3, format!("CPU and GPU are {apart} sd apart"))?;
    check(on(30)?.at == there.at, "tiles of 30 change a bit")?;
    let tiled = run_on(&job, &mut Cpu { tile_samples: 30, ..Cpu::default() }, &Options::default())?;
    check(tiled.at == here.at, "tiles of 30 change a bit on the CPU")?;
    let other = run_on(&drawn(0.0012)?, &mut Cpu::default(), &Options::default())?;
    check(difference(&other, &there) > 2e-2, "another spread is the same (control)")
}

fn in_motion_on_the_gpu() -> Result<(), Failed> {
    let text = |mean: f64| {
        let noise = "[accelerometer]\nvelocity_random_walk_m_s_rth = 0.01\n";
        flight(&format!("stiffness_per_k = {{ mean = {mean:?}, sd = 1e-4 }}\n{noise}"), 1024)
    };
    let on = |choice, text: &str| -> Result<_, Failed> {
        let study = flown(text)?;
        let flight = study.flight(study.in_motion.as_ref().ok_or("no trajectory")?, vec![20, 1000, 4000])?;
        Ok(fly(choice, &flight, &Control::silent())?)
    };
    let (here, there) = (on(Choice::Cpu, &text(2e-4))?, on(Choice::Gpu, &text(2e-4))?);
    check(there.machine.kind == "gpu", "the GPU's run was not on a GPU")?;
    let apart = percentiles_apart(&here, &there, 3);
    check(apart < 5e-3, format!("percentiles {apart} sd apart"))?;
    let other = on(Choice::Cpu, &text(2.2e-4))?;
    check(percentiles_apart(&here, &other, 3) > 5e-3, "another spring gave the same percentiles (control)")
}
