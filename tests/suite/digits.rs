//! Digits that are declared stable are: over repeats for laws in closed form, in the examples of
//! JCGM 101, and in a study.

use std::convert::Infallible;
use std::io::{BufRead as _, BufReader};
use std::ops::Range;
use std::process::{Command, Stdio};

use libtest_mimic::{Failed, Trial};
use proofmass::numerics::special::exact_interval;
use proofmass::rng::{Philox, Stream};
use proofmass::statistics::jcgm101::{BLOCK, BLOCKS, Stated, adaptive, block, need, tolerance};
use rand::Rng as _;
use serde_json::Value;

use super::world::{check, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test(
            "digits: the declared tolerance holds as often as it says, for a normal, a rectangular and a heavy-tailed law",
            holds,
        ),
        test("digits: JCGM 101 §9.2, additive models, within the tolerance", additive),
        test("digits: JCGM 101 §9.3, mass calibration, within the tolerance; the linear answer is not valid", mass),
        test("digits: JCGM 101 §9.4, comparison loss, within the tolerance", loss),
        test("digits: a study runs as many members as two digits take, and states them", study),
    ];
    #[cfg(unix)]
    all.push(test("digits: a run that is stopped goes on with --resume and ends with the same bits", resumed));
    all
}

/// Normal and uniform numbers of one trial, whatever the range it is asked in.
fn trials(seed: u64, range: Range<u64>, law: &dyn Fn(&mut Philox) -> f64) -> Vec<f64> {
    range.map(|trial| law(&mut Philox::new(seed, trial, Stream::Host))).collect()
}

fn stated(seed: u64, digits: u32, law: &dyn Fn(&mut Philox) -> f64) -> Result<Stated, Failed> {
    let sample = |range: Range<u64>| Ok::<_, Infallible>(trials(seed, range, law));
    adaptive(digits, sample).map_err(|never| match never {})
}

/// Uniform in (0, 1).
fn uniform(rng: &mut Philox) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// Uniform with this mean and half-width.
fn rectangular(rng: &mut Philox, mean: f64, half: f64) -> f64 {
    mean + half * (2.0 * uniform(rng) - 1.0)
}

/// Student's t with five degrees of freedom: a normal over the root of a χ² over five.
fn heavy(rng: &mut Philox) -> f64 {
    let normal = rng.normal();
    let chi: f64 = (0..5).map(|_| rng.normal().powi(2)).sum();
    normal / (chi / 5.0).sqrt()
}

/// A law with what is true of it: mean, standard deviation, ends of the symmetric interval of 95 %.
struct Law {
    name: &'static str,
    draw: fn(&mut Philox) -> f64,
    truth: [f64; 4],
}

/// Scaled so that two digits take more than the first stage and their tolerance is one thing: u
/// from 3 to 4 of its unit.
const LAWS: [Law; 3] = [
    Law { name: "normal", draw: |rng| 3.0 * rng.normal(), truth: [0.0, 3.0, -5.879_892, 5.879_892] },
    // Half-width 6: deviation 6/√3.
    Law { name: "rectangular", draw: |rng| rectangular(rng, 0.0, 6.0), truth: [0.0, 3.464_101_6, -5.7, 5.7] },
    // Deviation √(5/3); t(0.975; 5) = 2.570 582 (tables); both times 3.
    Law { name: "t with 5 degrees", draw: |rng| 3.0 * heavy(rng), truth: [0.0, 3.872_983_3, -7.711_746, 7.711_746] },
];

/// Few repeats, which take seconds; `PROOFMASS_REPEATS` says how many instead.
fn holds() -> Result<(), Failed> {
    let given = std::env::var("PROOFMASS_REPEATS").ok().and_then(|text| text.parse::<u64>().ok());
    let repeats = given.unwrap_or(20);
    for Law { name, draw, truth } in &LAWS {
        let (mut hits, mut early) = (0, 0);
        for repeat in 0..repeats {
            let result = stated(1000 + repeat, 2, draw)?;
            let got = [
                result.estimate,
                result.standard_uncertainty,
                result.interval95.symmetric[0],
                result.interval95.symmetric[1],
            ];
            let within = |tolerance: f64| got.iter().zip(truth).all(|(got, truth)| (got - truth).abs() <= tolerance);
            hits += u64::from(within(result.tolerance));
            // Control: a tenth of the tolerance does not hold.
            early += u64::from(within(0.1 * result.tolerance));
            check(result.trials >= BLOCKS * BLOCK && result.tolerance == 0.05, format!("{name}: {result:?}"))?;
        }
        println!("{name}: {hits} of {repeats} within the tolerance");
        let [_, high] = exact_interval(hits, repeats, 0.998);
        check(high >= 0.95, format!("{name}: {hits} of {repeats} within the tolerance"))?;
        check(early < repeats / 2, format!("{name}: {early} of {repeats} within a tenth of it"))?;
    }
    Ok(())
}

/// What is stated, and what is in print, to the tolerance of both.
fn agrees(what: &str, got: [f64; 4], printed: [f64; 4], within: f64) -> Result<(), Failed> {
    for (k, name) in ["estimate", "standard uncertainty", "lower end", "upper end"].iter().enumerate() {
        near(&format!("{what}: {name}"), got[k], printed[k], within)?;
    }
    Ok(())
}

fn of(result: &Stated, ends: [f64; 2]) -> [f64; 4] {
    [result.estimate, result.standard_uncertainty, ends[0], ends[1]]
}

fn additive() -> Result<(), Failed> {
    // §9.2.2: four standard normal inputs: 0, 2.0, ±3.92.
    let normal = stated(1, 2, &|rng| (0..4).map(|_| rng.normal()).sum())?;
    agrees("normal", of(&normal, normal.interval95.symmetric), [0.0, 2.0, -3.92, 3.92], 0.05)?;
    check(normal.beside(0.0, 2.0).validated == Some(true), "the linear answer is exact and not found valid")?;
    // §9.2.3: four rectangular ones of the same deviations: ±2√3[2 − (3/5)^¼] = ±3.88.
    let half = 3f64.sqrt();
    let rectangular_sum = stated(2, 2, &|rng| (0..4).map(|_| rectangular(rng, 0.0, half)).sum())?;
    let end = 2.0 * half * (2.0 - 0.6f64.powf(0.25));
    near("in print", end, 3.88, 0.005)?;
    agrees("rectangular", of(&rectangular_sum, rectangular_sum.interval95.symmetric), [0.0, 2.0, -end, end], 0.05)?;
    // §9.2.4: one of them with a deviation of 10: 0, 10.1, ±17.0, where the linear answer has
    // ±19.9.
    let wide = stated(3, 2, &|rng| {
        (0..3).map(|_| rectangular(rng, 0.0, half)).sum::<f64>() + rectangular(rng, 0.0, 10.0 * half)
    })?;
    agrees("one wide", of(&wide, wide.interval95.symmetric), [0.0, 10.1, -17.0, 17.0], 0.1)?;
    check(wide.beside(0.0, 103f64.sqrt()).validated == Some(false), "±19.9 is found valid where ±17.0 is true")
}

fn mass() -> Result<(), Failed> {
    // §9.3, equation (33): the correction to 100 g, in mg. Inputs of table 5.
    let model = |rng: &mut Philox| {
        let reference = 100_000.0 + 0.050 * rng.normal();
        let added = 1.234 + 0.020 * rng.normal();
        let air = rectangular(rng, 1.20, 0.10);
        let [weight, standard] = [rectangular(rng, 8000.0, 1000.0), rectangular(rng, 8000.0, 50.0)];
        (reference + added) * (1.0 + (air - 1.2) * (1.0 / weight - 1.0 / standard)) - 100_000.0
    };
    let result = stated(4, 1, &model)?;
    check(result.tolerance == 0.005, format!("{result:?}"))?;
    // Table 6: 1.234, 0.075, [1.083, 1.383]; the first-order linear answer has u = 0.054, [1.129,
    // 1.340].
    agrees("mass", of(&result, result.interval95.shortest), [1.234, 0.075, 1.083, 1.383], 0.01)?;
    agrees("mass", of(&result, result.interval95.symmetric), [1.234, 0.075, 1.083, 1.383], 0.005)?;
    check(result.beside(1.234, 0.054).validated == Some(false), "the first-order answer is found valid")
}

fn loss() -> Result<(), Failed> {
    // §9.4.2, no correlation: y = x₁² + x₂², deviations 0.005. In units of 10⁻⁶.
    let loss =
        |x1: f64| move |rng: &mut Philox| 1e6 * ((x1 + 0.005 * rng.normal()).powi(2) + (0.005 * rng.normal()).powi(2));
    let result = stated(5, 2, &loss(0.0))?;
    // x₁ = 0: an exponential law of mean 2σ² = 50; shortest interval 0 to −50 ln 0.05 = 149.8.
    agrees("x₁ = 0", of(&result, result.interval95.shortest), [50.0, 50.0, 0.0, 149.8], 0.5)?;
    // x₁ = 0.010: mean x₁² + 2σ² = 150, u = √(4x₁²σ² + 4σ⁴) = 111.8; σ² times a noncentral χ² with
    // two degrees, λ = 4, whose 2.5 and 97.5 % quantiles (scipy.stats.ncx2) times σ² = 25 are
    // these.
    let result = stated(6, 2, &loss(0.010))?;
    agrees("x₁ = 0.010", of(&result, result.interval95.symmetric), [150.0, 111.8, 8.547, 427.12], 5.0)?;
    let result = stated(7, 2, &loss(0.050))?;
    // x₁ = 0.050, λ = 100: 2550 and 502.5; the shortest interval of that law is 1594 to 3549.
    agrees("x₁ = 0.050", of(&result, result.interval95.symmetric), [2550.0, 502.5, 1638.5, 3603.4], 5.0)?;
    agrees("x₁ = 0.050", of(&result, result.interval95.shortest), [2550.0, 502.5, 1593.6, 3548.6], 20.0)
}

fn study() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("study.toml");
    let text = "duration_s = 10.0\nstep_s = 0.1\n[accelerometer]\nbias_mg = { mean = 0.0, sd = 1.0 }\n[report]\ntimes_s = [10.0]\n";
    std::fs::write(&path, text)?;
    let run = |out: &str, more: &[&str]| -> Result<Value, Failed> {
        let out = folder.path().join(out);
        let output = program()
            .arg("study")
            .arg(&path)
            .args(["--digits", "2", "--json", "--out"])
            .arg(out)
            .args(more)
            .output()?;
        check(output.status.code() == Some(0), String::from_utf8_lossy(&output.stderr).into_owned())?;
        Ok(serde_json::from_slice(&output.stdout)?)
    };
    let document = run("a", &[])?;
    let result = &document["jcgm101"];
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    // ½bt² of a bias of 1 mg: 0.4903 m.
    let sd = 0.5 * 1e-3 * 9.80665 * 100.0;
    let delta = number(&result["tolerance"]);
    near("tolerance", delta, tolerance(sd, 2), 1e-12)?;
    near("estimate", number(&result["estimate"]), 0.0, delta)?;
    near("standard uncertainty", number(&result["standard_uncertainty"]), sd, delta)?;
    for (k, end) in [-1.959_964 * sd, 1.959_964 * sd].into_iter().enumerate() {
        near("end", number(&result["interval95"]["symmetric"][k]), end, delta)?;
        check(result["interval95"]["shortest"][k].is_number(), "no shortest interval")?;
    }
    let count = result["trials"].as_u64().unwrap_or(0);
    check(document["members"] == count && count >= BLOCKS * BLOCK && result["digits"] == 2, result.to_string())?;
    check(result["linear"]["validated"] != false, result["linear"].to_string())?;
    // The same run again has the same bits.
    check(run("b", &[])?["jcgm101"] == *result, "another answer")?;
    check(run("c", &["--seed", "2"])?["jcgm101"] != *result, "another seed gives the same")?;
    // Control of the first stage: more digits take more trials.
    let law = |rng: &mut Philox| 3.0 * rng.normal();
    let draw = |k: u64| block(&mut trials(3, k * BLOCK..(k + 1) * BLOCK, &law));
    let blocks: Vec<_> = (0..BLOCKS).map(draw).collect();
    check(need(&blocks, 3).trials > 20 * need(&blocks, 2).trials, "three digits take hardly more than two")
}

/// Stopped in its second stage, which the note on the number of members begins.
#[cfg(unix)]
fn resumed() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("study.toml");
    let text = "duration_s = 10.0\nstep_s = 0.05\n[accelerometer]\nbias_mg = { mean = 0.0, sd = 0.6 }\n\
                noise_density_ug_rthz = 100.0\n[report]\ntimes_s = [10.0]\n";
    std::fs::write(&path, text)?;
    let ask = |out: &str| {
        let mut command = program();
        command
            .arg("study")
            .arg(&path)
            .args(["--digits", "2", "--backend", "cpu", "--json", "--out"])
            .arg(folder.path().join(out));
        command
    };
    let answer = |command: &mut Command| -> Result<Value, Failed> {
        let output = command.output()?;
        check(output.status.code() == Some(0), String::from_utf8_lossy(&output.stderr).into_owned())?;
        let mut document: Value = serde_json::from_slice(&output.stdout)?;
        document["seconds"] = Value::Null;
        Ok(document)
    };
    let whole = answer(&mut ask("whole"))?;
    for _ in 0..5 {
        let mut child = ask("stopped").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        let mut words = BufReader::new(child.stderr.take().ok_or("no stderr")?);
        let begun = (&mut words).lines().map_while(Result::ok).any(|line| line.contains("stable digits"));
        check(begun, "no word about the number of members")?;
        Command::new("kill").args(["-INT", &child.id().to_string()]).status()?;
        let output = child.wait_with_output()?;
        // Done before it was stopped: again.
        if output.status.success() {
            continue;
        }
        check(output.status.code() == Some(130), format!("{:?}", output.status))?;
        let resumed = answer(ask("stopped").arg("--resume"))?;
        return check(resumed == whole, "resumed and uninterrupted answers differ");
    }
    Err("no run was long enough to be stopped".into())
}
