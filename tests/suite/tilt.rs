//! A study along one axis says from when on its small angles are too large: a gyro with a constant
//! bias b tilts by b t, and sin θ departs from θ by 1 % at θ = √0.06 rad (θ³/6 = 0.01 θ).

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::{drift, ensemble, study};

use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![test("tilt: a study says from when on its tilt is not small, and only then", said)]
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
