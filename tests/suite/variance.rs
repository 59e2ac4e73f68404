//! `study --variance`: shares of the last position error's variance against closed forms, for sources
//! that add and for sources that act on each other, along one axis and along a trajectory.
//!
//! The closed forms are written out here, independent of the program. Of 16384 members a share is
//! known to about 0.006: 0.02 is more than three standard errors.

use std::path::Path;
use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::decision::variance::{Source, Variance, variance};
use proofmass::kernel::integrator::Integrator;
use proofmass::sensor::{Accelerometer, Sensor};
use proofmass::statistics::Estimate;
use proofmass::study::second::Second;
use proofmass::study::{self, Study};
use serde_json::Value;

use super::closed_form::G;
use super::world::{check, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("variance: of sources that add, each share is its closed form, alone, in all and as Shapley has it", adds),
        test("variance: the same with eight sources, by orders instead of subsets", adds_in_orders),
        test("variance: a scale factor times a drawn input interacts as its product form says", interacts),
        test("variance: along a trajectory it is that of the horizontal plane", in_motion),
        test("variance: a second sample of one source leaves the draws of all others", one_source),
        test("variance: the command prints it as JSON and words, beside what a study says anyway", command),
        test("variance: where all members are alike, or a [sweep] asks for several studies, it is refused", refused),
    ]
}

const MEMBERS: u64 = 16_384;
/// Length of every study, s, and the time of its last report.
const T: f64 = 10.0;
/// Most that a share may differ from its closed form.
const WITHIN: f64 = 0.02;

fn text(sections: &str) -> String {
    format!(
        "members = {MEMBERS}\nseed = 5\nduration_s = {T}\n[report]\ntimes_s = [{T}]\n[sensor]\nsample_rate_hz = 100.0\n{sections}"
    )
}

fn parsed(sections: &str) -> Result<Study, Failed> {
    Ok(study::parse("study.toml", &text(sections), Path::new(""))?)
}

fn shared(sections: &str) -> Result<Variance, Failed> {
    Ok(variance(&parsed(sections)?, &Control::silent())?)
}

/// Shares of one source in closed form: alone, with interactions, Shapley.
type Truth = (&'static str, [f64; 3]);

/// The shares of sources that add, of their variances.
fn additive(variances: &[(&'static str, f64)]) -> Vec<Truth> {
    let whole: f64 = variances.iter().map(|(_, variance)| variance).sum();
    variances.iter().map(|(name, variance)| (*name, [variance / whole; 3])).collect()
}

fn estimates(source: &Source) -> [Estimate; 3] {
    [source.share.alone, source.share.total, source.share.shapley]
}

/// Fails unless every share is its closed form to [`WITHIN`] and in an interval of twice the width,
/// which one in ten thousand misses, and the Shapley shares add up to one.
fn agree(got: &Variance, truth: &[Truth]) -> Result<(), Failed> {
    check(got.sources.len() == truth.len(), format!("{:?}", got.sources))?;
    for (name, shares) in truth {
        let source = got.sources.iter().find(|source| source.source == *name);
        let source = source.ok_or(format!("no {name} in {:?}", got.sources))?;
        for (estimate, share) in estimates(source).iter().zip(shares) {
            near(name, estimate.value, *share, WITHIN)?;
            let [low, high] = estimate.ci95;
            let wide = 0.5 * (high - low) + 1e-9;
            check((low - wide..=high + wide).contains(share), format!("{name}: {share} is not in {estimate:?}"))?;
            check(low <= estimate.value && estimate.value <= high, format!("{name}: {estimate:?}"))?;
        }
    }
    let shapley: f64 = got.sources.iter().map(|source| source.share.shapley.value).sum();
    near("Shapley shares together", shapley, 1.0, 1e-9)
}

fn sum_alone(got: &Variance) -> f64 {
    got.sources.iter().map(|source| source.share.alone.value).sum()
}

const ADD: &str = "[accelerometer]
bias_mg = { mean = 0.3, sd = 1.0 }
acceleration_ramp_mg_h = { mean = 0.0, sd = 1000.0 }
noise_density_ug_rthz = 2000.0
[gyro]
bias_deg_h = { mean = 0.0, sd = 40.0 }
";

/// Variances of [`ADD`]: (½ b t²)², (R t³/6)², (N t^1.5/√3)², (g b t³/6)².
fn add() -> Vec<(&'static str, f64)> {
    let square = |sd: f64| sd * sd;
    vec![
        ("accelerometer bias", square(0.5 * 1e-3 * G * T * T)),
        ("acceleration ramp", square(2.724_069_4e-3 * T.powi(3) / 6.0)),
        ("noise in the run", square(2000e-6 * G / 2f64.sqrt() * T.powf(1.5) / 3f64.sqrt())),
        ("gyro bias", square(G * 40.0 * 4.848_136_8e-6 * T.powi(3) / 6.0)),
    ]
}

fn adds() -> Result<(), Failed> {
    let got = shared(ADD)?;
    let truth = additive(&add());
    agree(&got, &truth)?;
    let whole: f64 = add().iter().map(|(_, variance)| variance).sum();
    near("standard deviation", got.sd_m, whole.sqrt(), 0.02 * whole.sqrt())?;
    near("alone together", sum_alone(&got), 1.0, WITHIN)?;
    let noise = got.sources.iter().find(|source| source.source == "noise in the run");
    check(noise.is_some_and(|noise| noise.holds == ["velocity random walk"]), format!("{noise:?}"))?;
    // Control: the shares of a study with a gyro twice as bad are others.
    let worse: Vec<_> =
        add().into_iter().map(|(name, v)| (name, if name == "gyro bias" { 4.0 * v } else { v })).collect();
    check(agree(&got, &additive(&worse)).is_err(), "another study's shares are accepted")
}

fn adds_in_orders() -> Result<(), Failed> {
    let sections = ADD
        .replace("[gyro]\n", "misalignment_mrad = { mean = 0.0, sd = 0.7 }\n[gyro]\nrate_ramp_deg_h_h = { mean = 0.0, sd = 50000.0 }\nangle_random_walk_deg_rth = 2.0\nwarm_up_deg_h = { mean = 0.0, sd = 60.0 }\nwarm_up_time_s = 5.0\n")
        + "[alignment]\nkind = \"drawn\"\ntilt_sd_deg = 0.03\n";
    let square = |sd: f64| sd * sd;
    let mut variances = add();
    // The gyro's noise is the same group: (g N t^2.5/√20)².
    variances[2].1 += square(G * 2.0 * 2.908_882e-4 * T.powf(2.5) / 20f64.sqrt());
    let x = T / 5.0;
    variances.extend([
        ("accelerometer misalignment", square(0.5 * G * 0.7e-3 * T * T)),
        ("rate ramp", square(G * 50.0 * 1.346_704_7e-6 * T.powi(4) / 24.0)),
        ("initial tilt", square(0.5 * G * 0.03f64.to_radians() * T * T)),
        ("gyro warm-up", square(G * 60.0 * 4.848_136_8e-6 * 125.0 * (x * x / 2.0 - x + 1.0 - (-x).exp()))),
    ]);
    agree(&shared(&sections)?, &additive(&variances))
}

/// Position error s ½ a t² of a scale factor s under a force a, both drawn: with means m and
/// standard deviations d, its variance is (d_s m_a)² + (m_s d_a)² + (d_s d_a)², in units of (½ t²)²;
/// the last is of both together.
fn interacts() -> Result<(), Failed> {
    let got = shared(
        "[accelerometer]\nscale_factor_ppm = { mean = 500.0, sd = 1000.0 }\n[excitation]\nkind = \"rectangle\"\n\
         amplitude_m_s2 = { mean = 2.0, sd = 1.0 }\nstart_s = 0.0\nlength_s = 100.0\n",
    )?;
    let [scale, force, both] = [4.0, 0.25, 1.0].map(|part: f64| part / 5.25);
    agree(
        &got,
        &[
            ("scale factor", [scale, scale + both, scale + 0.5 * both]),
            ("excitation", [force, force + both, force + 0.5 * both]),
        ],
    )?;
    near("standard deviation", got.sd_m, 0.5e-3 * T * T * 5.25f64.sqrt(), 0.02 * 0.5e-3 * T * T * 5.25f64.sqrt())?;
    // Alone they leave the interaction out.
    near("alone together", sum_alone(&got), 1.0 - both, WITHIN)?;
    // Control: taken for sources that add, they do not agree.
    let added = [("scale factor", [scale + 0.5 * both; 3]), ("excitation", [force + 0.5 * both; 3])];
    check(agree(&got, &added).is_err(), "shares without an interaction are accepted")
}

/// At rest on a flat Earth each horizontal axis drifts as one axis does, and two have the shares of
/// one.
fn in_motion() -> Result<(), Failed> {
    let sections = "[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\nnoise_density_ug_rthz = 2000.0\n[gyro]\n\
        bias_deg_h = { mean = 0.0, sd = 40.0 }\n[trajectory]\nkind = \"rest\"\n";
    let got = shared(sections)?;
    let without_ramp: Vec<_> = add().into_iter().filter(|(name, _)| *name != "acceleration ramp").collect();
    agree(&got, &additive(&without_ramp))?;
    let whole: f64 = without_ramp.iter().map(|(_, variance)| 2.0 * variance).sum();
    near("standard deviation of both axes", got.sd_m, whole.sqrt(), 0.02 * whole.sqrt())?;
    check(got.quantity == "position_error_ned_m", got.quantity)
}

fn one_source() -> Result<(), Failed> {
    let study = parsed(ADD)?;
    let bias = study.groups().into_iter().find(|group| group.name == "accelerometer bias").ok_or("no bias")?;
    // Of every other member.
    let taken = move |member: u64| if member % 2 == 1 { bias.slots } else { 0 };
    let second = study.with_second(Second { taken: Arc::new(taken), in_run: false });
    for member in 0..100 {
        let [first, second] = [&study, &second].map(|study| study.member(member).sensor);
        let accelerometer = Accelerometer { bias_m_s2: first.accelerometer.bias_m_s2, ..second.accelerometer };
        check(Sensor { accelerometer, ..second } == first, format!("member {member} differs by more than its bias"))?;
        check((second == first) == (member % 2 == 0), format!("member {member} has the bias of the other sample"))?;
    }
    let job = |in_run: bool| {
        let second = study.with_second(Second { taken: Arc::new(|_| 0), in_run });
        second.job(Integrator::Ideal, vec![1]).seed
    };
    check(job(false) == study.seed && job(true) != study.seed, "the noise in the run has the seed of its sample")
}

/// Runs the command on a small study in its own folder.
fn run(sections: &str, more: &[&str]) -> Result<(tempfile::TempDir, std::process::Output), Failed> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("study.toml"), text(sections))?;
    let mut command = program();
    command.current_dir(folder.path()).args(["study", "study.toml", "--members", "1024", "--out", "out"]).args(more);
    let output = command.output()?;
    Ok((folder, output))
}

fn command() -> Result<(), Failed> {
    let json = |more: &[&str]| -> Result<Value, Failed> {
        let (_folder, output) = run(ADD, &[&["--json"], more].concat())?;
        check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
        Ok(serde_json::from_slice(&output.stdout)?)
    };
    let (mut with, mut without) = (json(&["--variance"])?, json(&[])?);
    let variance = with.as_object_mut().and_then(|document| document.remove("variance")).ok_or("no variance")?;
    for document in [&mut with, &mut without] {
        document.as_object_mut().map(|document| document.remove("seconds"));
    }
    check(with == without, "--variance changes other fields")?;
    check(variance["quantity"] == "position_error_m" && variance["members"] == 1024, variance.to_string())?;
    let sources = variance["sources"].as_array().ok_or("no sources")?;
    check(sources.len() == 4, variance.to_string())?;
    for source in sources {
        for share in ["alone", "total", "shapley"] {
            let whole =
                source[share]["value"].is_f64() && source[share]["ci95"].as_array().is_some_and(|c| c.len() == 2);
            check(whole, source.to_string())?;
        }
    }
    let (folder, output) = run(ADD, &["--variance"])?;
    let words = String::from_utf8(output.stdout)?;
    let page = std::fs::read_to_string(folder.path().join("out/report.html"))?;
    for (place, text) in [("terminal", &words), ("page", &page)] {
        let holds = ["alone they make", "with interactions", "Shapley", "holds: velocity random walk"];
        let missing = holds.into_iter().find(|part| !text.replace('\u{a0}', " ").contains(part));
        check(missing.is_none(), format!("{place} lacks {missing:?}"))?;
    }
    let flight = "[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\n[trajectory]\nkind = \"rest\"\n";
    let (_folder, output) = run(flight, &["--variance", "--json"])?;
    let document: Value = serde_json::from_slice(&output.stdout)?;
    check(document["variance"]["quantity"] == "position_error_ned_m", document["variance"].to_string())
}

fn refused() -> Result<(), Failed> {
    let alike = "[accelerometer]\nbias_mg = 1.0\n";
    let swept = "[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\n[sweep]\naccelerometer.bias_mg.sd = \"1:2:2\"\n";
    for (sections, words) in [(alike, "all members have the same position error"), (swept, "asks for several studies")]
    {
        let (folder, output) = run(sections, &["--variance"])?;
        let said = String::from_utf8(output.stderr)?;
        check(output.status.code() == Some(2) && said.contains(words), said)?;
        check(!folder.path().join("out").exists(), "a refusal leaves a folder behind")?;
    }
    Ok(())
}
