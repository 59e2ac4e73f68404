//! Every noise term of the simulated reading obeys its law: the Allan deviation that IEEE 952 gives
//! for its coefficient.
//!
//! Root-mean Allan variance of 64 simulated sensors of 2¹⁶ samples: at averaging times up to 2¹⁰
//! samples they have some 4000 degrees of freedom together, a deviation known to 1.1 %; 5 % is more
//! than four standard errors.

use std::f64::consts::PI;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu;
use proofmass::control::Control;
use proofmass::kernel::cpu::lanes::LANES;
use proofmass::kernel::integrator::Integrator;
use proofmass::numerics::allan::Accumulator;
use proofmass::study;

use super::world::{check, near, test};

const SAMPLES: usize = 1 << 16;
const RATE_HZ: f64 = 100.0;
const TOLERANCE: f64 = 0.05;
const G: f64 = 9.80665;
/// °/h in rad/s.
const DEG_H: f64 = 4.848_136_811e-6;

/// Name, section of study.toml, whether it is the gyro's, Allan deviation at τ.
type Case = (&'static str, &'static str, bool, fn(f64) -> f64);

const CASES: &[Case] = &[
    // N/√τ with N = n/√2
    (
        "white accelerometer noise falls as τ^−1/2 at N = n/√2",
        "[accelerometer]\nnoise_density_ug_rthz = 100.0",
        false,
        |t| 100e-6 * G / 2f64.sqrt() / t.sqrt(),
    ),
    // 0.3 m/s/√h = 0.005 m/s/√s
    ("velocity random walk is N itself", "[accelerometer]\nvelocity_random_walk_m_s_rth = 0.3", false, |t| {
        0.005 / t.sqrt()
    }),
    // K√(τ/3), and for a walk that is held over samples of τ₀: K√(τ/3 (1 + τ₀²/2τ²)), by summing
    // its steps.
    (
        "acceleration random walk rises as τ^+1/2",
        "[accelerometer]\nacceleration_random_walk_ug_rts = 50.0",
        false,
        |t| 50e-6 * G * (t / 3.0 * held(t)).sqrt(),
    ),
    // √(2 ln 2/π) B
    (
        "accelerometer bias instability is flat at 0.664 B",
        "[accelerometer]\nbias_instability_ug = 100.0",
        false,
        |_| 0.664_281 * 100e-6 * G,
    ),
    // Rounding of a signal with noise well above a step: white with q²/12 per sample, beside the
    // noise.
    (
        "rounding under noise is white with q²/12",
        "[accelerometer]\nquantisation_mg = 10.0\nnoise_density_ug_rthz = 1000.0",
        false,
        |t| (((1000e-6 * G / 2f64.sqrt()).powi(2) + (10e-3 * G).powi(2) / 12.0 / RATE_HZ) / t).sqrt(),
    ),
    // 0.6 °/√h = 1.74533e-4 rad/√s
    ("angle random walk falls as τ^−1/2", "[gyro]\nangle_random_walk_deg_rth = 0.6", true, |t| {
        1.745_329e-4 / t.sqrt()
    }),
    ("gyro bias instability is flat at 0.664 B", "[gyro]\nbias_instability_deg_h = 20.0", true, |_| {
        0.664_281 * 20.0 * DEG_H
    }),
    // 60 °/h/√h = 60 × 4.848e-6/60 rad/s/√s
    ("rate random walk rises as τ^+1/2", "[gyro]\nrate_random_walk_deg_h_rth = 60.0", true, |t| {
        DEG_H * (t / 3.0 * held(t)).sqrt()
    }),
    // σ = 100 µg that forgets in 0.5 s
    (
        "a Gauss–Markov process has a hump at 1.89 times its memory",
        "[accelerometer]\ngauss_markov_ug = 100.0\ngauss_markov_time_s = 0.5",
        false,
        |t| 100e-6 * G * markov(t, 0.5),
    ),
    (
        "the gyro's Gauss–Markov process as well",
        "[gyro]\ngauss_markov_deg_h = 20.0\ngauss_markov_time_s = 2.0",
        true,
        |t| 20.0 * DEG_H * markov(t, 2.0),
    ),
    // A sin²(πfτ)/(πfτ) (IEEE 952), of a sine that is held over samples: over sin(πfτ₀)/(πfτ₀).
    ("a sinusoid is A sin²(πfτ)/(πfτ)", "[accelerometer]\nsinusoid_mg = 1.0\nsinusoid_hz = 0.7", false, |t| {
        let turn = |t: f64| PI * 0.7 * t;
        1e-3 * G * turn(t).sin().powi(2) / turn(t) * turn(1.0 / RATE_HZ) / turn(1.0 / RATE_HZ).sin()
    }),
];

/// Allan deviation of a Gauss–Markov sequence of deviation one: half the mean square of the
/// difference of two neighbouring means of m values whose covariance is φ^|i−j|, φ = e^(−τ₀/T), by
/// summing the covariances. For τ₀ ≪ T that is IEEE 952's curve.
fn markov(tau_s: f64, memory_s: f64) -> f64 {
    let (m, kept) = (tau_s * RATE_HZ, (-1.0 / (memory_s * RATE_HZ)).exp());
    let (lost, kept_m) = (1.0 - kept, kept.powf(m));
    let within = m * (1.0 + kept) / lost - 2.0 * kept * (1.0 - kept_m) / (lost * lost);
    let across = kept * (1.0 - kept_m).powi(2) / (lost * lost);
    (within - across).sqrt() / m
}

/// What holding a random walk over a sample adds to its Allan variance.
fn held(tau_s: f64) -> f64 {
    1.0 + 0.5 / (tau_s * RATE_HZ).powi(2)
}

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all: Vec<Trial> = CASES
        .iter()
        .map(|case| test(&format!("noise law: {}", case.0), move || obeys(case.1, case.2, case.3)))
        .collect();
    all.push(test("noise law: the check sees a one-sided density taken for N", || {
        let wrong = obeys(CASES[0].1, false, |t| 100e-6 * G / t.sqrt());
        check(wrong.is_err(), "a level that is √2 off passed")
    }));
    all.push(test("noise law: the check sees another memory of a Gauss–Markov process", || {
        let wrong = obeys(CASES[8].1, false, |t| 100e-6 * G * markov(t, 0.6));
        check(wrong.is_err(), "a memory that is a fifth off passed")
    }));
    all.push(test("noise law: the check sees another frequency of a sinusoid", || {
        let wrong = obeys(CASES[10].1, false, |t| {
            let turn = PI * 0.75 * t;
            1e-3 * G * turn.sin().powi(2) / turn
        });
        check(wrong.is_err(), "a frequency that is 7 % off passed")
    }));
    all.push(test("noise law: switching one term on does not change another", independent));
    all.push(test("noise law: terms of one reading are uncorrelated", uncorrelated));
    all
}

/// Samples of the first 64 members: accelerometer and gyro errors, member by member.
fn readings(sections: &str, samples: usize) -> Result<[Vec<Vec<f64>>; 2], Failed> {
    let duration_s = samples as f64 / RATE_HZ;
    let head =
        format!("members = {LANES}\nseed = 5\nduration_s = {duration_s}\n[sensor]\nsample_rate_hz = {RATE_HZ}\n");
    let study = study::parse("study.toml", &(head + sections), Path::new(""))?;
    let job = study.job(Integrator::Ideal, vec![study.clock.samples]);
    let mut both: [Vec<Vec<f64>>; 2] = std::array::from_fn(|_| vec![Vec::new(); LANES]);
    cpu::readings::<f64>(&job, 0, &Control::silent(), |seen| {
        for (series, lane) in both.iter_mut().zip([seen.accelerometer, seen.gyro]) {
            series.iter_mut().zip(&lane.0).for_each(|(member, value)| member.push(*value));
        }
    })?;
    Ok(both)
}

fn obeys(sections: &str, gyro: bool, law: impl Fn(f64) -> f64) -> Result<(), Failed> {
    let both = readings(sections, SAMPLES)?;
    let series = &both[usize::from(gyro)];
    check(series[0].len() == SAMPLES, format!("{} samples", series[0].len()))?;
    let curves: Vec<_> = series
        .iter()
        .map(|member| {
            let mut accumulator = Accumulator::new();
            member.iter().for_each(|v| accumulator.push(*v));
            accumulator.points(RATE_HZ)
        })
        .collect();
    for k in 0..curves[0].len() {
        let point = curves[0][k];
        if !point.on_octave() || point.factor > 1 << 10 {
            continue;
        }
        let variance = curves.iter().map(|c| c[k].variance).sum::<f64>() / LANES as f64;
        let what = format!("Allan deviation at {} s over its law", point.tau_s);
        near(&what, variance.sqrt() / law(point.tau_s), 1.0, TOLERANCE)?;
    }
    Ok(())
}

fn independent() -> Result<(), Failed> {
    let white = "[accelerometer]\nnoise_density_ug_rthz = 100.0\n";
    let [alone, _] = readings(white, 1000)?;
    let [with_gyro, _] = readings(&format!("{white}[gyro]\nangle_random_walk_deg_rth = 1.0\n"), 1000)?;
    check(alone == with_gyro, "the gyro's noise changed the accelerometer's")?;
    let walk = "acceleration_random_walk_ug_rts = 50.0\n";
    let [both, _] = readings(&format!("{white}{walk}"), 1000)?;
    let [walk_alone, _] = readings(&format!("[accelerometer]\n{walk}"), 1000)?;
    for ((a, b), sum) in alone.iter().zip(&walk_alone).zip(&both) {
        for k in 0..sum.len() {
            near("white + walk", a[k] + b[k], sum[k], 1e-12)?;
        }
    }
    Ok(())
}

fn uncorrelated() -> Result<(), Failed> {
    let samples = 4096;
    let [white, rate] =
        readings("[accelerometer]\nnoise_density_ug_rthz = 100.0\n[gyro]\nangle_random_walk_deg_rth = 1.0\n", samples)?;
    let correlation = |a: &[f64], b: &[f64]| {
        let (power_a, power_b): (f64, f64) = (a.iter().map(|x| x * x).sum(), b.iter().map(|x| x * x).sum());
        a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() / (power_a * power_b).sqrt()
    };
    // A correlation of independent series scatters by 1/√n; 65 of them stay below 5/√n but once in
    // 20,000 runs.
    let limit = 5.0 / (samples as f64).sqrt();
    for member in 0..LANES {
        let (a, b) = (&white[member], &rate[member]);
        check(correlation(a, b).abs() < limit, format!("accelerometer and gyro of member {member}"))?;
        let neighbour = &white[(member + 1) % LANES];
        check(correlation(a, neighbour).abs() < limit, format!("members {member} and the next"))?;
        check(
            correlation(&a[1..], &a[..samples - 1]).abs() < limit,
            format!("member {member} and itself a sample later"),
        )?;
    }
    check(correlation(&white[0], &white[0]) > 0.999, "the check cannot see correlation")
}
