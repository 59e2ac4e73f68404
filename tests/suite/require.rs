//! A requirement is answered with the value that theory gives, covered as stated, and none where
//! there is none.

use std::path::Path;
use std::process::Command;

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::decision::require::{Outcome, Question, answer};
use proofmass::decision::statistic::Limit;
use proofmass::numerics::special::exact_interval;
use proofmass::study::{Overrides, StudyText};
use serde_json::Value;

use super::world::{check, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test(
            "require: the value of a constant bias is that of ½bt², and its interval holds it as often as it says",
            bias,
        ),
        test("require: beside noise, the value is that of the sum of variances", beside_noise),
        test("require: a limit that the other errors exceed is met by no value, and that ends with 0", never),
        test("require: no still start is tried that makes a run hundreds of times as long", lengthened),
        test("require: several keys are scaled by one factor", together),
        test("require: where more is better, the value is the least that does", more_is_better),
        test("require: parts that meet the limit come first, the cheapest of them before all", parts),
        test("require: along a trajectory, the circular error probable is that of two equal normal errors", in_motion),
        test("require: what cannot be answered is refused in words", refused),
    ]
}

/// g, m/s², and the 95 % quantile of the standard normal.
const G: f64 = 9.80665;
const P95: f64 = 1.644_853_627;

/// A bias of the accelerometer alone, drawn with 1 mg: the position error is ½bt².
const BIAS: &str = "duration_s = 10.0\nstep_s = 0.1\n[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\n\
                    [report]\ntimes_s = [10.0]\n";

fn file(folder: &Path, name: &str, text: &str) -> Result<String, Failed> {
    let path = folder.join(name);
    std::fs::write(&path, text)?;
    Ok(path.display().to_string())
}

fn json(command: &mut Command) -> Result<Value, Failed> {
    let output = command.arg("--json").output()?;
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    check(output.status.code() == Some(0), format!("{:?}: {words}", output.status))?;
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Value, lower and upper end of the first key.
fn first(document: &Value) -> [f64; 3] {
    let key = &document["vary"][0];
    [&key["value"], &key["ci95"][0], &key["ci95"][1]].map(|v| v.as_f64().unwrap_or(f64::NAN))
}

fn bias() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = file(folder.path(), "study.toml", BIAS)?;
    // p95 = 1.645 sd ½ t²: 1 m after 10 s is 12.16 mm/s², 1.240 mg.
    let expected = 1.0 / (P95 * 50.0) / (1e-3 * G);
    let limit: Limit = "p95(position_error_m, 10) < 1".parse()?;
    let question = Question { limit, vary: vec!["accelerometer.bias_mg.sd".into()], tolerance: 0.03, most: None };
    let (mut hits, mut wrong, seeds) = (0, 0, 60);
    for seed in 1..=seeds {
        let overrides = Overrides { seed: Some(seed), ..Overrides::default() };
        let answer =
            answer(&StudyText::read(path.as_ref(), overrides, &Control::silent())?, &question, &Control::silent())?;
        check(answer.outcome == Outcome::Crosses { below: true } && answer.settled, format!("{:?}", answer.outcome))?;
        let [Some(low), Some(high)] = answer.vary[0].ci95 else { return Err("an interval without ends".into()) };
        hits += u64::from(low <= expected && expected <= high);
        wrong += u64::from(low <= 1.1 * expected && 1.1 * expected <= high);
        let value = answer.vary[0].value.unwrap_or(f64::NAN);
        check(0.5 * (high - low) <= 0.03 * value, format!("half-width of {low} to {high}"))?;
    }
    let [low, high] = exact_interval(hits, seeds, 0.999);
    check(low < 0.95 && 0.95 < high, format!("{hits} of {seeds} intervals hold {expected}"))?;
    check(wrong < seeds / 10, format!("{wrong} of {seeds} hold what is a tenth off"))
}

fn beside_noise() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let noise = "velocity_random_walk_m_s_rth = 0.6\n";
    let path = file(folder.path(), "study.toml", &BIAS.replace("[report]", &format!("{noise}[report]")))?;
    let ask = ["require", &path, "--vary", "accelerometer.bias_mg.sd", "--limit", "p95(position_error_m, 10) < 1"];
    let document = json(program().args(ask))?;
    // Random walk of velocity, 0.6 m/s/√h = 0.01 m/s/√s, makes N√(t³/3) of position.
    let (all, walk) = (1.0 / P95, 0.01 * (1000.0f64 / 3.0).sqrt());
    let expected = (all * all - walk * walk).sqrt() / 50.0 / (1e-3 * G);
    let [value, low, high] = first(&document);
    // Twice the interval: one seed.
    near("value", value, expected, 2.0 * 0.5 * (high - low))?;
    check(0.5 * (high - low) <= 0.01 * value && low < value && value < high, format!("{low} {value} {high}"))?;
    check(document["schema"] == "proofmass.require/1" && document["meets"] == true, document.to_string())?;
    check(document["members"].as_u64().is_some_and(|m| m > 50_000), document["members"].to_string())?;
    let few = json(program().args(ask).args(["--members", "4096"]))?;
    check(document["settled"] == true && few["settled"] == false, "4096 members are said to settle it")?;
    check(few["members"].as_u64() < document["members"].as_u64(), few["members"].to_string())
}

fn never() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let noise = "velocity_random_walk_m_s_rth = 6.0\n";
    let path = file(folder.path(), "study.toml", &BIAS.replace("[report]", &format!("{noise}[report]")))?;
    let out = folder.path().join("out");
    let ask = ["require", &path, "--vary", "accelerometer.bias_mg.sd", "--limit", "sd(position_error_m, 10) < 1"];
    let document = json(program().args(ask))?;
    check(document["meets"] == false && document["vary"][0]["value"].is_null(), document.to_string())?;
    // The noise alone: 0.1 m/s/√s · √(1000/3 s³) = 1.826 m.
    near("at best", document["statistic"]["value"].as_f64().unwrap_or(f64::NAN), 1.826, 0.06)?;
    check(!out.exists(), "a folder that nobody asked for")?;
    let written = json(program().args(ask).arg("--out").arg(&out))?;
    check(written == document && out.join("report.html").is_file(), "no report, or another answer with it")
}

fn lengthened() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let still = "velocity_random_walk_m_s_rth = 6.0\n[alignment]\nkind = \"still\"\nstill_s = 2.0\n";
    let path = file(folder.path(), "study.toml", &BIAS.replace("[report]", &format!("{still}[report]")))?;
    let ask = ["require", &path, "--vary", "alignment.still_s", "--limit", "sd(position_error_m, 10) < 1"];
    let document = json(program().args(ask))?;
    check(document["meets"] == false, document.to_string())?;
    // Rungs of a factor of four from 2 s would end beyond a year; up to 256 times a run of 12 s there are five.
    check(document["members"].as_u64().is_some_and(|m| m < 100_000), document["members"].to_string())
}

fn together() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let gyro = "[gyro]\nbias_deg_h = { mean = 0.0, sd = 100.0 }\n";
    let path = file(folder.path(), "study.toml", &format!("{BIAS}{gyro}"))?;
    let keys = ["accelerometer.bias_mg.sd", "gyro.bias_deg_h.sd"];
    let ask = ["require", &path, "--limit", "sd(position_error_m, 10) < 1", "--vary", keys[0], keys[1]];
    let document = json(program().args(ask))?;
    // ½bt² and g·b·t³/6 of independent biases.
    let [one, other] = [1e-3 * G * 50.0, G * (100.0 / 3600.0f64).to_radians() * 1000.0 / 6.0];
    let factor = 1.0 / one.hypot(other);
    let [value, low, high] = first(&document);
    near("factor", value, factor, high - low)?;
    near("the second key", document["vary"][1]["value"].as_f64().unwrap_or(f64::NAN), 100.0 * value, 1e-9)
}

/// The full scale of a sensor that a sine of 2 g shakes: below it, the readings saturate and the
/// mean drifts with the offset.
fn more_is_better() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let text = "duration_s = 2.0\nstep_s = 0.01\n[sensor]\nrange_g = 1.0\n[excitation]\nkind = \"rectangle\"\n\
                amplitude_m_s2 = 19.6133\nstart_s = 0.0\nlength_s = 3.0\n";
    let path = file(folder.path(), "study.toml", text)?;
    let ask = ["require", &path, "--limit", "abs95(position_error_m, 2) < 9.80665", "--vary", "sensor.range_g"];
    let document = json(program().args(ask))?;
    // Clipped to r g of 2 g for 2 s: (2 − r)·g·½·4 m, which is 9.80665 m at r = 1.5; nothing is
    // drawn, so nothing is in doubt.
    let [value, ..] = first(&document);
    near("full scale", value, 1.5, 0.01)?;
    check(document["side"] == "above", document.to_string())
}

fn parts() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = file(folder.path(), "study.toml", BIAS)?;
    let part = |name: &str, price: f64, sd: f64| {
        format!(
            "[[part]]\nname = \"{name}\"\nprice = {price}\n[part.accelerometer]\nbias_mg = {{ mean = 0.0, sd = {sd} }}\n"
        )
    };
    let catalogue = [("dear", 900.0, 0.2), ("poor", 1.0, 9.0), ("fair", 90.0, 1.0), ("bad", 5.0, 3.0)];
    let text: String = catalogue.iter().map(|(name, price, sd)| part(name, *price, *sd)).collect();
    let parts = file(folder.path(), "parts.toml", &text)?;
    let ask = ["require", &path, "--limit", "p95(position_error_m, 10) < 1", "--parts", &parts];
    let document = json(program().args(ask))?;
    let names: Vec<&str> =
        document["parts"].as_array().into_iter().flatten().filter_map(|p| p["name"].as_str()).collect();
    check(names == ["fair", "dear", "bad", "poor"], format!("{names:?}"))?;
    let met: Vec<bool> = document["parts"].as_array().into_iter().flatten().map(|p| p["meets"] == true).collect();
    check(met == [true, true, false, false] && document["meets"] == true, format!("{met:?}"))?;
    for (name, _, sd) in catalogue {
        let part = document["parts"].as_array().into_iter().flatten().find(|p| p["name"] == name);
        let value = part.and_then(|p| p["value"].as_f64()).unwrap_or(f64::NAN);
        // 4096 members: the standard error of the quantile is 2.11 sd/√n, 2 % of it.
        near(name, value, P95 * sd * 1e-3 * G * 50.0, 0.08 * P95 * sd * 1e-3 * G * 50.0)?;
    }
    Ok(())
}

/// At rest, drawn biases make north and east errors of sd σ = ½gt²·bias; a circle of radius σ√(−2
/// ln(1 − p)) holds p of them (Rayleigh).
fn in_motion() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = file(folder.path(), "study.toml", &format!("{BIAS}[trajectory]\nkind = \"rest\"\n"))?;
    let key = "accelerometer.bias_mg.sd";
    let expected = |p: f64| 1.0 / (-2.0 * (1.0 - p).ln()).sqrt() / 50.0 / (1e-3 * G);
    for (name, p, other) in [("cep50", 0.50, 0.95), ("cep95", 0.95, 0.50)] {
        let limit = format!("{name}(horizontal_error_m, 10) < 1");
        let document = json(program().args(["require", &path, "--vary", key, "--limit", &limit]))?;
        let [value, low, high] = first(&document);
        near(name, value, expected(p), high - low)?;
        check(near(name, value, expected(other), high - low).is_err(), "the other circle is taken for it")?;
        let out = folder.path().join(name);
        let sweep = program()
            .args([
                "study",
                &path,
                "--sweep",
                "accelerometer.bias_mg.sd=0.5:4:log4",
                "--limit",
                &limit,
                "--json",
                "--out",
            ])
            .arg(&out)
            .output()?;
        let sweep: Value = serde_json::from_slice(&sweep.stdout)?;
        let crossing = sweep["crossings"][0]["value"].as_f64().unwrap_or(f64::NAN);
        near("crossing of the sweep", crossing, value, 0.05 * value)?;
        let north = &sweep["points"][0]["position_error_ned_m"]["north"]["sd"][0];
        near("north", north.as_f64().unwrap_or(f64::NAN), 0.5e-3 * G * 50.0, 0.04 * 0.5e-3 * G * 50.0)?;
    }
    Ok(())
}

fn refused() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = file(folder.path(), "study.toml", BIAS)?;
    let unknown = file(folder.path(), "parts.toml", "[[part]]\nname = \"a\"\n[part.gyro]\nbias_deg_hr = 1.0\n")?;
    let empty = file(folder.path(), "empty.toml", "part = []\n")?;
    let limit = "p95(position_error_m, 10) < 1";
    let radius = "cep95(horizontal_error_m, 10) < 1";
    let cases: [(&[&str], &str); 9] = [
        (&["--limit", limit], "--vary"),
        (&["--limit", radius, "--vary", "gyro.bias_deg_h"], "needs a [trajectory]"),
        (&["--limit", "cep95(position_error_m, 10) < 1", "--vary", "gyro.bias_deg_h"], "of the horizontal error"),
        (&["--limit", "p96(position_error_m, 10) < 1", "--vary", "gyro.bias_deg_h"], "did you mean `p95`"),
        (&["--limit", "p95(position_error_m, 99) < 1", "--vary", "gyro.bias_deg_h"], "outside the run of 10 s"),
        (&["--limit", limit, "--vary", "gyro.bias_deg_hr"], "did you mean `bias_deg_h`"),
        (&["--limit", limit, "--vary", "gyro.bias_deg_h", "--tolerance", "0"], "--tolerance"),
        (&["--limit", limit, "--parts", &unknown], "did you mean `bias_deg_h`"),
        (&["--limit", limit, "--parts", &empty], "no [[part]]"),
    ];
    for (arguments, words) in cases {
        let output = program().args(["require", &path]).args(arguments).output()?;
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        check(output.status.code() == Some(2) && text.contains(words), format!("{arguments:?}: {text}"))?;
    }
    Ok(())
}
