//! Simulators: their generators, written anew from their documented laws, against `study`'s
//! readings in Allan deviation, at octaves from 1 to 1000 s.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu;
use proofmass::control::Control;
use proofmass::kernel::cpu::lanes::LANES;
use proofmass::kernel::integrator::Integrator;
use proofmass::numerics::allan::Accumulator;
use proofmass::study;

use super::super::world::{check, near, test};
use super::{DEG_H, DEG_RTH, DT, G, RATE_HZ, SENSOR, WHITE_SENSOR, exported, number, scaled};

const SAMPLES: usize = 1 << 17;

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all: Vec<Trial> = GENERATORS
        .iter()
        .map(|(name, _)| test(&format!("export: {name} generates the study's noise"), move || generates(name, |t| t)))
        .collect();
    all.push(test("export: generators' check sees a density taken for N and a sample for a density", controls));
    all
}

/// A generator of one axis: noise per sample (uniform or normal), and a bias that decays and is
/// driven at each sample.
#[derive(Clone, Copy)]
struct Generator {
    rate_hz: f64,
    sigma: f64,
    uniform: bool,
    decay: f64,
    step: f64,
}

impl Generator {
    /// White noise of σ per sample at the study's rate, and a walk that steps by so much per
    /// sample.
    fn walk(sigma: f64, step: f64) -> Self {
        Self { rate_hz: RATE_HZ, sigma, uniform: false, decay: 1.0, step }
    }
}

/// The law of a tool: its exported text and 0 for the accelerometer or 1 for the gyro, to a
/// generator.
type Law = fn(&str, usize) -> Result<Generator, Failed>;

const GENERATORS: &[(&str, Law)] = &[
    // σ/√Δt per sample, σ_b√Δt per step of the bias.
    ("openvins", |text, gyro| {
        let name = ["accelerometer", "gyroscope"][gyro];
        let (n, k) =
            (number(text, &format!("{name}_noise_density"), 0)?, number(text, &format!("{name}_random_walk"), 0)?);
        Ok(Generator::walk(n / DT.sqrt(), k * DT.sqrt()))
    }),
    // stddev per sample; σ_d = √(−σ²τ/2 (e^(−2Δt/τ) − 1)), φ = e^(−Δt/τ). Angular velocity comes
    // first, three axes each.
    ("gazebo-sdf", |text, gyro| {
        let of = |key| number(text, key, [3, 0][gyro]);
        let (sigma, drive, tau) = (of("stddev")?, of("dynamic_bias_stddev")?, of("dynamic_bias_correlation_time")?);
        let step = (-drive * drive * tau / 2.0 * (-2.0 * DT / tau).exp_m1()).sqrt();
        Ok(Generator { decay: (-DT / tau).exp(), ..Generator::walk(sigma, step) })
    }),
    // The same with a density for the white noise.
    ("px4", |text, gyro| {
        let name = ["accelerometer", "gyroscope"][gyro];
        let of = |key: &str| number(text, &format!("{name}{key}"), 0);
        let (n, drive, tau) = (of("NoiseDensity")?, of("RandomWalk")?, of("BiasCorrelationTime")?);
        let step = (-drive * drive * tau / 2.0 * ((-2.0 * DT / tau).exp() - 1.0)).sqrt();
        Ok(Generator { decay: (-DT / tau).exp(), ..Generator::walk(n / DT.sqrt(), step) })
    }),
    // Uniform in ± amplitude at 1000 Hz: 0.01 m/s² + RND; 0.04 °/s and, drawn apart, RND at full
    // throttle.
    ("ardupilot-sitl", |text, gyro| {
        let degree = std::f64::consts::PI / 180.0;
        let amplitude = match gyro {
            0 => 0.01 + number(text, "SIM_ACC1_RND", 0)?,
            _ => (0.04f64.powi(2) + number(text, "SIM_GYR1_RND", 0)?.powi(2)).sqrt() * degree,
        };
        Ok(Generator { rate_hz: 1000.0, uniform: true, ..Generator::walk(amplitude / 3f64.sqrt(), 0.0) })
    }),
    // arw in °/√h or vrw in mg (both /√Δt), bias walking by stability/√τ × √Δt.
    ("airsim", |text, gyro| {
        let (n, stability, tau) = match gyro {
            0 => (
                number(text, "VelocityRandomWalk", 0)? * G / 1e3,
                number(text, "AccelBiasStability", 0)? * 1e-6 * G,
                number(text, "AccelBiasStabilityTau", 0)?,
            ),
            _ => (
                number(text, "AngularRandomWalk", 0)? * DEG_RTH,
                number(text, "GyroBiasStability", 0)? * DEG_H,
                number(text, "GyroBiasStabilityTau", 0)?,
            ),
        };
        Ok(Generator::walk(n / DT.sqrt(), stability / tau.sqrt() * DT.sqrt()))
    }),
    // std per update; nothing that moves.
    ("isaac-lab", |text, gyro| {
        Ok(Generator::walk(number(text, ["accelerometer_std", "gyroscope_std"][gyro], 0)?, 0.0))
    }),
    // Two-sided: NoiseDensity × √SampleRate per sample, RandomWalk/√SampleRate per step.
    ("matlab", |text, gyro| {
        check(text.matches("NoiseType = \"double-sided\";").count() == 2, "the convention is not set")?;
        let name = ["accelerometer", "gyroscope"][gyro];
        let of = |key: &str| number(text, &format!("{name}.{key}"), 0);
        Ok(Generator::walk(of("NoiseDensity")? * RATE_HZ.sqrt(), of("RandomWalk")? / RATE_HZ.sqrt()))
    }),
    // N/√Δt; a = 1 − Δt/τ, b = σ√(1 − e^(−2Δt/τ)).
    ("gnss-ins-sim", |text, gyro| {
        let (n, sigma, tau) = match gyro {
            0 => (
                number(text, "accel_vrw", 0)? / 60.0,
                number(text, "accel_b_stability", 0)?,
                number(text, "accel_b_corr", 0)?,
            ),
            _ => (
                number(text, "gyro_arw", 0)? * DEG_RTH,
                number(text, "gyro_b_stability", 0)? * DEG_H,
                number(text, "gyro_b_corr", 0)?,
            ),
        };
        let step = sigma * (1.0 - (-2.0 * DT / tau).exp()).sqrt();
        Ok(Generator { decay: 1.0 - DT / tau, ..Generator::walk(n / DT.sqrt(), step) })
    }),
];

/// SplitMix64 (Steele, Lea, Flood 2014): nothing of the program's own.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (2.0 * std::f64::consts::PI * self.uniform()).cos()
    }
}

/// Averaging times, s, and Allan variances of several members, averaged; readings of a faster
/// generator are averaged to the study's rate.
fn curve(members: usize, mut member: impl FnMut(usize, &mut dyn FnMut(f64))) -> Vec<(f64, f64)> {
    let mut sums: Vec<(f64, f64)> = Vec::new();
    for m in 0..members {
        let mut accumulator = Accumulator::new();
        member(m, &mut |v| accumulator.push(v));
        let points = accumulator.points(RATE_HZ);
        let points = points.iter().filter(|p| p.on_octave() && (1.0..=1000.0).contains(&p.tau_s));
        let points: Vec<(f64, f64)> = points.map(|p| (p.tau_s, p.variance)).collect();
        sums.resize(points.len(), (0.0, 0.0));
        sums.iter_mut().zip(points).for_each(|(s, p)| *s = (p.0, s.1 + p.1 / members as f64));
    }
    sums
}

fn generated(generator: Generator, seed: u64) -> (usize, Vec<(f64, f64)>) {
    let block = (generator.rate_hz / RATE_HZ).round() as usize;
    let (members, samples) = if block > 1 { (8, SAMPLES / 4) } else { (64, SAMPLES) };
    let mut random = Random(seed);
    let curve = curve(members, |_, push| {
        let mut bias = 0.0;
        for _ in 0..samples {
            let mut sum = 0.0;
            for _ in 0..block {
                let unit =
                    if generator.uniform { (2.0 * random.uniform() - 1.0) * 3f64.sqrt() } else { random.normal() };
                sum += bias + generator.sigma * unit;
                if generator.step > 0.0 {
                    bias = generator.decay * bias + generator.step * random.normal();
                }
            }
            push(sum / block as f64);
        }
    });
    (members * samples, curve)
}

/// Allan variances of the study's accelerometer and gyro.
fn simulated(sensor: &str) -> Result<[Vec<(f64, f64)>; 2], Failed> {
    let head = format!("members = {LANES}\nseed = 9\nduration_s = {:?}\n", SAMPLES as f64 / RATE_HZ);
    let study = study::parse("study.toml", &(head + sensor), Path::new(""))?;
    let job = study.job(Integrator::Ideal, vec![study.clock.samples]);
    let mut both: [Vec<Vec<f64>>; 2] = std::array::from_fn(|_| vec![Vec::new(); LANES]);
    cpu::readings::<f64>(&job, 0, &Control::silent(), |seen| {
        for (series, lane) in both.iter_mut().zip([seen.accelerometer, seen.gyro]) {
            series.iter_mut().zip(&lane.0).for_each(|(member, value)| member.push(*value));
        }
    })?;
    Ok(both.map(|series| curve(LANES, |m, push| series[m].iter().for_each(|v| push(*v)))))
}

/// The generator of a target agrees with `study` where `change` has been made to its text.
fn generates(name: &str, change: fn(String) -> String) -> Result<(), Failed> {
    let still = ["isaac-lab", "ardupilot-sitl"].contains(&name);
    let sensor = if still { WHITE_SENSOR } else { SENSOR };
    let law = GENERATORS.iter().find(|g| g.0 == name).ok_or("no such law")?.1;
    let text = change(exported(name, sensor)?);
    let study = simulated(sensor)?;
    for (gyro, simulated) in study.iter().enumerate() {
        let (samples, curve) = generated(law(&text, gyro)?, 77 + gyro as u64);
        check(curve.len() == simulated.len() && curve.len() >= 8, format!("{} averaging times", curve.len()))?;
        for ((tau_s, got), (_, expected)) in curve.iter().zip(simulated) {
            // Of an Allan deviation with T/τ − 1 differences a member; four standard errors beside
            // the 5 %.
            let error = |samples: usize| tau_s * RATE_HZ / samples as f64;
            let spread = (0.5 * (error(samples) + error(LANES * SAMPLES))).sqrt();
            let what =
                format!("{name}, {}: Allan deviation at {tau_s} s over the study's", ["accelerometer", "gyro"][gyro]);
            near(&what, (got / expected).sqrt(), 1.0, 0.05 + 4.0 * spread)?;
        }
    }
    Ok(())
}

fn controls() -> Result<(), Failed> {
    let fails = |name, change: fn(String) -> String| {
        let changed = change(exported(name, SENSOR)?);
        check(changed != exported(name, SENSOR)?, format!("{name}: nothing was changed"))?;
        check(generates(name, change).is_err(), format!("{name}: a wrong convention passed"))
    };
    // One-sided densities n = √2 N.
    fails("openvins", |t| scaled(&t, &["accelerometer_noise_density", "gyroscope_noise_density"], 2f64.sqrt()))?;
    fails("px4", |t| scaled(&t, &["<accelerometerNoiseDensity", "<gyroscopeNoiseDensity"], 2f64.sqrt()))?;
    // A density where a sample's σ is wanted, and the other way round.
    fails("gazebo-sdf", |t| scaled(&t, &["<stddev"], 1.0 / RATE_HZ.sqrt()))?;
    fails("openvins", |t| scaled(&t, &["accelerometer_noise_density", "gyroscope_noise_density"], RATE_HZ.sqrt()))
}
