//! What a navigator errs by on perfect readings is in every figure of a study, and where the ensemble's mean is not
//! that of the linear model, or members fail, the answer says so.

use libtest_mimic::{Failed, Trial};
use nalgebra::Vector3;
use proofmass::backend::flight::Quantity;
use proofmass::control::Control;
use proofmass::ensemble::Choice;
use proofmass::motion::mechanisation::own_error;
use proofmass::report::strapdown::{findings, lede};
use proofmass::strapdown::answer::{Answer, Departure};
use proofmass::strapdown::backends::run_on;

use super::strapdown::{answered, percentiles_apart};
use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("own integration: every figure has the error of the navigator itself", in_figures),
        test("own integration: a mean that the linear model has not is said", means),
        test("own integration: members that fail are said with the answer", failed),
        gpu_test("own integration: the GPU's figures have it as well", on_gpu),
    ]
}

/// A drone read fifty times a second by a navigator that takes a sample for constant, with biases of 0.01 mg and
/// 0.01 °/h.
const COARSE: &str = "members = 1024\nduration_s = 60.0\n[trajectory]\nkind = \"drone\"\n[sensor]\nsample_rate_hz = 50.0\n\
    [accelerometer]\nbias_mg = { mean = 0.0, sd = 0.01 }\n[gyro]\nbias_deg_h = { mean = 0.0, sd = 0.01 }\n[navigator]\nintegrator = \"single-sample\"\n[report]\ntimes_s = [10.0, 60.0]\n";

fn last(answer: &Answer) -> Result<usize, Failed> {
    answer.report.last().copied().ok_or_else(|| "no report".into())
}

/// Expected: the error of the same navigator in f64 on the increments of the truth, which the tests of `mechanisation`
/// hold against closed forms. The biases have no mean.
fn in_figures() -> Result<(), Failed> {
    let answer = answered(COARSE)?;
    let (k, flight) = (last(&answer)?, &answer.flight);
    let errors = own_error(&flight.course.earth, answer_integrator(COARSE)?, &flight.course.truth);
    let own: Vector3<f64> = errors.last().ok_or("no error")?.position_m;
    check(own.xy().norm() > 0.1, format!("the navigator itself errs by {own} m, too little for a test"))?;
    for (axis, expected) in own.iter().enumerate() {
        let summary = answer.ensemble.summary(k, Quantity::Position(axis));
        let chance = 4.0 * summary.sd / (summary.count as f64).sqrt();
        near(&format!("mean along axis {axis}, m"), summary.mean, *expected, chance + 1e-3)?;
    }
    let rms = |quantity| {
        let summary = answer.ensemble.summary(k, quantity);
        summary.mean.hypot(summary.sd)
    };
    let (north, east) = (rms(Quantity::Position(0)), rms(Quantity::Position(1)));
    // A sample's variance divides by n − 1.
    near("horizontal distance, rms, m", rms(Quantity::Horizontal), north.hypot(east), north.hypot(east) / 1024.0)?;
    let budget = answer.parts().map(|part| part.horizontal_m2(k)).sum::<f64>().sqrt();
    // 1024 members know a spread to 2.2 %, of which half the square is: held to four of them.
    near("the budget's sum over the ensemble", budget / rms(Quantity::Horizontal), 1.0, 0.06)?;
    // The control: a navigator that allows for the motion within a sample errs by less.
    let fine = answered(&COARSE.replace("single-sample", "compensated"))?;
    let mean = |answer: &Answer| answer.ensemble.summary(k, Quantity::Position(0)).mean.abs();
    check(mean(&fine) < 0.5 * mean(&answer), format!("{} and {} m", mean(&fine), mean(&answer)))
}

fn answer_integrator(text: &str) -> Result<proofmass::motion::Integrator, Failed> {
    let study = super::strapdown::parsed(text)?;
    Ok(study.in_motion.as_ref().ok_or("no trajectory")?.mechanisation)
}

/// Readings that come 50 ms late move the mean by metres, which no covariance has.
fn means() -> Result<(), Failed> {
    let of = |delay_s: f64| {
        let text = COARSE.replace("single-sample", "compensated").replace("50.0", "200.0");
        answered(&text.replace("[accelerometer]", &format!("readout_delay_s = {delay_s:?}\n[accelerometer]")))
    };
    let late = of(0.05)?;
    let is_mean = late.apart.iter().any(|apart| matches!(apart.departure, Departure::Mean { .. }));
    let said = findings(&late).join(" ");
    check(is_mean && said.contains("the mean of the") && said.contains("readout delay"), said)?;
    let said = findings(&of(0.0)?).join(" ");
    check(said.is_empty(), format!("without a delay: {said}"))
}

/// A free vertical channel of an hour and a half grows by e every 570 s/√2: some of a wide spread leave the numbers.
fn failed() -> Result<(), Failed> {
    let text = "members = 64\nduration_s = 10800.0\n[trajectory]\nkind = \"rest\"\n[sensor]\nsample_rate_hz = 10.0\n\
        [accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\n[earth]\nlatitude_deg = 45.0\n[report]\ntimes_s = [10800.0]\n";
    let answer = answered(text)?;
    let count = answer.ensemble.failed;
    check(count > 0, "none failed, so that nothing is tested")?;
    check(lede(&answer).contains(&format!("({count} did)")), lede(&answer))?;
    let said = findings(&answer).join(" ");
    check(said.contains(&format!("{count} of 64 members failed")), said)?;
    // The control: in a tenth of the time none does, and nothing is said.
    let short = answered(&text.replace("10800.0", "1080.0"))?;
    check(short.ensemble.failed == 0 && !lede(&short).contains("fail"), lede(&short))
}

fn on_gpu() -> Result<(), Failed> {
    let answer = answered(COARSE)?;
    let on = |choice| run_on(choice, &answer.flight, &Control::silent());
    let (cpu, gpu) = (on(Choice::Cpu)?, on(Choice::Gpu)?);
    check(gpu.machine.kind == "gpu", "the GPU's run was not on a GPU")?;
    let apart = percentiles_apart(&cpu, &gpu, answer.ensemble.time_s.len());
    check(apart < 5e-3, format!("percentiles {apart} sd apart"))?;
    let mut without = answer.flight.clone();
    without.own = Default::default();
    let none = run_on(Choice::Gpu, &without, &Control::silent())?;
    let apart = percentiles_apart(&cpu, &none, answer.ensemble.time_s.len());
    check(apart > 0.1, "without it the percentiles are the same: the comparison is blind")
}
