//! What a motion leaves open, and what lies beyond the library: the first is not named, the second is said.
//!
//! References err by 1 mrad and 0.5 mm a pose, as motion capture does; expected numbers are those planted.

use libtest_mimic::{Failed, Trial};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use proofmass::diagnosis::answer::Answer;
use proofmass::diagnosis::verdict::Outcome;
use proofmass::report::diagnosis::worded;

use super::super::world::{check, near, test};
use super::flight::{by_hand, effect, ids, made_up, matrix};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("trajectory: of turns about one axis nothing else is named, and its scale is found", one_axis),
        test("trajectory: a slanted mounting is found next to misalignment, and neither spoils the other", slanted),
        test("trajectory: a law that is no candidate is said, and is no noise of the reference", beyond),
    ]
}

/// Turns about the vertical alone, of 2 rad/s, which show one scale of three, and two columns of misalignment in
/// none. Where nothing turns, a fit of noise to noise has a slope of any size.
fn one_axis() -> Result<(), Failed> {
    let turning = |t: f64| [0.0, 0.0, 1.4 * (1.3 * t).sin() + 1.4 * (2.1 * t + 0.5).sin()];
    for seed in [1, 2, 3] {
        let flight = by_hand(turning, seed).captured();
        let attitude = ["timestamp", "q_RS"];
        for (what, files) in [("whole", flight.files()), ("attitude", flight.files().with_columns(&attitude))] {
            let names = ids(&files.diagnosed()?);
            check(names.iter().all(|id| id == "reference-noise"), format!("seed {seed}, {what}: {names:?}"))?;
        }
        let scaled = flight.with_rate(|w| [w[0], w[1], 1.02 * w[2]]).diagnosed()?;
        let names = ids(&scaled);
        let expected = ["reference-noise", "scale-factor"].map(str::to_owned);
        check(names.iter().eq(&expected), format!("seed {seed}: {names:?}"))?;
        let found = &effect(&scaled, "scale-factor")?.parameters;
        check(found.len() == 1 && found[0].name == "gyro_z", format!("seed {seed}: {found:?}"))?;
        // 1 mrad of 120 turns by some 2 rad: 4 ppm; held to fifty of them.
        near("scale", found[0].value, 2e4, 200.0)?;
        let said = scaled.findings.iter().any(|f| f.contains("does not determine gyro_x, gyro_y of scale-factor"));
        check(said, format!("seed {seed}: {:?}", scaled.findings))?;
        let calibrated = matrix(&scaled)?;
        near("scale of x, left as it is", calibrated[0][0], 1.0, 1e-12)?;
        near("scale of z, calibrated", calibrated[2][2], 1.0 / 1.02, 2e-4)?;
    }
    Ok(())
}

/// Next to free axes of the gyro only specific force tells a mounting, and of a turn about the vertical only level
/// acceleration: some 0.3° here, and in each misalignment as much.
fn slanted() -> Result<(), Failed> {
    let turn = Vector3::new(10.0f64, 20.0, -90.0).map(f64::to_radians);
    let skew = Matrix3::new(0.0, 10.0, -20.0, 10.0, 0.0, 15.0, -20.0, 10.0, 0.0) * 1e-3;
    let flight = made_up(1)?.captured().mounted(UnitQuaternion::from_scaled_axis(turn));
    let straight = flight.diagnosed()?;
    check(!ids(&straight).contains("misalignment"), format!("none planted: {:?}", ids(&straight)))?;
    let askew = flight.with_rate(|w| (Vector3::from(w) + skew * Vector3::from(w)).into()).diagnosed()?;
    for (answer, most_deg) in [(&straight, 0.05), (&askew, 0.5)] {
        for (axis, p) in effect(answer, "mounting")?.parameters.iter().enumerate() {
            let half = 0.5 * (p.ci95[1] - p.ci95[0]);
            check(half < most_deg, format!("{}: {:?} says little", p.name, p.ci95))?;
            near(&format!("mounting {}", p.name), p.value, turn[axis].to_degrees(), 1.6 * half)?;
        }
        check(!ids(answer).contains("accelerometer-bias"), format!("{:?}", ids(answer)))?;
    }
    let expected = [skew.m12, skew.m13, skew.m21, skew.m23, skew.m31, skew.m32];
    for (p, expected) in effect(&askew, "misalignment")?.parameters.iter().zip(expected) {
        let half = 0.5 * (p.ci95[1] - p.ci95[0]);
        check(half < 8.0, format!("{}: ±{half} mrad says little", p.name))?;
        near(&p.name, p.value, 1e3 * expected, 1.6 * half)?;
    }
    Ok(())
}

fn finding<'a>(answer: &'a Answer, start: &str) -> Option<&'a String> {
    answer.findings.iter().find(|f| f.starts_with(start))
}

/// Turns about every axis, some 2 rad/s.
fn waving(t: f64) -> [f64; 3] {
    [1.3, 0.9, 1.1].map(|f| 1.8 * (f * t + f).sin() + 0.8 * (2.3 * f * t).sin())
}

/// A gyro that reads 1 % of the square of its rate too much, and positions that are 2 % too large.
fn beyond() -> Result<(), Failed> {
    const LEFT: &str = "what is left goes with the ";
    let lawful = |answer: &Answer, words: [&str; 2]| {
        let said = finding(answer, LEFT).ok_or_else(|| format!("no law is said: {:?}", answer.findings))?;
        check(words.iter().all(|w| said.contains(w)), said.clone())?;
        check(answer.outcome == Outcome::Unexplained, format!("{:?}", answer.outcome))
    };
    for seed in [1, 2] {
        let hand = by_hand(waving, seed).captured();
        let drone = made_up(seed)?.captured();
        for flight in [&hand, &drone] {
            let plain = flight.diagnosed()?;
            check(plain.outcome == Outcome::Explained, format!("seed {seed}: {:?}", plain.outcome))?;
            check(finding(&plain, LEFT).is_none(), "a law is said where there is none")?;
        }
        let square = hand.with_rate(|w| w.map(|v| v + 0.01 * v * v)).diagnosed()?;
        lawful(&square, ["square of the gyro's rate", "gyro_x "])?;
        let large = drone.with_pose_at(|_, p, q| (p * 1.02, q)).diagnosed()?;
        lawful(&large, ["size of the reference's positions", "too_large "])?;
        let sentence = worded(large).verdict.sentence;
        check(sentence.contains("goes with a law that no candidate has"), sentence)?;
    }
    Ok(())
}
