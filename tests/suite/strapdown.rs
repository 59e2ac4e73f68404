//! Six axes: at rest on a flat Earth they are three studies of one axis; on a round one errors
//! oscillate with Schuler's period; small errors spread as the linear covariance says; tiles and
//! threads change no bit.

use libtest_mimic::{Failed, Trial};
use nalgebra::{UnitQuaternion, Vector3};
use proofmass::backend::flight::{FlightCpu, Quantity};
use proofmass::control::Control;
use proofmass::drift;
use proofmass::ensemble;
use proofmass::strapdown::answer::{Answer, LINEAR, answer};
use proofmass::strapdown::backends::run_on;
use proofmass::strapdown::kept::Kept;
use proofmass::strapdown::run;
use proofmass::study::{self, Study};
use serde_json::Value;

use super::world::{check, gpu_test, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("strapdown: at rest on a flat Earth each axis drifts as a study of one axis", at_rest),
        test("strapdown: a horizontal bias oscillates with Schuler's period", schuler_accelerometer),
        test("strapdown: a gyro bias drifts and oscillates with Schuler's period", schuler_gyro),
        test("strapdown: a vertical bias diverges", vertical),
        test("strapdown: small errors spread as the linear covariance says", covariance),
        test("strapdown: after a still start as well", covariance_after_still),
        test("strapdown: in a figure of eight and in a drive as well", covariance_in_motion),
        test("strapdown: attitude errors of any size turn the force exactly", exact),
        test("strapdown: large heading errors leave the linear covariance", nonlinear),
        test("strapdown: the same bits for any tile", tiles),
        test("strapdown: the same document for any number of threads", threads),
        gpu_test("strapdown: the GPU gives the CPU's percentiles, with and without a still start", parity),
        test("strapdown: the JSON is the contract's", document),
        test("strapdown: keys out of place are refused in a sentence", refusals),
    ]
}

pub(super) const NOISE: &str = "[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\nscale_factor_ppm = { mean = 0.0, sd = 300.0 }\n\
    noise_density_ug_rthz = 200.0\nbias_instability_ug = 60.0\nacceleration_random_walk_ug_rts = 10.0\n\
    [gyro]\nbias_deg_h = { mean = 0.0, sd = 10.0 }\nangle_random_walk_deg_rth = 0.3\nbias_instability_deg_h = 8.0\n\
    rate_random_walk_deg_h_rth = 8.0\n";

pub(super) fn parsed(text: &str) -> Result<Study, Failed> {
    Ok(study::parse("a test", text, std::path::Path::new("."))?)
}

pub(super) fn answered(text: &str) -> Result<Answer, Failed> {
    let study = parsed(text)?;
    let motion = study.in_motion.as_ref().ok_or("no trajectory")?;
    Ok(answer(&study, motion, ensemble::Choice::Cpu, &Control::silent())?)
}

/// Standard deviation or mean at the user's report times.
pub(super) fn series(
    answer: &Answer,
    quantity: Quantity,
    pick: fn(&proofmass::statistics::Summary) -> f64,
) -> Vec<f64> {
    answer.report.iter().map(|k| pick(answer.ensemble.summary(*k, quantity))).collect()
}

fn at_rest() -> Result<(), Failed> {
    let members = 4096;
    let text = |noise: &str, more: &str| {
        format!(
            "members = {members}\nduration_s = 20.0\n[sensor]\nsample_rate_hz = 50.0\n{noise}[report]\ntimes_s = [2.0, 20.0]\n{more}"
        )
    };
    let six = answered(&text(NOISE, "[trajectory]\nkind = \"rest\"\n"))?;
    let one = |noise: &str| -> Result<Vec<f64>, Failed> {
        let study = parsed(&text(noise, ""))?;
        let run = |job: &_, _: &str| ensemble::run(job, &ensemble::Options::default());
        let drift = drift::answer(&study, &Control::silent(), run)?;
        Ok(drift.at_report(proofmass::statistics::quantity::POSITION).iter().map(|s| s.sd).collect())
    };
    let (expected, other) = (one(NOISE)?, one(&NOISE.replace("sd = 10.0", "sd = 20.0"))?);
    // Both are samples: the ratio of two standard deviations has the relative standard error 1/√n.
    let four = 4.0 / f64::from(members).sqrt();
    for axis in 0..2 {
        let got = series(&six, Quantity::Position(axis), |s| s.sd);
        for (k, (got, expected)) in got.iter().zip(&expected).enumerate() {
            near(&format!("axis {axis}, report {k}"), got / expected, 1.0, four)?;
        }
        // Control: twice the gyro bias is seen.
        check((got[1] / other[1] - 1.0).abs() > four, "another gyro bias gave the same drift")?;
    }
    Ok(())
}

const SCHULER: &str = "members = 64\nduration_s = 7200.0\nstep_s = 0.1\n[sensor]\nsample_rate_hz = 10.0\n\
    [trajectory]\nkind = \"rest\"\n[earth]\nlatitude_deg = 45.0\nrotation = false\nvertical = \"held\"\n\
    [report]\ntimes_s = [600.0, 1200.0, 1800.0, 2532.0, 3600.0, 5064.0, 6000.0, 7200.0]\n";

/// WGS-84 at 45°: normal gravity (TR8350.2), radius of the meridian a(1 − e²)/(1 − e²/2)^1.5, of
/// the prime vertical a/(1 − e²/2)^0.5.
fn at_45() -> (f64, [f64; 2]) {
    let (a, f): (f64, f64) = (6_378_137.0, 1.0 / 298.257_223_563);
    let e2 = f * (2.0 - f);
    let w = 1.0 - 0.5 * e2;
    let gravity = 9.780_325_335_9 * (1.0 + 0.001_931_852_652_41 * 0.5) / w.sqrt();
    (gravity, [a * (1.0 - e2) / w.powf(1.5), a / w.sqrt()])
}

/// All reports of a mean against a law, within a thousandth of its amplitude.
fn follows(answer: &Answer, quantity: Quantity, amplitude: f64, law: impl Fn(f64) -> f64) -> Result<(), Failed> {
    for (got, time_s) in series(answer, quantity, |s| s.mean).iter().zip(answer.report_times_s()) {
        near(&format!("{quantity:?} after {time_s} s"), *got, law(time_s), 1e-3 * amplitude)?;
    }
    Ok(())
}

fn schuler_accelerometer() -> Result<(), Failed> {
    let (gravity, radii) = at_45();
    let bias = 1e-4 * 9.806_65;
    for (axis, list) in [(0, "[0.1, 0.0, 0.0]"), (1, "[0.0, 0.1, 0.0]")] {
        let answer = answered(&format!("{SCHULER}[accelerometer]\nbias_mg = {list}\n"))?;
        let square = gravity / radii[axis];
        let law = |square: f64| move |t: f64| bias / square * (1.0 - (square.sqrt() * t).cos());
        follows(&answer, Quantity::Position(axis), 2.0 * bias / square, law(square))?;
        // Control: the other axis' radius, 0.3 % more or less, is seen.
        let other = gravity / radii[1 - axis];
        check(follows(&answer, Quantity::Position(axis), 2.0 * bias / square, law(other)).is_err(), "any radius fits")?;
    }
    Ok(())
}

fn schuler_gyro() -> Result<(), Failed> {
    let (gravity, radii) = at_45();
    let bias = 0.01 * std::f64::consts::PI / 180.0 / 3600.0;
    // A rate about east tilts the level to the south: position runs north by −R ε (t − sin ω t/ω);
    // about north, east by +.
    for (axis, sign, list) in [(0, -1.0, "[0.0, 0.01, 0.0]"), (1, 1.0, "[0.01, 0.0, 0.0]")] {
        let answer = answered(&format!("{SCHULER}[gyro]\nbias_deg_h = {list}\n"))?;
        let rate = (gravity / radii[axis]).sqrt();
        let law = |t: f64| sign * radii[axis] * bias * (t - (rate * t).sin() / rate);
        follows(&answer, Quantity::Position(axis), law(7200.0).abs(), law)?;
        let flat = |t: f64| sign * gravity * bias * t.powi(3) / 6.0;
        check(follows(&answer, Quantity::Position(axis), law(7200.0).abs(), flat).is_err(), "a flat Earth fits")?;
    }
    Ok(())
}

/// z″ = b + 2g/R z, with the gradient of normal gravity 2g/a (1 + f + m − 2f sin² φ) of TR8350.2.
fn vertical() -> Result<(), Failed> {
    let text =
        SCHULER.replace("held", "free").replace("7200.0]", "7000.0]").replace(", 3600.0, 5064.0, 6000.0, 7000.0", "");
    let answer =
        answered(&format!("{}[accelerometer]\nbias_mg = [0.0, 0.0, 0.1]\n", text.replace("7200.0", "2532.0")))?;
    let (gravity, _) = at_45();
    let flattening = 1.0 / 298.257_223_563;
    let surface = 2.0 * gravity / 6_378_137.0 * (1.0 + flattening + 0.003_449_786_506_84 - flattening);
    let bias = 1e-4 * 9.806_65;
    let law = |square: f64| move |t: f64| bias / square * ((square.sqrt() * t).cosh() - 1.0);
    follows(&answer, Quantity::Position(2), law(surface)(2532.0), law(surface))?;
    check(
        follows(&answer, Quantity::Position(2), law(surface)(2532.0), law(0.5 * surface)).is_err(),
        "any gradient fits",
    )
}

const SPREADS: &str = "members = 4096\nduration_s = 60.0\n[sensor]\nsample_rate_hz = 50.0\n[trajectory]\nkind = \"rest\"\n\
    [earth]\nlatitude_deg = 47.4\nheight_m = 400.0\n[report]\ntimes_s = [1.0, 10.0, 60.0]\n";

/// Every spread of an ensemble over that of the linear model.
pub(super) fn ratios(answer: &Answer) -> Vec<(Quantity, f64)> {
    let ratio = |k: usize, place: usize| {
        answer.ensemble.summary(k, LINEAR[place]).sd / answer.covariance.variance(k, place).sqrt()
    };
    answer
        .report
        .iter()
        .flat_map(|k| (0..9).map(|place| (LINEAR[place], ratio(*k, place))).collect::<Vec<_>>())
        .collect()
}

fn agree(text: &str) -> Result<(), Failed> {
    let answer = answered(text)?;
    // Four standard errors of a standard deviation, 1/√2n.
    let four = 4.0 / (2.0 * answer.ensemble.members as f64).sqrt();
    for (quantity, ratio) in ratios(&answer) {
        near(&format!("{quantity:?}"), ratio, 1.0, four)?;
    }
    check(answer.apart.is_empty(), format!("{:?}", answer.apart))?;
    // Control: a model of other errors is seen.
    let other = answered(&text.replace("rth = 0.3\n", "rth = 0.6\n"))?;
    let last = *answer.report.last().ok_or("no report")?;
    let ratio = answer.ensemble.summary(last, LINEAR[0]).sd / other.covariance.variance(last, 0).sqrt();
    check((ratio - 1.0).abs() > four, "another angle random walk has the same covariance")
}

fn covariance() -> Result<(), Failed> {
    let couplings = "misalignment_mrad = { mean = 0.0, sd = 1.0 }\ng_sensitivity_deg_h_g = { mean = 0.0, sd = 3.0 }\n\
                     g2_sensitivity_deg_h_g2 = { mean = 0.0, sd = 2.0 }\n";
    agree(&format!(
        "{SPREADS}{NOISE}{couplings}[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 0.02\nheading_sd_deg = 0.5\n"
    ))
}

fn covariance_after_still() -> Result<(), Failed> {
    agree(&format!("{SPREADS}{NOISE}[alignment]\nkind = \"still\"\nstill_s = 10.0\nheading_sd_deg = 0.5\n"))
}

fn covariance_in_motion() -> Result<(), Failed> {
    let more = "scale_factor_ppm = { mean = 0.0, sd = 500.0 }\nmisalignment_mrad = { mean = 0.0, sd = 1.0 }\n";
    let moving = |motion: &str| format!("{SPREADS}{NOISE}{more}").replace("kind = \"rest\"", motion);
    agree(&format!(
        "{}[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 0.02\nheading_sd_deg = 0.5\n",
        moving("kind = \"figure-eight\"\nradius_m = 50.0\nspeed_m_s = 10.0")
    ))?;
    agree(&format!(
        "{}[alignment]\nkind = \"still\"\nstill_s = 10.0\nheading_sd_deg = 0.5\n[mounting]\nlever_arm_m = [1.0, 0.5, -0.2]\n\
         rotation_deg = [0.0, 5.0, 90.0]\n",
        moving("kind = \"car\"")
    ))
}

/// At rest on a flat Earth under constant errors of the readings the computed attitude turns with
/// the gyros' error, exactly, and the position error is the double integral of the force that it
/// turns: here by the midpoint rule in f64.
fn exact() -> Result<(), Failed> {
    for bias_deg_h in [60.0, 6e4] {
        let text = format!(
            "members = 64\nduration_s = 60.0\n[sensor]\nsample_rate_hz = 200.0\n[trajectory]\nkind = \"rest\"\n[report]\n\
             times_s = [10.0, 60.0]\n[accelerometer]\nbias_mg = [2.0, -2.0, 2.0]\n\
             [gyro]\nbias_deg_h = [{bias_deg_h}, {bias_deg_h}, -{bias_deg_h}]\n"
        );
        let answer = answered(&text)?;
        let rate = bias_deg_h * std::f64::consts::PI / 180.0 / 3600.0 * Vector3::new(1.0, 1.0, -1.0);
        let (force, h) = (Vector3::new(0.0, 0.0, -9.806_65), 1e-3);
        let felt = force + 2.0 * 9.806_65e-3 * Vector3::new(1.0, -1.0, 1.0);
        let (mut velocity, mut position) = (Vector3::zeros(), Vector3::zeros());
        for k in 0..60_000 {
            let turn = UnitQuaternion::from_scaled_axis((f64::from(k) + 0.5) * h * rate);
            let error: Vector3<f64> = turn * felt - force;
            position += h * (velocity + 0.5 * h * error);
            velocity += h * error;
            if let Some(at) = [9_999, 59_999].iter().position(|last| *last == k) {
                for axis in 0..3 {
                    let got = series(&answer, Quantity::Position(axis), |s| s.mean)[at];
                    near(&format!("axis {axis}, {bias_deg_h} deg/h"), got, position[axis], 1e-3 * position.norm())?;
                }
                // Control: the linear model is not exact where the attitude turns by more than half
                // a circle.
                let linear = answer.covariance.mean(answer.report[at], 2);
                let large = bias_deg_h > 1e4;
                check(!large || (linear - position.z).abs() > 1e-3 * position.norm(), "large errors are linear")?;
            }
        }
    }
    Ok(())
}

fn nonlinear() -> Result<(), Failed> {
    let answer =
        answered(&format!("{SPREADS}[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 20.0\nheading_sd_deg = 60.0\n"))?;
    check(!answer.apart.is_empty(), "tilts of 20° spread as the linear model says")
}

fn tiles() -> Result<(), Failed> {
    let study =
        parsed(&format!("{SPREADS}{NOISE}[alignment]\nkind = \"still\"\nstill_s = 1.0\n").replace("4096", "700"))?;
    let motion = study.in_motion.as_ref().ok_or("no trajectory")?;
    let flight = study.flight(motion, vec![7, 1000, 3000])?;
    let run = |tile_samples: u64| -> Result<Vec<f64>, Failed> {
        let mut cpu = FlightCpu { tile_samples, ..FlightCpu::default() };
        let ensemble = run::run(&flight, &mut cpu, &mut Kept::none(), &Control::silent())?;
        let all = (0..3).flat_map(|k| LINEAR.map(|q| ensemble.summary(k, q).clone()));
        Ok(all.flat_map(|s| [s.mean, s.sd, s.min, s.max, s.percentiles[1]]).collect())
    };
    let whole = run(512)?;
    for tile in [4, 60, 64, 500] {
        check(run(tile)? == whole, format!("tiles of {tile} samples give other bits"))?;
    }
    let other = parsed("seed = 2\nduration_s = 1.0\n")?;
    check(other.seed != study.seed, "the control has the same seed")
}

/// Furthest apart of the percentiles of two ensembles at the first `reports` reports, over the
/// standard deviation.
pub(super) fn percentiles_apart(one: &run::Ensemble, other: &run::Ensemble, reports: usize) -> f64 {
    let at = |k: usize, q: Quantity| {
        let (a, b) = (one.summary(k, q), other.summary(k, q));
        let worst = a.percentiles.iter().zip(&b.percentiles).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        worst / a.sd
    };
    (0..reports).flat_map(|k| LINEAR.map(|q| at(k, q))).fold(0.0, f64::max)
}

/// Every source on, couplings included. Percentiles differ by rounding alone: by what `parity`
/// allows for one axis.
fn parity() -> Result<(), Failed> {
    let couplings =
        "scale_factor_ppm = 300.0\nmisalignment_mrad = { mean = 0.0, sd = 1.0 }\ng_sensitivity_deg_h_g = 3.0\n";
    let text = |start: &str| format!("{SPREADS}{NOISE}{couplings}{start}").replace("4096", "1024");
    for start in [
        "[alignment]\nkind = \"still\"\nstill_s = 3.1\nheading_sd_deg = 1.0\n",
        "[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 1.0\nheading_sd_deg = 60.0\n",
    ] {
        let study = parsed(&text(start))?;
        let motion = study.in_motion.as_ref().ok_or("no trajectory")?;
        let flight = study.flight(motion, vec![7, 500, 3000])?;
        let on = |choice, flight: &_| run_on(choice, flight, &Control::silent());
        let (cpu, gpu) = (on(ensemble::Choice::Cpu, &flight)?, on(ensemble::Choice::Gpu, &flight)?);
        let other = parsed(&text(start).replace("members", "seed = 2\nmembers"))?;
        let other = other.flight(other.in_motion.as_ref().ok_or("no trajectory")?, vec![7, 500, 3000])?;
        let other = on(ensemble::Choice::Cpu, &other)?;
        let apart = |to: &run::Ensemble| percentiles_apart(&cpu, to, 3);
        check(gpu.machine.kind == "gpu", "the GPU's run was not on a GPU")?;
        check(apart(&gpu) < 5e-3, format!("percentiles {} sd apart", apart(&gpu)))?;
        check(apart(&other) > 5e-3, "another seed gave the same percentiles: the comparison is blind")?;
    }
    Ok(())
}

pub(super) fn json(text: &str, threads: &str) -> Result<Value, Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("study.toml");
    std::fs::write(&path, text)?;
    let mut command = program();
    command.args(["--json", "study"]).arg(path).arg("--out").arg(folder.path().join("out"));
    let output = command.env("RAYON_NUM_THREADS", threads).output()?;
    check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    let page = std::fs::read_to_string(folder.path().join("out/report.html"))?;
    check(!page.contains("src=\"http"), "the report loads something from outside")?;
    let mut document: Value = serde_json::from_slice(&output.stdout)?;
    if let Some(fields) = document.as_object_mut() {
        fields.remove("seconds");
        fields.remove("backend");
    }
    Ok(document)
}

fn threads() -> Result<(), Failed> {
    let text = format!("{SPREADS}{NOISE}").replace("4096", "1000");
    let one = json(&text, "1")?;
    check(json(&text, "3")? == one, "three threads give another document than one")?;
    check(json(&text.replace("1000", "1001"), "1")? != one, "another member changes nothing")
}

fn document() -> Result<(), Failed> {
    let document = json(&format!("{SPREADS}{NOISE}").replace("4096", "512"), "2")?;
    check(document["schema"] == "proofmass.study/1", "schema")?;
    let axes = ["north", "east", "down"];
    let turns = ["roll", "pitch", "heading"];
    for (field, names) in
        [("position_error_ned_m", axes), ("velocity_error_ned_m_s", axes), ("attitude_error_rad", turns)]
    {
        for name in names {
            for row in ["mean", "sd", "p01", "p05", "p50", "p95", "p99"] {
                let list = &document[field][name][row];
                check(list.as_array().is_some_and(|v| v.len() == 3), format!("{field}.{name}.{row}"))?;
            }
            let list = &document["covariance"][field][name]["sd"];
            check(list.as_array().is_some_and(|v| v.len() == 3), format!("covariance.{field}.{name}"))?;
        }
    }
    for row in ["cep50", "cep95"] {
        check(document["horizontal_error_m"][row].as_array().is_some_and(|v| v.len() == 3), row)?;
    }
    check(document["position_error_m"].is_null() && document["tilt_error_rad"].is_null(), "one-axis fields stand")?;
    check(document["error_budget"].as_array().is_some_and(|v| v.len() > 8), "error budget")
}

fn refusals() -> Result<(), Failed> {
    let cases = [
        ("[earth]\nlatitude_deg = 45.0\n", "[earth] needs a [trajectory]"),
        ("[gyro]\nbias_deg_h = [1.0, 2.0, 3.0]\n", "list of three"),
        ("[gyro]\nmisalignment_mrad = 1.0\n", "does not rotate"),
        ("[trajectory]\nkind = \"rest\"\n[gyro]\nbias_deg_h = [1.0, 2.0]\n", "three numbers"),
        ("[trajectory]\nkind = \"rest\"\n[earth]\nlatitude_deg = 90.0\n", "pole"),
        ("[trajectory]\nkind = \"rest\"\n[earth]\nheight_m = 90.0\n", "latitude_deg"),
        ("[trajectory]\nkind = \"rest\"\n[excitation]\nkind = \"sine\"\n", "cannot be combined with"),
        ("[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 1.0\nheading_sd_deg = 1.0\n", "without a [trajectory]"),
        ("[trajectory]\nkind = \"rest\"\n[alignment]\nkind = \"ideal\"\nheading_sd_deg = 1.0\n", "belong to kind"),
    ];
    for (text, expected) in cases {
        match parsed(&format!("duration_s = 1.0\n{text}")) {
            Ok(_) => return Err(format!("accepted: {text}").into()),
            Err(error) => {
                let words = error.message().unwrap_or_default().to_owned();
                check(words.contains(expected), format!("{text}: {words}"))?;
            }
        }
    }
    Ok(())
}
