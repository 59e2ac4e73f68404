//! A sweep follows the closed form from value to value, and crosses its limit where theory does.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::world::{check, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test(
            "sweep: along a bias, the spread is that of ½bt² at every value, and the limit is crossed where theory has it",
            curve,
        ),
        test("sweep: [sweep] in study.toml is the same sweep, bit for bit", section),
        test("sweep: over two keys there is a map, with the crossing of each row", map),
        test("sweep: what cannot be swept is refused in words", refused),
    ];
    #[cfg(unix)]
    all.push(test("sweep: stopped and resumed, the same bits", resumed));
    all
}

/// g, m/s².
const G: f64 = 9.80665;
const STUDY: &str = "members = 4096\nduration_s = 10.0\nstep_s = 0.1\n[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\n\
                     [report]\ntimes_s = [5.0, 10.0]\n";

fn json(command: &mut Command, out: &Path) -> Result<Value, Failed> {
    let output = command.arg("--json").arg("--out").arg(out).output()?;
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    check(output.status.code() == Some(0), format!("{:?}: {words}", output.status))?;
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Standard deviation of position after 10 s under a bias of this many mg.
fn spread(bias_mg: f64) -> f64 {
    0.5 * bias_mg * 1e-3 * G * 100.0
}

fn curve() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("study.toml");
    std::fs::write(&path, STUDY)?;
    let out = folder.path().join("out");
    let axis = "accelerometer.bias_mg.sd=0.5:8:log5";
    let mut command = program();
    command.arg("study").arg(&path).args(["--sweep", axis, "--limit", "sd(position_error_m, 10) < 1"]);
    let document = json(&mut command, &out)?;
    let points = document["points"].as_array().ok_or("no points")?;
    check(points.len() == 5 && document["sweep"][0]["values"][2] == 2.0, document["sweep"].to_string())?;
    for point in points {
        let sd = spread(number(&point["values"][0]));
        // One standard error of a normal's deviation is 1/√(2·4096), 1.1 %.
        near("sd", number(&point["statistic"]["value"]), sd, 0.04 * sd)?;
        near("sd after 5 s", number(&point["position_error_m"]["sd"][0]), sd / 4.0, 0.01 * sd)?;
    }
    // The same members at every value: the ratios are exact, not within the noise.
    let ratio = number(&points[4]["statistic"]["value"]) / number(&points[3]["statistic"]["value"]);
    near("ratio of neighbours", ratio, 2.0, 1e-4)?;
    let crossing = &document["crossings"][0];
    let [low, high] = [0, 1].map(|k| number(&crossing["ci95"][k]));
    let expected = 1.0 / spread(1.0);
    near("crossing", number(&crossing["value"]), expected, high - low)?;
    check(high - low < 0.02 * expected * 1.01 && crossing["side"] == "below", crossing.to_string())?;
    for name in ["report.html", "curve.svg", "times.svg", "sweep.csv"] {
        check(out.join(name).is_file(), name)?;
    }
    Ok(())
}

fn section() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let [plain, swept] = ["plain.toml", "swept.toml"].map(|name| folder.path().join(name));
    std::fs::write(&plain, STUDY)?;
    let section = "[sweep]\nlimit = \"p95(position_error_m, 10) < 1\"\naccelerometer.bias_mg.sd = \"0.5:8:log3\"\n";
    std::fs::write(&swept, format!("{STUDY}{section}"))?;
    let mut command = program();
    let line = ["--sweep", "accelerometer.bias_mg.sd=0.5:8:log3", "--limit", "p95(position_error_m, 10) < 1"];
    command.arg("study").arg(&plain).args(line);
    let by_line = json(&mut command, &folder.path().join("a"))?;
    let by_section = json(program().arg("study").arg(&swept), &folder.path().join("b"))?;
    check(by_line == by_section, "another answer")?;
    let other = json(program().arg("study").arg(&swept).args(["--seed", "2"]), &folder.path().join("c"))?;
    check(other != by_section, "the seed changes nothing")
}

fn map() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("study.toml");
    std::fs::write(&path, format!("{STUDY}[gyro]\nbias_deg_h = {{ mean = 0.0, sd = 1.0 }}\n"))?;
    let out = folder.path().join("out");
    let axes = ["accelerometer.bias_mg.sd=0.5:3:3", "gyro.bias_deg_h.sd=10:100:2"];
    let mut command = program();
    command.arg("study").arg(&path).args(["--sweep", axes[0], "--sweep", axes[1]]);
    command.args(["--limit", "sd(position_error_m, 10) < 1"]);
    let document = json(&mut command, &out)?;
    let points = document["points"].as_array().ok_or("no points")?;
    check(points.len() == 6 && points[1]["values"] == serde_json::json!([1.75, 10.0]), document.to_string())?;
    // g·b·t³/6 of the gyro's bias.
    let tilted = |bias_deg_h: f64| G * (bias_deg_h / 3600.0).to_radians() * 1000.0 / 6.0;
    let crossings = document["crossings"].as_array().ok_or("no crossings")?;
    check(crossings.len() == 2, document["crossings"].to_string())?;
    for crossing in crossings {
        let expected = (1.0 - tilted(number(&crossing["other"])).powi(2)).sqrt() / spread(1.0);
        let [low, high] = [0, 1].map(|k| number(&crossing["ci95"][k]));
        near("crossing", number(&crossing["value"]), expected, high - low)?;
    }
    check(out.join("map.svg").is_file(), "no map")
}

fn refused() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("study.toml");
    std::fs::write(&path, STUDY)?;
    let cases: [(&[&str], &str); 6] = [
        (&["--sweep", "accelerometer.bias_mg.sd=1:2"], "FROM:TO:N"),
        (&["--sweep", "accelerometer.bias_mgs=1:2:3"], "did you mean `bias_mg`"),
        (&["--sweep", "a.b=1:2:3", "--sweep", "a.b=1:2:3"], "swept twice"),
        (&["--limit", "sd(position_error_m, 10) < 1"], "without --sweep"),
        (&["--sweep", "accelerometer.bias_mg.sd=1:2:3", "--limit", "sd(position_error_m, 11) < 1"], "outside the run"),
        (&["--sweep", "accelerometer.bias_mg.sd=1:2:3", "--digits", "2"], "--digits"),
    ];
    for (arguments, words) in cases {
        let out = folder.path().join("out");
        let output = program().arg("study").arg(&path).args(arguments).arg("--out").arg(&out).output()?;
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        check(output.status.code() == Some(2) && text.contains(words), format!("{arguments:?}: {text}"))?;
        check(!out.exists(), format!("{arguments:?} left a folder behind"))?;
    }
    Ok(())
}

/// Stopped once the first point is kept.
#[cfg(unix)]
fn resumed() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("study.toml");
    std::fs::write(&path, format!("{}[gyro]\nbias_instability_deg_h = 5.0\n", STUDY.replace("0.1", "0.01")))?;
    let ask = |out: &Path| {
        let mut command = program();
        command.arg("study").arg(&path).args(["--members", "8192", "--backend", "cpu", "--json", "--out"]).arg(out);
        command.args(["--sweep", "accelerometer.bias_mg.sd=0.5:8:log8"]).env("PROOFMASS_STATE_INTERVAL_S", "0.01");
        command
    };
    let whole = ask(&folder.path().join("whole")).output()?;
    check(whole.status.success(), String::from_utf8_lossy(&whole.stderr).into_owned())?;
    let out = folder.path().join("stopped");
    for _ in 0..5 {
        let mut child = ask(&out).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        while !out.join("interrupted-2.json").exists() && child.try_wait()?.is_none() {
            std::thread::sleep(Duration::from_millis(2));
        }
        Command::new("kill").args(["-INT", &child.id().to_string()]).status()?;
        let stopped = child.wait_with_output()?;
        // Done before it was stopped: again.
        if stopped.status.success() {
            continue;
        }
        check(stopped.status.code() == Some(130), format!("{:?}", stopped.status))?;
        let resumed = ask(&out).arg("--resume").output()?;
        check(resumed.status.success(), String::from_utf8_lossy(&resumed.stderr).into_owned())?;
        check(resumed.stdout == whole.stdout, "resumed and uninterrupted answers differ")?;
        return check(!out.join("interrupted-1.json").exists(), "a state file was left behind");
    }
    Err("no sweep was long enough to be stopped".into())
}
