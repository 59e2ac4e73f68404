//! Bad input of an IMU in motion: each fault is said by name, with what to do; each input without
//! its fault passes.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use nalgebra::{UnitQuaternion, Vector3};
use proofmass::rng::{Philox, Stream};
use proofmass::units::STANDARD_GRAVITY_M_S2;

use super::super::world::{check, data_test, test};
use super::flight::{Files, Flight, ids, made_up, real};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("trajectory: bad input is refused by name", refused),
        data_test("trajectory: quaternions that are read the wrong way are named", quaternions),
        test("trajectory: where nothing turns, quaternions are not accused", still),
        test("trajectory: rows without numbers are left out and said", without_numbers),
        test("trajectory: a jump outside the rows that are used does no harm", outside),
        test("trajectory: poses at 2 Hz are said to be few, and no sensor is blamed for it", few),
    ]
}

/// What the tool says when it refuses.
fn refusal(what: &str, files: &Files) -> Result<String, Failed> {
    match files.diagnosed() {
        Err(failed) => Ok(failed.message().unwrap_or_default().to_owned()),
        Ok(answer) => Err(format!("{what}: passes as {:?} {:?}", answer.outcome, ids(&answer)).into()),
    }
}

fn refused() -> Result<(), Failed> {
    let flight = made_up(2)?;
    flight.diagnosed()?;
    let jumped = flight.with_pose_at(|k, p, q| (if k < 4000 { p } else { p + Vector3::x() }, q));
    let turned = flight.with_pose_at(|k, p, [w, x, y, z]| {
        // By 0.6 rad about z from one pose on.
        let (c, s) = (0.3f64.cos(), 0.3f64.sin());
        (p, if k < 4000 { [w, x, y, z] } else { [c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w] })
    });
    let wrong: [(&str, Flight); 9] = [
        ("days apart", flight.shifted(3e7)),
        ("years apart", flight.shifted(1e9)),
        ("do not overlap", flight.shifted(500.0)),
        ("wrong sign", flight.with_force(|a| a.map(|v| -v))),
        ("degrees for radians", flight.with_rate(|w| w.map(f64::to_degrees))),
        ("in g", flight.with_force(|a| a.map(|v| v / 9.80665))),
        ("do not turn alike", flight.with_rate_at(|k, w| w.map(|v| 0.0 * v + (k as f64 * 0.37).sin()))),
        ("position jumps by 1 m behind row 3999 (at 39.99 s after the first pose)", jumped),
        ("attitude jumps by 34.", turned),
    ];
    for (words, flight) in wrong {
        let text = refusal(words, &flight.files())?;
        check(text.contains(words), format!("`{words}` is not said: {text}"))?;
        check(text.contains("could not"), format!("what was tried is not said: {text}"))?;
    }
    Ok(())
}

fn quaternions(data: &Path) -> Result<(), Failed> {
    let flight = real(data, "euroc_v102")?;
    let untouched = ids(&flight.diagnosed()?);
    let with = |of: fn([f64; 4]) -> [f64; 4]| flight.with_pose_at(|_, p, q| (p, of(q)));
    let wrong: [(&str, Flight); 5] = [
        // The whole reference in a left-handed system, y mirrored.
        ("left-handed", flight.with_pose_at(|_, p, [w, x, y, z]| (Vector3::new(p.x, -p.y, p.z), [w, -x, y, -z]))),
        ("left-handed", with(|[w, x, y, z]| [w, -x, y, -z])),
        ("left-handed", with(|[w, x, y, z]| [w, x, -y, z])),
        ("left-handed", with(|[w, x, y, z]| [w, -x, -y, -z])),
        // Written x y z w under headings that say w x y z.
        ("scalar-last", with(|[w, x, y, z]| [x, y, z, w])),
    ];
    for (n, (words, flight)) in wrong.into_iter().enumerate() {
        let text = refusal(words, &flight.files())?;
        check(text.contains(words), format!("{n}: `{words}` is not said: {text}"))?;
        check(text.contains("reference.csv"), format!("{n}: the file is not named: {text}"))?;
    }
    // As a TUM file: x y z w as it ought to be; w x y z is refused, and read where the model insists.
    let tum = |order: fn([&str; 4]) -> [&str; 4]| -> Files {
        let files = flight.files();
        let row = |_: usize, line: &str| -> String {
            let cells: Vec<&str> = line.split(',').collect();
            let quaternion = order([cells[4], cells[5], cells[6], cells[7]]).join(" ");
            let (whole, rest) = cells[0].split_at(cells[0].len() - 9);
            format!("{whole}.{rest} {} {} {} {quaternion}", cells[1], cells[2], cells[3])
        };
        let body = files.with_rows(row).reference;
        let body = body.split_once('\n').map_or(String::new(), |(_, rows)| rows.to_owned());
        Files { reference: body, ..files }
    };
    let last = ids(&tum(|[w, x, y, z]| [x, y, z, w]).diagnosed()?);
    check(last == untouched, format!("as a TUM file {last:?}, as it was {untouched:?}"))?;
    let first = tum(|q| q);
    let text = refusal("scalar-first", &first)?;
    check(text.contains("quaternions are scalar-first"), format!("scalar-first is not said: {text}"))?;
    let insisted = "file = \"reference.csv\"\nquaternion = \"scalar-first\"";
    let told = ids(&Files { model: first.model.replace("file = \"reference.csv\"", insisted), ..first }.diagnosed()?);
    check(told == untouched, format!("with the scalar first as the model says {told:?}, as it was {untouched:?}"))
}

/// On a bench every convention fits the gyro's noise as well as any other.
fn still() -> Result<(), Failed> {
    let mut random = Philox::new(4, 12, Stream::Host);
    let attitude = UnitQuaternion::from_euler_angles(0.2, -0.9, 0.0);
    let up = attitude.inverse() * Vector3::z() * STANDARD_GRAVITY_M_S2;
    let q = [attitude.w, attitude.i, attitude.j, attitude.k];
    let mut noise = |about: [f64; 3], size: f64| about.map(|v| v + size * random.normal());
    let rates: Vec<_> = (0..20_000).map(|_| noise([0.0; 3], 1.7e-3)).collect();
    let forces: Vec<_> = (0..20_000).map(|_| noise([up.x, up.y, up.z], 2e-2)).collect();
    let flight = made_up(4)?
        .with_pose_at(|_, _, _| (Vector3::zeros(), q))
        .with_rate_at(|k, _| rates[k])
        .with_force_at(|k, _| forces[k]);
    let said = match flight.diagnosed() {
        Ok(answer) => format!("{:?} {:?}", answer.outcome, answer.findings),
        Err(failed) => failed.message().unwrap_or_default().to_owned(),
    };
    let accuses = |said: &str| ["left-handed", "scalar-", "inverse", "conjugate"].iter().any(|w| said.contains(w));
    check(!accuses(&said), format!("at rest: {said}"))?;
    // Control: the same words where a moving body's quaternions are wrong.
    let moving = made_up(4)?.with_pose_at(|_, p, [w, x, y, z]| (p, [w, -x, -y, -z]));
    let said = refusal("conjugated", &moving.files())?;
    check(accuses(&said), format!("conjugated: {said}"))
}

fn without_numbers() -> Result<(), Failed> {
    let files = made_up(1)?.files();
    let is_lost = |k: usize| (3000..3020).contains(&k);
    let lost = files.with_rows(|k, line| {
        let stamp = line.split(',').next().unwrap_or_default();
        if is_lost(k) { format!("{stamp},nan,nan,nan,nan,nan,nan,nan") } else { line.to_owned() }
    });
    let answer = lost.diagnosed()?;
    check(ids(&answer).is_empty(), format!("twenty poses of NaN: {:?}", ids(&answer)))?;
    let said = "20 rows of the trajectory hold no pose and were left out, the first is row 3000";
    check(answer.findings.iter().any(|f| f == said), format!("{:?}", answer.findings))?;
    check(!files.diagnosed()?.findings.iter().any(|f| f == said), "the whole file is said to lack rows as well")?;
    // Two seconds without a pose are left out, and said.
    let hole = files.with_rows(|k, line| {
        let stamp = line.split(',').next().unwrap_or_default();
        if (3000..3200).contains(&k) { format!("{stamp},nan,nan,nan,nan,nan,nan,nan") } else { line.to_owned() }
    });
    let answer = hole.diagnosed()?;
    check(ids(&answer).is_empty(), format!("a hole of two seconds: {:?}", ids(&answer)))?;
    let said = "poses are missing in 1 place, up to 2.01 s long (after row 2999): that time is left out";
    check(answer.findings.iter().any(|f| f == said), format!("{:?}", answer.findings))?;
    // Readings.
    let mut k = 0;
    let row = |line: &str| {
        k += 1;
        let stamp = line.split(',').next().unwrap_or_default();
        if (4001..4005).contains(&k) { format!("{stamp},nan,nan,nan,nan,nan,nan\n") } else { format!("{line}\n") }
    };
    let imu: String = files.imu.lines().map(row).collect();
    let answer = Files { imu, ..files }.diagnosed()?;
    check(ids(&answer).is_empty(), format!("four readings of NaN: {:?}", ids(&answer)))?;
    let found = answer.findings.iter().any(|f| f.contains("4 missing values"));
    check(found, format!("four readings of NaN are not said: {:?}", answer.findings))
}

fn outside() -> Result<(), Failed> {
    let flight = made_up(1)?;
    let jumped = flight.with_pose_at(|k, p, q| (if k < 8000 { p } else { p + Vector3::x() }, q)).files();
    check(refusal("a jump", &jumped)?.contains("rows = [[from, to]]"), "how to leave the jump out is not said")?;
    let model = jumped.model.replace("[columns]", "rows = [[0, 14000]]\n[columns]");
    let answer = Files { model, ..jumped }.diagnosed()?;
    check(ids(&answer).is_empty(), format!("without the jump: {:?}", ids(&answer)))
}

fn few() -> Result<(), Failed> {
    for seed in [1, 6] {
        let flight = made_up(seed)?;
        let said = |flight: &Flight| -> Result<bool, Failed> {
            let answer = flight.diagnosed()?;
            check(ids(&answer).is_empty(), format!("seed {seed}: {:?}", ids(&answer)))?;
            Ok(answer.findings.iter().any(|f| f.starts_with("the poses come at 2 Hz")))
        };
        check(said(&flight.with_poses(|k| k % 50 == 0))?, "2 Hz is not said")?;
        check(!said(&flight)?, "a hundred poses per second are said to be few")?;
    }
    Ok(())
}
