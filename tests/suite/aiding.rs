//! Aided navigation: between updates errors grow by their closed forms, fixes spread as the linear
//! covariance says, a filter finds what exact measurements tell, and CPU and GPU apply the same
//! corrections.

use libtest_mimic::{Failed, Trial};
use nalgebra::Vector3;
use proofmass::backend::flight::{FlightCpu, Quantity};
use proofmass::control::Control;
use proofmass::ensemble;
use proofmass::motion::mechanisation::{Increment, increments};
use proofmass::strapdown::aiding;
use proofmass::strapdown::answer::{Answer, LINEAR};
use proofmass::strapdown::backends::run_on;
use proofmass::strapdown::kept::Kept;
use proofmass::strapdown::own_error::of_increments;
use proofmass::strapdown::run;

use super::strapdown::{NOISE, answered, json, parsed, percentiles_apart, series};
use super::world::{check, gpu_test, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("aiding: with zero-velocity updates a bias moves by half b T² in each interval", zero_velocity),
        test("aiding: in an outage a bias moves by half b T² from its start", outage),
        test("aiding: in an outage the fix's own errors grow as a start with them would", fix_noise),
        test("aiding: a filter finds a bias from exact fixes", filter_finds),
        test("aiding: filtered errors spread as the linear covariance says", covariance),
        test("aiding: the fixes correct what the navigator itself errs by", own_error),
        test("aiding: fixes take the same off a navigator as off the linear model's errors", taken_alike),
        test("aiding: the same bits for any tile", tiles),
        gpu_test("aiding: the GPU gives the CPU's percentiles, filtered and reset", parity),
        test("aiding: the JSON has each outage", document),
        test("aiding: sections that make no sense are refused in a sentence", refusals),
    ]
}

const REST: &str = "members = 64\nduration_s = 60.0\n[sensor]\nsample_rate_hz = 100.0\n[trajectory]\nkind = \"rest\"\n\
    [accelerometer]\nbias_mg = [1.0, 0.0, 0.0]\n";
/// 1 mg.
const BIAS_M_S2: f64 = 9.806_65e-3;

/// A mean against a law at every report, within a thousandth of the law's last value.
fn follows(answer: &Answer, law: impl Fn(f64) -> f64) -> Result<(), Failed> {
    let times_s = answer.report_times_s();
    let last = law(times_s.last().copied().unwrap_or(0.0)).abs();
    for (got, time_s) in series(answer, Quantity::Position(0), |s| s.mean).iter().zip(times_s) {
        near(&format!("north after {time_s} s"), *got, law(time_s), 1e-3 * last)?;
    }
    Ok(())
}

/// Every T the velocity begins again at zero: ½ b T² for each interval that has passed.
fn zero_velocity() -> Result<(), Failed> {
    for every_s in [2.0, 5.0] {
        let answer = answered(&format!(
            "{REST}[report]\ntimes_s = [10.0, 13.0, 60.0]\n[aiding]\nmethod = \"reset\"\n[aiding.zupt]\nevery_s = {every_s:?}\n\
             velocity_sd_m_s = 1e-9\n"
        ))?;
        let law = |every_s: f64| {
            move |t: f64| {
                let (whole, left) = ((t / every_s).floor(), t % every_s);
                0.5 * BIAS_M_S2 * (whole * every_s * every_s + left * left)
            }
        };
        follows(&answer, law(every_s))?;
        check(follows(&answer, law(2.0 * every_s)).is_err(), "any interval fits")?;
        check(follows(&answer, |t| 0.5 * BIAS_M_S2 * t * t).is_err(), "updates change nothing")?;
    }
    Ok(())
}

const GNSS: &str = "[aiding.gnss]\nposition_sd_m = [1e-6, 1e-6, 1e-6]\nvelocity_sd_m_s = [1e-9, 1e-9, 1e-9]\n\
    outages_s = [[20.0, 50.0]]\n";

fn outage() -> Result<(), Failed> {
    let answer =
        answered(&format!("{REST}[report]\ntimes_s = [20.0, 30.0, 50.0]\n[aiding]\nmethod = \"reset\"\n{GNSS}"))?;
    let law = |begin: f64| move |t: f64| 0.5 * BIAS_M_S2 * (t - begin) * (t - begin);
    follows(&answer, law(20.0))?;
    check(follows(&answer, law(19.0)).is_err(), "any start fits")?;
    // The first fix after the outage ends it.
    let after = answered(&format!("{REST}[report]\ntimes_s = [51.0]\n[aiding]\nmethod = \"reset\"\n{GNSS}"))?;
    near("after the outage", series(&after, Quantity::Position(0), |s| s.mean)[0], 0.0, 1e-5)?;
    let outage = answer.outages.first().ok_or("no outage")?;
    check([outage.from_s, outage.until_s] == [20.0, 50.0] && outage.places.len() > 8, format!("{outage:?}"))
}

/// A perfect sensor drifts with the last fix's velocity: variance σ_p² + σ_v² T².
fn fix_noise() -> Result<(), Failed> {
    let members = 4096;
    let answer = answered(&format!(
        "members = {members}\nduration_s = 60.0\n[sensor]\nsample_rate_hz = 100.0\n[trajectory]\nkind = \"rest\"\n[report]\n\
         times_s = [20.0, 50.0]\n[aiding]\nmethod = \"reset\"\n[aiding.gnss]\nposition_sd_m = [2.0, 3.0, 4.0]\n\
         velocity_sd_m_s = [0.1, 0.2, 0.3]\noutages_s = [[20.0, 50.0]]\n"
    ))?;
    let four = 4.0 / (2.0 * f64::from(members)).sqrt();
    for (axis, (position, velocity)) in [(2.0f64, 0.1), (3.0, 0.2), (4.0, 0.3)].into_iter().enumerate() {
        let got = series(&answer, Quantity::Position(axis), |s| s.sd);
        near(&format!("axis {axis} at its start"), got[0] / position, 1.0, four)?;
        let expected = position.hypot(30.0 * velocity);
        near(&format!("axis {axis} at its end"), got[1] / expected, 1.0, four)?;
        check((got[1] / position.hypot(31.0 * velocity * 1.1) - 1.0).abs() > four, "any velocity fits")?;
        near("linear", answer.covariance.variance(answer.report[1], axis).sqrt() / expected, 1.0, 1e-6)?;
    }
    Ok(())
}

/// Two exact fixes tell a constant bias (with the tilt that looks like it), so that nothing is left
/// to drift by; a reset leaves it.
fn filter_finds() -> Result<(), Failed> {
    let text = |method: &str| {
        format!(
            "{}[report]\ntimes_s = [50.0]\n[aiding]\nmethod = \"{method}\"\n{GNSS}",
            REST.replace("[1.0, 0.0, 0.0]", "{ mean = 0.0, sd = 1.0 }")
        )
    };
    let end = |method: &str| -> Result<f64, Failed> {
        Ok(series(&answered(&text(method))?, Quantity::Position(0), |s| s.sd)[0])
    };
    let drift = 0.5 * BIAS_M_S2 * 900.0;
    check(end("filter")? < 1e-3 * drift, "the filter leaves a bias")?;
    check(end("reset")? > 0.5 * drift, "a reset finds a bias")
}

const DRIVE: &str = "members = 4096\nduration_s = 90.0\n[sensor]\nsample_rate_hz = 50.0\n[trajectory]\nkind = \"car\"\n\
    [earth]\nlatitude_deg = 47.4\nheight_m = 400.0\n[report]\ntimes_s = [10.0, 40.0, 70.0, 90.0]\n\
    [alignment]\nkind = \"still\"\nstill_s = 10.0\nheading_sd_deg = 0.5\n";
const AIDED: &str = "[aiding.gnss]\nevery_s = 0.98\nposition_sd_m = [1.5, 1.5, 3.0]\nvelocity_sd_m_s = [0.05, 0.05, 0.1]\n\
    outages_s = [[40.0, 70.0]]\n[aiding.zupt]\nevery_s = 1.0\nvelocity_sd_m_s = 0.02\n";

/// Standard deviations over those of the linear model, at the end of the outage.
fn ratios(answer: &Answer, model: &Answer) -> Vec<f64> {
    let k = answer.report[2];
    (0..9).map(|q| answer.ensemble.summary(k, LINEAR[q]).sd / model.covariance.variance(k, q).sqrt()).collect()
}

fn covariance() -> Result<(), Failed> {
    let more = "scale_factor_ppm = { mean = 0.0, sd = 500.0 }\nmisalignment_mrad = { mean = 0.0, sd = 1.0 }\n";
    let mut ends = Vec::new();
    for method in ["filter", "reset"] {
        let text = format!("{DRIVE}{NOISE}{more}[aiding]\nmethod = \"{method}\"\n{AIDED}");
        let answer = answered(&text)?;
        let four = 4.0 / (2.0 * answer.ensemble.members as f64).sqrt();
        check(answer.apart.is_empty(), format!("{method}: {:?}", answer.apart))?;
        ratios(&answer, &answer).into_iter().try_for_each(|ratio| near(method, ratio, 1.0, four))?;
        // Control: fixes of other noise are seen.
        let other = answered(&text.replace("[0.05, 0.05, 0.1]", "[0.1, 0.1, 0.2]"))?;
        check(ratios(&answer, &other).iter().any(|ratio| (ratio - 1.0).abs() > four), "other fixes spread alike")?;
        ends.push(answer.ensemble.summary(answer.report[2], Quantity::Horizontal).percentiles[3]);
    }
    // What the filter has learnt of tilt and biases is what makes the outage shorter.
    check(ends[0] < 0.7 * ends[1], format!("the filter is no better than a reset: {ends:?}"))
}

const FLIGHT: &str = "members = 64\nduration_s = 60.0\n[sensor]\nsample_rate_hz = 50.0\n[trajectory]\nkind = \"drone\"\n\
    [earth]\nlatitude_deg = 47.4\nheight_m = 400.0\n[navigator]\nintegrator = \"single-sample\"\n\
    [report]\ntimes_s = [10.0, 20.0, 30.0, 60.0]\n";

/// A reset leaves no error of what it sees, and all of the attitude's: what coning makes of that is
/// the same with fixes as without.
fn own_error() -> Result<(), Failed> {
    let fixes = "[aiding]\nmethod = \"reset\"\n[aiding.gnss]\nevery_s = 1.0\nposition_sd_m = [1.0, 1.0, 1.0]\n\
        velocity_sd_m_s = [0.1, 0.1, 0.1]\noutages_s = [[30.0, 60.0]]\n";
    let (free, aided) = (answered(FLIGHT)?, answered(&format!("{FLIGHT}{fixes}"))?);
    for (k, time_s) in aided.report.iter().zip(aided.report_times_s()).take(3) {
        let now = aided.own.mean[*k];
        check(now[..6].iter().all(|v| v.abs() < 1e-9), format!("after {time_s} s: {now:?}"))?;
        check(free.own.mean[free.report[1]][..6].iter().any(|v| v.abs() > 1e-4), "there is nothing to correct")?;
    }
    let ends = [&free, &aided].map(|answer| answer.own.mean[answer.report[3]]);
    near("heading, rad", ends[1][8], ends[0][8], 1e-3 * ends[0][8].abs())?;
    // The attitude errs, and gravity along it moves the body in the outage.
    check(ends[1][0].hypot(ends[1][1]) > 1e-4, "nothing is left of it in the outage")?;
    check(ends[1][0].hypot(ends[1][1]) < 0.7 * ends[0][0].hypot(ends[0][1]), "the fixes correct nothing")
}

/// Increments with the biases of a study, integrated by the f64 navigator and corrected by the
/// study's fixes, against the means that the linear model propagates through the same fixes.
fn taken_alike() -> Result<(), Failed> {
    let sensors = "[accelerometer]\nbias_mg = [1.0, -0.5, 0.0]\n[gyro]\nbias_deg_h = [20.0, 0.0, -30.0]\n";
    let fixes = "[aiding]\n[aiding.gnss]\nevery_s = 1.0\nposition_sd_m = [1.0, 1.0, 2.0]\noutages_s = [[30.0, 60.0]]\n";
    let (text, force, rate) = (FLIGHT.replace("single-sample", "compensated"), [1.0, -0.5, 0.0], [20.0, 0.0, -30.0]);
    let study = parsed(&format!("{text}{sensors}{fixes}"))?;
    let motion = study.in_motion.as_ref().ok_or("no trajectory")?;
    let answer = answered(&format!("{text}{sensors}{fixes}"))?;
    let flight = &answer.flight;
    let perfect = increments(&flight.course.truth);
    let interval_s = flight.course.truth.interval_s;
    let biased: Vec<Increment> = perfect
        .iter()
        .map(|i| Increment {
            velocity_m_s: i.velocity_m_s + Vector3::from(force) * (BIAS_M_S2 * interval_s),
            rotation_rad: i.rotation_rad + Vector3::from(rate) * (1f64.to_radians() / 3600.0 * interval_s),
        })
        .collect();
    let [with, without] = [&biased, &perfect].map(|i| of_increments(motion, flight, i));
    for k in &answer.report {
        let model: Vec<f64> = (0..9).map(|q| answer.covariance.mean(*k, q)).collect();
        for (q, expected) in model.iter().enumerate() {
            let largest = model[q / 3 * 3..q / 3 * 3 + 3].iter().fold(0.0f64, |m, v| m.max(v.abs()));
            near(&format!("report {k}, error {q}"), with[*k][q] - without[*k][q], *expected, 0.02 * largest)?;
        }
    }
    // Control: without the fixes the same increments lead elsewhere.
    let free = answered(&format!("{text}{sensors}"))?;
    let [free_m, aided_m] = [&free, &answer].map(|a| a.covariance.mean(a.report[2], 0).abs());
    check(aided_m < 0.2 * free_m, format!("the fixes correct nothing: {aided_m} m, {free_m} m"))
}

fn tiles() -> Result<(), Failed> {
    let study = parsed(&format!("{DRIVE}{NOISE}[aiding]\n{AIDED}").replace("4096", "700"))?;
    let motion = study.in_motion.as_ref().ok_or("no trajectory")?;
    let flight = aiding::flight(&study, motion, vec![7, 1000, 4500])?;
    let run = |flight: &_, tile_samples: u64| -> Result<Vec<f64>, Failed> {
        let mut cpu = FlightCpu { tile_samples, ..FlightCpu::default() };
        let ensemble = run::run(flight, &mut cpu, &mut Kept::none(), &Control::silent())?;
        let all = (0..3).flat_map(|k| LINEAR.map(|q| ensemble.summary(k, q).clone()));
        Ok(all.flat_map(|s| [s.mean, s.sd, s.min, s.max, s.percentiles[1]]).collect())
    };
    let whole = run(&flight, 512)?;
    for tile in [4, 49, 64, 500] {
        check(run(&flight, tile)? == whole, format!("tiles of {tile} samples give other bits"))?;
    }
    // Control: without the fixes the numbers are others.
    let free = study.flight(motion, vec![7, 1000, 4500])?;
    check(run(&free, 512)? != whole, "fixes change nothing")
}

/// Percentiles differ by rounding alone: by what `strapdown` allows without fixes.
fn parity() -> Result<(), Failed> {
    let still = "kind = \"still\"\nstill_s = 10.0\nheading_sd_deg = 0.5\n";
    for (method, start) in [("filter", still), ("reset", "kind = \"ideal\"\n")] {
        let text = format!("{DRIVE}{NOISE}[aiding]\nmethod = \"{method}\"\n{AIDED}").replace("4096", "1024");
        let text = text.replace(still, start);
        let flight = |text: &str| -> Result<_, Failed> {
            let study = parsed(text)?;
            Ok(aiding::flight(&study, study.in_motion.as_ref().ok_or("no trajectory")?, vec![7, 2000, 3500, 4500])?)
        };
        let on = |choice, flight: &_| run_on(choice, flight, &Control::silent());
        let aided = flight(&text)?;
        let (cpu, gpu) = (on(ensemble::Choice::Cpu, &aided)?, on(ensemble::Choice::Gpu, &aided)?);
        let other = on(ensemble::Choice::Cpu, &flight(&text.replacen("members", "seed = 2\nmembers", 1))?)?;
        let apart = |to: &run::Ensemble| percentiles_apart(&cpu, to, 4);
        check(gpu.machine.kind == "gpu", "the GPU's run was not on a GPU")?;
        check(apart(&gpu) < 5e-3, format!("{method}: percentiles {} sd apart", apart(&gpu)))?;
        check(apart(&other) > 5e-3, "another seed gave the same percentiles: the comparison is blind")?;
    }
    Ok(())
}

fn document() -> Result<(), Failed> {
    let text = format!("{DRIVE}{NOISE}[aiding]\n{AIDED}").replace("4096", "256");
    let document = json(&text, "2")?;
    let outage = &document["outages"][0];
    check(outage["from_s"] == 40.0 && outage["until_s"] == 70.0, format!("{outage}"))?;
    let times = outage["time_s"].as_array().map_or(0, Vec::len);
    for list in [
        &outage["horizontal_error_m"]["cep95"],
        &outage["spherical_error_m"]["sep50"],
        &outage["position_error_ned_m"]["north"]["sd"],
        &outage["velocity_error_ned_m_s"]["down"]["p95"],
        &outage["covariance"]["position_error_ned_m"]["east"]["sd"],
    ] {
        check(times > 8 && list.as_array().is_some_and(|v| v.len() == times), format!("{list}"))?;
    }
    let sources = document["error_budget"].as_array().cloned().unwrap_or_default();
    check(sources.iter().any(|row| row["source"] == "noise of the fixes"), "the budget has no row for the fixes")?;
    let own = |row: &&serde_json::Value| row["source"] == "navigator's integration";
    check(sources.iter().filter(own).count() == 1, "the budget has no row for the navigator")?;
    let last = |row: &serde_json::Value| {
        row["share_of_variance"]
            .as_array()
            .and_then(|v| v.last())
            .and_then(serde_json::Value::as_f64)
            .unwrap_or(f64::NAN)
    };
    near("all shares", sources.iter().map(last).sum(), 1.0, 1e-12)?;
    let free = json(&text.replace("outages_s = [[40.0, 70.0]]\n", ""), "2")?;
    check(free["outages"].is_null(), "outages without an outage")
}

fn refusals() -> Result<(), Failed> {
    let cases = [
        ("", "[aiding]\n", "no measurements"),
        ("", "[aiding.gnss]\nevery_s = 1.0\n", "measures nothing"),
        ("", "[aiding.gnss]\nposition_sd_m = [0.0, 1.0, 1.0]\n", "more than zero"),
        ("", "[aiding.gnss]\nposition_sd_m = [1.0, 1.0, 1.0]\nevery_s = 0.0151\n", "times the sample period"),
        ("", "[aiding.gnss]\nposition_sd_m = [1.0, 1.0, 1.0]\noutages_s = [[3.0, 2.0]]\n", "begin before end"),
        ("", "[aiding.gnss]\nposition_sd_m = [1.0, 1.0, 1.0]\noutages_s = [[1.0, 4.0], [3.0, 5.0]]\n", "overlap"),
        ("", "[aiding.zupt]\nevery_s = 20.0\n", "longer than the run"),
        ("circle", "[aiding.zupt]\nevery_s = 1.0\n", "finds no stop"),
    ];
    for (kind, text, expected) in cases {
        let kind =
            if kind.is_empty() { "kind = \"rest\"\n" } else { "kind = \"circle\"\nradius_m = 5.0\nspeed_m_s = 2.0\n" };
        match parsed(&format!("duration_s = 10.0\n[trajectory]\n{kind}{text}")) {
            Ok(_) => return Err(format!("accepted: {text}").into()),
            Err(error) => {
                let words = error.message().unwrap_or_default().to_owned();
                check(words.contains(expected), format!("{text}: {words}"))?;
            }
        }
    }
    check(parsed("duration_s = 10.0\n[aiding.zupt]\nevery_s = 1.0\n").is_err(), "aided without a trajectory")
}
