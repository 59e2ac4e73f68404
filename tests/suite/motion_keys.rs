//! `[vibration]`, `[navigator]` and a gyro's range: each key does what its law says, and nothing
//! where there is nothing for it to act on.

use libtest_mimic::{Failed, Trial};
use proofmass::backend::flight::Quantity;
use proofmass::control::Control;
use proofmass::ensemble::Choice;
use proofmass::strapdown::answer::Answer;
use proofmass::strapdown::backends::run_on;
use proofmass::strapdown::run::Ensemble;

use super::strapdown::{answered, parsed, percentiles_apart, series};
use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("motion keys: vibration along each axis is rectified by a quadratic nonlinearity", rectified),
        test("motion keys: the navigator's integrator owns its row of the budget", integrator),
        test("motion keys: beyond its range a gyro reads no more, whatever its other errors", range),
        gpu_test("motion keys: the GPU ends a gyro's range where the CPU does", range_on_the_gpu),
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
    check(still.simulated.is_empty(), "a row for a vibration that is not there")?;
    for (axis, key) in ["x_g2_hz", "y_g2_hz", "z_g2_hz"].into_iter().enumerate() {
        let answer = shaken(&format!("[vibration]\n{key} = [[20.0, 0.01], [80.0, 0.01]]\n"))?;
        let expected = K2_M_S2_G2 * 0.6 * DURATION_S;
        // The mean square of a band of B over T has the relative standard error 1/√(B T).
        let four = 4.0 / (60.0 * DURATION_S).sqrt();
        for other in 0..3 {
            let gained = velocity(&answer, other) - velocity(&still, other);
            let law = if other == axis { expected } else { 0.0 };
            near(&format!("{key}, axis {other}"), gained, law, four * expected)?;
            let last = *answer.report.last().ok_or("no report")?;
            let row = answer.simulated.first().ok_or("no row of the vibration")?;
            near(
                &format!("{key}, row of the budget, axis {other}"),
                row.mean[last][3 + other],
                gained,
                1e-2 * expected,
            )?;
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
    Ok(answer.own.horizontal_m2(last).sqrt())
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

/// Level circles at 5 m/s with a radius of 10 m: 0.5 rad/s about down.
fn circling(gyro: &str, start: &str) -> String {
    format!(
        "members = 64\nduration_s = 10.0\n[sensor]\nsample_rate_hz = 200.0\n[gyro]\n{gyro}[trajectory]\n\
         kind = \"circle\"\nradius_m = 10.0\nspeed_m_s = 5.0\n{start}[report]\ntimes_s = [10.0]\n"
    )
}

/// Rows of the budget that are simulated: cause and mean of one error.
pub type Rows = Vec<(&'static str, f64)>;

/// What the gyro falls short by turns the heading: (R − Ω) t, whatever bias it has beside.
fn range() -> Result<(), Failed> {
    let heading = |gyro: &str| -> Result<(f64, Rows), Failed> {
        let answer = answered(&circling(gyro, ""))?;
        let last = *answer.report.last().ok_or("no report")?;
        let left_out = answer.simulated.iter().map(|part| (part.cause.name(), part.mean[last][8])).collect();
        Ok((answer.ensemble.summary(last, Quantity::Attitude(2)).mean, left_out))
    };
    let range_deg_s = 28.0_f64;
    let short = (range_deg_s.to_radians() - 0.5) * 10.0;
    for more in ["", "bias_deg_h = [0.0, 0.0, 3600.0]\n", "scale_factor_ppm = 5000.0\n"] {
        let (error, left_out) = heading(&format!("range_deg_s = {range_deg_s:?}\n{more}"))?;
        near(&format!("heading error, {more}"), error, short, 1e-4)?;
        let [("gyro range", row)] = left_out[..] else { return Err(format!("simulated: {left_out:?}").into()) };
        // What the range changes: all that the gyro would have read without it.
        let without = heading(more)?.0;
        near(&format!("row of the range, heading, {more}"), row, short - without, 1e-4)?;
    }
    // Controls: a range that is never reached, and one that a bias of 1 °/s reaches.
    let (free, _) = heading("range_deg_s = 29.0\n")?;
    near("heading error within the range", free, 0.0, 1e-4)?;
    let (biased, _) = heading("range_deg_s = 29.0\nbias_deg_h = [0.0, 0.0, 3600.0]\n")?;
    near("heading error of a bias", biased, (29f64.to_radians() - 0.5) * 10.0, 1e-4)?;
    let refused = parsed("members = 2\nduration_s = 1.0\n[gyro]\nrange_deg_s = 100.0\n").err();
    let refused = refused.map(|error| format!("{error:?}")).unwrap_or_default();
    check(refused.contains("gyro.range_deg_s") && refused.contains("[trajectory]"), refused)
}

fn range_on_the_gpu() -> Result<(), Failed> {
    let noise = "angle_random_walk_deg_rth = 1.0\nbias_deg_h = { mean = 3600.0, sd = 1800.0 }\n";
    let start = "still_s = 2.0\n[alignment]\nkind = \"still\"\nstill_s = 3.0\n";
    let on = |choice, range_deg_s: f64| -> Result<Ensemble, Failed> {
        let gyro = format!("range_deg_s = {range_deg_s:?}\n{noise}");
        let study = parsed(&circling(&gyro, start).replace("= 64", "= 1024"))?;
        let flight = study.flight(study.in_motion.as_ref().ok_or("no trajectory")?, vec![300, 1000, 2000])?;
        Ok(run_on(choice, &flight, &Control::silent())?)
    };
    let (here, there) = (on(Choice::Cpu, 29.0)?, on(Choice::Gpu, 29.0)?);
    check(there.machine.kind == "gpu", "the GPU's run was not on a GPU")?;
    let apart = percentiles_apart(&here, &there, 3);
    check(apart < 5e-3, format!("percentiles {apart} sd apart"))?;
    let other = percentiles_apart(&here, &on(Choice::Cpu, 29.2)?, 3);
    check(other > 5e-3, format!("another range is {other} sd apart (control)"))
}
