//! `report` against the commands whose answers it gathers: the same numbers on one page, and in words why a
//! part is not there.

use std::fmt::Write as _;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::rng::{Philox, Stream};
use serde_json::Value;

use super::bench::{Bench, run};
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("report: a log at rest gets what diagnose, check and allan say of it, on one page", at_rest),
        test("report: a decay has no halves to compare and no rest, and the page says so", decay),
        test("report: of a log that moves most of the time the rest is judged, and said", mostly_moving),
        test("report: two headings that may each be the input are refused with both commands", either),
    ]
}

const HEADINGS: &str = "t_s,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2\n";
const RATE_HZ: f64 = 100.0;

/// An IMU with white noise that turns at this rate about z, row by row.
fn imu(rows: usize, seed: u64, turn_rad_s: impl Fn(f64) -> f64) -> String {
    let mut rng = Philox::new(seed, 0, Stream::Host);
    let mut text = HEADINGS.to_owned();
    for k in 0..rows {
        let t = k as f64 / RATE_HZ;
        let turn = turn_rad_s(t);
        let gyro = [0.0, 0.0, turn].map(|w| w + 1e-3 * rng.normal());
        let force = [0.3 * turn, 0.2 * turn, 9.81].map(|f| f + 2e-2 * rng.normal());
        let [gx, gy, gz] = gyro;
        let [ax, ay, az] = force;
        let _ = writeln!(text, "{t},{gx},{gy},{gz},{ax},{ay},{az}");
    }
    text
}

fn reported(log: &Path, out: &Path) -> Result<(Value, String), Failed> {
    let document = run(program().arg("report").arg(log).args(["--json", "--out"]).arg(out))?.json()?;
    check(document["schema"] == "proofmass.report/1", document["schema"].to_string())?;
    let written: Value = serde_json::from_str(&std::fs::read_to_string(out.join("report.json"))?)?;
    check(written == document, "report.json differs from --json")?;
    Ok((document, std::fs::read_to_string(out.join("report.html"))?))
}

/// A page whose ids are each given once.
fn is_one_page(page: &str) -> Result<(), Failed> {
    let mut ids: Vec<&str> = page.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let all = ids.len();
    ids.sort_unstable();
    ids.dedup();
    check(ids.len() == all, format!("of {all} ids {} differ", ids.len()))?;
    for heading in ["What the model leaves out", "Does it say so twice", "Noise at rest", "What the file holds"] {
        check(page.contains(&format!(">{heading}</h2>")), format!("no section \"{heading}\""))?;
    }
    check(page.matches("<header>").count() == 1, "more than one title")
}

fn at_rest() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let log = bench.file("still.csv", &imu(8000, 3, |_| 0.0))?;
    let (document, page) = reported(&log, &bench.path("out"))?;
    is_one_page(&page)?;
    check(document["not_made"] == serde_json::json!([]), document["not_made"].to_string())?;
    let asked = |command: &str| run(program().arg(command).arg(&log).arg("--json"))?.json();
    let [verdict, halves, noise, seen] = [asked("diagnose")?, asked("check")?, asked("allan")?, asked("inspect")?];
    for key in ["verdict", "sentence", "effects", "fit"] {
        check(document["verdict"][key] == verdict[key], format!("{key}: {}", verdict[key]))?;
    }
    check(document["check"] == halves, "another check")?;
    check(document["noise"] == noise, "another noise")?;
    check(document["inspect"] == seen, "another first look")?;
    // The control: another log has another noise.
    let other = bench.file("other.csv", &imu(8000, 4, |_| 0.0))?;
    check(reported(&other, &bench.path("other"))?.0["noise"]["channels"] != noise["channels"], "the same noise")?;
    let words = run(program().arg("report").arg(&log).arg("--out").arg(bench.path("out")))?;
    for part in ["what the model leaves out: ", "does it say so twice: ", "noise at rest: ", "report: "] {
        check(words.stdout.contains(part), format!("no \"{part}\" in {}", words.stdout))?;
    }
    Ok(())
}

fn decay() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let mut rng = Philox::new(5, 0, Stream::Host);
    let mut text = "t_s,displacement_m\n".to_owned();
    for k in 0..3000 {
        let t = k as f64 / RATE_HZ;
        let _ = writeln!(text, "{t},{}", (-0.1 * t).exp() * (9.0 * t).cos() + 1e-3 * rng.normal());
    }
    let (document, page) = reported(&bench.file("decay.csv", &text)?, &bench.path("out"))?;
    is_one_page(&page)?;
    check(document["verdict"]["verdict"] == "adequate", document["verdict"]["sentence"].to_string())?;
    let parts: Vec<&Value> = document["not_made"].as_array().into_iter().flatten().map(|n| &n["part"]).collect();
    check(parts == ["check", "noise"] && document["check"].is_null(), document["not_made"].to_string())?;
    check(page.contains("Not made: it is never at rest"), "a part is missing without a reason")
}

fn mostly_moving() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let log = bench.file("log.csv", &imu(24_000, 6, |t| if t < 100.0 { 0.0 } else { (0.7 * t).sin() }))?;
    let (document, page) = reported(&log, &bench.path("out"))?;
    is_one_page(&page)?;
    check(document["verdict"]["kind"] == "static", document["verdict"]["kind"].to_string())?;
    let samples = document["noise"]["recording"]["samples"].as_f64().unwrap_or(0.0);
    check((9000.0..=10_200.0).contains(&samples), format!("{samples} samples at rest"))
}

fn either() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let rows: String = (0..2000).map(|k| format!("{},{},{}\n", 0.01 * f64::from(k), (k * k) % 17, k % 13)).collect();
    let log = bench.file("two.csv", &format!("t_s,V1_V,V2_V\n{rows}"))?;
    let answer = run(program().arg("report").arg(&log).arg("--out").arg(bench.path("out")))?;
    answer.refuses("two voltages", "may each be the input")?;
    check(!bench.path("out").exists(), "a folder was made for nothing")
}
