//! Covariances of messages and of filters that take them: the exported numbers alone, in each tool's
//! law, against the readings of `study`, filtered here, and against closed forms.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu;
use proofmass::control::Control;
use proofmass::export::filter::Filter;
use proofmass::export::imu::Imu;
use proofmass::export::{self, TARGETS};
use proofmass::kernel::cpu::lanes::LANES;
use proofmass::kernel::integrator::Integrator;
use proofmass::study;

use super::super::world::{check, data_test, near, program, test};
use super::{DEG_RTH, SENSOR, WALK, WHITE, WHITE_SENSOR, number};

/// Messages per second, and how many a run has.
const RATE_HZ: f64 = 100.0;
const MESSAGES: usize = 2000;
/// Cut-off of the low-pass, Hz, and readings of the sensor for each message behind it.
const CUTOFF_HZ: f64 = 20.0;
const READINGS: usize = 10;
/// Messages that are summed.
const SUMMED: usize = 50;
const KEYS: [&str; 2] = ["linear_acceleration_covariance", "angular_velocity_covariance"];

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("export: a message's covariance is that of the study's noise, filtered or not", one_message),
        test("export: independent messages' covariance is that of sums of the study's", sums),
        test("export: gtsam sums to the closed forms over any time", gtsam),
        test("export: ekf2 forms the study's covariance at its own step", ekf2),
        test("export: a noise that is not stated is left out and said, never zero", left_out),
        test("export: rates and filters that cannot be are refused in sentences", refused),
        data_test("export: half a still recording gives the covariance of sums in its other half", recorded),
    ]
}

fn sent(target: &str, sensor: &str, rate_hz: Option<f64>, filter: Filter) -> Result<String, Failed> {
    let target = export::target(target)?;
    Ok(target.export(&Imu::parse("sensor.toml", sensor)?.sent(target, rate_hz, filter)?))
}

/// The nine numbers of a key.
fn matrix(text: &str, key: &str) -> Result<Vec<f64>, Failed> {
    let row = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(": [")?.strip_suffix(']'));
    let numbers: Vec<f64> =
        row.ok_or(format!("no {key} in\n{text}"))?.split(", ").map(str::parse).collect::<Result<_, _>>()?;
    check(numbers.len() == 9, format!("{key}: {} numbers", numbers.len()))?;
    Ok(numbers)
}

/// Messages of the accelerometers and gyros of two ensembles: each of `study`'s readings, or behind
/// a low-pass one of each [`READINGS`] of them.
fn messages(filtered: bool) -> Result<[Vec<Vec<f64>>; 2], Failed> {
    let readings = if filtered { READINGS } else { 1 };
    let rate_hz = RATE_HZ * readings as f64;
    let sensor = WHITE_SENSOR.replace("sample_rate_hz = 10.0", &format!("sample_rate_hz = {rate_hz:?}"));
    // A pole at a reading's interval; it has settled after a tenth of a second, twelve time constants.
    let kept = (-2.0 * std::f64::consts::PI * CUTOFF_HZ / rate_hz).exp();
    let settled = if filtered { (0.1 * rate_hz) as usize } else { 0 };
    let seconds = (MESSAGES * readings + settled) as f64 / rate_hz;
    let mut both: [Vec<Vec<f64>>; 2] = Default::default();
    for seed in [3, 4] {
        let head = format!("members = {LANES}\nseed = {seed}\nduration_s = {seconds:?}\n");
        let study = study::parse("study.toml", &(head + &sensor), Path::new(""))?;
        let job = study.job(Integrator::Ideal, vec![study.clock.samples]);
        let mut series: [Vec<Vec<f64>>; 2] = std::array::from_fn(|_| vec![Vec::new(); LANES]);
        let (mut passed, mut count) = ([[0.0; LANES]; 2], 0);
        cpu::readings::<f64>(&job, 0, &Control::silent(), |seen| {
            count += 1;
            for (sense, lane) in [seen.accelerometer, seen.gyro].into_iter().enumerate() {
                for (member, value) in lane.0.iter().enumerate() {
                    let passed = &mut passed[sense][member];
                    *passed = if filtered { kept * *passed + (1.0 - kept) * value } else { *value };
                    if count > settled && (count - settled).is_multiple_of(readings) {
                        series[sense][member].push(*passed);
                    }
                }
            }
        })?;
        both.iter_mut().zip(series).for_each(|(all, more)| all.extend(more));
    }
    check(both.iter().flatten().all(|run| run.len() == MESSAGES), "messages are missing")?;
    Ok(both)
}

/// Computes the mean of e²/variance over runs, where e is the sum of `summed` successive messages.
fn consistency(runs: &[Vec<f64>], summed: usize, variance: f64) -> f64 {
    let squares = runs.iter().flat_map(|run| run.chunks_exact(summed)).map(|sum| sum.iter().sum::<f64>().powi(2));
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    sum / count / (summed as f64 * variance)
}

/// The variance that a target exports for the messages of `study`, by its matrix.
fn exported(target: &str, sense: usize, filtered: bool) -> Result<f64, Failed> {
    let filter = if filtered { Filter::LowPass(CUTOFF_HZ) } else { Filter::Mean };
    let text = sent(target, WHITE_SENSOR, Some(RATE_HZ), filter)?;
    let [x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z] = matrix(&text, KEYS[sense])?[..] else {
        return Err(format!("not diagonal:\n{text}").into());
    };
    check(x == y && x == z, format!("x, y and z differ:\n{text}"))?;
    check(matrix(&text, "orientation_covariance")?[0] == -1.0, "orientation is not unknown")?;
    Ok(x)
}

fn one_message() -> Result<(), Failed> {
    for filtered in [false, true] {
        for (sense, runs) in messages(filtered)?.iter().enumerate() {
            // 128 runs of 2000 messages, correlated by at most 0.28: four standard errors are 1.2 %.
            // A pole held over a reading passes tanh(x)/x of one in continuous time, x = π 20/1000.
            let found = |factor: f64| {
                Ok::<_, Failed>(consistency(runs, 1, factor * exported("ros-covariance", sense, filtered)?))
            };
            near(&format!("{}, filtered: {filtered}: e²/variance", KEYS[sense]), found(1.0)?, 1.0, 0.014)?;
            for wrong in [2.0, 0.5, RATE_HZ, 1.0 / RATE_HZ] {
                check((found(wrong)? - 1.0).abs() > 0.4, "the control is blind")?;
            }
        }
    }
    Ok(())
}

fn sums() -> Result<(), Failed> {
    for filtered in [false, true] {
        for (sense, runs) in messages(filtered)?.iter().enumerate() {
            // 5120 sums: four standard errors are 8 %; the ends of a sum of 50 take 1.2 %.
            let found = |target| Ok::<_, Failed>(consistency(runs, SUMMED, exported(target, sense, filtered)?));
            near("e²/variance of a sum", found("robot-localization")?, 1.0, 0.1)?;
            // Control: the covariance of one message makes a filter sure of a sum by 1.8 times.
            let sure = found("ros-covariance")?;
            check((sure > 1.5) == filtered, format!("filtered: {filtered}: {sure}"))?;
        }
    }
    Ok(())
}

/// Computes the variances of position and velocity, and their covariance, after `steps` steps of GTSAM's
/// `integrateMeasurement` at rest (4.2 and later), along one axis.
fn preintegrated(white: f64, integration: f64, dt: f64, steps: usize) -> [f64; 3] {
    (0..steps).fold([0.0; 3], |[p, v, pv], _| {
        let held = white / dt;
        [
            p + 2.0 * dt * pv + dt * dt * v + (0.5 * dt * dt).powi(2) * held + integration * dt,
            v + dt * dt * held,
            pv + dt * v + 0.5 * dt * dt * dt * held,
        ]
    })
}

fn gtsam() -> Result<(), Failed> {
    let text = sent("gtsam", SENSOR, Some(RATE_HZ), Filter::Mean)?;
    let of = |key: &str| number(&text, &format!("params.set{key}"), 0);
    let (acceleration, integration) = (of("AccelerometerCovariance")?, of("IntegrationCovariance")?);
    let dt = 1.0 / RATE_HZ;
    for steps in [1, 2, 500] {
        let [t, n2] = [steps as f64 * dt, WHITE[0].powi(2)];
        let closed = [n2 * t.powi(3) / 3.0, n2 * t, n2 * t * t / 2.0];
        let sum = preintegrated(acceleration, integration, dt, steps);
        for (sum, closed) in sum.iter().zip(closed) {
            // Nine printed digits, squared.
            near(&format!("{steps} steps over N²T³/3, N²T, N²T²/2"), sum / closed, 1.0, 4e-8)?;
        }
        // Controls: nothing for the integration, the variance of a message for the density.
        let without = preintegrated(acceleration, 0.0, dt, steps)[0] / closed[0];
        let missing = 0.25 / (steps as f64).powi(2);
        check((1.0 - without - missing).abs() < 1e-6, format!("{steps} steps without integration: {without}"))?;
        let message = preintegrated(acceleration * RATE_HZ, integration, dt, steps)[1] / closed[1];
        check((message - RATE_HZ).abs() < 1e-4, "the control is blind")?;
    }
    for (key, n) in
        [("GyroscopeCovariance", WHITE[1]), ("BiasOmegaCovariance", WALK[1]), ("BiasAccCovariance", WALK[0])]
    {
        near(key, of(key)? / (n * n), 1.0, 4e-8)?;
    }
    // A narrow filter leaves the density; what a wide one folds in is in the messages: x coth x.
    for (cutoff_hz, folded) in [(1.0, 1.0), (100.0, std::f64::consts::PI / std::f64::consts::PI.tanh())] {
        let text = sent("gtsam", SENSOR, Some(RATE_HZ), Filter::LowPass(cutoff_hz))?;
        let seen = number(&text, "params.setGyroscopeCovariance", 0)? / WHITE[1].powi(2);
        near("N² behind a filter", seen / folded, 1.0, 4e-4)?;
    }
    Ok(())
}

fn ekf2() -> Result<(), Failed> {
    // As many whole messages as come nearest to 10 ms.
    for (rate_hz, step_s) in [(400.0, 0.01), (160.0, 0.0125), (30.0, 1.0 / 30.0)] {
        let text = sent("ekf2", SENSOR, Some(rate_hz), Filter::Mean)?;
        for (sense, name) in ["ACC", "GYR"].into_iter().enumerate() {
            let [noise, walk] =
                [number(&text, &format!("EKF2_{name}_NOISE"), 0)?, number(&text, &format!("EKF2_{name}_B_NOISE"), 0)?];
            near("N² step", (noise * step_s).powi(2) / (WHITE[sense].powi(2) * step_s), 1.0, 4e-8)?;
            near("K² step", (walk * step_s).powi(2) / (WALK[sense].powi(2) * step_s), 1.0, 4e-8)?;
            // Control: σ of a message at the IMU's rate, where that is not the step's.
            let message = WHITE[sense] * rate_hz.sqrt();
            check(((message / noise).powi(2) - 1.0).abs() > 0.2 || rate_hz < 100.0, "the control is blind")?;
        }
    }
    let columns = sent("ekf2", SENSOR, None, Filter::Mean)?;
    let rows: Vec<Vec<&str>> =
        columns.lines().filter(|l| !l.starts_with('#')).map(|l| l.split('\t').collect()).collect();
    check(
        rows.len() == 4 && rows.iter().all(|r| r.len() == 5 && r[4] == "9"),
        format!("no columns of QGroundControl:\n{columns}"),
    )
}

fn left_out() -> Result<(), Failed> {
    let gyro = "[sensor]\nsample_rate_hz = 100.0\n[gyro]\nangle_random_walk_deg_rth = 0.6\n";
    for target in TARGETS.iter().filter(|t| t.messages) {
        let text = sent(target.name, gyro, None, Filter::Mean)?;
        check(
            text.contains("is left out: the sensor file states no white noise of the accelerometer"),
            format!("{}:\n{text}", target.name),
        )?;
        let set = |line: &str| {
            ["linear_acceleration", "setAccelerometer", "setIntegration", "EKF2_ACC", "params.setBias", "_B_"]
                .iter()
                .any(|key| line.contains(key))
        };
        let numbers = text.lines().filter(|line| !line.starts_with('#') && set(line)).count();
        check(numbers == 0, format!("{}: a noise that is not stated has a number\n{text}", target.name))?;
    }
    // One axis of three: two of a matrix would leave a zero.
    let axis = format!("{gyro}[accelerometer]\nvelocity_random_walk_m_s_rth = [0.3, 0.0, 0.3]\n");
    let text = sent("ros-covariance", &axis, None, Filter::Mean)?;
    check(text.contains("states no white noise of the accelerometer along y;"), text.clone())?;
    check(matrix(&text, KEYS[0]).is_err(), "a zero was written")?;
    near("the gyro's", matrix(&text, KEYS[1])?[4], (0.6 * DEG_RTH).powi(2) * 100.0, 1e-14)
}

fn refused() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text);
    write("sensor.toml", SENSOR)?;
    write("norate.toml", "[gyro]\nangle_random_walk_deg_rth = 0.6\n")?;
    write("bias.toml", "[sensor]\nsample_rate_hz = 10.0\n[gyro]\nbias_deg_h = 7.0\n")?;
    let run = |arguments: &[&str]| program().current_dir(folder.path()).arg("export").args(arguments).output();
    for (arguments, words) in [
        (&["norate.toml", "--to", "ros-covariance"][..], &["need the rate of the messages", "--rate-hz 200"][..]),
        (&["bias.toml", "--to", "ekf2"], &["need white noise", "proofmass allan LOG --to ekf2"]),
        (&["sensor.toml", "--to", "gtsam", "--rate-hz", "-5"], &["need more than zero, got -5"]),
        (
            &["sensor.toml", "--to", "gtsam", "--filter", "high"],
            &["one-pole low-pass in Hz, got `high`", "low-pass:80"],
        ),
        (&["sensor.toml", "--to", "kalibr", "--filter", "80"], &["leave --filter out", "ros-covariance"]),
        (&["sensor.toml", "--to", "ros"], &["ros-covariance", "robot-localization"]),
    ] {
        let output = run(arguments)?;
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        check(
            output.status.code() == Some(2) && words.iter().all(|w| error.contains(w)),
            format!("{arguments:?}: {error}"),
        )?;
    }
    // The same with a rate goes; and a log's noise behind a filter is the messages' own: N² rate.
    check(
        run(&["norate.toml", "--to", "ros-covariance", "--rate-hz", "200"])?.status.success(),
        "a rate does not help",
    )?;
    let mut state = 1u32;
    let log: String = (0..8192)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            format!("{}\n", f64::from(state >> 8) / f64::from(1 << 24))
        })
        .collect();
    write("log.csv", &format!("gx\n{log}"))?;
    let variance = |more: &[&str]| -> Result<f64, Failed> {
        let command = [
            "allan",
            "log.csv",
            "--rate-hz",
            "100",
            "--gyro",
            "gx",
            "--gyro-scale",
            "rad/s",
            "--to",
            "robot-localization",
        ];
        let output = program().current_dir(folder.path()).args(command).args(more).output()?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        check(output.status.success(), format!("{text}{}", String::from_utf8_lossy(&output.stderr)))?;
        Ok(matrix(&text, KEYS[1])?[0])
    };
    near("independent messages behind a filter", variance(&["--filter", "40"])?, variance(&[])?, 1e-8)
}

/// Half of two hours of an ADIS16405 at rest, exported by `allan`, against sums of messages in the
/// other half; differences of neighbours take the slow bias out.
fn recorded(data: &Path) -> Result<(), Failed> {
    let log = data.join("adis16405/run1_counts.csv");
    let half = 375_000;
    let output = program()
        .arg("allan")
        .arg(&log)
        .args(["--rate-hz", "100", "--to-s", "3750", "--gyro", "gx_lsb,gy_lsb,gz_lsb", "--gyro-scale", "0.05deg/s"])
        .args(["--to", "robot-localization"])
        .output()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let variances = matrix(&text, KEYS[1])?;
    let held_out = std::fs::read_to_string(&log)?;
    for (axis, variance) in [(0, variances[0]), (1, variances[4]), (2, variances[8])] {
        let counts =
            held_out.lines().skip(1 + half).map(|row| row.split(',').nth(axis).and_then(|n| n.trim().parse().ok()));
        let rates: Vec<f64> = counts
            .map(|n: Option<f64>| n.map(|n| n * 0.05f64.to_radians()))
            .collect::<Option<_>>()
            .ok_or("a row without counts")?;
        let found = |summed: usize, variance: f64| {
            let sums: Vec<f64> = rates.chunks_exact(summed).map(|sum| sum.iter().sum()).collect();
            let squares: f64 = sums.chunks_exact(2).map(|pair| (pair[1] - pair[0]).powi(2) / 2.0).sum();
            squares / (sums.len() / 2) as f64 / (summed as f64 * variance)
        };
        // 18,750 and 3750 pairs: four standard errors are 4 % and 9 %.
        for summed in [10, 50] {
            near(&format!("axis {axis}, e²/variance of {summed} messages"), found(summed, variance), 1.0, 0.1)?;
            for wrong in [2.0, 0.5, 100.0] {
                check((found(summed, wrong * variance) - 1.0).abs() > 0.1, "the control is blind")?;
            }
        }
    }
    Ok(())
}
