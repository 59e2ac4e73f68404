//! `study --risk`: small probabilities against closed forms and, where there is none, against
//! counts of ordinary members.
//!
//! The closed forms are written out here, independent of the program.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::decision::risk::{Exceeds, Risk, risk};
use proofmass::decision::values::{Place, Work};
use proofmass::numerics::special::{normal_cdf, normal_quantile};
use proofmass::statistics::Estimate;
use proofmass::study::{self, Study};
use serde_json::Value;

use super::closed_form::G;
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test(
            "risk: one in ten million, of a drawn bias and white noise, within a fifth at a thousandth of a count",
            gaussian,
        ),
        test("risk: of a process that its start decides, and of a uniform tolerance", starts_and_ends),
        test("risk: of a scale factor times a drawn input, whose tails are those of a product", product),
        test("risk: after a still start, with bias instability, errors have the tails of a normal law", still),
        test("risk: along a trajectory what is counted is found, and beyond it goes on as a radius does", in_motion),
        test("risk: the command prints it as JSON and words, beside what a study says anyway", command),
        test("risk: what cannot be asked is refused in words", refused),
    ]
}

/// Length of every study, s.
const T: f64 = 10.0;

fn text(sections: &str) -> String {
    format!(
        "members = 1024\nseed = 5\nduration_s = {T}\n[report]\ntimes_s = [{T}]\n[sensor]\nsample_rate_hz = 20.0\n{sections}"
    )
}

fn parsed(sections: &str) -> Result<Study, Failed> {
    Ok(study::parse("study.toml", &text(sections), Path::new(""))?)
}

fn found(sections: &str, event: &str) -> Result<Risk, Failed> {
    Ok(risk(&parsed(sections)?, &event.parse()?, &Control::silent())?)
}

fn probability(risk: &Risk) -> Result<Estimate, Failed> {
    Ok(risk.probability.ok_or("no probability")?)
}

/// Half-width of an interval whose middle is that of its logarithms.
fn reach(estimate: Estimate) -> f64 {
    (estimate.ci95[1] / estimate.value).ln()
}

/// Returns whether a probability is another, to twice its interval (4.7 standard errors, which
/// Student's law with seven degrees of freedom exceeds once in five hundred) and 5 % for what the
/// noise's small steps and single precision leave.
fn agrees(estimate: Estimate, truth: f64) -> bool {
    (estimate.value / truth).ln().abs() < 2.0 * reach(estimate) + 0.05
}

/// Standard deviations of ½ b t² and N t^1.5/√3.
fn bias_and_noise() -> f64 {
    (0.5 * 1e-3 * G * T * T).hypot(2000e-6 * G / 2f64.sqrt() * T.powf(1.5) / 3f64.sqrt())
}

const BIAS_AND_NOISE: &str = "[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\nnoise_density_ug_rthz = 2000.0\n";

fn gaussian() -> Result<(), Failed> {
    let limit = 5.32 * bias_and_noise();
    let truth = 2.0 * normal_cdf(-5.32);
    let got = found(BIAS_AND_NOISE, &format!("abs(position_error_m, {T}) > {limit}"))?;
    let estimate = probability(&got)?;
    check(agrees(estimate, truth), format!("{estimate:?}, {truth:e}"))?;
    // Members that counting takes for a 95 % interval of ± 20 %: the count has a variance of itself.
    let counted = 1.96f64.powi(2) / (0.2 * 0.2 * truth);
    check(reach(estimate) < 0.2 && (got.members as f64) < 1e-3 * counted, format!("{estimate:?}, {}", got.members))?;
    for exceeded in &got.exceeded {
        let truth = -normal_quantile(0.5 * exceeded.probability) * bias_and_noise();
        let Estimate { value, ci95: [low, high] } = exceeded.error;
        check((value - truth).abs() < high - low, format!("{exceeded:?}, {truth}"))?;
    }
    check(got.exceeded.len() == 6, format!("{:?}", got.exceeded))?;
    // Control: the same probability of a limit 5 % nearer is refused.
    check(!agrees(estimate, 2.0 * normal_cdf(-0.95 * 5.32)), "another limit's probability is accepted")
}

/// A Gauss–Markov bias that hardly changes in the run: ½ σ t² of its start, with 1 − t/(3τ) of it at
/// the end (first order in t/τ, variance (½ t²)² σ² (1 − 2t/(5τ)); here τ = 3000 s).
fn starts_and_ends() -> Result<(), Failed> {
    let sections = "[accelerometer]\ngauss_markov_ug = 1000.0\ngauss_markov_time_s = 3000.0\n";
    let sd = 0.5 * 1e-3 * G * T * T;
    let estimate = probability(&found(sections, &format!("signed(position_error_m, {T}) > {}", 5.2 * sd))?)?;
    check(agrees(estimate, normal_cdf(-5.2)), format!("{estimate:?}"))?;
    // Three thousandths of a uniform law lie beyond 0.994 of its end.
    let uniform = "[accelerometer]\nbias_mg = { min = -1.0, max = 1.0 }\n";
    let estimate = probability(&found(uniform, &format!("signed(position_error_m, {T}) > {}", 0.994 * sd))?)?;
    check(agrees(estimate, 0.003), format!("{estimate:?}"))?;
    let got = found(uniform, &format!("abs(position_error_m, {T}) > {}", 1.001 * sd))?;
    // Beyond the end of the law there is nothing; single precision ends before one in 10¹⁰ does.
    check(got.probability.is_none() && got.exceeded.len() >= 5, format!("{got:?}"))
}

/// P(|x y| > c) of two standard normal numbers, by the trapezoid rule over one.
fn product_beyond(c: f64) -> f64 {
    let step = 1e-3;
    let density = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
    (1..10_000).map(|i| step * f64::from(i)).map(|x| 4.0 * step * density(x) * normal_cdf(-c / x)).sum()
}

fn product() -> Result<(), Failed> {
    let got = found(
        "[accelerometer]\nscale_factor_ppm = { mean = 0.0, sd = 1000.0 }\n[excitation]\nkind = \"rectangle\"\n\
         amplitude_m_s2 = { mean = 0.0, sd = 1.0 }\nstart_s = 0.0\nlength_s = 100.0\n",
        &format!("abs(position_error_m, {T}) > {}", 14.0 * 0.5e-3 * T * T),
    )?;
    let (estimate, truth) = (probability(&got)?, product_beyond(14.0));
    check(agrees(estimate, truth), format!("{estimate:?}, {truth:e}"))?;
    // Control: of a normal number as wide it would be nowhere near.
    check(!agrees(estimate, 2.0 * normal_cdf(-14.0)), "tails of a normal law are accepted")
}

const AT_REST: &str = "[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\nbias_instability_ug = 300.0\n[gyro]\n\
    bias_deg_h = { mean = 0.0, sd = 50.0 }\nbias_instability_deg_h = 30.0\n[alignment]\nkind = \"still\"\nstill_s = 10.0\n";

/// Errors of this many ordinary members.
fn ordinary(study: &Study, event: &Exceeds, members: u64) -> Result<Vec<f64>, Failed> {
    let place = Place { quantity: event.quantity, samples: Place::at(event.time_s, study)? };
    Ok(Work::new(&Control::silent(), "members").values(study, place, 0..members)?)
}

/// The drift of all sources is a sum of normal ones, so that all quantiles stand in the ratio of a
/// normal law's. Its size is that of ordinary members to 1 %: bias instability is within 2 or 3 %
/// of its law, whichever way its slow terms go.
fn still() -> Result<(), Failed> {
    let study = parsed(AT_REST)?;
    let event: Exceeds = format!("abs(position_error_m, {T}) > 1.5").parse()?;
    let errors = ordinary(&study, &event, 1 << 17)?;
    let sd = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    let got = risk(&study, &event, &Control::silent())?;
    check(got.exceeded.len() >= 5, format!("{got:?}"))?;
    for exceeded in &got.exceeded {
        let ratio = exceeded.error.value / (-normal_quantile(0.5 * exceeded.probability) * sd);
        check((ratio - 1.0).abs() < 0.015, format!("{exceeded:?}: {ratio}"))?;
    }
    Ok(())
}

fn in_motion() -> Result<(), Failed> {
    let sections = "[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\nnoise_density_ug_rthz = 2000.0\n[gyro]\n\
        bias_deg_h = { mean = 0.0, sd = 40.0 }\n[trajectory]\nkind = \"rest\"\n[alignment]\nkind = \"drawn\"\n\
        heading_sd_deg = 1.0\ntilt_sd_deg = 0.03\n";
    let study = parsed(sections)?;
    // On each horizontal axis: what one axis drifts by, a gyro bias (g b t³/6) and a tilt (g θ t²/2).
    let tilted = 0.5 * G * 0.03f64.to_radians() * T * T;
    let sd = bias_and_noise().hypot(G * 40.0 * 4.848_136_8e-6 * T.powi(3) / 6.0).hypot(tilted);
    // A radius of two such axes exceeds r with exp(−r²/2).
    let one_in = |p: f64| (-2.0 * f64::ln(p)).sqrt() * sd;
    let event: Exceeds = format!("abs(horizontal_error_m, {T}) > {}", one_in(1e-6)).parse()?;
    let got = risk(&study, &event, &Control::silent())?;
    let estimate = probability(&got)?;
    check(agrees(estimate, 1e-6), format!("{estimate:?}"))?;
    let errors = ordinary(&study, &event, 1 << 15)?;
    for exceeded in &got.exceeded[..2] {
        let beyond = errors.iter().filter(|error| **error > exceeded.error.value).count() as f64;
        let expected = exceeded.probability * errors.len() as f64;
        // Three standard deviations of a count, and of the quantile's own error as much.
        check((beyond - expected).abs() < 6.0 * expected.sqrt(), format!("{exceeded:?}: {beyond}, not {expected}"))?;
    }
    Ok(())
}

/// Runs the command on a small study in its own folder.
fn run(sections: &str, more: &[&str]) -> Result<(tempfile::TempDir, std::process::Output), Failed> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("study.toml"), text(sections))?;
    let mut command = program();
    command.current_dir(folder.path()).args(["study", "study.toml", "--out", "out"]).args(more);
    let output = command.output()?;
    Ok((folder, output))
}

fn command() -> Result<(), Failed> {
    let event = format!("abs(position_error_m, {T}) > {:.2}", 3.8 * bias_and_noise());
    let json = |more: &[&str]| -> Result<Value, Failed> {
        let (_folder, output) = run(BIAS_AND_NOISE, &[&["--json"], more].concat())?;
        check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
        Ok(serde_json::from_slice(&output.stdout)?)
    };
    let (mut with, mut without) = (json(&["--risk", &event])?, json(&[])?);
    let risk = with.as_object_mut().and_then(|document| document.remove("risk")).ok_or("no risk")?;
    for document in [&mut with, &mut without] {
        document.as_object_mut().map(|document| document.remove("seconds"));
    }
    check(with == without, "--risk changes other fields")?;
    check(risk["quantity"] == "position_error_m" && risk["absolute"] == true, risk.to_string())?;
    let value = risk["probability"]["value"].as_f64().ok_or("no probability")?;
    check((5e-5..4e-4).contains(&value), risk.to_string())?;
    check(risk["exceeded"].as_array().is_some_and(|all| all.len() == 3), risk.to_string())?;
    let (folder, output) = run(BIAS_AND_NOISE, &["--risk", &event])?;
    let words = String::from_utf8_lossy(&output.stdout).into_owned();
    check(words.contains("Probability that the size of the position error after 10 s exceeds"), &words)?;
    let page = std::fs::read_to_string(folder.path().join("out/report.html"))?;
    check(page.contains("How probable a large error is"), "not on the page")
}

fn refused() -> Result<(), Failed> {
    let sine = "[excitation]\nkind = \"sine\"\namplitude_m_s2 = 1.0\nfrequency_hz = 1.0\n";
    let alike = format!("[accelerometer]\nbias_mg = 1.0\n{sine}");
    for (sections, event, word) in [
        (BIAS_AND_NOISE, "abs(position_error_m, 60) > 1", "outside the run"),
        (BIAS_AND_NOISE, "abs(horizontal_error_m, 10) > 1", "needs a [trajectory]"),
        (BIAS_AND_NOISE, "p95(position_error_m, 10) > 1", "neither abs nor signed"),
        (alike.as_str(), "abs(position_error_m, 10) > 1", "the same for all members"),
        (BIAS_AND_NOISE, "abs(tilt_error_rad, 10) > 1", "the same for all members"),
    ] {
        let (_folder, output) = run(sections, &["--risk", event])?;
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        check(!output.status.success() && words.contains(word), format!("{event}: {words}"))?;
    }
    Ok(())
}
