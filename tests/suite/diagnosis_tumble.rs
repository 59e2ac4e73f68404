//! A tumble diagnosis names what was planted, is silent where nothing was, and does not name what
//! it does not know.

use libtest_mimic::{Failed, Trial};
use nalgebra::{Matrix3, Vector3};
use proofmass::control::Control;
use proofmass::diagnosis::tumble::diagnose_in;
use proofmass::diagnosis::verdict::Outcome;
use proofmass::report::diagnosis::{Diagnosis, worded};
use rayon::prelude::*;

use super::tumble_bench::{Imu, model};
use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test("tumble: an ideal IMU is adequate, at most one false alarm in a hundred", silence),
        test("tumble: 95 % intervals cover as often as they claim", coverage),
        test("tumble: a drift without a temperature column is named for itself, never for what drives it", drift),
        test("tumble: a drift as small as 1/f noise may make it is told and not named", small_drift),
        test("tumble: one pose that was knocked is left out and told, and the names stay", knocked),
        test("tumble: an accelerometer alone is calibrated as beside a gyro", alone),
        test("tumble: a gyro that does something unknown leaves the accelerometer its names", gyro_foreign),
        test("tumble: a gyro that bends by no law of the library has intervals that hold its scale at rest", bent),
        test("tumble: biases and matrices come out and hold the truth, whatever the verdict", calibration),
    ];
    all.extend(PLANTS.map(|plant| {
        let (id, sensor, _) = plant;
        test(&format!("tumble: {id} of {sensor} is named, alone, in each of twelve IMUs"), move || planted(plant))
    }));
    all.extend(PAIRS.map(|(a, b)| {
        let (first, second) = (PLANTS[a], PLANTS[b]);
        let what = format!("{} of {} and {} of {}", first.0, first.1, second.0, second.1);
        test(&format!("tumble: {what} at once are both named in each of six IMUs"), move || two_at_once(first, second))
    }));
    all.extend(INVENTIONS.map(|invention| {
        test(
            &format!("tumble: {}, which no candidate is, is unexplained in each of twelve IMUs", invention.0),
            move || foreign(invention),
        )
    }));
    all
}

fn diagnose(imu: &Imu, seed: u64) -> Result<Diagnosis, Failed> {
    let (recording, ranges) = imu.record(seed);
    Ok(worded(diagnose_in(&recording, &model(), Some(ranges), &Control::silent())?))
}

pub(super) fn names(d: &Diagnosis) -> Vec<(String, char)> {
    let mut out: Vec<(String, char)> =
        d.verdict.effects.iter().map(|e| (e.id.clone(), e.channels[0].chars().next().unwrap_or('?'))).collect();
    out.sort();
    out
}

/// What went wrong in each run, empty where nothing did.
pub(super) fn many(
    runs: u64,
    run: impl Fn(u64) -> Result<Option<String>, Failed> + Sync,
) -> Result<Vec<String>, Failed> {
    let said: Vec<Result<Option<String>, Failed>> = (0..runs).into_par_iter().map(&run).collect();
    said.into_iter().filter_map(Result::transpose).collect()
}

fn none(wrong: &[String]) -> Result<(), Failed> {
    check(wrong.is_empty(), wrong.join("\n"))
}

/// What a diagnosis said, unless it is right.
pub(super) fn unless(right: bool, seed: u64, d: &Diagnosis) -> Option<String> {
    (!right).then(|| format!("IMU {seed}: {:?} {:?} {}", d.verdict.verdict, names(d), d.verdict.sentence))
}

fn silence() -> Result<(), Failed> {
    let runs = 240;
    let alarms = many(runs, |seed| {
        let d = diagnose(&Imu::without_defect(seed), seed)?;
        Ok(unless(d.verdict.verdict == Outcome::Adequate, seed, &d))
    })?;
    // At a true rate of 1 %, more than 6 false alarms in 240 happen in 1.2 % of such trials
    // (binomial).
    check(alarms.len() <= 6, format!("{} false alarms in {runs}:\n{}", alarms.len(), alarms.join("\n")))
}

type Plant = (&'static str, char, fn(&mut Imu));

const PLANTS: [Plant; 7] = [
    ("scale-factor", 'a', |i| i.scale[0][1] *= 1.004),
    ("scale-factor", 'g', |i| i.scale[1][2] *= 1.01),
    ("misalignment", 'a', |i| i.alignment[0][(0, 1)] = 0.005),
    ("misalignment", 'g', |i| i.alignment[1][(2, 0)] = -0.01),
    ("g-sensitivity", 'g', |i| i.g_sensitivity[(1, 0)] = 4e-4),
    ("scale-nonlinearity", 'a', |i| i.quadratic[0][2] = 4e-4),
    ("earth-rate", 'g', |i| {
        // The earth's rate at 45° of latitude, heading north, before a gyro quiet enough to feel
        // it.
        i.frame_rate_rad_s = Vector3::new(5.16e-5, 0.0, 5.16e-5);
        i.noise[1] = 2e-5;
        i.scale[1] *= 100.0;
    }),
];

fn planted((id, sensor, plant): Plant) -> Result<(), Failed> {
    none(&many(12, |seed| {
        let mut imu = Imu::without_defect(1000 + seed);
        plant(&mut imu);
        let d = diagnose(&imu, 1000 + seed)?;
        let right = d.verdict.verdict == Outcome::Explained && names(&d) == [(id.to_owned(), sensor)];
        Ok(unless(right, 1000 + seed, &d))
    })?)
}

const PAIRS: [(usize, usize); 4] = [(0, 4), (2, 3), (4, 5), (1, 2)];

fn two_at_once(first: Plant, second: Plant) -> Result<(), Failed> {
    let mut truth = vec![(first.0.to_owned(), first.1), (second.0.to_owned(), second.1)];
    truth.sort();
    none(&many(6, |seed| {
        let mut imu = Imu::without_defect(2000 + seed);
        (first.2)(&mut imu);
        (second.2)(&mut imu);
        let d = diagnose(&imu, 2000 + seed)?;
        Ok(unless(names(&d) == truth, 2000 + seed, &d))
    })?)
}

type Invention = (&'static str, fn(&mut Imu));

const INVENTIONS: [Invention; 3] = [
    ("a bias that keeps the sign of the last flip", |i| i.hysteresis_m_s2 = 0.03),
    ("a rate that follows the heading", |i| i.heading_rad_s = 0.01),
    ("a stop that yields on one side", |i| i.soft_stop_m_s2 = 0.4),
];

fn foreign((_, invent): Invention) -> Result<(), Failed> {
    none(&many(12, |seed| {
        let mut imu = Imu::without_defect(3000 + seed);
        invent(&mut imu);
        let d = diagnose(&imu, 3000 + seed)?;
        let honest = d.verdict.verdict == Outcome::Unexplained && d.verdict.effects.is_empty();
        Ok(unless(honest, 3000 + seed, &d))
    })?)
}

fn coverage() -> Result<(), Failed> {
    let k = Matrix3::new(1.0, 3.0, 7.0, -15.0, 0.5, 9.0, -8.0, -9.0, 2.0) * 1e-4;
    let counts: Vec<Result<(usize, usize), Failed>> = (0..60u64)
        .into_par_iter()
        .map(|seed| {
            let mut imu = Imu::without_defect(4000 + seed);
            imu.g_sensitivity = k;
            imu.alignment[0][(0, 1)] = 0.01;
            imu.alignment[0][(1, 2)] = -0.02;
            let d = diagnose(&imu, 4000 + seed)?;
            let (mut inside, mut all) = (0, 0);
            for effect in &d.verdict.effects {
                for (n, p) in effect.parameters.iter().enumerate() {
                    let truth = match effect.id.as_str() {
                        "g-sensitivity" => k[(n / 3, n % 3)] * 9.806_65_f64.to_degrees(),
                        "misalignment" => [0.01, 0.0, -0.02][n % 3],
                        _ => continue,
                    };
                    all += 1;
                    inside += usize::from(p.ci95[0] <= truth && truth <= p.ci95[1]);
                }
            }
            Ok((inside, all))
        })
        .collect();
    let (inside, all) = counts.into_iter().try_fold((0, 0), |s, c| c.map(|c| (s.0 + c.0, s.1 + c.1)))?;
    let share = inside as f64 / all as f64;
    // 720 intervals that are not quite independent: ±2.5 % is three standard errors.
    check(all >= 700 && (0.925..=0.975).contains(&share), format!("{inside} of {all} intervals cover: {share:.3}"))
}

/// Scale and misalignment of both sensors, as every unit has.
fn ordinary(seed: u64) -> Imu {
    let mut imu = Imu::without_defect(seed);
    for sensor in 0..2 {
        imu.scale[sensor][1] *= 1.012;
        imu.scale[sensor][2] *= 0.994;
        imu.alignment[sensor][(0, 1)] = 0.008;
        imu.alignment[sensor][(0, 2)] = -0.004;
        imu.alignment[sensor][(1, 2)] = 0.011;
    }
    imu.alignment[1][(2, 0)] = -0.006;
    imu
}

fn of_sensor(d: &Diagnosis, sensor: char) -> Vec<String> {
    names(d).into_iter().filter(|n| n.1 == sensor).map(|n| n.0).collect()
}

const USUAL: [&str; 2] = ["misalignment", "scale-factor"];

/// An offset that drifts is named for that, never for what drives it, and the figure is right.
fn drift() -> Result<(), Failed> {
    // A pose every 3 s: 30 values along a line, of which the variance is (30² − 1)/12 steps squared.
    let (per_minute, rms_minutes) = (0.02, 3.0 / 60.0 * ((30.0f64 * 30.0 - 1.0) / 12.0).sqrt());
    let outcomes = many(12, |seed| {
        let mut imu = Imu::without_defect(5000 + seed);
        imu.drift_per_minute[0][0] = per_minute;
        let d = diagnose(&imu, 5000 + seed)?;
        let named = d.verdict.verdict == Outcome::Explained && names(&d) == [("slow-drift".to_owned(), 'a')];
        // The control: without the drift nothing is named.
        let without = diagnose(&Imu::without_defect(5000 + seed), 5000 + seed)?;
        Ok(unless(named && names(&without).is_empty(), 5000 + seed, &d))
    })?;
    none(&outcomes)?;
    let missed = many(12, |seed| {
        let mut imu = Imu::without_defect(5000 + seed);
        imu.drift_per_minute[0][0] = per_minute;
        let d = diagnose(&imu, 5000 + seed)?;
        let rms = d.verdict.effects[0].parameters.iter().find(|p| p.name == "rms_x");
        let covers = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
        let truth = per_minute * rms_minutes;
        // The control: twice the drift is outside each time.
        check(
            rms.is_some_and(|p| !covers(p.ci95, 2.0 * truth)),
            format!("IMU {seed}: {rms:?} covers twice the drift"),
        )?;
        Ok(unless(rms.is_some_and(|p| covers(p.ci95, truth)), 5000 + seed, &d))
    })?;
    // 95 % of twelve: three misses come once in fifty.
    check(missed.len() <= 2, missed.join("\n"))
}

/// A drift of the size that 1/f noise may have is never named. It is told where it is seen, and never
/// where there is none (control).
fn small_drift() -> Result<(), Failed> {
    let told = |d: &Diagnosis| d.verdict.findings.iter().any(|f| f.starts_with("slow drift of the accelerometer"));
    let outcomes = many(12, |seed| {
        let mut imu = Imu::without_defect(5000 + seed);
        imu.noise[0] = 0.008;
        let without = diagnose(&imu, 5000 + seed)?;
        // 0.008 m/s² over the root of 100 readings of a pose are 0.8 mm/s²; the drift is 1.7 rms.
        imu.drift_per_minute[0][0] = 0.004;
        let d = diagnose(&imu, 5000 + seed)?;
        check(names(&d).is_empty() && !told(&without), format!("IMU {}: {:?}", 5000 + seed, names(&d)))?;
        Ok(unless(told(&d), 5000 + seed, &d))
    })?;
    // Twice the noise of one pose in thirty of them is near what is seen: a few are, at the least.
    check(outcomes.len() <= 9, outcomes.join("\n"))
}

fn knocked() -> Result<(), Failed> {
    none(&many(12, |seed| {
        let imu = ordinary(6000 + seed);
        let (mut recording, ranges) = imu.record(6000 + seed);
        let range = ranges[7].clone();
        for (n, column) in recording.columns.iter_mut().enumerate().take(3) {
            column.values[range.clone()].iter_mut().for_each(|v| *v += 25.0 + 10.0 * n as f64);
        }
        let d = worded(diagnose_in(&recording, &model(), Some(ranges), &Control::silent())?);
        let told = d.verdict.findings.iter().any(|f| f.starts_with("pose 8 ") && f.contains("disagrees"));
        let right =
            d.verdict.verdict == Outcome::Explained && of_sensor(&d, 'a') == USUAL && of_sensor(&d, 'g') == USUAL;
        Ok(unless(right && told, 6000 + seed, &d))
    })?)
}

fn alone() -> Result<(), Failed> {
    none(&many(12, |seed| {
        let imu = ordinary(7000 + seed);
        let (recording, ranges) = imu.record(7000 + seed);
        let mut model = model();
        model.columns.gyro = None;
        let d = worded(diagnose_in(&recording, &model, Some(ranges), &Control::silent())?);
        let right = d.verdict.verdict == Outcome::Explained && of_sensor(&d, 'a') == USUAL && names(&d).len() == 2;
        let only = d.verdict.calibration.as_ref().is_some_and(|c| c.gyro.is_none());
        Ok(unless(right && only, 7000 + seed, &d))
    })?)
}

fn gyro_foreign() -> Result<(), Failed> {
    none(&many(12, |seed| {
        let mut imu = ordinary(8000 + seed);
        imu.heading_rad_s = 0.01;
        let d = diagnose(&imu, 8000 + seed)?;
        let foreign = of_sensor(&d, 'g').iter().any(|id| !USUAL.contains(&id.as_str()));
        let right = d.verdict.verdict == Outcome::Unexplained && of_sensor(&d, 'a') == USUAL && !foreign;
        Ok(unless(right, 8000 + seed, &d))
    })?)
}

/// Whether biases and matrices hold the truth, of an ordinary IMU and of one whose gyro does
/// something unknown: that verdict is `unexplained`, and its accelerometer's numbers must hold all
/// the same.
fn calibration() -> Result<(), Failed> {
    let counts: Vec<Result<(usize, usize), Failed>> = (0..80u64)
        .into_par_iter()
        .map(|seed| {
            let mut imu = ordinary(9000 + seed);
            if seed % 2 == 1 {
                imu.heading_rad_s = 0.01;
            }
            let d = diagnose(&imu, 9000 + seed)?;
            let Some(found) = &d.verdict.calibration else { return Err("no calibration".into()) };
            let sensors = [Some(&found.accelerometer), found.gyro.as_ref().filter(|_| seed % 2 == 0)];
            let (mut inside, mut all) = (0, 0);
            let mut hold = |ci95: [f64; 2], truth: f64| {
                all += 1;
                inside += usize::from(ci95[0] <= truth && truth <= ci95[1]);
            };
            for (n, sensor) in sensors.into_iter().enumerate() {
                let Some(sensor) = sensor else { continue };
                let inverse = imu.alignment[n].try_inverse().ok_or("a singular M")?;
                let truth = inverse * Matrix3::from_diagonal(&imu.scale[n].map(|s| 1.0 / s));
                for i in 0..3 {
                    hold(sensor.bias_ci95[i], imu.offset[n][i]);
                    // The lower triangle of the accelerometer's matrix is zero by the choice of the
                    // frame.
                    (0..3).filter(|j| n == 1 || *j >= i).for_each(|j| hold(sensor.matrix_ci95[i][j], truth[(i, j)]));
                }
            }
            Ok((inside, all))
        })
        .collect();
    let (inside, all) = counts.into_iter().try_fold((0, 0), |s, c| c.map(|c| (s.0 + c.0, s.1 + c.1)))?;
    let share = inside as f64 / all as f64;
    // 1200 intervals that are not quite independent: ±2.5 % is about three standard errors.
    check(all >= 1100 && (0.925..=0.975).contains(&share), format!("{inside} of {all} intervals cover: {share:.3}"))
}

/// The scale at rest of a gyro whose scale grows with |ω|, where that is unexplained: leaving poses
/// out in turn does not tell how far the law that is missing moves it.
fn bent() -> Result<(), Failed> {
    let counts: Vec<Result<[usize; 3], Failed>> = (0..24u64)
        .into_par_iter()
        .map(|seed| {
            let mut imu = ordinary(9500 + seed);
            imu.bend_s = 0.03;
            let d = diagnose(&imu, 9500 + seed)?;
            if d.verdict.verdict != Outcome::Unexplained {
                return Ok([0; 3]);
            }
            let found = d.verdict.calibration.as_ref().and_then(|c| c.gyro.as_ref()).ok_or("no calibration")?;
            let inverse = imu.alignment[1].try_inverse().ok_or("a singular M")?;
            let (mut inside, mut far) = (0, 0);
            for i in 0..3 {
                let ([low, high], truth) = (found.matrix_ci95[i][i], inverse[(i, i)] / imu.scale[1][i]);
                inside += usize::from(low <= truth && truth <= high);
                far += usize::from(low <= 1.5 * truth && 1.5 * truth <= high);
            }
            Ok([3, inside, far])
        })
        .collect();
    let [all, inside, far] =
        counts.into_iter().try_fold([0; 3], |s, c| c.map(|c| [s[0] + c[0], s[1] + c[1], s[2] + c[2]]))?;
    check(all >= 36, format!("{} of 24 unexplained", all / 3))?;
    // 95 % less two standard errors of the fewest.
    check(100 * inside >= 88 * all, format!("{inside} of {all} intervals hold the scale at rest"))?;
    // Control: an interval that holds everything would hold half as much again.
    check(far == 0, format!("{far} of {all} hold a scale that is half as large again"))
}
