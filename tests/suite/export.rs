//! Configurations for other tools hold what they say: each tool's own law, driven by the numbers of the exported file alone,
//! gives back the noise of `study`.
//!
//! Simulators: their generators, written anew from their documented laws, against `study`'s readings in Allan deviation, at
//! octaves from 1 to 1000 s. Estimators: the covariance of a step that they form, against N²Δt and K²Δt (IEEE 952).

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu;
use proofmass::control::Control;
use proofmass::export::imu::Imu;
use proofmass::export::{self, TARGETS};
use proofmass::kernel::cpu::lanes::LANES;
use proofmass::kernel::integrator::Integrator;
use proofmass::numerics::allan::Accumulator;
use proofmass::study;

use super::world::{check, near, program, test};

const RATE_HZ: f64 = 10.0;
const SAMPLES: usize = 1 << 17;
const G: f64 = 9.80665;
/// °/√h in rad/√s, °/h in rad/s.
const DEG_RTH: f64 = std::f64::consts::PI / 180.0 / 60.0;
const DEG_H: f64 = std::f64::consts::PI / 180.0 / 3600.0;
/// N of the accelerometer (0.3 m/s/√h) and of the gyro (0.6 °/√h), SI.
const WHITE: [f64; 2] = [0.005, 0.6 * DEG_RTH];
/// K of the accelerometer (100 µg/√s) and of the gyro (120 °/h/√h), SI.
const WALK: [f64; 2] = [100e-6 * G, 120.0 * DEG_H / 60.0];
const SENSOR: &str = "[sensor]\nsample_rate_hz = 10.0\n\
    [accelerometer]\nvelocity_random_walk_m_s_rth = 0.3\nacceleration_random_walk_ug_rts = 100.0\n\
    [gyro]\nangle_random_walk_deg_rth = 0.6\nrate_random_walk_deg_h_rth = 120.0\n";
const WHITE_SENSOR: &str = "[sensor]\nsample_rate_hz = 10.0\n\
    [accelerometer]\nvelocity_random_walk_m_s_rth = 0.3\n[gyro]\nangle_random_walk_deg_rth = 0.6\n";

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all: Vec<Trial> = GENERATORS
        .iter()
        .map(|(name, _)| test(&format!("export: {name} generates the study's noise"), move || generates(name, |t| t)))
        .collect();
    all.push(test("export: generators' check sees a density taken for N and a sample for a density", controls));
    all.push(test("export: estimators form the study's covariance per step", covariances));
    all.push(test("export: importing what was exported changes no digit", round_trip));
    all.push(test("export: axes that differ are kept apart where the tool has them, and come back", by_axis));
    all.push(test("export: each number has its unit, convention and source beside it", commented));
    all.push(test("export: what a tool cannot represent is said, with the error of what stands for it", said));
    all.push(test("export command: lists, writes, and refuses in sentences", command));
    all
}

fn exported(target: &str, sensor: &str) -> Result<String, Failed> {
    Ok(export::target(target)?.export(&Imu::parse("sensor.toml", sensor)?))
}

/// The nth number that is set for a key, in any of the syntaxes; comments do not count.
fn number(text: &str, key: &str, nth: usize) -> Result<f64, Failed> {
    let of = |line: &str| {
        let line = line.trim();
        let bare = !line.starts_with(['#', '%']) && !line.starts_with("<!--") && !line.starts_with("\"//");
        let at = line.find(key).filter(|_| bare)?;
        let before = line[..at].chars().next_back();
        let rest = &line[at + key.len()..];
        let whole = before.is_none_or(|c| !c.is_alphanumeric() && c != '_')
            && !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_');
        let digits = rest.trim_start_matches(|c: char| !c.is_ascii_digit() && c != '-' || c == '(');
        let end = digits.find(|c: char| !"0123456789.eE+-".contains(c)).unwrap_or(digits.len());
        whole.then(|| digits[..end].parse().ok()).flatten()
    };
    text.lines().filter_map(of).nth(nth).ok_or_else(|| format!("no {key} in\n{text}").into())
}

/// A generator of one axis: noise per sample (uniform or normal), and a bias that decays and is driven at each sample.
#[derive(Clone, Copy)]
struct Generator {
    rate_hz: f64,
    sigma: f64,
    uniform: bool,
    decay: f64,
    step: f64,
}

impl Generator {
    /// White noise of σ per sample at the study's rate, and a walk that steps by so much per sample.
    fn walk(sigma: f64, step: f64) -> Self {
        Self { rate_hz: RATE_HZ, sigma, uniform: false, decay: 1.0, step }
    }
}

/// The law of a tool: its exported text and 0 for the accelerometer or 1 for the gyro, to a generator.
type Law = fn(&str, usize) -> Result<Generator, Failed>;

const DT: f64 = 1.0 / RATE_HZ;

const GENERATORS: &[(&str, Law)] = &[
    // σ/√Δt per sample, σ_b√Δt per step of the bias.
    ("openvins", |text, gyro| {
        let name = ["accelerometer", "gyroscope"][gyro];
        let (n, k) =
            (number(text, &format!("{name}_noise_density"), 0)?, number(text, &format!("{name}_random_walk"), 0)?);
        Ok(Generator::walk(n / DT.sqrt(), k * DT.sqrt()))
    }),
    // stddev per sample; σ_d = √(−σ²τ/2 (e^(−2Δt/τ) − 1)), φ = e^(−Δt/τ). Angular velocity comes first, three axes each.
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
    // Uniform in ± amplitude at 1000 Hz: 0.01 m/s² + RND; 0.04 °/s and, drawn apart, RND at full throttle.
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

/// Averaging times, s, and Allan variances of several members, averaged; readings of a faster generator are averaged to the
/// study's rate.
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
            // Of an Allan deviation with T/τ − 1 differences a member; four standard errors beside the 5 %.
            let error = |samples: usize| tau_s * RATE_HZ / samples as f64;
            let spread = (0.5 * (error(samples) + error(LANES * SAMPLES))).sqrt();
            let what =
                format!("{name}, {}: Allan deviation at {tau_s} s over the study's", ["accelerometer", "gyro"][gyro]);
            near(&what, (got / expected).sqrt(), 1.0, 0.05 + 4.0 * spread)?;
        }
    }
    Ok(())
}

/// The text with each number of a key times a factor.
fn scaled(text: &str, keys: &[&str], factor: f64) -> String {
    let line = |line: &str| match keys.iter().find(|key| line.trim().starts_with(**key)) {
        Some(key) => match number(line, key.trim_start_matches(['<', '"']), 0) {
            Ok(value) => line.replacen(
                &format!("{value:.8e}").replace("e0", "e+00").replace("e-", "e-0"),
                &format!("{:e}", value * factor),
                1,
            ),
            Err(_) => line.to_owned(),
        },
        None => line.to_owned(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
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

/// Variance of velocity or angle, and of the bias, that a step adds.
type Step = fn(&str, usize) -> Result<[f64; 2], Failed>;

const ESTIMATORS: &[(&str, Step)] = &[
    // σ_d = σ/√Δt held for Δt; σ_b√Δt.
    ("kalibr", |text, gyro| {
        let name = ["accelerometer", "gyroscope"][gyro];
        let (n, k) =
            (number(text, &format!("{name}_noise_density"), 0)?, number(text, &format!("{name}_random_walk"), 0)?);
        Ok([(n / DT.sqrt() * DT).powi(2), k * k * DT])
    }),
    // V Q Vᵀ of midpoint integration: ½Δt for each of two samples, Δt for the bias.
    ("vins", |text, gyro| {
        let (n, w) = (number(text, ["acc_n", "gyr_n"][gyro], 0)?, number(text, ["acc_w", "gyr_w"][gyro], 0)?);
        Ok([2.0 * (0.5 * DT * n).powi(2), (w * DT).powi(2)])
    }),
    // GTSAM: a continuous covariance over Δt held for Δt; √Δt × BiasN.
    ("lio-sam", |text, gyro| {
        let (n, w) = (
            number(text, ["imuAccNoise", "imuGyrNoise"][gyro], 0)?,
            number(text, ["imuAccBiasN", "imuGyrBiasN"][gyro], 0)?,
        );
        Ok([n * n / DT * DT * DT, (DT.sqrt() * w).powi(2)])
    }),
    // cov Δt².
    ("fast-lio", |text, gyro| {
        let (n, w) =
            (number(text, ["acc_cov", "gyr_cov"][gyro], 0)?, number(text, ["b_acc_cov", "b_gyr_cov"][gyro], 0)?);
        Ok([n * DT * DT, w * DT * DT])
    }),
    // Noise × √f held for Δt; walk/√f.
    ("orb-slam3", |text, gyro| {
        let f = number(text, "IMU.Frequency", 0)?;
        let (n, w) = (
            number(text, ["IMU.NoiseAcc", "IMU.NoiseGyro"][gyro], 0)?,
            number(text, ["IMU.AccWalk", "IMU.GyroWalk"][gyro], 0)?,
        );
        Ok([(n * f.sqrt() * DT).powi(2), (w / f.sqrt()).powi(2)])
    }),
    // q Δt with q = N² and 2σ²/T; °/√h, m/s/√h, °/h, mGal, h.
    ("kf-gins", |text, gyro| {
        let corr_s = number(text, "corrtime", 0)? * 3600.0;
        let (n, sigma) = match gyro {
            0 => (number(text, "vrw", 0)? / 60.0, number(text, "abstd", 0)? * 1e-5),
            _ => (number(text, "arw", 0)? * DEG_RTH, number(text, "gbstd", 0)? * DEG_H),
        };
        Ok([n * n * DT, 2.0 * sigma * sigma / corr_s * DT])
    }),
];

fn covariances() -> Result<(), Failed> {
    for (name, step) in ESTIMATORS {
        let text = exported(name, SENSOR)?;
        for gyro in 0..2 {
            let [white, walk] = step(&text, gyro)?;
            // Nine printed digits, squared.
            near(&format!("{name}: white noise of a step"), white / (WHITE[gyro].powi(2) * DT), 1.0, 4e-8)?;
            near(&format!("{name}: random walk of a step"), walk / (WALK[gyro].powi(2) * DT), 1.0, 4e-8)?;
        }
    }
    // A density for N, and a sample for a density.
    for (name, keys, factor) in
        [("kalibr", ["accelerometer_noise_density"], 2f64.sqrt()), ("lio-sam", ["imuAccNoise"], RATE_HZ.sqrt())]
    {
        let text = scaled(&exported(name, SENSOR)?, &keys, factor);
        let step = ESTIMATORS.iter().find(|e| e.0 == name).ok_or("no such law")?.1;
        let ratio = step(&text, 0)?[0] / (WHITE[0].powi(2) * DT);
        check((ratio - factor * factor).abs() < 1e-6, format!("{name}: the control is blind: {ratio}"))?;
    }
    Ok(())
}

/// Lines that are no comments.
fn code(text: &str) -> Vec<&str> {
    let comment = |line: &&str| {
        ["#", "%", "<!--", "\"//"].iter().any(|c| line.trim().starts_with(c)) && !line.starts_with("%YAML")
    };
    text.lines().filter(|line| !comment(line)).collect()
}

fn round_trip() -> Result<(), Failed> {
    let biased =
        format!("{}bias_deg_h = 7.0\n", SENSOR.replace("[gyro]", "bias_mg = { mean = 1.5, sd = 0.25 }\n[gyro]"));
    let mut read_back = 0;
    for target in TARGETS.iter().filter(|t| t.imports()) {
        let first = target.export(&Imu::parse("sensor.toml", &biased)?);
        let sensor = target.import("configuration", &first)?.sensor_toml(target.name);
        let again = target.export(&Imu::parse("sensor.toml", &sensor)?);
        check(code(&first) == code(&again), format!("{}:\n{first}\n{sensor}\n{again}", target.name))?;
        let imu = Imu::parse("sensor.toml", &sensor)?;
        for (errors, sense) in [(imu.accelerometer, 0), (imu.gyro, 1)] {
            near("N read back", errors.white.mean / WHITE[sense], 1.0, 2e-8)?;
            near("K read back", errors.walk.mean / WALK[sense], 1.0, 2e-8)?;
        }
        read_back += 1;
    }
    check(read_back == 4, format!("{read_back} targets are read back"))?;
    let wrong = export::target("kalibr")?.import("imu.yaml", "update_rate: 10\naccelerometer_noise_densty: 1.0\n");
    let error = wrong.err().ok_or("a misspelt key was read")?;
    check(error.to_string().contains("accelerometer_noise_densty"), error.to_string())
}

/// Axes with N, 2 N and 3 N.
fn by_axis() -> Result<(), Failed> {
    let imu = Imu::parse("sensor.toml", WHITE_SENSOR)?;
    let times = |factor: f64| {
        let mut axis = [imu.accelerometer, imu.gyro];
        axis.iter_mut().for_each(|errors| errors.white.mean *= factor);
        axis
    };
    let apart = imu.clone().with_axes([times(1.0), times(2.0), times(3.0)]);
    // √((1 + 4 + 9)/3)
    near("rms over axes", apart.gyro.white.mean / imu.gyro.white.mean, (14f64 / 3.0).sqrt(), 1e-12)?;
    let sdf = export::target("gazebo-sdf")?.export(&apart);
    for (nth, factor) in [(0, 1.0), (1, 2.0), (2, 3.0)] {
        near("stddev of an axis", number(&sdf, "stddev", nth)?, factor * WHITE[1] * RATE_HZ.sqrt(), 1e-8)?;
    }
    let back = export::target("gazebo-sdf")?.import("imu.sdf", &sdf)?;
    for axis in 0..3 {
        for sense in 0..2 {
            let [found, given] = [&back, &apart].map(|imu| imu.axis(axis)[sense].white.mean);
            near("N of an axis, read back", found / given, 1.0, 2e-8)?;
        }
    }
    check(back.sensor_toml("gazebo-sdf").contains("# y alone:"), "the other axes are not said")?;
    for target in &TARGETS {
        let text = target.export(&apart);
        check(text.contains("x, y, z differ"), format!("{}: nothing is said of the axes\n{text}", target.name))?;
    }
    // Control: axes that are alike are one sensor.
    let alike = imu.clone().with_axes([times(1.0); 3]);
    check(alike.axes.is_none() && !export::target("kalibr")?.export(&alike).contains("differ"), "alike axes differ")
}

fn commented() -> Result<(), Failed> {
    for target in &TARGETS {
        let text = target.export(&Imu::parse("sensor.toml", SENSOR)?);
        let beside = text.lines().filter(|line| line.contains("; documented in ")).count();
        check(beside >= 4, format!("{}: {beside} numbers are explained\n{text}", target.name))?;
        check(text.contains("sensor.toml"), format!("{}: its source is not named", target.name))?;
    }
    let settings: serde_json::Value = serde_json::from_str(&exported("airsim", SENSOR)?)?;
    let imu = &settings["Vehicles"]["Drone1"]["Sensors"]["Imu"];
    near(
        "AirSim's white noise, mg/√Hz",
        imu["VelocityRandomWalk"].as_f64().unwrap_or(f64::NAN) * G / 1e3,
        WHITE[0],
        1e-9,
    )
}

fn said() -> Result<(), Failed> {
    let flicker = "[sensor]\nresonance_hz = 900.0\ndamping_ratio = 0.7\n[accelerometer]\nnoise_density_ug_rthz = 60.0\n\
                   bias_instability_ug = 40.0\nscale_factor_ppm = 300.0\n";
    for target in &TARGETS {
        let text = target.export(&Imu::parse("sensor.toml", flicker)?);
        for word in
            ["bias instability B = ", "Error of the Allan deviation: ", "scale_factor_ppm = 300", "resonance_hz"]
        {
            check(text.contains(word), format!("{}: {word} is not said\n{text}", target.name))?;
        }
    }
    let drawn = "[accelerometer]\nnoise_density_ug_rthz = { mean = 60.0, sd = 6.0 }\n";
    check(exported("kalibr", drawn)?.contains("sd 10 %"), "a drawn level is not said")?;
    check(Imu::parse("empty.toml", "[sensor]\nsample_rate_hz = 10.0\n").is_err(), "a sensor without noise was exported")
}

fn command() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("sensor.toml");
    std::fs::write(&path, SENSOR)?;
    let list = program().args(["export", "--list"]).output()?;
    check(String::from_utf8_lossy(&list.stdout).lines().count() == 14, "the list does not hold fourteen tools")?;
    let to = |target: &str, out: &str| {
        let mut command = program();
        command.current_dir(folder.path()).args(["export", "sensor.toml", "--to", target]);
        if !out.is_empty() {
            command.args(["--out", out]);
        }
        command.output()
    };
    let printed = to("kalibr", "")?;
    check(
        String::from_utf8_lossy(&printed.stdout) == exported("kalibr", SENSOR)?,
        "stdout is not the configuration alone",
    )?;
    let misspelt = to("kalib", "")?;
    let error = String::from_utf8_lossy(&misspelt.stderr).into_owned();
    check(misspelt.status.code() == Some(2) && error.contains("did you mean `kalibr`?"), error)?;
    for _ in 0..2 {
        check(to("kalibr", "imu.yaml")?.status.success(), "its own file is not replaced")?;
    }
    check(to("vins", "vins.yaml")?.status.success(), "a second file is not written")?;
    check(folder.path().join("imu.yaml").is_file(), "a second file takes the first one away")?;
    std::fs::write(folder.path().join("imu.yaml"), "mine")?;
    check(to("kalibr", "imu.yaml")?.status.code() == Some(2), "the user's file was replaced")?;
    check(std::fs::read_to_string(folder.path().join("imu.yaml"))? == "mine", "the user's file was replaced")?;
    // A log without scale: what to do is said. One with a scale: both steps at once.
    let log: String = (0..4096).map(|i| format!("{}\n", f64::from((i * 7919) % 1009) / 1009.0)).collect();
    std::fs::write(folder.path().join("log.csv"), format!("ax\n{log}"))?;
    let both = program()
        .current_dir(folder.path())
        .args(["allan", "log.csv", "--rate-hz", "10", "--accelerometer", "ax"])
        .args(["--to", "kalibr"])
        .output()?;
    let text = String::from_utf8_lossy(&both.stdout).into_owned();
    check(
        both.status.success() && number(&text, "accelerometer_noise_density", 0)? > 0.0,
        format!("{text}{}", String::from_utf8_lossy(&both.stderr)),
    )
}
