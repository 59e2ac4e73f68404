//! A study along one axis says from when on its small angles are too large: a gyro with a constant
//! bias b tilts by b t, and sin θ departs from θ by 1 % at θ = √0.06 rad (θ³/6 = 0.01 θ).

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::flight::Quantity;
use proofmass::control::Control;
use proofmass::drift::scope::SMALL_TILT_RAD;
use proofmass::statistics::quantity;
use proofmass::{drift, ensemble, study};

use super::strapdown::{answered, series};
use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("tilt: a study says from when on its tilt is not small, and only then", said),
        test("tilt: six axes put the force of a small tilt 1 % lower at the angle that is stated", six_axes),
    ]
}

/// When the tilt of a study with this gyro bias, °/h, stops being small, s.
fn ends_s(bias_deg_h: f64) -> Result<Option<f64>, Failed> {
    let text = format!("members = 64\nduration_s = 60.0\n[gyro]\nbias_deg_h = {bias_deg_h:?}\n");
    let study = study::parse("tilt", &text, Path::new("."))?;
    let options = ensemble::Options::default();
    Ok(drift::answer(&study, &Control::silent(), |job, _| ensemble::run(job, &options))?.small_tilt_ends_s())
}

fn said() -> Result<(), Failed> {
    for bias_deg_h in [18_000.0f64, -18_000.0, 7_200.0] {
        let expected_s = 0.06f64.sqrt() / (bias_deg_h.abs() / 3600.0).to_radians();
        let got_s = ends_s(bias_deg_h)?.ok_or("a turn of 300 degrees is taken for a small tilt")?;
        // Points of the curve lie at most a quarter apart here.
        check((expected_s..1.25 * expected_s).contains(&got_s), format!("{got_s} s, expected {expected_s} s"))?;
    }
    // Control: 20 °/h tilt by 0.33° in a minute.
    check(ends_s(20.0)?.is_none(), "a third of a degree is called too large")
}

/// The study of six axes turns the force exactly, and so tells what the small angle of one axis costs.
/// A gyro with a bias of 2 °/s about one level axis tilts by θ = 2 °/s · t; the force that leaks is the
/// slope of the velocity error, over half a second to either side (by which a slope of g sin θ falls
/// short by (0.5 s · 2 °/s)²/6, 5e-5 of itself). At θ it departs by θ²/6 of itself.
fn six_axes() -> Result<(), Failed> {
    let rate_rad_s = 2f64.to_radians();
    for (part, expected) in [(1.0, 0.01), (0.5, 0.0025)] {
        // The samples next to the moment when the tilt is this part of the limit.
        let middle_s = (part * SMALL_TILT_RAD / rate_rad_s * 100.0).round() / 100.0;
        let times_s = [middle_s - 0.5, middle_s + 0.5].map(|t| (t * 100.0).round() / 100.0);
        let common = format!(
            "members = 64\nduration_s = 10.0\n[sensor]\nsample_rate_hz = 100.0\n[report]\ntimes_s = {times_s:?}\n"
        );
        let six =
            answered(&format!("{common}[trajectory]\nkind = \"rest\"\n[gyro]\nbias_deg_h = [0.0, 7200.0, 0.0]\n"))?;
        let velocities = series(&six, Quantity::Velocity(0), |s| s.mean);
        let one = study::parse("tilt", &format!("{common}[gyro]\nbias_deg_h = 7200.0\n"), Path::new("."))?;
        let options = ensemble::Options::default();
        let one = drift::answer(&one, &Control::silent(), |job, _| ensemble::run(job, &options))?;
        let alone: Vec<f64> = one.at_report(quantity::VELOCITY).iter().map(|s| s.mean).collect();
        let leaks = |velocity: &[f64]| (velocity[1] - velocity[0]).abs();
        let departs = 1.0 - leaks(&velocities) / leaks(&alone);
        // Of the next order, θ²/20 of the departure, and of the slopes' length, 2 %.
        near(&format!("departure at {part} of the limit"), departs, expected, 0.04 * expected)?;
    }
    Ok(())
}
