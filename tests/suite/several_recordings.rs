//! Several recordings of one sensor: fitted together, each with its own beginning and offset, and
//! judged by others.

use std::fmt::Write as _;
use std::path::PathBuf;

use libtest_mimic::{Failed, Trial};
use proofmass::trial::physics::Physics;
use proofmass::trial::plant::Size;

use super::bench::{Answer, Bench, run};
use super::diagnosis_driven::plant::{Plan, Planted, plant};
use super::world::{check, near, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("several recordings: a spring is found in both together and predicts a third", together),
        test("several recordings: a spring that another sensor does not have explains nothing there", elsewhere),
        test("several recordings: what does not belong together is refused by name", refused),
        test("several recordings: one in another unit than the other ends unexplained", contradicting),
    ]
}

const MODEL: &str = "kind = \"driven\"\nrate_hz = 1000.0\n[columns]\ninput = \"u\"\noutput = \"y\"\n";

fn csv(planted: &Planted, range: std::ops::Range<usize>, offset: f64) -> String {
    let mut text = String::from("u,y\n");
    for k in range {
        let _ = writeln!(text, "{},{}", planted.input[k], planted.reading[k] + offset);
    }
    text
}

fn diagnose(train: &[&PathBuf], model: &PathBuf, test: &[&PathBuf]) -> Result<Answer, Failed> {
    let mut command = program();
    command.arg("diagnose").args(train).arg("--model").arg(model).arg("--json");
    if !test.is_empty() {
        command.arg("--test").args(test);
    }
    run(&mut command)
}

fn planted() -> Result<Planted, Failed> {
    of_strength(0.05)
}

fn of_strength(strength: f64) -> Result<Planted, Failed> {
    plant(&Plan {
        physics: Some(Physics::CubicStiffness),
        size: Size::Raw(strength),
        samples: 9000,
        rate_hz: 1000.0,
        resonance_hz: 60.0,
        zeta: 0.05,
        noise: 0.002,
        seed: 11,
        driven: true,
    })
}

fn together() -> Result<(), Failed> {
    let (bench, planted) = (Bench::new()?, planted()?);
    let sd = proofmass::numerics::moments::mean_sd(&planted.reading).1;
    // The second begins in the middle of the motion and reads three standard deviations higher.
    let first = bench.file("first.csv", &csv(&planted, 0..3000, 0.0))?;
    let second = bench.file("second.csv", &csv(&planted, 4000..7000, 3.0 * sd))?;
    let third = bench.file("third.csv", &csv(&planted, 7500..9000, 0.0))?;
    let model = bench.file("model.toml", MODEL)?;
    let judged = diagnose(&[&first], &model, &[&third])?.json()?;
    let both = diagnose(&[&first, &second], &model, &[])?.json()?;
    for (verdict, roles) in [(&judged, ["train", "test"]), (&both, ["train", "train"])] {
        check(verdict["verdict"] == "explained", format!("{}: {}", verdict["verdict"], verdict["sentence"]))?;
        let effects = verdict["effects"].as_array().map_or(0, Vec::len);
        check(effects == 1 && verdict["effects"][0]["id"] == "cubic-stiffness", format!("{}", verdict["effects"]))?;
        let beta = &verdict["effects"][0]["parameters"][0];
        let width = beta["ci95"][1].as_f64().unwrap_or(0.0) - beta["ci95"][0].as_f64().unwrap_or(0.0);
        // Twice the 95 % interval: one recording, not a study of coverage.
        near("beta", beta["value"].as_f64().unwrap_or(0.0), planted.strength, width)?;
        let floor = verdict["fit"]["noise_floor"].as_f64().unwrap_or(0.0);
        for (i, role) in roles.iter().enumerate() {
            let entry = &verdict["fit"]["recordings"][i];
            check(entry["role"] == *role, format!("{entry}"))?;
            let [before, after] = ["rmse_before", "rmse_after"].map(|key| entry[key].as_f64().unwrap_or(0.0));
            check(after < 1.15 * floor && before > 3.0 * after && after > 0.0, format!("{entry}, floor {floor}"))?;
        }
    }
    // 1500 samples less 24 at either end and the first 50.
    check(judged["fit"]["recordings"][1]["samples"] == 1402, format!("{}", judged["fit"]["recordings"]))?;
    // Control: end to end in one file, the jump between both is not predicted.
    let glued = csv(&planted, 0..3000, 0.0) + csv(&planted, 4000..7000, 3.0 * sd).trim_start_matches("u,y\n");
    let glued = diagnose(&[&bench.file("glued.csv", &glued)?], &model, &[])?.json()?;
    let entry = &glued["fit"]["recordings"][0];
    let floor = both["fit"]["noise_floor"].as_f64().unwrap_or(0.0);
    let error = entry["rmse_after"].as_f64().or(entry["rmse_before"].as_f64()).unwrap_or(0.0);
    check(error > 5.0 * floor, format!("{entry}, floor {floor}"))
}

// The control is the validation recording of `together`, of the same sensor: explained.
fn elsewhere() -> Result<(), Failed> {
    let (bench, planted, other) = (Bench::new()?, planted()?, of_strength(0.06)?);
    let first = bench.file("first.csv", &csv(&planted, 0..3000, 0.0))?;
    let others = bench.file("others.csv", &csv(&other, 7500..9000, 0.0))?;
    let model = bench.file("model.toml", MODEL)?;
    let verdict = diagnose(&[&first], &model, &[&others])?.json()?;
    let sentence = verdict["sentence"].as_str().unwrap_or_default();
    check(verdict["verdict"] == "unexplained", format!("{}: {sentence}", verdict["verdict"]))?;
    check(verdict["effects"][0]["id"] == "cubic-stiffness", format!("{sentence} {}", verdict["findings"]))?;
    check(sentence.contains("on the validation recording") && !sentence.contains("remains is noise"), sentence)?;
    // The share is of the errors over the noise that stand next to it.
    let test = &verdict["fit"]["test"];
    let [before, after, share] = [&test["rmse_before"], &test["rmse_after"], &test["share"]["value"]]
        .map(|number| number.as_f64().unwrap_or(f64::NAN));
    let noise = verdict["fit"]["noise_floor"].as_f64().unwrap_or(f64::NAN);
    let excess = |error: f64| error.powi(2) - noise.powi(2);
    near("share", share, 1.0 - excess(after) / excess(before), 1e-9)
}

// No law has two strengths at once, and laws with memory begin anew in each recording.
fn contradicting() -> Result<(), Failed> {
    let (bench, planted) = (Bench::new()?, planted()?);
    let mut small = self::planted()?;
    small.reading.iter_mut().for_each(|y| *y *= 0.3);
    let first = bench.file("first.csv", &csv(&planted, 0..2000, 0.0))?;
    let second = bench.file("second.csv", &csv(&small, 4000..6000, 0.0))?;
    let model = bench.file("model.toml", MODEL)?;
    let verdict = diagnose(&[&first, &second], &model, &[])?.json()?;
    check(verdict["verdict"] == "unexplained", format!("{}: {}", verdict["verdict"], verdict["sentence"]))
}

fn refused() -> Result<(), Failed> {
    let (bench, planted) = (Bench::new()?, planted()?);
    let first = bench.file("first.csv", &csv(&planted, 0..2000, 0.0))?;
    let second = bench.file("second.csv", &csv(&planted, 4000..6000, 0.0))?;
    let part = bench.file("part.csv", &csv(&planted, 1200..2000, 0.0))?;
    let short = bench.file("short.csv", &csv(&planted, 4000..4230, 0.0))?;
    let other = bench.file("other.csv", &csv(&planted, 0..2000, 0.0).replacen("u,y", "u,z", 1))?;
    let timed = |name: &str, step_s: f64, from: usize| {
        let mut text = String::from("t,u,y\n");
        for k in 0..1000 {
            let _ = writeln!(text, "{},{},{}", step_s * k as f64, planted.input[from + k], planted.reading[from + k]);
        }
        bench.file(name, &text)
    };
    let (fast, slow) = (timed("fast.csv", 1e-3, 0)?, timed("slow.csv", 2e-3, 4000)?);
    let model = bench.file("model.toml", MODEL)?;
    let clock = bench
        .file("clock.toml", &MODEL.replace("rate_hz = 1000.0\n", "").replace("[columns]", "[columns]\ntime = \"t\""))?;
    let split = bench.file("split.toml", &format!("{MODEL}[split]\ntrain = [[0, 1000]]\n"))?;
    let still = bench.file("still.toml", "kind = \"static\"\nrate_hz = 1000.0\n[columns]\nchannels = [\"y\"]\n")?;
    let of = |train: &[&PathBuf], model, test: &[&PathBuf]| diagnose(train, model, test);
    of(&[&fast, &slow], &clock, &[])?.refuses("two rates", "500 Hz")?;
    of(&[&first], &model, &[&short])?.refuses("a short judge", "too few for validation")?;
    of(&[&first, &other], &model, &[])?.refuses("another column", "other.csv")?;
    of(&[&first, &second], &split, &[])?.refuses("a split", "[split]")?;
    of(&[&first], &still, &[&second])?.refuses("at rest", "2 recordings")?;
    of(&[&first], &model, &[&first])?.refuses("a recording that judges itself", "from row 0 on")?;
    of(&[&first], &model, &[&part])?.refuses("a part that judges the whole", "part.csv is also in")?;
    of(&[&first, &first], &model, &[])?.refuses("one recording given twice", "give each recording once")
}
