//! Slow errors with a time of their own along a trajectory: the ensemble of six axes and the linear
//! covariance agree on a Gauss–Markov process, a warm-up and a sinusoid, and so do CPU and GPU.

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::ensemble::Choice;
use proofmass::strapdown::backends::run_on;
use proofmass::strapdown::run;

use super::strapdown::{answered, parsed, percentiles_apart, ratios};
use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all: Vec<Trial> = CASES
        .iter()
        .map(|case| test(&format!("slow in motion: {} spreads as the linear covariance says", case.0), || agree(case)))
        .collect();
    all.push(test("slow in motion: a time that is drawn is left out of the covariance, and named", left_out));
    all.push(gpu_test("slow in motion: the GPU gives the CPU's percentiles", parity));
    all
}

/// What it is, its lines in `[accelerometer]` and in `[gyro]`, and a change to one of them that must
/// be seen.
type Case = (&'static str, &'static str, &'static str, [&'static str; 2]);

const CASES: &[Case] = &[
    (
        "an accelerometer's Gauss–Markov process",
        "gauss_markov_ug = 500.0\ngauss_markov_time_s = 8.0\n",
        "",
        ["time_s = 8.0", "time_s = 16.0"],
    ),
    (
        "a gyro's Gauss–Markov process",
        "",
        "gauss_markov_deg_h = 6.0\ngauss_markov_time_s = 8.0\n",
        ["time_s = 8.0", "time_s = 16.0"],
    ),
    // A step of the covariance is 20 ms.
    (
        "a process that forgets within a step",
        "gauss_markov_ug = 9000.0\ngauss_markov_time_s = 0.008\n",
        "",
        ["time_s = 0.008", "time_s = 0.016"],
    ),
    (
        "an accelerometer's warm-up",
        "warm_up_mg = { mean = 1.0, sd = 2.0 }\nwarm_up_time_s = 12.0\n",
        "",
        ["time_s = 12.0", "time_s = 18.0"],
    ),
    (
        "a gyro's warm-up",
        "",
        "warm_up_deg_h = { mean = 2.0, sd = 8.0 }\nwarm_up_time_s = 12.0\n",
        ["time_s = 12.0", "time_s = 18.0"],
    ),
    ("an accelerometer's sinusoid", "sinusoid_mg = 2.0\nsinusoid_hz = 0.037\n", "", ["hz = 0.037", "hz = 0.05"]),
    ("a sinusoid of four steps", "sinusoid_mg = 50.0\nsinusoid_hz = 12.3\n", "", ["hz = 12.3", "hz = 9.3"]),
    (
        "a gyro's sinusoid of one phase",
        "",
        "sinusoid_deg_h = { min = 0.0, max = 4.0 }\nsinusoid_hz = 0.037\nsinusoid_phase_deg = 30.0\n",
        ["phase_deg = 30.0", "phase_deg = 70.0"],
    ),
];

/// 200 Hz, in a curve, at a latitude. Gyros err so little that the square of the tilt is nothing
/// beside the vertical noise.
fn text(accelerometer: &str, gyro: &str, start: &str) -> String {
    format!(
        "members = 2048\nduration_s = 60.0\n[sensor]\nsample_rate_hz = 200.0\n\
         [accelerometer]\nvelocity_random_walk_m_s_rth = 0.01\n{accelerometer}\
         [gyro]\nangle_random_walk_deg_rth = 0.01\n{gyro}\
         [trajectory]\nkind = \"circle\"\nradius_m = 200.0\nspeed_m_s = 5.0\n[earth]\nlatitude_deg = 47.4\n\
         [report]\ntimes_s = [5.0, 20.0, 60.0]\n{start}"
    )
}

const STARTS: [&str; 2] = [
    "[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 0.001\nheading_sd_deg = 0.01\n",
    "[alignment]\nkind = \"still\"\nstill_s = 10.0\nheading_sd_deg = 0.01\n",
];

fn agree((_, accelerometer, gyro, [from, to]): &Case) -> Result<(), Failed> {
    for start in STARTS {
        let answer = answered(&text(accelerometer, gyro, start))?;
        check(answer.covariance.left_out.is_empty(), format!("left out: {:?}", answer.covariance.left_out))?;
        // Four standard errors of a standard deviation, 1/√2n.
        let four = 4.0 / (2.0 * answer.ensemble.members as f64).sqrt();
        for (quantity, ratio) in ratios(&answer) {
            near(&format!("{quantity:?} over the covariance, {start}"), ratio, 1.0, four)?;
        }
        check(answer.apart.is_empty(), format!("{:?}", answer.apart))?;
        // Control: another shape is seen.
        let [accelerometer, gyro] = [accelerometer, gyro].map(|lines| lines.replace(from, to));
        let mut other = answered(&text(&accelerometer, &gyro, start).replace("2048", "64"))?;
        other.ensemble = answer.ensemble;
        let worst = ratios(&other).iter().map(|(_, ratio)| (ratio - 1.0).abs()).fold(0.0, f64::max);
        check(worst > four, format!("{to} has the covariance of {from}"))?;
    }
    Ok(())
}

fn left_out() -> Result<(), Failed> {
    let shape = |time: &str| text(&format!("gauss_markov_ug = 500.0\ngauss_markov_time_s = {time}\n"), "", STARTS[0]);
    let names = |time: &str| -> Result<Vec<&str>, Failed> {
        Ok(answered(&shape(time).replace("2048", "64"))?.covariance.left_out.iter().map(|cause| cause.name()).collect())
    };
    check(names("{ min = 4.0, max = 12.0 }")? == ["accelerometer Gauss–Markov bias"], "it is not named")?;
    check(names("8.0")?.is_empty(), "it is named though it is in (control)")
}

fn parity() -> Result<(), Failed> {
    let all = |part: usize| CASES.iter().map(|case| [case.1, case.2][part]).collect::<Vec<_>>();
    // One of each kind: a key stands once in a section.
    let of = |lines: &[&str], places: &[usize]| places.iter().map(|place| lines[*place]).collect::<String>();
    let (accelerometer, gyro) = (of(&all(0), &[0, 3, 5]), of(&all(1), &[1, 4, 7]));
    for start in STARTS {
        let text = text(&accelerometer, &gyro, start).replace("2048", "1024");
        let on = |choice, text: &str| -> Result<run::Ensemble, Failed> {
            let study = parsed(text)?;
            let flight = study.flight(study.in_motion.as_ref().ok_or("no trajectory")?, vec![7, 500, 12_000])?;
            Ok(run_on(choice, &flight, &Control::silent())?)
        };
        let (cpu, gpu) = (on(Choice::Cpu, &text)?, on(Choice::Gpu, &text)?);
        let other = on(Choice::Cpu, &text.replace("members", "seed = 2\nmembers"))?;
        check(gpu.machine.kind == "gpu", "the GPU's run was not on a GPU")?;
        let apart = |to: &run::Ensemble| percentiles_apart(&cpu, to, 3);
        check(apart(&gpu) < 5e-3, format!("percentiles {} sd apart", apart(&gpu)))?;
        check(apart(&other) > 5e-3, "another seed gave the same percentiles: the comparison is blind")?;
    }
    Ok(())
}
