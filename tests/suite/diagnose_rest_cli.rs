//! `diagnose` on a sensor at rest at the command line, bad input of its own kind, and every kind's
//! repaired model as a study.

use std::fs;

use libtest_mimic::{Failed, Trial};
use proofmass::rng::{Philox, Stream};
use serde_json::Value;

use super::bench::{Bench, study};
use super::tumble_bench::Imu;
use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("diagnose static: report, verdict and figures are written, and the named walk runs in a study", contract),
        test("diagnose static: a named ramp runs in a study, and drifts as R t³/6", ramp_runs_in_study),
        test("diagnose static: a recording that cannot be judged is refused with attempt, cause and hint", refused),
        test("diagnose static: a damaged recording is survived, and the damage mentioned", survived),
        test("diagnose tumble: poses that lie in the moves are refused, one that moved is mentioned", poses_that_move),
        test("diagnose: what a driven diagnosis repairs runs in a study", driven_runs_in_study),
    ]
}

const ROWS: usize = 4000;
const MODEL: &str = "kind = \"static\"\nrate_hz = 100.0\nunit = \"mg\"\n[columns]\nchannels = [\"x\", \"y\", \"z\"]\n";

/// Rows t, x, y, z in mg at 100 Hz: gravity on z, white noise of 1 mg, a walk of 0.2 mg per step on
/// x.
fn rows() -> Vec<[f64; 4]> {
    let mut rng = Philox::new(77, 0, Stream::Host);
    let mut walk = 0.0;
    (0..ROWS)
        .map(|n| {
            let mut draw = || rng.normal();
            walk += 0.2 * draw();
            [n as f64 / 100.0, walk + draw(), 3.0 + draw(), 1000.0 + draw()]
        })
        .collect()
}

fn csv(edit: impl Fn(usize, &mut [f64; 4])) -> String {
    let cell = |v: &f64| if v.is_nan() { String::new() } else { format!("{v:.6}") };
    let mut text = String::from("t,x,y,z\n");
    for (n, mut row) in rows().into_iter().enumerate() {
        edit(n, &mut row);
        // A row that is all missing was never logged.
        if !row.iter().all(|v| v.is_nan()) {
            text += &(row.iter().map(cell).collect::<Vec<_>>().join(",") + "\n");
        }
    }
    text
}

fn contract() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let out = bench.path("out");
    let verdict = bench.diagnose(&csv(|_, _| {}), MODEL, &["--json", "--out", &out.display().to_string()])?.json()?;
    check(verdict["kind"] == "static" && verdict["verdict"] == "explained", format!("{}", verdict["sentence"]))?;
    let effect = &verdict["effects"][0];
    check(effect["id"] == "random-walk" && effect["channels"][0] == "x", format!("{}", verdict["sentence"]))?;
    // K = σ of a step · √rate = 0.2 mg · √100 Hz.
    let interval: Vec<f64> = (0..2).filter_map(|i| effect["parameters"][0]["ci95"][i].as_f64()).collect();
    check(interval[0] < 2.0 && 2.0 < interval[1], format!("K: {interval:?} mg/√s"))?;
    for file in ["report.html", "verdict.json", "repaired.toml", "allan-x.svg"] {
        check(out.join(file).is_file(), format!("no {file}"))?;
    }
    let drift = study(&out.join("repaired.toml"), &bench.path("study"), 256)?;
    // Closed form: σ² = N²t³/3 + K²t⁵/20, N = 1 mg/√100 Hz, at one minute: the study holds both.
    let (n, k, t) = (0.1 * 9.80665e-3, 2.0 * 9.80665e-3, 60.0f64);
    let expected = (n * n * t.powi(3) / 3.0 + k * k * t.powi(5) / 20.0).sqrt();
    let last = drift["time_s"].as_array().map_or(0, Vec::len).saturating_sub(1);
    let sd = drift["position_error_m"]["sd"][last].as_f64().unwrap_or(f64::NAN);
    // K is known to a few per cent, 256 members give their spread to 4.4 %.
    near("sd of position after 60 s", sd, expected, 0.25 * expected)
}

fn refused() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let refused = |what: &str, csv: &str, model: &str, words: &str| bench.refused(what, csv, model, words);
    let good = csv(|_, _| {});
    let few: String = good.lines().take(100).map(|l| format!("{l}\n")).collect();
    refused("too few rows", &few, MODEL, "99 samples")?;
    refused("all channels dead", &csv(|_, r| (r[1], r[2], r[3]) = (1.0, 2.0, 3.0)), MODEL, "constant")?;
    refused("a column that is not there", &good, &MODEL.replace("\"y\"", "\"yy\""), "`yy`")?;
    refused("no channel", &good, &MODEL.replace("\"x\", \"y\", \"z\"", ""), "names no channel")?;
    refused("a negative rate", &good, &MODEL.replace("100.0", "-100.0"), "rate")?;
    // A column that rises like a clock is one by its heading only.
    refused("no clock", &good.replacen("t,", "first,", 1), &MODEL.replace("rate_hz = 100.0\n", ""), "rate")?;
    let missing = csv(|n, r| {
        if n % 7 == 0 {
            r[1] = f64::NAN;
        }
    });
    refused("every seventh value missing", &missing, MODEL, "missing")?;
    refused("text in a cell", &good.replacen("\n", "\n1,two,3,4\n", 1), MODEL, "`two` is not a number")
}

fn survived() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let survived = |what: &str, csv: &str, model: &str, words: &str| bench.survived(what, csv, model, words);
    let named = |v: &Value| v["effects"].as_array().is_some_and(|e| e.iter().any(|e| e["id"] == "random-walk"));
    let good = csv(|_, _| {});
    let dead = survived("a dead channel", &csv(|_, r| r[2] = 7.0), MODEL, "`y` is constant")?;
    check(named(&dead), "the dead channel hides the walk of another")?;
    let holes = csv(|n, r| {
        if n % 97 == 3 {
            r[1] = f64::NAN;
        }
    });
    check(named(&survived("holes", &holes, MODEL, "missing values")?), "holes hide the walk")?;
    let clocked = MODEL.replace("rate_hz = 100.0\n", "").replace("[columns]\n", "[columns]\ntime = \"t\"\n");
    let gap = csv(|n, r| {
        if (1000..1020).contains(&n) {
            *r = [f64::NAN; 4];
        }
    });
    check(named(&survived("a short gap", &gap, &clocked, "gap")?), "a gap hides the walk")?;
    // The same numbers called g: 1000 g at rest.
    survived("unit wrong by a thousand", &good, &MODEL.replace("\"mg\"", "\"g\""), "times gravity")?;
    // 1 mg at 100 Hz is 0.141 mg/√Hz; the datasheet's 141 was in µg.
    let promise = format!("{MODEL}[noise]\ndensity = 141.0\n");
    let told = survived("a promise wrong by a thousand", &good, &promise, "check the unit")?;
    check(told["verdict"] != "adequate", "a level wrong by a thousand is called adequate")?;
    let silent = bench.verdict(&good, MODEL)?;
    // Of a walk it is said that the mean is no bias; that is no damage.
    let is_damage = |f: &Value| !f.as_str().is_some_and(|f| f.contains("`: mean "));
    let damage = silent["findings"].as_array().is_none_or(|all| all.iter().any(is_damage));
    check(!damage, format!("{}", silent["findings"]))
}

/// The turntable's recording with its poses, shifted by so many rows.
fn turned(shift: usize, only: Option<usize>) -> (String, String) {
    let (recording, ranges) = Imu::without_defect(5).record(5);
    let mut text = String::from("ax,ay,az,gx,gy,gz\n");
    for k in 0..recording.samples() {
        let cells: Vec<String> = recording.columns.iter().map(|c| c.values[k].to_string()).collect();
        text += &(cells.join(",") + "\n");
    }
    let mut poses = String::from("start_row,end_row_exclusive\n");
    for (n, range) in ranges.iter().enumerate().take(ranges.len() - 1) {
        let by = if only.is_none_or(|o| o == n) { shift } else { 0 };
        poses += &format!("{},{}\n", range.start + by, range.end + by);
    }
    (text, poses)
}

fn poses_that_move() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let model = "kind = \"tumble\"\nrate_hz = 50.0\ngravity_m_s2 = 9.81\nposes = \"poses.csv\"\n[columns]\n\
                 gyro = [\"gx\", \"gy\", \"gz\"]\naccelerometer = [\"ax\", \"ay\", \"az\"]\n";
    let (log, shifted) = turned(25, None);
    fs::write(bench.path("poses.csv"), shifted)?;
    bench.refused("poses half a second late", &log, model, "are not still")?;
    let (log, one) = turned(25, Some(4));
    fs::write(bench.path("poses.csv"), one)?;
    let mentioned = bench.verdict(&log, model)?["findings"].to_string();
    check(mentioned.contains("1 of the"), format!("no word of the pose that moved: {mentioned}"))?;
    let (log, right) = turned(0, None);
    fs::write(bench.path("poses.csv"), right)?;
    let silent = bench.verdict(&log, model)?["findings"].to_string();
    check(!silent.contains("not still"), silent)
}

/// A Duffing oscillator, integrated with Runge–Kutta 4 at twenty steps a sample under a multisine
/// in closed form.
fn duffing() -> String {
    let (natural, zeta, beta, rate_hz) = (250.0f64, 0.15, 4e9, 500.0);
    let force = |t: f64| -> f64 {
        (1..60).map(|k| 4.0 * (std::f64::consts::TAU * 1.5 * f64::from(k) * t + f64::from(k * k) * 0.7).sin()).sum()
    };
    let slope =
        |t: f64, [x, v]: [f64; 2]| [v, force(t) - 2.0 * zeta * natural * v - natural * natural * x - beta * x * x * x];
    let mut rng = Philox::new(5, 0, Stream::Host);
    let (mut state, h) = ([0.0, 0.0], 1.0 / rate_hz / 20.0);
    let mut text = String::from("u,y\n");
    for n in 0..4000 {
        let noise = rng.normal();
        text += &format!("{:.8e},{:.8e}\n", force(n as f64 / rate_hz), state[0] + 4e-7 * noise);
        for i in 0..20 {
            let t = (n * 20 + i) as f64 * h;
            let add = |s: [f64; 2], k: [f64; 2], by: f64| [s[0] + by * k[0], s[1] + by * k[1]];
            let k1 = slope(t, state);
            let k2 = slope(t + h / 2.0, add(state, k1, h / 2.0));
            let k3 = slope(t + h / 2.0, add(state, k2, h / 2.0));
            let k4 = slope(t + h, add(state, k3, h));
            state = std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
    }
    text
}

/// 0.05 mg/s on white noise of 1 mg, 80 s at 100 Hz.
fn ramp_runs_in_study() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let out = bench.path("out");
    let mut rng = Philox::new(78, 0, Stream::Host);
    let rows: String = (0..8000).map(|n| format!("{:.6}\n", 0.05 * f64::from(n) / 100.0 + rng.normal())).collect();
    let model = MODEL.replace("[\"x\", \"y\", \"z\"]", "[\"x\"]");
    let arguments = ["--json", "--out", &out.display().to_string()];
    let verdict = bench.diagnose(&format!("x\n{rows}"), &model, &arguments)?.json()?;
    check(verdict["effects"][0]["id"] == "rate-ramp", format!("{}", verdict["sentence"]))?;
    let repaired = fs::read_to_string(out.join("repaired.toml"))?;
    check(repaired.contains("\nacceleration_ramp_mg_h = "), format!("no ramp in\n{repaired}"))?;
    check(!repaired.contains("Not in this study: rate-ramp"), "a study is said not to run it")?;
    let drift = study(&out.join("repaired.toml"), &bench.path("study"), 256)?;
    let mean = drift["position_error_m"]["mean"][2].as_f64().unwrap_or(f64::NAN);
    // The rate itself is estimated to about a per cent.
    near("position after 60 s, R t³/6", mean, 0.05e-3 * 9.80665 * 60f64.powi(3) / 6.0, 0.6)
}

fn driven_runs_in_study() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let out = bench.path("out");
    let model = "kind = \"driven\"\nrate_hz = 500.0\n[columns]\ninput = \"u\"\noutput = \"y\"\n";
    let verdict = bench.diagnose(&duffing(), model, &["--json", "--out", &out.display().to_string()])?.json()?;
    check(verdict["effects"][0]["id"] == "cubic-stiffness", format!("{}", verdict["sentence"]))?;
    let repaired = fs::read_to_string(out.join("repaired.toml"))?;
    check(repaired.contains("\ncubic_stiffness_per_m2_s2 = "), "the named spring is not in the repaired model")?;
    study(&out.join("repaired.toml"), &bench.path("study"), 256).map(|_| ())
}
