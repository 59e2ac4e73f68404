//! `check` of a sensor in poses that is not linear: it says of which sensor the linear model leaves more than noise,
//! for its intervals hold no such thing; and of a linear one nothing.

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::diagnosis::repeatability::besides::What;
use proofmass::diagnosis::tumble::known_in;

use super::diagnosis_tumble::many;
use super::tumble_bench::{Imu, model};
use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![test("check: a sensor that its linear model does not describe is said, and no other", beyond)]
}

/// What is planted, and the sensor that is to be said.
type Plant = (&'static str, fn(&mut Imu), &'static [&'static str]);

/// A square of 4e-4 of the force is 40 mm/s² at one g, next to a noise of a pose of 1 mm/s²; a gyro that bends by 1 % at
/// 1 rad/s is off by some 10 mrad after a turn, next to 0.5 mrad.
const PLANTS: [Plant; 3] = [
    ("nothing", |_| {}, &[]),
    ("a square of the force", |imu| imu.quadratic[0][2] = 4e-4, &["accelerometer"]),
    ("a gyro that bends", |imu| imu.bend_s = 0.01, &["gyro"]),
];

fn beyond() -> Result<(), Failed> {
    for (what, plant, expected) in PLANTS {
        let wrong = many(24, |seed| {
            let mut imu = Imu::without_defect(9000 + seed);
            plant(&mut imu);
            let (recording, poses) = imu.record(9000 + seed);
            let run = known_in(&recording, &model(), Some(poses), &Control::silent())?;
            let said: Vec<&str> = run.besides.iter().map(|besides| besides.channel.as_str()).collect();
            let large = run.besides.iter().all(|besides| matches!(besides.what, What::Beyond(times) if times > 2.0));
            Ok((said != expected || !large).then(|| format!("{seed}: {:?}", run.besides)))
        })?;
        // A false alarm in 250 sensors: two of 24 happen in 0.4 % of such trials (binomial).
        check(wrong.len() <= 1, format!("{what}: {}", wrong.join("; ")))?;
    }
    Ok(())
}
