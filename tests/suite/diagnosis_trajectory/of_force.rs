//! Scale and axes of the accelerometer, as a body that turns shows them by gravity: found next to whole poses, and
//! not where the reference's positions have another size.
//!
//! References err by 1 mrad and 0.5 mm a pose, as motion capture does; expected numbers are those planted.

use std::collections::BTreeSet;

use libtest_mimic::{Failed, Trial};
use nalgebra::{Matrix3, Vector3};
use proofmass::diagnosis::answer::{Answer, Detail};
use proofmass::diagnosis::verdict::{Effect, Outcome};

use super::super::world::{check, near, test};
use super::flight::{Flight, by_hand, ids, made_up};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("trajectory: scale and axes of the accelerometer are found as the body turns, and calibrated", found),
        test("trajectory: positions of another size are no scale of the accelerometer", size),
    ]
}

/// Turns about every axis, some 2 rad/s.
fn waving(t: f64) -> [f64; 3] {
    [1.3, 0.9, 1.1].map(|f| 1.8 * (f * t + f).sin() + 0.8 * (2.3 * f * t).sin())
}

fn scaled(flight: &Flight, matrix: Matrix3<f64>) -> Flight {
    flight.with_force(|f| (matrix * Vector3::from(f)).into())
}

fn of_force<'a>(answer: &'a Answer, id: &str) -> Option<&'a Effect> {
    answer.effects.iter().find(|e| e.id == id && e.parameters.iter().all(|p| p.name.starts_with("accelerometer")))
}

fn found() -> Result<(), Failed> {
    let scale = [0.02, -0.01, 0.03];
    let diagonal = Matrix3::from_diagonal(&Vector3::from(scale).add_scalar(1.0));
    let skew = Matrix3::new(0.0, 0.0, 0.0, 6e-3, 0.0, 0.0, -4e-3, 5e-3, 0.0);
    for seed in [1, 2] {
        let hand = by_hand(waving, seed).captured();
        let none = hand.diagnosed()?;
        check(ids(&none) == BTreeSet::from(["reference-noise".to_owned()]), format!("{seed}: {:?}", ids(&none)))?;
        for (what, matrix) in [("scale-factor", diagonal), ("misalignment", Matrix3::identity() + skew)] {
            let answer = scaled(&hand, matrix).diagnosed()?;
            let names = ids(&answer);
            check(names == BTreeSet::from([what.to_owned(), "reference-noise".to_owned()]), format!("{names:?}"))?;
            check(answer.outcome == Outcome::Explained, format!("{seed}, {what}: {:?}", answer.outcome))?;
            let effect = of_force(&answer, what).ok_or("it is not the accelerometer's")?;
            let expected: Vec<f64> = match what {
                "scale-factor" => scale.map(|s| s * 1e6).into(),
                _ => [skew.m21, skew.m31, skew.m32].map(|s| s * 1e3).into(),
            };
            // In the unit of each: 300 ppm, 0.3 mrad, a hundredth of what is planted.
            let most = if what == "scale-factor" { 300.0 } else { 0.3 };
            check(effect.parameters.len() == expected.len(), format!("{:?}", effect.parameters))?;
            for (p, expected) in effect.parameters.iter().zip(expected) {
                let half = 0.5 * (p.ci95[1] - p.ci95[0]);
                check(half < most, format!("{}: ±{half} {} says little", p.name, p.unit))?;
                near(&p.name, p.value, expected, 1.6 * half)?;
            }
            let Detail::Trajectory(detail) = &answer.detail else { return Err("another kind".into()) };
            let calibrated = &detail.published.as_ref().ok_or("no calibration")?.accelerometer.matrix;
            let inverse = matrix.try_inverse().ok_or("no inverse")?;
            for (i, row) in calibrated.iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    near(&format!("calibration {i}{j}"), *value, inverse[(i, j)], 5e-4)?;
                }
            }
        }
    }
    Ok(())
}

/// Both signs and sizes on either side of what a sensor is delivered with: a scale does not do what they do, for
/// gravity stays as large as it is.
fn size() -> Result<(), Failed> {
    for (seed, size) in [(1, 1.02), (2, 0.994)] {
        let drone = made_up(seed)?.captured();
        let answer = drone.with_pose_at(|_, p, q| (p * size, q)).diagnosed()?;
        check(of_force(&answer, "scale-factor").is_none(), format!("{size}: {:?}", ids(&answer)))?;
        // The control: as large a scale, in the accelerometer alone, is one.
        let answer = scaled(&drone, Matrix3::identity() * size).diagnosed()?;
        check(of_force(&answer, "scale-factor").is_some(), format!("{size}, its own: {:?}", ids(&answer)))?;
    }
    Ok(())
}
