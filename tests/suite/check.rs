//! `check` against planted truth: halves of hand-turned sensors agree as often as their intervals claim, what a
//! motion does not determine is named and not estimated, and the run that changed is found.

use std::fmt::Write as _;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use nalgebra::Matrix3;
use proofmass::control::Control;
use proofmass::diagnosis::repeatability::agreement::{Agreement, Odd};
use proofmass::diagnosis::repeatability::parameter::{Estimate, Role};
use proofmass::diagnosis::repeatability::run::Run;
use proofmass::diagnosis::tumble::known_in;
use proofmass::numerics::special::normal_quantile;
use proofmass::recording::Recording;
use proofmass::rng::{Philox, Stream};
use proofmass::sensor::Sense;
use rand::RngExt;
use rayon::prelude::*;

use super::bench::{Bench, run};
use super::tumble_bench::{Imu, model};
use super::world::{check, data_test, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("check: halves of hand-turned sensors agree as often as their 95 % intervals claim", halves),
        test("check: what a motion about fewer axes does not show is named, and not estimated", degenerate),
        test("check: halves that do not determine the calibration by themselves do not disagree for it", short),
        test("check: of three runs the one whose scale changed by half a per cent is found, and no other", odd),
        test("check: the command answers for one log and for three, and writes a sensor that a study takes", command),
        test("check: a driven log, one log given twice, and poses of one log for two, are refused", refused),
        data_test("check: halves of a real IMU are compared, and what differs is named with by how much", real),
    ]
}

/// Sensors of the test of halves: 30 parameters each. Were the true share 95 % and a sensor's
/// parameters independent, the share would lie within ± 1.2 % (three standard errors).
const SENSORS: u64 = 100;
/// Motions of each degenerate kind.
const MOTIONS: u64 = 25;
/// Sets of three runs, with a change and without.
const SETS: u64 = 24;

/// A sensor as they come: scales, axes and g-sensitivity of its own.
fn ordinary(seed: u64) -> Imu {
    let mut imu = Imu::without_defect(seed);
    let mut rng = Philox::new(seed, 9, Stream::Host);
    let mut about = |half: f64| half * (2.0 * rng.random::<f64>() - 1.0);
    for sensor in 0..2 {
        imu.scale[sensor] = imu.scale[sensor].map(|s| s * (1.0 + about(0.02)));
        for (i, j) in (0..9).map(|n| (n / 3, n % 3)).filter(|(i, j)| i != j && (sensor == 1 || j > i)) {
            imu.alignment[sensor][(i, j)] = about(0.015);
        }
    }
    imu.g_sensitivity = Matrix3::from_fn(|_, _| about(2e-4));
    imu
}

fn checked(imu: &Imu, seed: u64) -> Result<Run, Failed> {
    let (recording, poses) = imu.record(seed);
    Ok(known_in(&recording, &model(), Some(poses), &Control::silent())?)
}

/// The same of all seeds, side by side.
fn each<T: Send>(seeds: u64, of: impl Fn(u64) -> Result<T, Failed> + Sync) -> Result<Vec<T>, Failed> {
    (0..seeds).into_par_iter().map(&of).collect::<Vec<_>>().into_iter().collect()
}

fn halves() -> Result<(), Failed> {
    let agreements = each(SENSORS, |seed| {
        let halves = checked(&ordinary(seed), seed)?.halves.ok_or("30 poses were not divided")?;
        Ok(Agreement::of(&halves.each.each_ref()))
    })?;
    let lines = || agreements.iter().flat_map(|a| &a.lines);
    let share = |of_width: f64| {
        lines().filter(|l| l.difference.abs() < of_width * l.half_width).count() as f64 / lines().count() as f64
    };
    check(lines().count() as u64 > 25 * SENSORS, format!("only {} parameters were compared", lines().count()))?;
    let band = 0.93..=0.97;
    let slack = normal_quantile(0.975) * (0.05 * 0.95 / lines().count() as f64).sqrt();
    let within = |share: f64| share > band.start() - slack && share < band.end() + slack;
    check(within(share(1.0)), format!("{} of parameters agree", share(1.0)))?;
    // The control: intervals half as wide hold far less.
    check(!within(share(0.5)), format!("with half the width {} agree", share(0.5)))?;
    let alarms = agreements.iter().filter(|a| a.joint.is_none_or(|j| !j.agrees())).count();
    // At one in a hundred, more than 5 of 100 happen in 0.06 % of such trials (binomial).
    check(alarms <= 5, format!("{alarms} of {SENSORS} sensors disagree in all parameters together"))
}

/// Of ten poses each half has five: too few for nine parameters of an accelerometer.
fn short() -> Result<(), Failed> {
    let agreements = each(24, |seed| {
        let (recording, poses) = ordinary(7000 + seed).record(seed);
        let run = known_in(&recording, &model(), Some(poses[..10].to_vec()), &Control::silent())?;
        let halves = run.halves.ok_or("10 poses were not divided")?;
        let lost = halves.each.iter().any(|h| !undetermined(h).is_empty());
        Ok((lost, Agreement::of(&halves.each.each_ref())))
    })?;
    let lost = agreements.iter().filter(|a| a.0).count();
    check(lost >= 12, format!("only {lost} of 24 have a half that does not determine everything"))?;
    let alarms = agreements.iter().filter(|a| a.1.joint.is_some_and(|j| !j.agrees())).count();
    check(alarms <= 2, format!("{alarms} of 24 sensors disagree"))?;
    let lines = || agreements.iter().flat_map(|a| &a.1.lines);
    let differ = lines().filter(|l| !l.agrees()).count();
    let expected = 0.05 * lines().count() as f64;
    check((differ as f64) < 2.0 * expected, format!("{differ} of {} differ", lines().count()))
}

type Named = (Sense, Role, usize);

fn undetermined(estimate: &Estimate) -> Vec<Named> {
    let not = (0..estimate.parameters.len()).filter(|p| !estimate.determines(*p));
    not.filter_map(|p| estimate.parameters[p].element()).map(|p| (p.sensor, p.role, p.axis)).collect()
}

fn degenerate() -> Result<(), Failed> {
    use Sense::{Accelerometer, Gyro};
    // About x and y alone; about x alone, so that gravity stays in a plane; about all (control).
    let about: [([f64; 3], &[Named], &[Named]); 3] = [
        ([1.0, 1.0, 0.0], &[(Gyro, Role::Scale, 2)], &[(Gyro, Role::Scale, 0), (Accelerometer, Role::Scale, 2)]),
        (
            [1.0, 0.0, 0.0],
            &[
                (Accelerometer, Role::Bias, 0),
                (Accelerometer, Role::Scale, 0),
                (Gyro, Role::Scale, 1),
                (Gyro, Role::Scale, 2),
            ],
            &[(Gyro, Role::Scale, 0), (Accelerometer, Role::Scale, 1), (Accelerometer, Role::Scale, 2)],
        ),
        ([1.0, 1.0, 1.0], &[], &[(Gyro, Role::Scale, 2), (Accelerometer, Role::Bias, 0)]),
    ];
    for (share, must, must_not) in about {
        let right = each(MOTIONS, |seed| {
            let imu = Imu { turned: share.into(), ..ordinary(5000 + seed) };
            let named = undetermined(&checked(&imu, 5000 + seed)?.estimate);
            Ok(must.iter().all(|m| named.contains(m)) && !must_not.iter().any(|m| named.contains(m)))
        })?;
        let wrong = right.iter().filter(|r| !**r).count();
        // The aim is 98 %: two wrong of 25 have a chance of 9 % there, three of 1.5 %.
        check(wrong <= 2, format!("{wrong} of {MOTIONS} motions about {share:?} are named wrong"))?;
    }
    Ok(())
}

fn odd() -> Result<(), Failed> {
    let found = each(SETS, |seed| {
        let imu = ordinary(9000 + seed);
        let estimate = |imu: &Imu, run: u64| Ok::<_, Failed>(checked(imu, 100_000 + 10 * seed + run)?.estimate);
        let runs = (0..3).map(|run| estimate(&imu, run)).collect::<Result<Vec<_>, _>>()?;
        let false_alarm = Agreement::of(&runs.iter().collect::<Vec<_>>()).odd.is_some();
        let mut changed = imu.clone();
        changed.scale[(seed % 2) as usize][(seed % 3) as usize] *= 1.005;
        let place = (seed / 3 % 3) as usize;
        let mut with = runs;
        with[place] = estimate(&changed, 7)?;
        let agreement = Agreement::of(&with.iter().collect::<Vec<_>>());
        Ok((false_alarm, agreement.odd == Some(Odd::Run(place))))
    })?;
    let [alarms, right] = [found.iter().filter(|f| f.0).count() as u64, found.iter().filter(|f| f.1).count() as u64];
    // At 1 %, two of 24 have a chance of 2.4 %; at 95 %, four missed of 24 one of 3 %.
    check(alarms <= 1, format!("{alarms} of {SETS} sets without a change are said to have one"))?;
    check(right + 3 >= SETS, format!("the changed run is found in {right} of {SETS} sets"))
}

fn csv(recording: &Recording) -> String {
    let mut text = recording.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(",");
    for row in 0..recording.columns[0].values.len() {
        let cells: Vec<String> = recording.columns.iter().map(|c| c.values[row].to_string()).collect();
        let _ = write!(text, "\n{}", cells.join(","));
    }
    text
}

const MODEL: &str = "kind = \"tumble\"\nrate_hz = 50.0\ngravity_m_s2 = 9.81\n[columns]\ngyro = [\"gx\", \"gy\", \"gz\"]\n\
                     accelerometer = [\"ax\", \"ay\", \"az\"]\n";

fn command() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let model = bench.file("model.toml", MODEL)?;
    let imu = ordinary(3);
    let mut changed = imu.clone();
    changed.scale[1][2] *= 1.01;
    let named = [("one.csv", &imu, 1), ("two.csv", &imu, 2), ("three.csv", &changed, 3)];
    for (name, imu, seed) in named {
        bench.file(name, &csv(&imu.record(seed).0))?;
    }
    let logs = named.map(|(name, ..)| bench.path(name));
    let one = run(program().arg("check").arg(&logs[0]).arg("--model").arg(&model))?;
    check(one.code == Some(0), &one.stderr)?;
    for words in ["two halves of", "agree", "still poses", "all 30 parameters are determined", "next: "] {
        check(one.stdout.contains(words), format!("no \"{words}\" in {}", one.stdout))?;
    }
    let out = bench.path("out");
    let mut command = program();
    command.arg("check").args(&logs).arg("--model").arg(&model).arg("--json").arg("--out").arg(&out);
    let said = run(&mut command)?.json()?;
    check(said["schema"] == "proofmass.check/1", said["schema"].to_string())?;
    let agreement = &said["agreement"];
    check(agreement["odd"].as_str().is_some_and(|f| f.ends_with("three.csv")), agreement["odd"].to_string())?;
    let lines = agreement["parameters"].as_array().cloned().unwrap_or_default();
    let scale = lines.iter().find(|l| l["name"] == "gyro scale z").ok_or("no gyro scale z")?;
    check(scale["agrees"] == false, scale.to_string())?;
    let share = scale["spread"]["between"].as_f64().unwrap_or(0.0) / scale["spread"]["mean"].as_f64().unwrap_or(1.0);
    // Two runs alike and one 1 % off have a standard deviation of 0.58 %.
    check((0.004..0.008).contains(&share), format!("spread {share}"))?;
    let page = std::fs::read_to_string(out.join("report.html"))?;
    check(page.contains("<svg") && page.contains("half of its 95 % interval"), "a page without its figure")?;
    let sensor = std::fs::read_to_string(out.join("sensor.toml"))?;
    check(sensor.contains("sd = ") && sensor.contains("gyro"), &sensor)?;
    run(program().arg("export").arg(out.join("sensor.toml")).args(["--to", "kalibr", "--json"]))?.json()?;
    Ok(())
}

fn refused() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let rows: String = (0..2000).map(|k| format!("{},{}\n", k % 7, k % 11)).collect();
    let log = bench.file("log.csv", &format!("u,y\n{rows}"))?;
    let model =
        bench.file("m.toml", "kind = \"driven\"\nrate_hz = 10.0\n[columns]\ninput = \"u\"\noutput = \"y\"\n")?;
    let answer = run(program().arg("check").arg(&log).arg("--model").arg(&model))?;
    answer.refuses("a driven log", "kind = \"driven\"")?;
    let twice = run(program().arg("check").args([&log, &log]).arg("--model").arg(&model))?;
    twice.refuses("one log given twice", "every row")?;
    // Poses and references belong to one recording: two may not share them.
    let imu = ordinary(3);
    let logs = [1, 2].map(|seed| bench.file(&format!("{seed}.csv"), &csv(&imu.record(seed).0)));
    let [one, two] = logs;
    let poses = bench.file("poses.csv", "start,end\n0,10\n")?;
    let model = bench.file("poses.toml", &MODEL.replace("9.81\n", &format!("9.81\nposes = {poses:?}\n")))?;
    let shared = run(program().arg("check").args([one?, two?]).arg("--model").arg(&model))?;
    shared.refuses("poses of one recording for two", "belongs to one recording")
}

fn real(data: &Path) -> Result<(), Failed> {
    let bench = Bench::new()?;
    let poses = data.join("xsens_mti/static_intervals.csv");
    let text = MODEL.replace("50.0", "100.0").replace("9.81\n", &format!("9.81744\nposes = {poses:?}\n"));
    let text = ["gx", "gy", "gz", "ax", "ay", "az"]
        .iter()
        .fold(text, |t, n| t.replace(&format!("\"{n}\""), &format!("\"{n}_cnt\"")));
    let model = bench.file("model.toml", &text)?;
    let log = data.join("xsens_mti/raw_counts.csv");
    let said = run(program().arg("check").arg(&log).arg("--model").arg(&model).arg("--json"))?.json()?;
    let lines = said["agreement"]["parameters"].as_array().cloned().unwrap_or_default();
    check(lines.len() >= 27, format!("{} parameters compared", lines.len()))?;
    let differ: Vec<String> = lines.iter().filter(|l| l["agrees"] == false).map(|l| l["name"].to_string()).collect();
    check(said["agreement"]["joint"]["agrees"] == true, format!("{} {differ:?}", said["answer"]))?;
    // Of 30 at 5 % more than six differ once in 1,800 sensors (binomial).
    check(differ.len() <= 6, format!("{} of {} differ: {differ:?}", differ.len(), lines.len()))
}
