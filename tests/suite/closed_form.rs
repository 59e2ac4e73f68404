//! Every error source alone drifts as its closed form says, at 5, 10 and 20 s, with 8192 members.
//!
//! The expected numbers are written out here from the textbook laws (Woodman, UCAM-CL-TR-696, §6;
//! Titterton & Weston, §12), independent of `drift::expected`. The sd of 8192 members scatters by
//! 0.8 %: 4 % is five standard errors.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::drift::expected::Expected;
use proofmass::drift::{self, Drift};
use proofmass::ensemble::{self, Choice, Options};
use proofmass::kernel::integrator::Integrator;
use proofmass::navigation::power_law::EXPONENTS;
use proofmass::statistics::{Statistics, quantity};
use proofmass::study::{self, Study};

use super::world::{check, gpu_test, near, test};

/// Report times, s.
pub const TIMES_S: [f64; 3] = [5.0, 10.0, 20.0];
const TOLERANCE: f64 = 0.04;
/// Gravity, m/s².
pub const G: f64 = 9.80665;

/// Name, section of study.toml, standard deviation of position after t seconds.
type Case = (&'static str, &'static str, fn(f64) -> f64);

const CASES: &[Case] = &[
    // ½ b t²
    ("accelerometer bias", "[accelerometer]\nbias_mg = { mean = 0.0, sd = 2.0 }", |t| 0.5 * 2e-3 * G * t * t),
    // N t^1.5/√3, N = n/√2
    ("velocity random walk", "[accelerometer]\nnoise_density_ug_rthz = 100.0", |t| {
        100e-6 * G / 2f64.sqrt() * t.powf(1.5) / 3f64.sqrt()
    }),
    // K t^2.5/√20
    ("acceleration random walk", "[accelerometer]\nacceleration_random_walk_ug_rts = 50.0", |t| {
        50e-6 * G * t.powf(2.5) / 20f64.sqrt()
    }),
    // R t³/6; 1 mg/h = 2.7241e-6 m/s³
    ("acceleration ramp", "[accelerometer]\nacceleration_ramp_mg_h = { mean = 0.0, sd = 100.0 }", |t| {
        2.724_069_4e-4 * t.powi(3) / 6.0
    }),
    // g R t⁴/24; 1 °/h/h = 1.3467e-9 rad/s²
    ("rate ramp", "[gyro]\nrate_ramp_deg_h_h = { mean = 0.0, sd = 1000.0 }", |t| G * 1.346_704_7e-6 * t.powi(4) / 24.0),
    // s × the true displacement of a force 2 sin 2πt: (2/ω)(t − sin ωt/ω), whole periods
    (
        "scale factor",
        "[accelerometer]\nscale_factor_ppm = { mean = 0.0, sd = 1000.0 }\n[excitation]\nkind = \"sine\"\namplitude_m_s2 = 2.0\nfrequency_hz = 1.0",
        |t| 1e-3 * 2.0 / std::f64::consts::TAU * t,
    ),
    // What passes the mass by is a part of the force: ½ d a t²
    (
        "feedthrough",
        "[accelerometer]\nfeedthrough_ppm = { mean = 0.0, sd = 1000.0 }\n[excitation]\nkind = \"rectangle\"\namplitude_m_s2 = 2.0\nstart_s = 0.0\nlength_s = 100.0",
        |t| 0.5 * 1e-3 * 2.0 * t * t,
    ),
    // (1/6) g b t³; 1 °/h = 4.8481e-6 rad/s
    ("gyro bias", "[gyro]\nbias_deg_h = { mean = 0.0, sd = 10.0 }", |t| G * 4.848_136_8e-5 * t.powi(3) / 6.0),
    // g N t^2.5/√20; 1 °/√h = 2.9089e-4 rad/√s
    ("angle random walk", "[gyro]\nangle_random_walk_deg_rth = 0.5", |t| G * 1.454_441e-4 * t.powf(2.5) / 20f64.sqrt()),
    // g K t^3.5/√252; 1 °/h/√h = 8.0802e-8 rad/s/√s
    ("rate random walk", "[gyro]\nrate_random_walk_deg_h_rth = 100.0", |t| {
        G * 8.080_228e-6 * t.powf(3.5) / 252f64.sqrt()
    }),
    // ½ b t², the bias in m/s²
    ("accelerometer bias in m/s²", "[accelerometer]\nbias_m_s2 = { mean = 0.0, sd = 0.02 }", |t| 0.5 * 0.02 * t * t),
    // An axis that is m out of the horizontal plane reads g m: ½ g m t²
    ("accelerometer misalignment", "[accelerometer]\nmisalignment_mrad = { mean = 0.0, sd = 2.0 }", |t| {
        0.5 * G * 2e-3 * t * t
    }),
    // The same of a tilt δ: ½ g δ t²
    ("initial tilt", "[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 0.2", |t| 0.5 * G * 0.2f64.to_radians() * t * t),
    // A rate error k a under a constant force a: g k a t³/6; 1 °/h/g under 2 m/s² = 4.8481e-6 ×
    // 2/9.80665 rad/s
    (
        "gyro g-sensitivity",
        "[gyro]\ng_sensitivity_deg_h_g = { mean = 0.0, sd = 50.0 }\n[excitation]\nkind = \"rectangle\"\namplitude_m_s2 = 2.0\nstart_s = 0.0\nlength_s = 100.0",
        |t| G * 50.0 * 4.848_136_8e-6 * 2.0 / G * t.powi(3) / 6.0,
    ),
    // k a² instead: 1 °/h/g² under 2 m/s² = 4.8481e-6 × (2/9.80665)² rad/s
    (
        "gyro g²-sensitivity",
        "[gyro]\ng2_sensitivity_deg_h_g2 = { mean = 0.0, sd = 50.0 }\n[excitation]\nkind = \"rectangle\"\namplitude_m_s2 = 2.0\nstart_s = 0.0\nlength_s = 100.0",
        |t| G * 50.0 * 4.848_136_8e-6 * (2.0 / G).powi(2) * t.powi(3) / 6.0,
    ),
    // A bias that warms at 1 K/s by b′ per kelvin is a ramp: b′ t³/6
    (
        "accelerometer bias over temperature",
        "[accelerometer]\nbias_temperature_ug_k = { mean = 0.0, sd = 100.0 }\n[temperature]\nprofile_s_deg_c = [[0.0, 20.0], [20.0, 40.0]]",
        |t| 100e-6 * G * t.powi(3) / 6.0,
    ),
    // Of its square, (1 K/s · t)² c: c t⁴/12; of its cube, c t⁵/20
    (
        "accelerometer bias over temperature squared",
        "[accelerometer]\nbias_temperature_ug_k2 = { mean = 0.0, sd = 10.0 }\n[temperature]\nprofile_s_deg_c = [[0.0, 20.0], [20.0, 40.0]]",
        |t| 10e-6 * G * t.powi(4) / 12.0,
    ),
    (
        "accelerometer bias over temperature cubed",
        "[accelerometer]\nbias_temperature_ug_k3 = { mean = 0.0, sd = 1.0 }\n[temperature]\nprofile_s_deg_c = [[0.0, 20.0], [20.0, 40.0]]",
        |t| 1e-6 * G * t.powi(5) / 20.0,
    ),
    // 10 K above the reference at k per kelvin, under a constant 2 m/s²: ½ · 10 k · 2 t²
    (
        "scale factor over temperature",
        "[accelerometer]\nscale_temperature_ppm_k = { mean = 0.0, sd = 100.0 }\n[temperature]\nprofile_s_deg_c = [[0.0, 30.0]]\nreference_deg_c = 20.0\n[excitation]\nkind = \"rectangle\"\namplitude_m_s2 = 2.0\nstart_s = 0.0\nlength_s = 100.0",
        |t| 0.5 * 1e-3 * 2.0 * t * t,
    ),
    // The ramp of a gyro's rate: g b′ t⁴/24
    (
        "gyro bias over temperature",
        "[gyro]\nbias_temperature_deg_h_k = { mean = 0.0, sd = 10.0 }\n[temperature]\nprofile_s_deg_c = [[0.0, 20.0], [20.0, 40.0]]",
        |t| G * 4.848_136_8e-5 * t.powi(4) / 24.0,
    ),
    // Its square and its cube: g c t⁵/60 and g c t⁶/120
    (
        "gyro bias over temperature squared",
        "[gyro]\nbias_temperature_deg_h_k2 = { mean = 0.0, sd = 1.0 }\n[temperature]\nprofile_s_deg_c = [[0.0, 20.0], [20.0, 40.0]]",
        |t| G * 4.848_136_8e-6 * t.powi(5) / 60.0,
    ),
    (
        "gyro bias over temperature cubed",
        "[gyro]\nbias_temperature_deg_h_k3 = { mean = 0.0, sd = 0.1 }\n[temperature]\nprofile_s_deg_c = [[0.0, 20.0], [20.0, 40.0]]",
        |t| G * 4.848_136_8e-7 * t.powi(6) / 120.0,
    ),
    // σ τ² √(2T³/3 − T² + 2 − 2 (1 + T) e^(−T)), T = t/τ: ∬ p q e^(−|p−q|) dp dq
    (
        "accelerometer Gauss–Markov process",
        "[accelerometer]\ngauss_markov_ug = 100.0\ngauss_markov_time_s = 5.0",
        |t| {
            let x = t / 5.0;
            100e-6 * G * 25.0 * (x.powi(3) / 1.5 - x * x + 2.0 - 2.0 * (1.0 + x) * (-x).exp()).sqrt()
        },
    ),
    // g σ τ³ √(T⁵/10 − T⁴/4 + T³/3 − 2 + (T² + 2T + 2) e^(−T))
    ("gyro Gauss–Markov process", "[gyro]\ngauss_markov_deg_h = 20.0\ngauss_markov_time_s = 5.0", |t| {
        let x = t / 5.0;
        let square = x.powi(5) / 10.0 - x.powi(4) / 4.0 + x.powi(3) / 3.0 - 2.0 + (x * x + 2.0 * x + 2.0) * (-x).exp();
        G * 20.0 * 4.848_136_8e-6 * 125.0 * square.sqrt()
    }),
    // b τ² (T − 1 + e^(−T))
    ("accelerometer warm-up", "[accelerometer]\nwarm_up_mg = { mean = 0.0, sd = 2.0 }\nwarm_up_time_s = 5.0", |t| {
        2e-3 * G * 25.0 * (t / 5.0 - 1.0 + (-t / 5.0).exp())
    }),
    // g b τ³ (T²/2 − T + 1 − e^(−T))
    ("gyro warm-up", "[gyro]\nwarm_up_deg_h = { mean = 0.0, sd = 20.0 }\nwarm_up_time_s = 5.0", |t| {
        let x = t / 5.0;
        G * 20.0 * 4.848_136_8e-6 * 125.0 * (x * x / 2.0 - x + 1.0 - (-x).exp())
    }),
    // Any phase: A/(√2 ω²) |e^(iθ) − 1 − iθ|, θ = ωt
    ("accelerometer sinusoid", "[accelerometer]\nsinusoid_mg = 2.0\nsinusoid_hz = 0.11", |t| {
        let (omega, theta) = (std::f64::consts::TAU * 0.11, std::f64::consts::TAU * 0.11 * t);
        2e-3 * G * (theta.cos() - 1.0).hypot(theta.sin() - theta) / (2f64.sqrt() * omega * omega)
    }),
    // g A/(√2 ω³) |e^(iθ) − 1 − iθ + θ²/2|
    ("gyro sinusoid", "[gyro]\nsinusoid_deg_h = 20.0\nsinusoid_hz = 0.11", |t| {
        let (omega, theta) = (std::f64::consts::TAU * 0.11, std::f64::consts::TAU * 0.11 * t);
        let size = (theta.cos() - 1.0 + theta * theta / 2.0).hypot(theta.sin() - theta);
        G * 20.0 * 4.848_136_8e-6 * size / (2f64.sqrt() * omega.powi(3))
    }),
    // Rounding with noise well above half a step: white, q/√12 per sample at 100 Hz, beside the
    // noise itself.
    ("quantisation over noise", "[accelerometer]\nquantisation_mg = 5.0\nnoise_density_ug_rthz = 400.0", |t| {
        let (noise, rounding) = (400e-6 * G / 2f64.sqrt(), 5e-3 * G / 12f64.sqrt() / 10.0);
        (noise.powi(2) + rounding.powi(2)).sqrt() * t.powf(1.5) / 3f64.sqrt()
    }),
];

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all: Vec<Trial> = CASES
        .iter()
        .map(|case| {
            test(&format!("closed form: {} alone, 8192 members, on the CPU", case.0), move || alone(case, Choice::Cpu))
        })
        .collect();
    all.extend(CASES.iter().map(|case| {
        gpu_test(&format!("closed form: {} alone, 8192 members, on a GPU", case.0), move || alone(case, Choice::Gpu))
    }));
    all.push(test("closed form: bias instability follows the sum of its held processes", flicker));
    all.push(test("closed form: mixed sources add in variance", mixed));
    all.push(test("closed form: a drawn tilt is the tilt error, and a start of another kind has none", tilt));
    all.push(test("closed form: the paper's 0.034 m/s² is 1.7 m after 10 s", paper));
    all.push(test("error budget: the sources add up to the whole and each owns what its closed form says", budget));
    all.push(test("growth: a source alone grows by its power of time", growth));
    all.push(test("closed form: the check sees a law that is wrong", control));
    all
}

/// A study of these sections, with the report times.
pub fn study(sections: &str) -> Result<Study, Failed> {
    let head = format!(
        "members = 8192\nseed = 11\nduration_s = 20.0\n[report]\ntimes_s = {TIMES_S:?}\n[sensor]\nsample_rate_hz = 100.0\n"
    );
    Ok(study::parse("study.toml", &format!("{head}{sections}"), Path::new(""))?)
}

/// Its ensemble.
pub fn simulate(study: &Study, backend: Choice) -> Result<Statistics, Failed> {
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
    compare(&simulate(&study, backend)?, law)?;
    // The closed form that reports print is the same law.
    let expected = Expected::of(&study, &study.clock.report_samples).total(quantity::POSITION);
    for (time_s, moment) in TIMES_S.iter().zip(expected) {
        near("reported closed form over the law", moment.variance.sqrt() / law(*time_s), 1.0, 0.005)?;
    }
    Ok(())
}

/// Against `drift::expected` for all four quantities: there is no textbook law for a sum of held
/// processes.
fn against_expected(sections: &str, tolerance: f64) -> Result<(), Failed> {
    let study = study(sections)?;
    let statistics = simulate(&study, Choice::Cpu)?;
    let expected = Expected::of(&study, &study.clock.report_samples);
    for q in [quantity::POSITION, quantity::VELOCITY, quantity::ACCELERATION, quantity::TILT] {
        for ((at, moment), time_s) in statistics.at.iter().zip(expected.total(q)).zip(TIMES_S) {
            let theory = moment.variance.sqrt();
            if theory > 0.0 {
                let what = format!("{} after {time_s} s over its closed form", proofmass::statistics::QUANTITIES[q]);
                near(&what, at[q].sd / theory, 1.0, tolerance)?;
            }
        }
    }
    Ok(())
}

fn flicker() -> Result<(), Failed> {
    against_expected("[accelerometer]\nbias_instability_ug = 100.0", TOLERANCE)?;
    against_expected("[gyro]\nbias_instability_deg_h = 20.0", TOLERANCE)
}

fn mixed() -> Result<(), Failed> {
    against_expected(
        "[accelerometer]\nbias_mg = { min = -1.0, max = 1.0 }\nnoise_density_ug_rthz = 300.0\n\
         [gyro]\nbias_deg_h = { mean = 3.0, sd = 8.0 }\nangle_random_walk_deg_rth = 0.4",
        TOLERANCE,
    )
}

fn tilt() -> Result<(), Failed> {
    let drawn = "[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 0.5";
    against_expected(drawn, TOLERANCE)?;
    let statistics = simulate(&study(drawn)?, Choice::Cpu)?;
    near("sd of the tilt error, °", statistics.at[0][quantity::TILT].sd.to_degrees(), 0.5, TOLERANCE * 0.5)?;
    for (sections, words) in [
        ("[alignment]\nkind = \"drawn\"", "`alignment.tilt_sd_deg` is missing"),
        ("[alignment]\nkind = \"drawn\"\ntilt_sd_deg = -1.0", "need zero or more"),
        ("[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 1.0\nstill_s = 1.0", "does not belong to kind = \"drawn\""),
        ("[alignment]\nkind = \"ideal\"\ntilt_sd_deg = 1.0", "belongs to kind = \"drawn\""),
        ("[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 1.0\nheading_sd_deg = 1.0", "has no heading"),
    ] {
        let refused = study::parse("study.toml", &format!("members = 64\nduration_s = 1.0\n{sections}"), Path::new(""));
        let cause = refused.err().map(|e| e.cause).unwrap_or_default();
        check(cause.contains(words), format!("{sections}: {cause}"))?;
    }
    Ok(())
}

fn paper() -> Result<(), Failed> {
    // Section II.A of the paper: a linear acceleration error of 0.034 m/s² makes 1.7 m after 10 s.
    let bias_mg = 0.034 / G * 1e3;
    let statistics = simulate(&study(&format!("[accelerometer]\nbias_mg = {bias_mg}"))?, Choice::Cpu)?;
    let at_10_s = &statistics.at[1][quantity::POSITION];
    near("mean position error after 10 s", at_10_s.mean, 1.7, 1e-4)?;
    check(at_10_s.sd < 1e-6, format!("a fixed bias has no spread, got {:e}", at_10_s.sd))
}

fn answer(sections: &str) -> Result<Drift, Failed> {
    let options = Options { backend: Choice::Cpu, ..Options::default() };
    Ok(drift::answer(&study(sections)?, &options.control, |job, _| ensemble::run(job, &options))?)
}

fn budget() -> Result<(), Failed> {
    let drift = answer(
        "[accelerometer]\nbias_mg = { mean = 0.0, sd = 0.5 }\nnoise_density_ug_rthz = 300.0\nquantisation_mg = 1.0\n\
         [gyro]\nbias_deg_h = { mean = 0.0, sd = 8.0 }\nangle_random_walk_deg_rth = 0.4",
    )?;
    let last = drift.statistics.time_s.len() - 1;
    let whole = drift.statistics.at[last][quantity::POSITION].sd.powi(2);
    let sum: f64 = drift.budget.contributions.iter().map(|s| s.variance_m2[last]).sum();
    // Variances of 4096 and 8192 members scatter by 2.2 and 1.6 %.
    near("sum of the sources over the whole variance", sum / whole, 1.0, 0.1)?;
    let total = drift.expected.total(quantity::POSITION)[last].variance;
    for (source, rows) in &drift.expected.sources {
        let Some(contribution) = drift.budget.contributions.iter().find(|s| s.source == *source) else {
            return Err(format!("{} is not in the budget", source.name()).into());
        };
        let theory = rows[last][quantity::POSITION].variance / total;
        near(source.name(), drift.budget.fraction(contribution, last), theory, 0.05)?;
    }
    check(
        drift.budget.contributions[0].variance_m2[last] >= drift.budget.contributions[1].variance_m2[last],
        "not sorted",
    )
}

fn growth() -> Result<(), Failed> {
    let powers =
        [("velocity random walk", 1.5), ("accelerometer bias", 2.0), ("angle random walk", 2.5), ("gyro bias", 3.0)];
    for (name, exponent) in powers {
        let (_, sections, law) = *CASES.iter().find(|case| case.0 == name).ok_or("no such case")?;
        let growth = answer(sections)?.growth;
        let slope = growth.exponents[growth.exponents.len() - 1];
        near(&format!("{name}: local exponent at 20 s"), slope, exponent, 0.1)?;
        let powers = growth.fitted.iter().zip(EXPONENTS).map(|(a, p)| (a * 20f64.powf(p)).powi(2)).sum::<f64>();
        near(&format!("{name}: fitted powers at 20 s over the law"), powers.sqrt() / law(20.0), 1.0, TOLERANCE)?;
        let k = EXPONENTS.iter().position(|p| *p == exponent).ok_or("no such power")?;
        near(
            &format!("{name}: closed-form coefficient"),
            growth.expected[k] * 20f64.powf(exponent) / law(20.0),
            1.0,
            1e-3,
        )?;
    }
    Ok(())
}

fn control() -> Result<(), Failed> {
    // The classic mistake: the one-sided density taken for the random walk, a factor √2.
    let statistics = simulate(&study(CASES[1].1)?, Choice::Cpu)?;
    let wrong = compare(&statistics, |t| 2f64.sqrt() * (CASES[1].2)(t));
    check(wrong.is_err(), "a law that is √2 off passed")?;
    // Laws with a time of their own: a time that is a quarter off.
    for (name, time) in [
        ("accelerometer Gauss–Markov process", "time_s = 6.25"),
        ("gyro Gauss–Markov process", "time_s = 6.25"),
        ("accelerometer warm-up", "time_s = 6.25"),
        ("gyro warm-up", "time_s = 6.25"),
        ("accelerometer sinusoid", "sinusoid_hz = 0.1375"),
        ("gyro sinusoid", "sinusoid_hz = 0.1375"),
    ] {
        let (_, sections, law) = *CASES.iter().find(|case| case.0 == name).ok_or("no such case")?;
        let other = sections.replace("time_s = 5.0", time).replace("sinusoid_hz = 0.11", time);
        check(other != sections, "the control changes nothing")?;
        let wrong = compare(&simulate(&study(&other)?, Choice::Cpu)?, law);
        check(wrong.is_err(), format!("{name}: a time that is a quarter off passed"))?;
    }
    Ok(())
}
