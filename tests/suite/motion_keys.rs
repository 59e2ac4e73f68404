//! `[vibration]` and `[navigator]`: each key does what its law says, and nothing where there is
//! nothing for it to act on.

use libtest_mimic::{Failed, Trial};
use proofmass::backend::flight::Quantity;
use proofmass::strapdown::answer::Answer;

use super::strapdown::{answered, series};
use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("motion keys: vibration along each axis is rectified by a quadratic nonlinearity", rectified),
        test("motion keys: the navigator's integrator owns its row of the budget", integrator),
    ]
}

const DURATION_S: f64 = 60.0;
/// Of the nonlinearity, m/s² per g².
const K2_M_S2_G2: f64 = 100e-6 * 9.806_65;

fn shaken(vibration: &str) -> Result<Answer, Failed> {
    answered(&format!(
        "members = 64\nduration_s = {DURATION_S:?}\n[sensor]\nsample_rate_hz = 400.0\n[trajectory]\nkind = \"rest\"\n\
         [accelerometer]\nk2_ug_per_g2 = 100.0\n{vibration}[report]\ntimes_s = [{DURATION_S:?}]\n"
    ))
}

/// A zero-mean force of mean square σ² beside a constant f reads, through K₂, as a bias K₂ (f² +
/// σ²) (IEEE 1293, vibration rectification). σ² is the integral of the density: flat from 20 to 80
/// Hz at 0.01 g²/Hz, 0.6 g².
fn rectified() -> Result<(), Failed> {
    let velocity = |answer: &Answer, axis: usize| series(answer, Quantity::Velocity(axis), |s| s.mean)[0];
    let still = shaken("")?;
    for (axis, key) in ["x_g2_hz", "y_g2_hz", "z_g2_hz"].into_iter().enumerate() {
        let answer = shaken(&format!("[vibration]\n{key} = [[20.0, 0.01], [80.0, 0.01]]\n"))?;
        let expected = K2_M_S2_G2 * 0.6 * DURATION_S;
        // The mean square of a band of B over T has the relative standard error 1/√(B T).
        let four = 4.0 / (60.0 * DURATION_S).sqrt();
        for other in 0..3 {
            let gained = velocity(&answer, other) - velocity(&still, other);
            let law = if other == axis { expected } else { 0.0 };
            near(&format!("{key}, axis {other}"), gained, law, four * expected)?;
        }
        // Control: half the density is another bias.
        let half = shaken(&format!("[vibration]\n{key} = [[20.0, 0.005], [80.0, 0.005]]\n"))?;
        let gained = velocity(&half, axis) - velocity(&still, axis);
        check((gained - expected).abs() > four * expected, "any density is rectified alike")?;
    }
    Ok(())
}

/// Horizontal rms of the row at the last report, m.
fn own_m(motion: &str, integrator: &str) -> Result<f64, Failed> {
    let answer = answered(&format!(
        "members = 64\nduration_s = 30.0\n[sensor]\nsample_rate_hz = 50.0\n[trajectory]\n{motion}[navigator]\n\
         integrator = \"{integrator}\"\n"
    ))?;
    let last = *answer.report.last().ok_or("no report")?;
    let own = answer.own.as_ref().ok_or("no row")?;
    Ok(answer.covariance.horizontal_m2(own, last).sqrt())
}

/// Coning and sculling within a sample are what a single-sample navigator leaves out (Savage, J.
/// Guidance 21 (1998) 19).
fn integrator() -> Result<(), Failed> {
    let drone = "kind = \"drone\"\n";
    let [single, compensated] = [own_m(drone, "single-sample")?, own_m(drone, "compensated")?];
    check(compensated > 0.0 && single > 5.0 * compensated, format!("{single} m and {compensated} m"))?;
    // Control: at rest there is nothing to compensate.
    let [single, compensated] = ["single-sample", "compensated"].map(|name| own_m("kind = \"rest\"\n", name));
    near("at rest", single?, compensated?, 1e-9)
}
