//! A still start: what averaging the first seconds leaves of each error follows its closed form on
//! every backend, any tile gives the same bits, and the excitation begins at its end.
//!
//! The expected numbers are written out here from the laws in `navigation::closed_form`,
//! independent of `drift::expected`. The sd of 8192 members scatters by 0.8 %: 4 % is five standard
//! errors, a false alarm in two million checks.

use std::path::Path;
use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu::Cpu;
use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::drift::expected::Expected;
use proofmass::drift::{self};
use proofmass::ensemble::{self, Choice, Options, run_on};
use proofmass::kernel::integrator::Integrator;
use proofmass::kernel::job::Job;
use proofmass::sensor::{ProofMass, Sensor};
use proofmass::statistics::{QUANTITIES, Statistics, quantity};
use proofmass::study::{self, Study};
use proofmass::validation::jobs::{Sine, duffing, job};
use proofmass::validation::parity::{difference, everything};

use super::world::{check, gpu_test, near, test};

const TIMES_S: [f64; 3] = [5.0, 10.0, 20.0];
/// Length of the still start, s: no multiple of the 64 samples that the kernels sum at a time.
const STILL_S: f64 = 4.1;
const TOLERANCE: f64 = 0.04;
const G: f64 = 9.80665;

/// Name, section of study.toml, standard deviation of position t seconds after a still start of T
/// seconds.
type Case = (&'static str, &'static str, fn(f64, f64) -> f64);

const CASES: &[Case] = &[
    // N² (t³/3 + t⁴/4T)
    ("velocity random walk", "[accelerometer]\nvelocity_random_walk_m_s_rth = 0.06", |t, still| {
        1e-3 * (t.powi(3) / 3.0 + t.powi(4) / (4.0 * still)).sqrt()
    }),
    // K² (t⁵/20 + t⁴ T/12)
    ("acceleration random walk", "[accelerometer]\nacceleration_random_walk_ug_rts = 50.0", |t, still| {
        50e-6 * G * (t.powi(5) / 20.0 + t.powi(4) * still / 12.0).sqrt()
    }),
    // g² N² (t⁵/20 + t⁶/36T); 1 °/√h = 2.9089e-4 rad/√s
    ("angle random walk", "[gyro]\nangle_random_walk_deg_rth = 0.5", |t, still| {
        G * 1.454_441e-4 * (t.powi(5) / 20.0 + t.powi(6) / (36.0 * still)).sqrt()
    }),
    // g² K² (t⁷/252 + t⁶ T/108); 1 °/h/√h = 8.0802e-8 rad/s/√s
    ("rate random walk", "[gyro]\nrate_random_walk_deg_h_rth = 100.0", |t, still| {
        G * 8.080_228e-6 * (t.powi(7) / 252.0 + t.powi(6) * still / 108.0).sqrt()
    }),
];

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all: Vec<Trial> = CASES
        .iter()
        .map(|case| test(&format!("still start: {} alone, on the CPU", case.0), move || alone(case, Choice::Cpu)))
        .collect();
    all.extend(
        CASES.iter().map(|case| {
            gpu_test(&format!("still start: {} alone, on a GPU", case.0), move || alone(case, Choice::Gpu))
        }),
    );
    all.push(test("still start: the check sees the law without it", control));
    all.push(test("still start: biases leave nothing but the tilt that levelling takes them for", biases));
    all.push(test("still start: flicker and mixed errors follow the closed form in all four quantities", mixed));
    all.push(test("still start: the error budget and the powers of growth know of it", budget));
    all.push(test("still start: the excitation begins at its end", excitation));
    all.push(test("still start: tiles, batches and an empty start do not change a bit", invariance));
    all.push(gpu_test("still start: CPU and GPU agree, and tiles do not change a bit on the GPU", parity));
    all.extend(REFUSED.iter().map(|case| test(&format!("still start: refused: {}", case.0), move || refused(case))));
    all
}

fn study_with(alignment: &str, sections: &str) -> Result<Study, Failed> {
    let head = format!(
        "members = 8192\nseed = 11\nduration_s = 20.0\n[report]\ntimes_s = {TIMES_S:?}\n[sensor]\nsample_rate_hz = 100.0\n"
    );
    Ok(study::parse("study.toml", &format!("{head}{alignment}\n{sections}"), Path::new(""))?)
}

fn study(sections: &str) -> Result<Study, Failed> {
    study_with(&format!("[alignment]\nkind = \"still\"\nstill_s = {STILL_S}"), sections)
}

fn simulate(study: &Study, backend: Choice) -> Result<Statistics, Failed> {
    let job = study.job(Integrator::Ideal, study.clock.report_samples.clone());
    Ok(ensemble::run(&job, &Options { backend, ..Options::default() })?)
}

fn compare(statistics: &Statistics, law: impl Fn(f64) -> f64) -> Result<(), Failed> {
    for (time_s, sd) in TIMES_S.iter().zip(statistics.series(quantity::POSITION, |s| s.sd)) {
        near(&format!("sd of position after {time_s} s over its closed form"), sd / law(*time_s), 1.0, TOLERANCE)?;
    }
    Ok(())
}

fn alone((_, sections, law): &Case, backend: Choice) -> Result<(), Failed> {
    let study = study(sections)?;
    let statistics = simulate(&study, backend)?;
    check(
        statistics.time_s.iter().zip(TIMES_S).all(|(a, b)| (a - b).abs() < 1e-9),
        format!("times do not count from the end of the still start: {:?}", statistics.time_s),
    )?;
    compare(&statistics, |t| law(t, STILL_S))?;
    let expected = Expected::of(&study, &study.clock.report_samples).total(quantity::POSITION);
    for (time_s, moment) in TIMES_S.iter().zip(expected) {
        near("reported closed form over the law", moment.variance.sqrt() / law(*time_s, STILL_S), 1.0, 0.005)?;
    }
    Ok(())
}

fn control() -> Result<(), Failed> {
    for (name, sections, law) in CASES {
        let with = simulate(&study(sections)?, Choice::Cpu)?;
        // An endless still start of white noise leaves nothing, an infinitely short one nothing of
        // a random walk.
        let other = if name.ends_with("random walk") && (name.starts_with("acc") || name.starts_with("rate")) {
            1e-12
        } else {
            1e12
        };
        check(compare(&with, |t| law(t, other)).is_err(), format!("{name}: the law without a still start passed"))?;
    }
    Ok(())
}

fn biases() -> Result<(), Failed> {
    let study =
        study("[accelerometer]\nbias_mg = { mean = 3.0, sd = 2.0 }\n[gyro]\nbias_deg_h = { mean = 100.0, sd = 50.0 }")?;
    let statistics = simulate(&study, Choice::Cpu)?;
    let last = &statistics.at[2];
    // What rounding in 32 bits leaves of 3 mg, half a metre after 20 s if nothing were taken off.
    check(last[quantity::POSITION].sd < 1e-5 && last[quantity::POSITION].mean.abs() < 1e-5, format!("{last:?}"))?;
    // Levelling takes the accelerometer's bias for tilt: −3 mg / g = −3 mrad, spread by 2 mrad.
    near("mean tilt", last[quantity::TILT].mean, -3e-3, 5.0 * 2e-3 / 8192f64.sqrt())?;
    near("sd of tilt", last[quantity::TILT].sd / 2e-3, 1.0, TOLERANCE)?;
    let expected = Expected::of(&study, &study.clock.report_samples);
    near("closed form of the mean tilt", expected.total(quantity::TILT)[2].mean, -3e-3, 1e-9)?;
    near("closed form of the position", expected.total(quantity::POSITION)[2].variance, 0.0, 1e-18)
}

/// Against `drift::expected`: there is no textbook law for a sum of held processes.
fn mixed() -> Result<(), Failed> {
    for sections in [
        "[accelerometer]\nbias_instability_ug = 100.0",
        "[gyro]\nbias_instability_deg_h = 20.0",
        "[accelerometer]\nbias_mg = { min = -1.0, max = 1.0 }\nnoise_density_ug_rthz = 300.0\nquantisation_mg = 1.0\n\
         acceleration_random_walk_ug_rts = 30.0\n\
         [gyro]\nbias_deg_h = { mean = 3.0, sd = 8.0 }\nangle_random_walk_deg_rth = 0.4\nrate_random_walk_deg_h_rth = 40.0",
        "[accelerometer]\ngauss_markov_ug = 100.0\ngauss_markov_time_s = 3.0",
        "[gyro]\ngauss_markov_deg_h = 20.0\ngauss_markov_time_s = 3.0",
        "[accelerometer]\nwarm_up_mg = { mean = 0.0, sd = 2.0 }\nwarm_up_time_s = 3.0",
        "[gyro]\nwarm_up_deg_h = { mean = 0.0, sd = 20.0 }\nwarm_up_time_s = 3.0",
        "[accelerometer]\nsinusoid_mg = 2.0\nsinusoid_hz = 0.11",
        "[gyro]\nsinusoid_deg_h = 20.0\nsinusoid_hz = 0.11",
    ] {
        let study = study(sections)?;
        let statistics = simulate(&study, Choice::Cpu)?;
        let expected = Expected::of(&study, &study.clock.report_samples);
        for q in 0..4 {
            for ((at, moment), time_s) in statistics.at.iter().zip(expected.total(q)).zip(TIMES_S) {
                let theory = moment.variance.sqrt();
                if theory > 0.0 {
                    near(
                        &format!("{} after {time_s} s: {sections}", QUANTITIES[q]),
                        at[q].sd / theory,
                        1.0,
                        TOLERANCE,
                    )?;
                }
            }
        }
    }
    Ok(())
}

fn budget() -> Result<(), Failed> {
    let study = study(
        "[accelerometer]\nbias_mg = { mean = 0.0, sd = 5.0 }\nnoise_density_ug_rthz = 300.0\n\
         [gyro]\nbias_deg_h = { mean = 0.0, sd = 80.0 }\nangle_random_walk_deg_rth = 0.4",
    )?;
    let options = Options { backend: Choice::Cpu, ..Options::default() };
    let drift = drift::answer(&study, &options.control, |job, _| ensemble::run(job, &options))?;
    let last = drift.statistics.time_s.len() - 1;
    let total = drift.expected.total(quantity::POSITION)[last].variance;
    for (source, rows) in &drift.expected.sources {
        let Some(contribution) = drift.budget.contributions.iter().find(|s| s.source == *source) else {
            return Err(format!("{} is not in the budget", source.name()).into());
        };
        let theory = rows[last][quantity::POSITION].variance / total;
        near(source.name(), drift.budget.fraction(contribution, last), theory, 0.05)?;
        let bias = source.name().ends_with("bias");
        check(!bias || theory == 0.0, format!("the still start left some of the {}", source.name()))?;
    }
    // Each power of the envelope: t^1.5 and t² of the accelerometer's white noise, t^2.5 and t³ of
    // the gyro's.
    let (n, a) = (300e-6 * G / 2f64.sqrt(), 0.4 * 2.908_882e-4 * G);
    let powers = [n / 3f64.sqrt(), n / (4.0 * STILL_S).sqrt(), a / 20f64.sqrt(), a / (36.0 * STILL_S).sqrt()];
    for (k, power) in powers.into_iter().enumerate() {
        near(&format!("power {k} of the growth"), drift.growth.expected[k] / power, 1.0, 1e-3)?;
    }
    Ok(())
}

/// Largest difference of mean and sd of position, in sd. The other errors are nothing but rounding
/// at some of these times.
fn apart(a: &Statistics, b: &Statistics) -> f64 {
    let position = a.at.iter().zip(&b.at).map(|(a, b)| (&a[quantity::POSITION], &b[quantity::POSITION]));
    position.map(|(a, b)| ((a.mean - b.mean).abs() + (a.sd - b.sd).abs()) / a.sd).fold(0.0, f64::max)
}

/// Scale errors and mechanics act on the motion alone: the same numbers as from an ideal start.
fn excitation() -> Result<(), Failed> {
    let mass = "resonance_hz = 30.0\ndamping_ratio = 0.7\ncubic_stiffness_per_m2_s2 = 4.5e9\n";
    let scale = "[accelerometer]\nscale_factor_ppm = { mean = 0.0, sd = 1000.0 }\nk2_ug_per_g2 = 50.0\n";
    for (kind, integrator) in [
        ("kind = \"sine\"\namplitude_m_s2 = 2.0\nfrequency_hz = 0.3\nphase_rad = 1.0", Integrator::Ideal),
        (
            "kind = \"sine\"\namplitude_m_s2 = 2.0\nfrequency_hz = { min = 0.2, max = 0.4 }\nphase_rad = 1.0",
            Integrator::RungeKutta4 { substeps: 4 },
        ),
        ("kind = \"rectangle\"\namplitude_m_s2 = 2.0\nlength_s = 3.0", Integrator::RungeKutta4 { substeps: 4 }),
    ] {
        let mass = if integrator == Integrator::Ideal { "" } else { mass };
        let sections = format!("{mass}{scale}[excitation]\n{kind}");
        let run = |alignment: &str| -> Result<Statistics, Failed> {
            let head =
                format!("members = 512\nduration_s = 20.0\n{alignment}\n[report]\ntimes_s = {TIMES_S:?}\n[sensor]\n");
            let study = study::parse("study.toml", &format!("{head}{sections}"), Path::new(""))?;
            let job = study.job(integrator, study.clock.report_samples.clone());
            Ok(ensemble::run(&job, &Options { backend: Choice::Cpu, ..Options::default() })?)
        };
        let (ideal, still) = (run("")?, run("[alignment]\nkind = \"still\"\nstill_s = 4.1")?);
        let near = apart(&ideal, &still);
        check(near < 1e-3, format!("{kind}: {near} sd between an ideal and a still start of noiseless sensors"))?;
        // Control: a still start of another sensor is told apart.
        let control = apart(&ideal, &run("seed = 2\n[alignment]\nkind = \"still\"\nstill_s = 4.1")?);
        check(control > 1e-2, "the comparison is blind")?;
    }
    Ok(())
}

/// All errors on, a Duffing proof mass, and a still start that ends inside a draw of four samples.
fn full(still_samples: u64) -> Job {
    let sensor =
        Sensor { proof_mass: Some(ProofMass { force_noise_m_s_rts: 1e-4, ..duffing(30.0, 0.7) }), ..everything() };
    let force = Sine { amplitude_m_s2: 4.0, frequency_hz: 3.0, offset_m_s2: 0.0 };
    let mut job = job(sensor, 1500, &[0.07, 1.0, 2.5], force, Integrator::RungeKutta4 { substeps: 1 });
    job.clock.still_samples = still_samples;
    job.clock.samples += still_samples;
    job.clock.report_samples.iter_mut().for_each(|s| *s += still_samples);
    job
}

fn same(what: &str, a: &Statistics, b: &Statistics) -> Result<(), Failed> {
    check(a.at == b.at && a.failed == b.failed, format!("{what} changes the result"))
}

fn invariance() -> Result<(), Failed> {
    let run = |cpu: Cpu, job: &Job, batch_members: Option<u64>| {
        run_on(job, &mut { cpu }, &Options { batch_members, ..Options::default() })
    };
    for still_samples in [1, 203, 512] {
        let job = full(still_samples);
        let plain = run(Cpu::default(), &job, None)?;
        for tile_samples in [4, 60, 1000] {
            same("the tile", &plain, &run(Cpu { tile_samples, ..Cpu::default() }, &job, None)?)?;
        }
        same("the batch", &plain, &run(Cpu::default(), &job, Some(256))?)?;
        let ideal = run(Cpu::default(), &full(0), None)?;
        check(ideal.at != plain.at, "a still start changes nothing")?;
    }
    Ok(())
}

fn parity() -> Result<(), Failed> {
    let device = Arc::new(Gpu::open()?);
    let options = Options::default();
    let job = full(203);
    let on = |tile_samples: u64| {
        let mut ensembles = Ensembles::on(device.clone());
        ensembles.tile_samples = tile_samples;
        run_on(&job, &mut ensembles, &options)
    };
    let there = on(4096)?;
    same("the tile", &there, &on(20)?)?;
    same("a tile that begins inside a draw of four", &there, &on(3)?)?;
    let here = run_on(&job, &mut Cpu::default(), &options)?;
    let apart = difference(&here, &there);
    check(apart < 2e-3, format!("percentiles {apart} sd apart"))?;
    let control = difference(&run_on(&full(200), &mut Cpu::default(), &options)?, &there);
    check(control > 2e-3, "a still start three samples shorter is not told apart")
}

/// What is wrong, the sections (after `duration_s = 10.0`), a word of the cause, a word of the
/// hint.
type Wrong = (&'static str, &'static str, &'static str, &'static str);

const LOG: &str = "[compare]\nfile = \"x.csv\"\nrate_hz = 100.0\naxis = []\n";
const STILL: &str = "[alignment]\nkind = \"still\"\nstill_s = 1.0\n";

const REFUSED: &[Wrong] = &[
    ("no length", "[alignment]\nkind = \"still\"", "`alignment.still_s` is missing", "10.0"),
    ("no kind", "[alignment]\nstill_s = 10.0", "without `kind`", "still"),
    ("nothing at all", "[alignment]", "empty", "kind"),
    ("another kind", "[alignment]\nkind = \"stil\"", "unknown variant `stil`", "still"),
    ("zero", "[alignment]\nkind = \"still\"\nstill_s = 0.0", "more than zero", "seconds"),
    ("negative", "[alignment]\nkind = \"still\"\nstill_s = -10.0", "more than zero", "seconds"),
    ("not a number", "[alignment]\nkind = \"still\"\nstill_s = nan", "more than zero", "seconds"),
    ("endless", "[alignment]\nkind = \"still\"\nstill_s = 1e12", "samples", "shorten"),
    ("no multiple of a sample", "[alignment]\nkind = \"still\"\nstill_s = 1.003", "100.3", "multiple"),
    ("a length for an ideal start", "[alignment]\nkind = \"ideal\"\nstill_s = 1.0", "does not belong", "still"),
    ("an unknown key", "[alignment]\nkind = \"still\"\nstil_s = 1.0", "unknown field `stil_s`", "still_s"),
    ("no windows", "{STILL}{LOG}windows_s = []", "0 lengths", "Allan"),
    ("a negative window", "{STILL}{LOG}windows_s = [-10.0]", "-10.0 s", "seconds"),
    ("a window that is not a number", "{STILL}{LOG}windows_s = [10.0, nan]", "NaN s", "seconds"),
    ("windows out of order", "{STILL}{LOG}windows_s = [60.0, 10.0]", "does not increase", "sort"),
    ("windows after an ideal start", "{LOG}windows_s = [10.0]", "needs a still start", "[alignment]"),
    ("a log without a clock", "{STILL}[compare]\nfile = \"x.csv\"\naxis = []", "no clock", "rate_hz"),
    (
        "a log at another rate than the sensor",
        "{STILL}[sensor]\nsample_rate_hz = 200.0\n{LOG}windows_s = [10.0]",
        "disagrees with `sensor.sample_rate_hz` = 200 Hz",
        "agree",
    ),
];

fn refused((_, sections, cause, hint): &Wrong) -> Result<(), Failed> {
    let windows_last =
        sections.replace("{LOG}windows_s", "[compare]\nfile = \"x.csv\"\nrate_hz = 100.0\naxis = []\nwindows_s");
    let text = windows_last.replace("{STILL}", STILL).replace("{LOG}", LOG);
    let Err(error) = study::parse("study.toml", &format!("duration_s = 10.0\n{text}\n"), Path::new("")) else {
        return Err("it was accepted".into());
    };
    check(error.cause.contains(cause), format!("cause does not say '{cause}': {error}"))?;
    check(error.hint.contains(hint), format!("hint does not say '{hint}': {error}"))?;
    check(error.attempt.starts_with("could not"), format!("{error}"))
}
