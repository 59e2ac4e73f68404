//! A reference that is wrong in places, and a gyro whose range ends: each is said for itself, left out,
//! and nothing else is blamed for it.
//!
//! The real recordings are of a wand beside motion capture (Szczęsna et al., ICCVG 2016). What is
//! expected of them was found independently of the tool: a turn of 2.6° by least squares on rates,
//! the rail by a histogram of the readings.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use nalgebra::{UnitQuaternion, Vector3};
use proofmass::control::Control;
use proofmass::diagnosis::answer::Answer;
use proofmass::diagnosis::verdict::Effect;
use proofmass::diagnosis::{diagnose, model};
use proofmass::rng::{Philox, Stream};

use super::super::world::{check, data_test, near, test};
use super::flight::{Files, Flight, base, by_hand, effect, ids};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        data_test("trajectory: of a wand the turn of its holder is found, and no fault of the reference", slow),
        data_test("trajectory: of a quick wand the rail of the gyro and the leaps of the reference are found", fast),
        test("trajectory: any mounting and half a second between the clocks are found", any_mounting),
        test("trajectory: leaps, stretches that stand and gaps of a reference are listed and left out", leaps),
        test("trajectory: a wrong convention is named although the reference leaps", conventions),
        test("trajectory: a noisy rail is named where the body turned quicker, and a steady turn is none", rail),
    ]
}

/// Headings of a reference without positions.
const ATTITUDE: [&str; 2] = ["timestamp", "q_RS"];

fn wand(data: &Path, name: &str) -> Result<Answer, Failed> {
    let folder = tempfile::tempdir()?;
    let path = |what: &str| data.join("wand").join(format!("{name}_{what}.csv"));
    let model = folder.path().join("model.toml");
    let reference = path("reference").display().to_string();
    std::fs::write(&model, format!("kind = \"trajectory\"\n[reference]\nfile = {reference:?}\n"))?;
    let model = model::read(&model)?;
    let recording = model::read_recording(&path("imu"), &model, &Control::silent())?;
    Ok(diagnose(&recording, &model, &Control::silent())?)
}

/// Sentences about a reference that is wrong.
fn faults(answer: &Answer) -> Vec<&String> {
    answer.findings.iter().filter(|f| f.starts_with("the reference ")).collect()
}

/// The turn of the gyro against the reference, °: as a mounting, or as misalignment, of which the part
/// with opposite signs is a turn.
fn turn_deg(answer: &Answer) -> Result<f64, Failed> {
    let number = |e: &Effect, name: &str| e.parameters.iter().find(|p| p.name == name).map_or(0.0, |p| p.value);
    if let Ok(found) = effect(answer, "mounting") {
        return Ok(Vector3::from(["x", "y", "z"].map(|n| number(found, n))).norm());
    }
    let found = effect(answer, "misalignment")?;
    let pairs = [("gyro_yz", "gyro_zy"), ("gyro_zx", "gyro_xz"), ("gyro_xy", "gyro_yx")];
    let half = pairs.map(|(a, b)| 0.5 * (number(found, a) - number(found, b)) * 1e-3);
    Ok(Vector3::from(half).norm().to_degrees())
}

/// Nothing absurd: a reference noise below a tenth of a radian, scale factors below five per cent.
fn is_sober(what: &str, answer: &Answer) -> Result<(), Failed> {
    for (id, most) in [("reference-noise", 100.0), ("scale-factor", 5e4)] {
        let Ok(found) = effect(answer, id) else { continue };
        check(found.parameters.iter().all(|p| p.value.abs() < most), format!("{what}: {:?}", found.parameters))?;
    }
    Ok(())
}

fn slow(data: &Path) -> Result<(), Failed> {
    let answer = wand(data, "slow")?;
    near("turn", turn_deg(&answer)?, 2.6, 0.3)?;
    check(ids(&answer).contains("time-offset") || ids(&answer).contains("readout-lowpass"), "no lag is named")?;
    check(faults(&answer).is_empty(), format!("{:?}", faults(&answer)))?;
    check(!ids(&answer).contains("readout-saturation"), "a rail is named where none was reached")?;
    is_sober("slow", &answer)
}

fn fast(data: &Path) -> Result<(), Failed> {
    let answer = wand(data, "fast")?;
    let found = effect(&answer, "readout-saturation")?;
    check(found.parameters.len() == 1 && found.parameters[0].name == "gyro_x", format!("{:?}", found.parameters))?;
    near("rail", found.parameters[0].value, 7.36, 0.02)?;
    let said = faults(&answer);
    check(said.iter().any(|s| s.contains("does not turn as the gyro does")), format!("{said:?}"))?;
    check(said.iter().any(|s| s.contains("leaps") && s.contains("by up to 150°")), format!("{said:?}"))?;
    is_sober("fast", &answer)
}

/// Turns about every axis, up to some 3 rad/s.
fn waving(t: f64) -> [f64; 3] {
    [
        1.8 * (1.3 * t).sin() + 0.8 * (2.9 * t + 0.4).sin(),
        1.5 * (0.9 * t + 1.0).sin() + 0.7 * (2.3 * t).sin(),
        1.6 * (1.1 * t + 2.0).sin() + 0.6 * (3.3 * t + 1.3).sin(),
    ]
}

fn without_position(flight: &Flight) -> Files {
    flight.files().with_columns(&ATTITUDE)
}

/// Rotations that are uniform over all: four normal numbers of unit length (Shoemake 1992).
fn any_mounting() -> Result<(), Failed> {
    let flight = by_hand(waving, 1);
    let none = without_position(&flight).diagnosed()?;
    check(ids(&none).is_empty() && faults(&none).is_empty(), format!("{:?} {:?}", ids(&none), faults(&none)))?;
    let mut random = Philox::new(5, 14, Stream::Host);
    for shift_s in [0.5, -0.5, 0.31] {
        let q = nalgebra::Quaternion::new(random.normal(), random.normal(), random.normal(), random.normal());
        let turned = UnitQuaternion::from_quaternion(q);
        let answer = without_position(&flight.mounted(turned).shifted(shift_s)).diagnosed()?;
        let all: Vec<String> = ids(&answer).into_iter().collect();
        check(all == ["mounting", "time-offset"], format!("{turned} and {shift_s} s: {all:?}"))?;
        let deg = effect(&answer, "mounting")?.parameters.iter().map(|p| p.value);
        let found = UnitQuaternion::from_scaled_axis(Vector3::from_iterator(deg.map(f64::to_radians)));
        check(found.angle_to(&turned) < 2e-3, format!("{found} for {turned}"))?;
        check(found.angle_to(&turned.inverse()) > 2e-3, "the inverse would pass")?;
        near("offset", base(&answer, "time_offset")?.value, shift_s, 1e-3)?;
    }
    Ok(())
}

/// One pose and three poses turned away, a turn of the frame for good, and four seconds that stand.
fn spoiled(flight: &Flight) -> Flight {
    let held = std::cell::Cell::new([1.0, 0.0, 0.0, 0.0]);
    flight.with_pose_at(|k, p, q| {
        let away = |q: [f64; 4]| {
            let q = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]));
            let q = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.9) * q;
            [q.w, q.i, q.j, q.k]
        };
        if !(4000..4400).contains(&k) {
            held.set(q);
        }
        let is_away = k == 1000 || (2000..2003).contains(&k) || k >= 3000;
        (p, if is_away { away(held.get()) } else { held.get() })
    })
}

fn leaps() -> Result<(), Failed> {
    let flight = by_hand(waving, 2);
    let answer = without_position(&spoiled(&flight)).diagnosed()?;
    check(ids(&answer).is_empty(), format!("{:?}", ids(&answer)))?;
    let said = faults(&answer);
    let listed = "behind its rows 999, 1000, 1999, 2002, 2999";
    check(said.iter().any(|s| s.contains("leaps") && s.contains(listed)), format!("{said:?}"))?;
    let standing = said.iter().find(|s| s.contains("stands still while the gyro turns: its rows "));
    let rows: Vec<usize> = standing
        .and_then(|s| s.rsplit("rows ").next())
        .map(|s| s.split(" to ").filter_map(|v| v.parse().ok()).collect())
        .unwrap_or_default();
    check(rows.len() == 2 && rows[0] <= 4000 && rows[1] >= 4399, format!("{said:?}"))?;
    check(rows[1] - rows[0] < 600, format!("far more than what stands is left out: {rows:?}"))?;
    // Five faults, each with a margin: most of the minute is kept.
    let clean = without_position(&flight).diagnosed()?;
    check(faults(&clean).is_empty() && ids(&clean).is_empty(), format!("{:?} {:?}", faults(&clean), ids(&clean)))?;
    for axis in ["x", "y", "z"] {
        let half = |a: &Answer| base(a, &format!("gyro_bias_{axis}")).map(|e| 0.5 * (e.ci95[1] - e.ci95[0]));
        check(half(&answer)? < 3.0 * half(&clean)?, format!("{axis}: what is left says little"))?;
    }
    Ok(())
}

fn conventions() -> Result<(), Failed> {
    let flight = spoiled(&by_hand(waving, 3));
    type Convention = fn([f64; 4]) -> [f64; 4];
    let wrong: [(&str, Convention); 3] = [
        ("world to body", |[w, x, y, z]| [w, -x, -y, -z]),
        ("scalar-last", |[w, x, y, z]| [x, y, z, w]),
        ("left-handed", |[w, x, y, z]| [w, -x, y, -z]),
    ];
    for (words, of) in wrong {
        let said = match without_position(&flight.with_pose_at(|_, p, q| (p, of(q)))).diagnosed() {
            Err(failed) => failed.message().unwrap_or_default().to_owned(),
            Ok(answer) => format!("passes as {:?} {:?}", answer.outcome, ids(&answer)),
        };
        check(said.contains(words), format!("`{words}` is not said: {said}"))?;
    }
    // As it ought to be.
    without_position(&flight).diagnosed().map(|_| ())
}

/// A swing of 6 rad/s about x that a rail ends at 3, beside a body that turns at 3 and no quicker.
fn rail() -> Result<(), Failed> {
    let about_x = |x: f64, t: f64| [x, 0.4 * (0.7 * t).sin(), 0.3 * (1.1 * t).cos()];
    let swing = |t: f64| (6.0 + 0.5 * (0.37 * t).sin()) * (2.0 * t).sin();
    let quick = by_hand(|t| about_x(swing(t), t), 4);
    let mut random = Philox::new(6, 15, Stream::Host);
    let noise: Vec<f64> = quick.rate.iter().map(|_| 3e-3 * random.normal()).collect();
    let railed =
        quick.with_rate_at(|k, w| [if w[0].abs() > 3.0 { 3.0f64.copysign(w[0]) + noise[k] } else { w[0] }, w[1], w[2]]);
    let answer = without_position(&railed).diagnosed()?;
    let found = effect(&answer, "readout-saturation")?;
    check(found.parameters.len() == 1 && found.parameters[0].name == "gyro_x", format!("{:?}", found.parameters))?;
    near("rail", found.parameters[0].value, 3.0, 0.02)?;
    // The corners of a clipped swing are taken for vibration, which is a defect; nothing else may be named.
    let is_told = |id: &String| ["readout-saturation", "vibration"].contains(&id.as_str());
    check(ids(&answer).iter().all(is_told), format!("{:?}", ids(&answer)))?;
    check(faults(&answer).is_empty(), format!("{:?}", faults(&answer)))?;
    // The same readings of a body that turns like them.
    let steady = by_hand(|t| about_x(swing(t).clamp(-3.0, 3.0), t), 4);
    let answer = without_position(&steady).diagnosed()?;
    check(!ids(&answer).contains("readout-saturation"), format!("{:?}", ids(&answer)))
}
