//! Poses that err each by itself are no noise of the sensor.

use libtest_mimic::{Failed, Trial};
use nalgebra::Vector3;
use proofmass::rng::{Philox, Stream};
use proofmass::strapdown::windows::Sensor;
use proofmass::strapdown::windows::score;

use super::super::world::{check, near, test};
use super::{NOISE, RIGHT, compared, plain, poses, readings, study_text, together, truth};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![test(
        "flown: poses that err each by itself are not taken for noise of the sensor, however agile the flight",
        agile,
    )]
}

fn agile() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let mut draw = Philox::new(7, 1, Stream::Start);
    let mut sensor_m = 0.0;
    // 12 m/s² sideways: readings are longer than gravity by half. Then poses of 20 mm, whose spline is known to
    // decimetres per second.
    for (radius_m, speed_m_s, off_m) in [(3.0, 6.0, 0.0), (10.0, 3.0, 0.02)] {
        let mut truth =
            truth(&format!("kind = \"figure-eight\"\nradius_m = {radius_m:?}\nspeed_m_s = {speed_m_s:?}"), 200.0)?;
        std::fs::write(folder.path().join("imu.csv"), readings(&truth, 1.0, plain))?;
        truth.samples.iter_mut().for_each(|s| s.position_m += Vector3::from_fn(|_, _| off_m * draw.normal()));
        std::fs::write(folder.path().join("poses.csv"), poses(&truth))?;
        let found = compared(folder.path(), &study_text("[5.0]", ""))?;
        let [low, high] = found.inflation.ok_or("no inflation")?.interval[3];
        // One interval of 95 %, widened by a fifth.
        check(low / 1.2 <= NOISE[1] && NOISE[1] <= high * 1.2, format!("{off_m}: N {low} to {high}, {}", NOISE[1]))?;
        near(&format!("{off_m}"), together(&found, &Sensor::Stated)?, 1.0, RIGHT)?;
        let north = score::axis(&found.lengths[0].errors(), &found.lengths[0].expected[0], 0);
        sensor_m = if off_m == 0.0 { north.sd_predicted } else { sensor_m };
        // Control: these windows err by far more than the sensor alone explains.
        check((north.rms_recorded > 1.5 * sensor_m) == (off_m > 0.0), format!("{off_m}: {north:?}, {sensor_m}"))?;
    }
    Ok(())
}
