//! The paper's twenty figures: every check holds, and the checks can fail.

use libtest_mimic::{Failed, Trial};
use proofmass::backend::orbits::Device;
use proofmass::control::Control;
use proofmass::dynamics::fractal::{Scales, correlation};
use proofmass::navigation::kalman::{Filter, Model, Reading, Weighting};
use proofmass::paper::check::{Check, Exhibit, Provenance};
use proofmass::paper::{self, beliefs, compute, fusion, inertial, moved, pitch};
use proofmass::rng::{Philox, Stream};

use super::pages::{whole, without_own_script};
use super::world::{check, data_test, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("paper: all checks of all twenty figures hold, simulated", simulated),
        data_test("paper: the checks of figures 5 to 12 hold on the recording", recorded),
        test("paper: a filter that misjudges its accelerometer fails the NIS check", misjudged),
        test("paper: a filled plane and a curve fail the attractor's dimension", not_fractal),
        test("paper: a map runs, and a misspelt key is named", map_command),
    ]
}

fn all_hold(exhibits: &[&Exhibit]) -> Result<(), Failed> {
    for e in exhibits {
        check(!e.checks.is_empty(), format!("figure {} has no check", e.figure))?;
        for c in &e.checks {
            let words = format!("figure {}: {}: {} ± {}, got {}", e.figure, c.name, c.expected, c.tolerance, c.got);
            check(
                c.holds == ((c.got - c.expected).abs() <= c.tolerance),
                format!("{words}: verdict and numbers differ"),
            )?;
            check(c.holds, words)?;
        }
    }
    Ok(())
}

fn simulated() -> Result<(), Failed> {
    let paper = compute(None, false, Device::Cpu, &Control::silent())?;
    let exhibits = paper.exhibits();
    let numbers: Vec<u32> = exhibits.iter().map(|e| e.figure).collect();
    check(numbers == (1..=20).collect::<Vec<u32>>(), format!("figures are {numbers:?}"))?;
    check(exhibits.iter().all(|e| e.source == Provenance::Simulated), "nothing was recorded here")?;
    let page = paper::page::page(&paper).finish();
    check(page.len() < 5_000_000, format!("the page has {} bytes", page.len()))?;
    check(!without_own_script(&page)?.contains("<script"), "the page holds a script that is not its own")?;
    let json = serde_json::to_value(exhibits[0])?;
    let keys = |v: &serde_json::Value| v.as_object().map(|o| o.keys().cloned().collect::<Vec<_>>()).unwrap_or_default();
    let mut figure = keys(&json);
    figure.sort();
    check(figure == ["checks", "figure", "source", "title"], format!("{figure:?}"))?;
    let mut one = keys(&json["checks"][0]);
    one.sort();
    check(one == ["expected", "got", "holds", "name", "tolerance"], format!("{one:?}"))?;
    all_hold(&exhibits)?;
    whole("paper", &page)
}

fn recorded(folder: &std::path::Path) -> Result<(), Failed> {
    let imu = inertial::recorded(folder, &Control::silent())?;
    check(imu.poses.len() > 30, "poses are missing")?;
    let pitch = pitch::compute(&imu);
    let fusion = fusion::compute(moved::compute(&imu, &pitch));
    check(
        pitch.exhibits.iter().all(|e| e.source == Provenance::Recorded),
        "figures 5 to 10 are not from the recording",
    )?;
    all_hold(&pitch.exhibits.iter().chain(&fusion.exhibits).collect::<Vec<_>>())
}

fn misjudged() -> Result<(), Failed> {
    let truth = beliefs::model();
    let mean_nis = |believed: Model| {
        let mut random = Philox::new(3, 0, Stream::Host);
        let mut normal = || random.normal();
        let mut filter = Filter::new(believed, Weighting::Plain, 0.0);
        let mut sum = 0.0;
        for step in 0..20_000 {
            let rate_rad_s = truth.angle_walk_rad_rts / truth.step_s.sqrt() * normal();
            let tilt_rad = truth.tilt_noise_rad * normal();
            let nis = filter.step(Reading { rate_rad_s, tilt_rad, force_m_s2: truth.gravity_m_s2 }).nis;
            sum += if step >= 4000 { nis } else { 0.0 };
        }
        sum / 16_000.0
    };
    // The check of figure 11, with its tolerance for 16,000 innovations; tilt is known to stand
    // still here, so that the honest filter is a little cautious.
    let judge = |nis| Check::near("NIS", "", 1.0, nis, 0.06).holds;
    check(judge(mean_nis(truth)), format!("an honest filter failed: {}", mean_nis(truth)))?;
    let wrong = Model { tilt_noise_rad: truth.tilt_noise_rad / 2.0, ..truth };
    check(!judge(mean_nis(wrong)), "half the noise passed")
}

fn not_fractal() -> Result<(), Failed> {
    // The attractor's correlation dimension is some 1.55 and must lie between 1 and the
    // Kaplan–Yorke dimension, 1.64.
    let judge = |d: f64| Check::between("dimension", "", 1.0 + 1e-2, 1.64 + 0.04, d).holds;
    let mut random = Philox::new(4, 0, Stream::Host);
    let mut place = || 0.5 + 0.25 * random.normal();
    let plane: Vec<Vec<[f64; 2]>> = (0..4).map(|_| (0..3000).map(|_| [place(), place()]).collect()).collect();
    let scales = Scales { coarse: 3, fine: 6 };
    check(!judge(correlation(&plane, scales).estimate.value), "a filled plane passed")?;
    let curve: Vec<Vec<[f64; 2]>> = plane.iter().map(|g| g.iter().map(|p| [p[0], 0.5]).collect()).collect();
    check(!judge(correlation(&curve, scales).estimate.value), "a line passed")
}

fn map_command() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("map.toml");
    let text = "[oscillator]\ndamping_kg_s = 0.1\nstiffness_n_m = 1.0\ncubic_n_m3 = 0.3\n[drive]\namplitude_n = 66.75\n\
                omega_rad_s = 1.5\n[[map]]\ntitle = \"small\"\nx = { quantity = \"amplitude_n\", from = 60.0, to = 70.0, \
                points = 20 }\ny = { quantity = \"omega_rad_s\", from = 1.4, to = 1.6, points = 10 }\n[[bifurcation]]\n\
                title = \"short\"\nfrom_n = 60.0\nto_n = 70.0\npoints = 10\nstrobes = 10\n";
    std::fs::write(&file, text)?;
    let out = folder.path().join("out");
    let run = program().arg("--json").arg("map").arg(&file).arg("--out").arg(&out).output()?;
    check(run.status.success(), String::from_utf8_lossy(&run.stderr))?;
    let json: serde_json::Value = serde_json::from_slice(&run.stdout)?;
    let share = json["maps"][0]["chaotic_share"].as_f64().unwrap_or(0.0);
    check(share > 0.2 && share < 1.0, format!("{share} of the cells around the paper's point are chaotic"))?;
    check(out.join("report.html").is_file() && out.join("map-1.csv").is_file(), "report or table is missing")?;
    std::fs::write(&file, text.replace("strobes", "strobs"))?;
    let run = program().arg("map").arg(&file).output()?;
    let words = String::from_utf8_lossy(&run.stderr).into_owned();
    check(run.status.code() == Some(2) && words.contains("did you mean `strobes`?"), words)
}
