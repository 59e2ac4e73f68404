//! Configurations for other tools hold what they say: each tool's own law, driven by the numbers of
//! the exported file alone, gives back the noise of `study`.
//!
//! `generators`: simulators. `estimators`: filters. `messages`: covariances at a rate, behind a filter.
//! `imports`: configurations that others wrote.

mod estimators;
mod generators;
mod imports;
mod messages;

use libtest_mimic::{Failed, Trial};
use proofmass::export::imu::{Errors, Imu};
use proofmass::export::{self, TARGETS};

use super::world::{check, near, program, test};

const RATE_HZ: f64 = 10.0;
const DT: f64 = 1.0 / RATE_HZ;
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
    let mut all = generators::tests();
    all.extend(messages::tests());
    all.push(test("export: estimators form the study's covariance per step", estimators::covariances));
    all.push(test("export: importing what was exported changes no digit", round_trip));
    all.push(test("export: an import chooses nothing without a word", imports::made_by_others));
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
    by_axis_and_back()?;
    for target in &TARGETS {
        let text = target.export(&apart);
        check(text.contains("x, y, z differ"), format!("{}: nothing is said of the axes\n{text}", target.name))?;
    }
    // Control: axes that are alike are one sensor.
    let alike = imu.clone().with_axes([times(1.0); 3]);
    check(alike.axes.is_none() && !export::target("kalibr")?.export(&alike).contains("differ"), "alike axes differ")
}

/// What is given axis by axis, biases and a gyro's range among it, is exported, imported and
/// exported again without the change of a digit, where the tool has axes.
fn by_axis_and_back() -> Result<(), Failed> {
    let sensor = "[sensor]\nsample_rate_hz = 10.0\n\
        [accelerometer]\nvelocity_random_walk_m_s_rth = [0.3, 0.4, 0.55]\n\
        acceleration_random_walk_ug_rts = [100.0, 0.0, 70.0]\nbias_mg = [1.5, -2.0, 0.25]\n\
        [gyro]\nangle_random_walk_deg_rth = 0.6\nrate_random_walk_deg_h_rth = [120.0, 90.0, 80.0]\n\
        bias_deg_h = [7.0, 0.0, -3.0]\n";
    for (target, more) in [("gazebo-sdf", ""), ("matlab", "range_deg_s = 450.0\n")] {
        let given = format!("{sensor}{more}");
        let first = exported(target, &given)?;
        let back = export::target(target)?.import("configuration", &first)?.sensor_toml(target);
        let again = exported(target, &back)?;
        check(code(&first) == code(&again), format!("{target}:\n{first}\n{back}\n{again}"))?;
        let (imu, read) = (Imu::parse("sensor.toml", &given)?, Imu::parse("sensor.toml", &back)?);
        for axis in 0..3 {
            for sense in 0..2 {
                let [given, read] = [&imu, &read].map(|imu| imu.axis(axis)[sense]);
                for of in [|e: &Errors| e.white.mean, |e: &Errors| e.walk.mean, |e: &Errors| e.bias.mean] {
                    near("a number of an axis, read back", of(&read), of(&given), 2e-8 * of(&given).abs())?;
                }
                check(
                    target != "matlab" || given.range == read.range || (given.range / read.range - 1.0).abs() < 1e-8,
                    "range",
                )?;
            }
        }
        // Control: axes that are exchanged are another configuration.
        let exchanged = exported(target, &given.replace("[0.3, 0.4, 0.55]", "[0.4, 0.3, 0.55]"))?;
        check(code(&first) != code(&exchanged), format!("{target}: x and y exchanged change nothing"))?;
    }
    // 1.5, −2 and 0.25 mg, each on its own axis, and not their mean, −0.83 mg.
    let sitl = exported("ardupilot-sitl", sensor)?;
    for (axis, mg) in [("X", 1.5), ("Y", -2.0), ("Z", 0.25)] {
        let key = format!("SIM_ACC1_BIAS_{axis} ");
        let value =
            sitl.lines().find_map(|line| line.strip_prefix(&key)?.split_whitespace().next()?.parse::<f64>().ok());
        near(&key, value.ok_or(key.clone())?, mg * 9.80665e-3, 1e-8)?;
    }
    // A row of two is no three axes.
    let matlab = exported("matlab", sensor)?;
    let two = matlab.replace("accelerometer.ConstantBias = [", "accelerometer.ConstantBias = [1 2];%");
    let refused = export::target("matlab")?.import("configuration", &two).err().map(|e| e.to_string());
    check(refused.is_some_and(|said| said.contains("ConstantBias")), "two numbers pass for three")
}

fn commented() -> Result<(), Failed> {
    for target in &TARGETS {
        let text = target.export(&Imu::parse("sensor.toml", SENSOR)?);
        let beside = text.lines().filter(|line| line.contains("; documented in ")).count();
        // Three matrices are all that a message of ROS has.
        let least = if text.contains("orientation_covariance") { 3 } else { 4 };
        check(beside >= least, format!("{}: {beside} numbers are explained\n{text}", target.name))?;
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
    let biased = "[accelerometer]\nnoise_density_ug_rthz = 60.0\nbias_mg = { mean = 0.0, sd = 5.0 }\n";
    let text = exported("kalibr", biased)?;
    check(text.contains("bias_mg = 0 (sd 5.00) mg"), format!("the spread of a bias is not said\n{text}"))?;
    check(Imu::parse("empty.toml", "[sensor]\nsample_rate_hz = 10.0\n").is_err(), "a sensor without noise was exported")
}

fn command() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("sensor.toml");
    std::fs::write(&path, SENSOR)?;
    let list = program().args(["export", "--list"]).output()?;
    check(String::from_utf8_lossy(&list.stdout).lines().count() == TARGETS.len(), "the list does not hold every tool")?;
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
